// FCLIB files: round trips in every matrix storage, files written value by value as other programs
// write them, and refusals.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include <functional>
#include <limits>
#include <optional>

#include "host/io/h5.h"
#include "host/io/problem_file.h"
#include "tests/host/input_files.h"
#include "tests/host/io/output_fixtures.h"

namespace scree {
namespace {

using test::refusal;
using test::ScratchDirectory;
using testing::AllOf;
using testing::HasSubstr;
using Ints = std::vector<std::int32_t>;
using Doubles = std::vector<double>;

void put(h5::Group& group, const char* name, const Ints& values) {
  group.write(name, std::span<const std::int32_t>(values));
}
void put(h5::Group& group, const char* name, const Doubles& values) {
  group.write(name, std::span<const double>(values));
}

/// A matrix as it lies in a file.
struct RawMatrix {
  int m, n, nz;
  Ints p, i;
  Doubles x;
  int nzmax = 0;
};

void put(h5::Group& parent, const char* name, const RawMatrix& a) {
  h5::Group group = parent.create_group(name);
  put(group, "m", Ints{a.m});
  put(group, "n", Ints{a.n});
  put(group, "nz", Ints{a.nz});
  put(group, "nzmax", Ints{a.nzmax});
  put(group, "p", a.p);
  put(group, "i", a.i);
  put(group, "x", a.x);
}

/// All that the file of a local problem in 2-D with two contacts holds; tests spoil parts of it.
struct RawLocal {
  Ints spacedim{2};
  RawMatrix W{4, 4, -2, {0, 1, 2, 3, 4}, {0, 1, 2, 3}, {1, 2, 3, 4}, 4};
  Doubles q{-1, 0, 1, 0.5};
  Doubles mu{0.5, 0};
  std::optional<Doubles> mu_r;
  std::string group = "fclib_local";
  std::function<void(h5::Group& root, h5::Group& form)> more = [](h5::Group&, h5::Group&) {};
  bool has_vectors = true;
};

void write(const std::filesystem::path& path, const RawLocal& raw) {
  h5::File file = h5::File::create(path);
  {
    h5::Group root = file.root();
    h5::Group form = root.create_group(raw.group);
    put(form, "spacedim", raw.spacedim);
    put(form, "W", raw.W);
    if (raw.has_vectors) {
      h5::Group vectors = form.create_group("vectors");
      put(vectors, "q", raw.q);
      put(vectors, "mu", raw.mu);
      if (raw.mu_r) put(vectors, "mu_r", *raw.mu_r);
    }
    raw.more(root, form);
  }
  file.close();
}

/// Makes it a problem of one contact with rolling friction.
RawLocal& make_rolling(RawLocal& raw) {
  raw.spacedim = {5};
  raw.W = {5, 5, -2, {0, 1, 2, 3, 4, 5}, {0, 1, 2, 3, 4}, {1, 2, 3, 4, 5}, 5};
  raw.q = {-1, 0, 1, 0.5, 2};
  raw.mu = {0.5};
  raw.mu_r = {0.01};
  return raw;
}

class FclibFile : public ::testing::Test {
 protected:
  LocalProblem read_local(const RawLocal& raw) {
    write(path_, raw);
    return std::get<LocalProblem>(read_problem(path_).form);
  }
  std::string refusal_of(const RawLocal& raw) {
    write(path_, raw);
    return refusal([&] { read_problem(path_); });
  }
  ScratchDirectory scratch_;
  std::filesystem::path path_ = scratch_ / "problem.hdf5";
};

/// The other triangle is not stored where the attribute says so.
TEST_F(FclibFile, SymmetricPackedMatricesAreWholeOnceRead) {
  RawLocal raw;
  raw.W = {4, 4, -1, {0, 2, 3, 4, 5}, {0, 2, 1, 2, 3}, {5, -1, 6, 7, 8}, 5};  // the lower one
  raw.more = [](h5::Group&, h5::Group& form) {
    h5::Group W = form.open_group("W");
    W.write_attribute<std::int32_t>("symmetric_packed", 1);
  };
  EXPECT_EQ(read_local(raw).W,
            compress(4, 4, {{0, 0, 5}, {0, 2, -1}, {1, 1, 6}, {2, 0, -1}, {2, 2, 7}, {3, 3, 8}}));
  raw.W = {4, 4, 3, {0, 1, 0}, {0, 0, 1}, {5, 1, 1}, 3};  // both
  EXPECT_THAT(refusal_of(raw),
              AllOf(HasSubstr("W/attribute symmetric_packed"), HasSubstr("one triangle")));
  raw.more = [](h5::Group&, h5::Group& form) {
    h5::Group W = form.open_group("W");
    W.write_attribute<std::int32_t>("symmetric_packed", 0);
  };
  EXPECT_EQ(read_local(raw).W, compress(4, 4, {{0, 0, 5}, {0, 1, 1}, {1, 0, 1}}));
}

// ---- round trips -------------------------------------------------------------------------------

LocalProblem local_problem(int dimension, bool bilateral) {
  const int rows = 3 * dimension;
  LocalProblem p;
  p.dimension = dimension;
  std::vector<MatrixEntry> entries;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < rows; ++column)
      if ((row + 2 * column) % 3 != 1) entries.push_back({row, column, 1.0 / (1 + row + column)});
  entries[2].value = 0;  // a zero that is stored
  p.W = compress(rows, rows, entries);
  for (int row = 0; row < rows; ++row) p.q.push_back(std::sqrt(row + 1.0) - 2);
  p.mu = {0.3, 0, 0.7};
  if (dimension == 5) p.mu_r = {0.01, 0.02, 0};
  if (bilateral) {
    p.V = compress(rows, 2, {{0, 1, 0.5}, {rows - 1, 0, -2}});
    p.R = compress(2, 2, {{0, 0, 3}, {0, 1, 0.25}, {1, 0, 0.25}, {1, 1, 1}});
    p.s = {0.125, -1e-300};
  }
  return p;
}

GlobalProblem global_problem(int dimension, bool bilateral) {
  const int rows = 3 * dimension;
  GlobalProblem p;
  p.dimension = dimension;
  p.M = compress(4, 4, {{0, 0, 2}, {1, 1, 2}, {2, 2, 3}, {2, 3, 0.5}, {3, 2, 0.5}, {3, 3, 1e-11}});
  std::vector<MatrixEntry> entries;
  for (int row = 0; row < 4; ++row)
    for (int column = row; column < rows; column += 2) entries.push_back({row, column, row - 1.5});
  p.H = compress(4, rows, entries);
  p.f = {1, -2, 3, std::numeric_limits<double>::denorm_min()};
  p.w.assign(static_cast<std::size_t>(rows), 0.1);
  p.mu = {0.3, 0, 0.7};
  if (dimension == 5) p.mu_r = {0.01, 0.02, 0};
  if (bilateral) {
    p.G = compress(4, 1, {{1, 0, 1}});
    p.b = {0.5};
  }
  return p;
}

struct RoundTrip {
  int dimension;
  bool bilateral;
  FclibStorage storage;
};

class FclibRoundTrip : public ::testing::TestWithParam<RoundTrip> {
 protected:
  StoredProblem written_and_read(const StoredProblem& problem) {
    const auto path = scratch_ / "problem.hdf5";
    write_problem(path, problem, GetParam().storage);
    return read_problem(path);
  }
  static void expect_same_texts_and_points(const StoredProblem& a, const StoredProblem& b) {
    EXPECT_EQ(a.info, b.info);
    EXPECT_EQ(a.solution, b.solution);
    EXPECT_EQ(a.guesses, b.guesses);
  }
  ScratchDirectory scratch_;
};
INSTANTIATE_TEST_SUITE_P(All, FclibRoundTrip,
                         ::testing::Values(RoundTrip{2, false, FclibStorage::triplets},
                                           RoundTrip{2, true, FclibStorage::columns},
                                           RoundTrip{2, false, FclibStorage::rows},
                                           RoundTrip{3, true, FclibStorage::triplets},
                                           RoundTrip{3, false, FclibStorage::columns},
                                           RoundTrip{3, true, FclibStorage::rows},
                                           RoundTrip{5, true, FclibStorage::triplets},
                                           RoundTrip{5, false, FclibStorage::columns},
                                           RoundTrip{5, true, FclibStorage::rows}));

TEST_P(FclibRoundTrip, LocalProblem) {
  StoredProblem problem;
  const LocalProblem p = local_problem(GetParam().dimension, GetParam().bilateral);
  problem.form = p;
  problem.info = {"a title", "described as \xa8 in Latin-1", "rank 3"};
  const Doubles rows(p.q.size(), 0.5), other(p.q.size(), -1e-9);
  problem.solution = {{}, rows, other, p.s};
  problem.guesses = {{{}, other, rows, {}}, {{}, rows, rows, p.s}};
  const StoredProblem back = written_and_read(problem);
  EXPECT_EQ(std::get<LocalProblem>(back.form), p);
  expect_same_texts_and_points(back, problem);
}

TEST_P(FclibRoundTrip, GlobalProblem) {
  StoredProblem problem;
  const GlobalProblem p = global_problem(GetParam().dimension, GetParam().bilateral);
  problem.form = p;
  problem.info.title = "only a title";
  const Doubles rows(p.w.size(), 0.5);
  problem.solution = {p.f, rows, rows, p.b};
  const StoredProblem back = written_and_read(problem);
  EXPECT_EQ(std::get<GlobalProblem>(back.form), p);
  expect_same_texts_and_points(back, problem);
}

TEST(FclibStorageDefaults, AreThoseOfTheCollection) {
  const ScratchDirectory scratch;
  StoredProblem local, global;
  local.form = local_problem(3, false);
  global.form = global_problem(3, false);
  write_problem(scratch / "local.hdf5", local);
  write_problem(scratch / "global.hdf5", global);
  const auto nz = [&](const char* file, const char* name) {
    return h5::File::open(scratch / file).root().read<std::int32_t>(name).front();
  };
  EXPECT_EQ(nz("local.hdf5", "fclib_local/W/nz"), -2);
  EXPECT_EQ(nz("global.hdf5", "fclib_global/M/nz"), 6);
}

// ---- files of others ---------------------------------------------------------------------------

/// A mass that touches a plane, as Siconos writes problems with rolling friction.
TEST_F(FclibFile, RollingFrictionLiesInAGroupOfItsOwn) {
  const auto put_rolling = [&](const char* name, int spacedim) {
    h5::File file = h5::File::create(path_);
    {
      h5::Group root = file.root();
      h5::Group form = root.create_group(name);
      put(form, "spacedim", Ints{spacedim});
      put(form, "M", RawMatrix{2, 2, 2, {0, 1}, {0, 1}, {3, 4}, 2});
      put(form, "H", RawMatrix{2, 5, 3, {0, 1, 4}, {0, 1, 1}, {1, 2, 3}, 3});
      h5::Group vectors = form.create_group("vectors");
      put(vectors, "f", Doubles{-1, 2});
      put(vectors, "w", Doubles{0, 0, 0, 0, 0.5});
      put(vectors, "mu", Doubles{0.7});
      put(vectors, "mu_r", Doubles{0.02});
    }
    file.close();
  };
  put_rolling("fclib_global_rolling", 5);
  const auto p = std::get<GlobalProblem>(read_problem(path_).form);
  EXPECT_EQ(p.dimension, 5);
  EXPECT_EQ(p.H, compress(2, 5, {{0, 0, 1}, {1, 1, 2}, {1, 4, 3}}));
  EXPECT_EQ(p.mu, Doubles{0.7});
  EXPECT_EQ(p.mu_r, Doubles{0.02});
  put_rolling("fclib_global", 5);
  EXPECT_THAT(refusal([&] { read_problem(path_); }),
              AllOf(HasSubstr("spacedim is 5 in fclib_global"), HasSubstr("fclib_global_rolling")));
  put_rolling("fclib_global_rolling", 3);
  EXPECT_THAT(refusal([&] { read_problem(path_); }),
              HasSubstr("spacedim is 3 in fclib_global_rolling, expected 5"));
}

TEST_F(FclibFile, TripletsHaveRowsInIDuplicatesAndRoomBehind) {
  RawLocal raw;
  // W = [1 0 0 7; 0 2 0 0; 0 0 3 0; 0 0 0 4], its 3 in two parts; what lies behind nz is garbage.
  raw.W = {4, 4, 6, {0, 1, 2, 3, 3, 2, 99}, {0, 1, 2, 3, 0, 2, -5}, {1, 2, 1, 4, 7, 2, 1e300}, 7};
  EXPECT_EQ(read_local(raw).W,
            compress(4, 4, {{0, 0, 1}, {0, 3, 7}, {1, 1, 2}, {2, 2, 3}, {3, 3, 4}}));
}

TEST_F(FclibFile, ColumnsAndRowsNeedNotBeSorted) {
  RawLocal raw;
  const SparseMatrix W = compress(4, 4, {{0, 0, 1}, {0, 3, 7}, {1, 1, 2}, {2, 2, 3}, {3, 3, 4}});
  raw.W = {4, 4, -2, {0, 2, 3, 4, 5}, {3, 0, 1, 2, 3}, {7, 1, 2, 3, 4}, 5};
  EXPECT_EQ(read_local(raw).W, W);
  raw.W = {4, 4, -1, {0, 1, 2, 3, 5}, {0, 1, 2, 3, 0}, {1, 2, 3, 4, 7}, 5};
  EXPECT_EQ(read_local(raw).W, W);
}

TEST_F(FclibFile, OtherWidthsOfNumbersAreRead) {
  RawLocal raw;
  raw.has_vectors = false;
  raw.more = [](h5::Group&, h5::Group& form) {
    h5::Group vectors = form.create_group("vectors");
    const std::vector<float> q{-1, 0, 1, 0.5f};
    vectors.write("q", std::span<const float>(q));
    put(vectors, "mu", Doubles{0.5, 0});
  };
  EXPECT_EQ(read_local(raw).q, (Doubles{-1, 0, 1, 0.5}));
}

TEST_F(FclibFile, TextsOfVariableLengthAreLeftOut) {  // as Python writes them
  RawLocal raw;
  raw.more = [](h5::Group&, h5::Group& form) { form.create_group("info"); };
  write(path_, raw);
  {
    const h5::Handle file(H5Fopen(path_.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
    const h5::Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(type.id(), H5T_VARIABLE);
    const h5::Handle space(H5Screate(H5S_SCALAR), H5Sclose);
    const h5::Handle title(H5Dcreate2(file.id(), "fclib_local/info/title", type.id(), space.id(),
                                      H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                           H5Dclose);
    const char* text = "from Python";
    ASSERT_GE(H5Dwrite(title.id(), type.id(), H5S_ALL, H5S_ALL, H5P_DEFAULT, &text), 0);
  }
  EXPECT_EQ(read_problem(path_).info.title, "");
}

TEST_F(FclibFile, OneTriangleOfMIsMirrored) {
  StoredProblem problem;
  GlobalProblem p = global_problem(3, false);
  p.M = compress(4, 4, {{0, 0, 2}, {1, 1, 2}, {2, 2, 3}, {2, 3, 0.5}, {3, 3, 1}});
  problem.form = p;
  write_problem(path_, problem);
  EXPECT_EQ(std::get<GlobalProblem>(read_problem(path_).form).M,
            compress(4, 4, {{0, 0, 2}, {1, 1, 2}, {2, 2, 3}, {2, 3, 0.5}, {3, 2, 0.5}, {3, 3, 1}}));
}

// ---- refusals ----------------------------------------------------------------------------------

struct BadLocal {
  const char* name;
  std::function<void(RawLocal&)> spoil;
  std::vector<const char*> words;
};

std::ostream& operator<<(std::ostream& out, const BadLocal& bad) { return out << bad.name; }

class BadFclib : public FclibFile, public ::testing::WithParamInterface<BadLocal> {};

const double nan_value = std::numeric_limits<double>::quiet_NaN();

INSTANTIATE_TEST_SUITE_P(
    All, BadFclib,
    ::testing::Values(
        BadLocal{"NoProblem", [](RawLocal& r) { r.group = "other"; }, {"holds no contact problem"}},
        BadLocal{"RollingWithoutItsFriction",
                 [](RawLocal& r) { r.spacedim = {5}; },
                 {"fclib_local/vectors/mu_r", "no such dataset"}},
        BadLocal{"RollingFrictionWithoutItsRows",
                 [](RawLocal& r) { r.mu_r = {0.1, 0.1}; },
                 {"mu_r", "spacedim is 2", "expected 5"}},
        BadLocal{"RollingFrictionOfMoreContacts",
                 [](RawLocal& r) { make_rolling(r).mu_r = {0.1, 0.2}; },
                 {"mu_r has 2 values, expected 1", "one a contact"}},
        BadLocal{"NegativeRollingFriction",
                 [](RawLocal& r) { make_rolling(r).mu_r = {-0.1}; },
                 {"mu_r[0] is -0.1", "not negative"}},
        BadLocal{"RollingAndAnother",
                 [](RawLocal& r) {
                   r.more = [](h5::Group& root, h5::Group&) {
                     root.create_group("fclib_global_rolling");
                   };
                 },
                 {"both fclib_local and fclib_global_rolling"}},
        BadLocal{"BothKinds",
                 [](RawLocal& r) {
                   r.more = [](h5::Group& root, h5::Group&) { root.create_group("fclib_global"); };
                 },
                 {"both"}},
        BadLocal{"Spacedim", [](RawLocal& r) { r.spacedim = {4}; }, {"spacedim", "4", "2, 3, or 5"}},
        BadLocal{"TwoSpacedims",
                 [](RawLocal& r) {
                   r.spacedim = {2, 3};
                 },
                 {"spacedim", "2 values", "expected one"}},
        BadLocal{"NoVectors",
                 [](RawLocal& r) { r.has_vectors = false; },
                 {"fclib_local/vectors/q", "no such dataset"}},
        BadLocal{"UnknownStorage", [](RawLocal& r) { r.W.nz = -3; }, {"W/nz", "-3", "triplets"}},
        BadLocal{"TooFewTriplets", [](RawLocal& r) { r.W.nz = 5; }, {"W/i", "4 values", "5"}},
        BadLocal{"WrongSizeOfW", [](RawLocal& r) { r.W.m = 5; }, {"W/m", "5", "expected 4"}},
        BadLocal{"NegativeSizeOfW", [](RawLocal& r) { r.W.n = -4; }, {"W/n", "-4", "expected 4"}},
        BadLocal{"RowStartsTooFew", [](RawLocal& r) { r.W.p.pop_back(); }, {"W/p", "4", "5"}},
        BadLocal{"RowStartsNotFromZero", [](RawLocal& r) { r.W.p[0] = 1; }, {"W/p[0]", "1", "0"}},
        BadLocal{"RowStartsDescend", [](RawLocal& r) { r.W.p[2] = 0; }, {"W/p[2]", "ascending"}},
        BadLocal{"OneRowStartPastTheEnd",
                 [](RawLocal& r) { r.W.p[2] = 100000; },
                 {"W/p[2] is 100000", "the last of p"}},
        BadLocal{"RowStartsPastTheEnd", [](RawLocal& r) { r.W.p[4] = 9; }, {"W/i", "4", "9"}},
        BadLocal{"ColumnTooLarge", [](RawLocal& r) { r.W.i[2] = 4; }, {"W/i[2]", "4", "0 to 3"}},
        BadLocal{"ColumnNegative", [](RawLocal& r) { r.W.i[3] = -1; }, {"W/i[3]", "-1"}},
        BadLocal{"NanInW",
                 [](RawLocal& r) { r.W.x[1] = nan_value; },
                 {"W in row 1, column 1", "nan", "finite"}},
        BadLocal{"NanInQ", [](RawLocal& r) { r.q[2] = nan_value; }, {"q[2]", "nan", "finite"}},
        BadLocal{"InfiniteMu", [](RawLocal& r) { r.mu[0] = 1 / 0.0; }, {"mu[0]", "inf"}},
        BadLocal{"NegativeMu", [](RawLocal& r) { r.mu[1] = -0.5; }, {"mu[1]", "-0.5", "negative"}},
        BadLocal{"MuOfMoreContacts",
                 [](RawLocal& r) { r.mu.push_back(0.5); },
                 {"mu", "3 values", "expected 2", "one a contact"}},
        BadLocal{
            "RowsNotOfContacts", [](RawLocal& r) { r.spacedim = {3}; }, {"4", "multiple", "3"}},
        BadLocal{"NoContacts",
                 [](RawLocal& r) {
                   r.W = {0, 0, -2, {0}, {}, {}, 0};
                   r.q = {};
                   r.mu = {};
                 },
                 {"no contacts"}},
        BadLocal{"VWithoutR",
                 [](RawLocal& r) {
                   r.more = [](h5::Group&, h5::Group& form) { form.create_group("V"); };
                 },
                 {"V and R"}},
        BadLocal{"ShortSolution",
                 [](RawLocal& r) {
                   r.more = [](h5::Group& root, h5::Group&) {
                     h5::Group solution = root.create_group("solution");
                     put(solution, "u", Doubles{1, 2});
                   };
                 },
                 {"solution/u", "2 values", "expected 4"}},
        BadLocal{"MissingGuess",
                 [](RawLocal& r) {
                   r.more = [](h5::Group& root, h5::Group&) {
                     h5::Group guesses = root.create_group("guesses");
                     put(guesses, "number_of_guesses", Ints{2000000000});
                   };
                 },
                 {"guesses/1", "no such group"}}),
    [](const auto& info) { return info.param.name; });

TEST_P(BadFclib, IsRefusedInOneSentence) {
  RawLocal raw;
  GetParam().spoil(raw);
  const std::string message = refusal_of(raw);
  EXPECT_THAT(message, HasSubstr("cannot read contact problem " + path_.string() + ": "));
  for (const char* word : GetParam().words) EXPECT_THAT(message, HasSubstr(word));
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

TEST_F(FclibFile, WrongKindsOfNumbersAreRefused) {
  RawLocal raw;
  raw.has_vectors = false;
  raw.more = [](h5::Group&, h5::Group& form) {
    h5::Group vectors = form.create_group("vectors");
    put(vectors, "q", Ints{1, 2, 3, 4});
    put(vectors, "mu", Doubles{0.5, 0});
  };
  EXPECT_THAT(refusal_of(raw), AllOf(HasSubstr("vectors/q"), HasSubstr("floating-point")));
}

TEST_F(FclibFile, WhatIsNoHdf5FileIsRefused) {
  EXPECT_THAT(refusal([&] { read_problem(path_); }), HasSubstr("there is no such file"));
  EXPECT_THAT(refusal([&] { read_problem(scratch_.path()); }), HasSubstr("it is not a file"));
  test::put(path_, "");
  EXPECT_THAT(refusal([&] { read_problem(path_); }), HasSubstr("it is not an HDF5 file"));
  test::put(path_, std::string(4096, 'x'));
  EXPECT_THAT(refusal([&] { read_problem(path_); }), HasSubstr("it is not an HDF5 file"));
}

TEST_F(FclibFile, TruncatedFilesAreRefused) {
  write(path_, {});
  const std::string whole = test::contents(path_);
  for (const std::size_t size : {whole.size() - 1, whole.size() / 2, std::size_t(100)}) {
    test::put(path_, whole.substr(0, size));
    EXPECT_THAT(refusal([&] { read_problem(path_); }), HasSubstr("cannot read contact problem"));
  }
}

TEST_F(FclibFile, InvalidProblemsAreNotWritten) {
  StoredProblem problem;
  LocalProblem p = local_problem(3, false);
  p.mu[1] = -1;
  problem.form = p;
  EXPECT_THAT(refusal([&] { write_problem(path_, problem); }), HasSubstr("mu[1]"));
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(FclibFile, FullDiskKeepsThePreviousFile) {
  StoredProblem problem;
  problem.form = local_problem(3, false);
  write_problem(path_, problem);
  const std::string before = test::contents(path_);
  const int code = test::with_full_disk(4096, [&] {
    try {
      write_problem(path_, problem);
    } catch (const RunError& error) {
      return std::string(error.what()).find("cannot write") == std::string::npos ? 3 : 1;
    }
    return 0;
  });
  EXPECT_EQ(code, 1);
  EXPECT_EQ(test::contents(path_), before);
}

}  // namespace
}  // namespace scree
