// Problems with bodies in scree's own layout.
#include "host/io/problem_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>

#include "host/io/body_problem_layout.h"
#include "host/io/h5.h"
#include "host/io/seal.h"
#include "tests/distinct_fields.h"
#include "tests/host/input_files.h"
#include "tests/host/io/output_fixtures.h"
#include "tests/stored_problem_samples.h"

namespace scree {
namespace {

using fixtures::random_body_problem;
using fixtures::stored;
using test::refusal;
using test::ScratchDirectory;
using testing::HasSubstr;

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

class ProblemFile : public ::testing::TestWithParam<ContactLayout> {
 protected:
  ScratchDirectory scratch_;
  std::filesystem::path path_ = scratch_ / "problem_7.hdf5";
};
INSTANTIATE_TEST_SUITE_P(Layouts, ProblemFile,
                         ::testing::Values(ContactLayout::radial, ContactLayout::general,
                                           ContactLayout::rolling),
                         [](const auto& info) { return std::string(to_string(info.param)); });

TEST_P(ProblemFile, RoundTripKeepsEveryBit) {
  BodyProblem p = random_body_problem({.layout = GetParam(), .has_adhesion = true});
  fixtures::visit_numbered(
      p, [&]<class T>(const ContactField& field, int number, std::vector<T>& values) {
        if (field.is_optional) values = fixtures::distinct_values<T>(number, p.body_a.size());
      });
  write_problem(path_, stored(p));
  const StoredProblem read = read_problem(path_);
  const auto& back = std::get<BodyProblem>(read.form);
  EXPECT_EQ(back.layout, p.layout);
  EXPECT_EQ(back.source, p.source);
  EXPECT_EQ(back.free_count, p.free_count);
  EXPECT_TRUE(same_bits(back.body_id, p.body_id));
  EXPECT_TRUE(same_bits(back.free_velocity, p.free_velocity));
  EXPECT_TRUE(same_bits(back.radial_inertia, p.radial_inertia));
  EXPECT_TRUE(same_bits(back.general_inertia, p.general_inertia));
  p.visit([](const ContactField& field, const auto& a,
             const auto& b) { EXPECT_TRUE(same_bits(a, b)) << field.name; },
          p, back);
  EXPECT_TRUE(same_bits(back.impulse, p.impulse));
}

/// The names in files are a promise, whatever the list of fields calls them.
TEST_P(ProblemFile, HasTheDatasetsOfTheFormat) {
  BodyProblem p = random_body_problem({.layout = GetParam()});
  const bool is_radial = GetParam() == ContactLayout::radial;
  const bool is_rolling = GetParam() == ContactLayout::rolling;
  for (const bool has_drift : {false, true}) {
    p.drift.assign(has_drift ? p.body_a.size() : 0, {});
    write_problem(path_, stored(p));
    int count = 0;
    p.visit([&](const ContactField&, const auto&) { ++count; }, p);
    EXPECT_EQ(count, 10);
    const h5::File file = h5::File::open(path_);
    const h5::Group contact = file.root().open_group("contact");
    for (const char* name : {"body_a", "body_b", "normal", "bias", "mu", "adhesion"})
      EXPECT_TRUE(contact.has(name)) << name;
    EXPECT_EQ(contact.has("arm_a"), !is_radial);
    EXPECT_EQ(contact.has("arm_b"), !is_radial);
    EXPECT_EQ(contact.has("rolling"), is_rolling);
    EXPECT_EQ(contact.has("drift"), has_drift);
  }
}

TEST_P(ProblemFile, DamageAnywhereIsFoundBeforeHdf5ReadsIt) {
  write_problem(path_, stored(random_body_problem({.layout = GetParam()})));
  const std::string good = test::contents(path_);
  EXPECT_TRUE(good.starts_with("scree contact problem\nversion 1\n"));
  for (std::size_t byte = 30; byte < good.size(); byte += 211) {
    std::string bad = good;
    bad[byte] = static_cast<char>(bad[byte] ^ 0x10);
    test::put(path_, bad);
    EXPECT_THROW(read_problem(path_), InputError) << "byte " << byte;
  }
  test::put(path_, good.substr(0, good.size() - 1));
  EXPECT_THAT(refusal([&] { read_problem(path_); }), HasSubstr("bytes where"));
}

TEST_P(ProblemFile, OneWithoutASealAsOtherProgramsWriteItIsRead) {
  const BodyProblem p = random_body_problem({.layout = GetParam()});
  h5::File file = h5::File::create(path_);
  {
    h5::Group root = file.root();
    write_body_problem(root, p);
  }
  file.close();
  EXPECT_TRUE(same_bits(std::get<BodyProblem>(read_problem(path_).form).bias, p.bias));
}

struct BadProblem {
  const char* name;
  ContactLayout layout;
  std::function<void(BodyProblem&)> spoil;
  std::vector<const char*> words;
};

std::ostream& operator<<(std::ostream& out, const BadProblem& bad) { return out << bad.name; }

class BadBodyProblem : public ::testing::TestWithParam<BadProblem> {};

constexpr ContactLayout radial = ContactLayout::radial;
constexpr ContactLayout general = ContactLayout::general;
constexpr ContactLayout rolling = ContactLayout::rolling;
const double not_a_number = std::numeric_limits<double>::quiet_NaN();

INSTANTIATE_TEST_SUITE_P(
    All, BadBodyProblem,
    ::testing::Values(BadProblem{"TimeStep",
                                 radial,
                                 [](BodyProblem& p) { p.source.time_step = 0; },
                                 {"time_step", "0", "positive"}},
                      BadProblem{"FreeCount",
                                 radial,
                                 [](BodyProblem& p) { p.free_count = 99; },
                                 {"free_count", "99"}},
                      BadProblem{"NoContacts",
                                 radial,
                                 [](BodyProblem& p) {
                                   p.body_a.clear();
                                   p.body_b.clear();
                                 },
                                 {"no contacts"}},
                      BadProblem{"FixedBodyA",
                                 radial,
                                 [](BodyProblem& p) { p.body_a[3] = p.free_count; },
                                 {"contact/body_a[3]", "free body"}},
                      BadProblem{"BodyBOutOfRange",
                                 radial,
                                 [](BodyProblem& p) { p.body_b[2] = 1000; },
                                 {"contact/body_b[2]", "1000"}},
                      BadProblem{"BodyBBeforeA",
                                 radial,
                                 [](BodyProblem& p) { p.body_b[2] = p.body_a[2]; },
                                 {"contact/body_b[2]", "behind"}},
                      BadProblem{"NotSorted",
                                 radial,
                                 [](BodyProblem& p) {
                                   std::swap(p.body_a.front(), p.body_a.back());
                                   p.body_b.front() = p.body_b.back() = p.free_count;
                                 },
                                 {"contact/body_a[1]", "ascending"}},
                      BadProblem{"NormalNotUnit",
                                 radial,
                                 [](BodyProblem& p) {
                                   p.normal[1] = {2, 0, 0};
                                 },
                                 {"contact/normal[1]", "(2, 0, 0)", "unit"}},
                      BadProblem{"NanNormal",
                                 radial,
                                 [](BodyProblem& p) { p.normal[1].x = not_a_number; },
                                 {"contact/normal[1]"}},
                      BadProblem{"NegativeMu",
                                 radial,
                                 [](BodyProblem& p) { p.friction[4] = -0.5; },
                                 {"contact/mu[4]", "-0.5"}},
                      BadProblem{"NegativeAdhesion",
                                 radial,
                                 [](BodyProblem& p) { p.adhesion[4] = -1; },
                                 {"contact/adhesion[4]", "-1"}},
                      BadProblem{"NanBias",
                                 radial,
                                 [](BodyProblem& p) { p.bias[0] = not_a_number; },
                                 {"contact/bias[0]", "nan"}},
                      BadProblem{"ShortMu",
                                 radial,
                                 [](BodyProblem& p) { p.friction.pop_back(); },
                                 {"contact/mu", "19 values", "expected 20"}},
                      BadProblem{"ShortWarmStart",
                                 rolling,
                                 [](BodyProblem& p) { p.impulse.resize(20); },
                                 {"warm_start/impulse", "20 values", "expected 40"}},
                      BadProblem{"NanVelocity",
                                 radial,
                                 [](BodyProblem& p) { p.free_velocity[1].linear.y = not_a_number; },
                                 {"body/free_velocity[1]"}},
                      BadProblem{"NegativeInverseMass",
                                 radial,
                                 [](BodyProblem& p) { p.radial_inertia[2].inv_mass = -1; },
                                 {"body/inv_mass[2]", "-1"}},
                      BadProblem{"FixedBodyWithMass",
                                 radial,
                                 [](BodyProblem& p) { p.radial_inertia.back().inv_mass = 1; },
                                 {"body/inv_mass[11]", "zero"}},
                      BadProblem{"IndefiniteInertia",
                                 general,
                                 [](BodyProblem& p) { p.general_inertia[0].inv_inertia.xy = 100; },
                                 {"body/inv_inertia[0]", "positive definite"}},
                      BadProblem{"RollingLength",
                                 rolling,
                                 [](BodyProblem& p) { p.rolling[5].length = 0; },
                                 {"contact/rolling[5]", "positive length"}}),
    [](const auto& info) { return info.param.name; });

TEST_P(BadBodyProblem, IsRefused) {
  BodyProblem p = random_body_problem({.layout = GetParam().layout});
  EXPECT_NO_THROW(validate(p));
  GetParam().spoil(p);
  const std::string message = refusal([&] { validate(p); });
  for (const char* word : GetParam().words) EXPECT_THAT(message, HasSubstr(word));
}

class ProblemLayout : public ::testing::Test {
 protected:
  void SetUp() override { write_problem(path_, stored(random_body_problem({}))); }
  /// The message after a change to the file.
  std::string refusal_after(const std::function<void(h5::Group&)>& change) {
    h5::File file = h5::File::open_for_append(path_);
    {
      h5::Group root = file.root();
      change(root);
    }
    file.close();
    write_seal(path_, problem_format_name, problem_format_version);
    return refusal([&] { read_problem(path_); });
  }
  ScratchDirectory scratch_;
  std::filesystem::path path_ = scratch_ / "problem.hdf5";
};

TEST_F(ProblemLayout, OtherVersionsAreRefused) {
  EXPECT_THAT(refusal_after(
                  [](h5::Group& root) { root.write_attribute<std::int64_t>("format_version", 3); }),
              testing::AllOf(HasSubstr(path_.string()), HasSubstr("format_version is 3"),
                             HasSubstr("expected 1 or 2")));
}

TEST_F(ProblemLayout, BilateralRowsAreAVersionOfTheirOwn) {
  BodyProblem p = random_body_problem({.layout = ContactLayout::general});
  for (int k = 0; k < 3; ++k) {
    BilateralRow row;
    row.body_b = k + 1;
    row.arm_a = {1, 2.0 + k, 3};
    row.arm_b = {4, 5, 6.0 + k};
    row.force = {0, 0.1 * k, 1};
    row.moment = {7.0 + k, 8, 9};
    row.bias = 0.3 * k;
    row.impulse = -0.7 * k;
    p.bilateral.push_back(row);
  }
  const auto version = [&] {
    return h5::File::open(path_).root().attribute<std::int64_t>("format_version");
  };
  EXPECT_EQ(version(), 1);
  write_problem(path_, stored(p));
  EXPECT_EQ(version(), 2);
  EXPECT_EQ(std::get<BodyProblem>(read_problem(path_).form).bilateral, p.bilateral);
}

TEST_F(ProblemLayout, BilateralRowsMustBeThereAndOfOneNumber) {
  EXPECT_THAT(refusal_after(
                  [](h5::Group& root) { root.write_attribute<std::int64_t>("format_version", 2); }),
              HasSubstr("bilateral/body_a: no such dataset"));
  EXPECT_THAT(refusal_after([](h5::Group& root) {
                h5::Group rows = root.create_group("bilateral");
                const std::int32_t two[] = {0, 0};
                rows.write("body_a", std::span<const std::int32_t>(two, 2));
                rows.write("body_b", std::span<const std::int32_t>(two, 1));
              }),
              HasSubstr("bilateral/body_b has 1 rows, expected 2 (as bilateral/body_a)"));
}

TEST_F(ProblemLayout, UnknownContactLayoutsAreRefused) {
  EXPECT_THAT(refusal_after([](h5::Group& root) { root.write_text_attribute("layout", "square"); }),
              testing::AllOf(HasSubstr("\"square\""), HasSubstr("radial, general or rolling")));
}

TEST_F(ProblemLayout, OfAnotherContactLayoutDatasetsAreMissing) {
  EXPECT_THAT(
      refusal_after([](h5::Group& root) { root.write_text_attribute("layout", "general"); }),
      HasSubstr("body/mass: no such dataset"));
}

/// As numpy makes them of a column: one number a row, in two dimensions.
TEST_F(ProblemLayout, ArraysOfOtherDimensionsAreRefused) {
  const std::vector<double> numbers(6, 1.0);
  const auto refusal_of = [&](std::uint64_t velocity_columns) {
    h5::File file = h5::File::create(path_);
    {
      h5::Group root = file.root();
      for (const auto& [name, text] :
           {std::pair{"format", "scree contact problem"}, std::pair{"layout", "radial"},
            std::pair{"scene", "s"}, std::pair{"program", "p"}, std::pair{"backend", "cpu"},
            std::pair{"precision", "double"}})
        root.write_text_attribute(name, text);
      for (const char* name : {"format_version", "free_count", "step"})
        root.write_attribute<std::int64_t>(name, 1);
      for (const char* name : {"time", "time_step", "reference_speed"})
        root.write_attribute<double>(name, 1);
      h5::Group body = root.create_group("body");
      const std::int32_t id = 0;
      body.write("id", std::span<const std::int32_t>(&id, 1));
      body.write("free_velocity", std::span<const double>(numbers), velocity_columns);
      body.write("inv_mass", std::span<const double>(numbers.data(), 1), 1);
    }
    file.close();
    return refusal([&] { read_problem(path_); });
  };
  EXPECT_THAT(refusal_of(0), HasSubstr("body/free_velocity is an array of one dimension, expected "
                                       "two dimensions, rows of 6"));
  EXPECT_THAT(refusal_of(6), HasSubstr("body/inv_mass is an array of two dimensions, rows of 1, "
                                       "expected one dimension"));
}

TEST_F(ProblemLayout, WrongNumbersOfBodiesAreRefused) {
  EXPECT_THAT(
      refusal_after([](h5::Group& root) { root.write_attribute<std::int64_t>("free_count", -3); }),
      HasSubstr("free_count is -3"));
}

}  // namespace
}  // namespace scree
