// Problems of the FCLIB collection that others wrote, against published figures about them. The
// files are not part of the source tree.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "host/io/h5.h"
#include "host/io/problem_file.h"
#include "host/problems/matrix_form.h"
#include "tests/host/io/output_fixtures.h"
#include "tests/host/solve/fclib_reference.h"

namespace scree {
namespace {

namespace fs = std::filesystem;
using fclib::Figures;
using fclib::figures;
using physics::shared_file;

std::vector<fs::path> files_in(const std::string& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (const fs::directory_entry& entry :
       fs::directory_iterator(shared_file("fclib/" + folder), error))
    if (entry.path().extension() == ".hdf5") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

double length_of(const std::vector<double>& v) {
  double sum = 0;
  for (const double x : v) sum += x * x;
  return std::sqrt(sum);
}

double largest(const SparseMatrix& a) {
  double most = 0;
  for (const double x : a.value) most = std::max(most, std::abs(x));
  return most;
}

SparseMatrix difference(const SparseMatrix& a, const SparseMatrix& b) {
  std::vector<MatrixEntry> entries;
  for (const auto& [matrix, sign] : {std::pair{&a, 1.0}, std::pair{&b, -1.0}})
    for (std::int32_t row = 0; row < matrix->row_count; ++row)
      for (std::int32_t k = matrix->row_start[row]; k < matrix->row_start[row + 1]; ++k)
        entries.push_back({row, matrix->column[k], sign * matrix->value[k]});
  return compress(a.row_count, a.column_count, entries);
}

class FclibCollection : public ::testing::Test {
 protected:
  void SetUp() override {
    if (files_in("local").empty())
      GTEST_SKIP() << "there are no problems in " << shared_file("fclib/local");
  }
};

TEST_F(FclibCollection, LocalProblemsHaveTheirPublishedFigures) {
  const std::vector<Figures> published = figures();
  EXPECT_FALSE(published.empty());
  for (const Figures& f : published) {
    const fs::path path = shared_file("fclib/local/" + f.name + ".hdf5");
    SCOPED_TRACE(f.name);
    ASSERT_TRUE(fs::exists(path));
    const StoredProblem stored = read_problem(path);
    const auto& p = std::get<LocalProblem>(stored.form);
    EXPECT_EQ(p.dimension, f.dimension);
    EXPECT_EQ(p.contact_count(), f.contact_count);
    EXPECT_NEAR(*std::min_element(p.mu.begin(), p.mu.end()), f.mu_min, 1e-6);
    EXPECT_NEAR(*std::max_element(p.mu.begin(), p.mu.end()), f.mu_max, 1e-6);
    EXPECT_NEAR(length_of(p.q), f.norm_q, 1e-11 * f.norm_q);
    const double asymmetry = largest(difference(p.W, transpose(p.W))) / largest(p.W);
    EXPECT_NEAR(asymmetry, f.asymmetry, 0.06 * f.asymmetry + 1e-15);
  }
}

/// Rows, signs and the order of impulses: at published impulses, velocities and objective come out.
TEST_F(FclibCollection, PublishedImpulsesGiveThePublishedVelocitiesAndMinima) {
  const h5::File file = h5::File::open(shared_file("fclib/reference_solutions.hdf5"));
  for (const Figures& f : figures()) {
    SCOPED_TRACE(f.name);
    const StoredProblem stored = read_problem(shared_file("fclib/local/" + f.name + ".hdf5"));
    const auto& p = std::get<LocalProblem>(stored.form);
    const h5::Group solution = file.root().open_group(f.name);
    const auto velocity = [&](const std::vector<double>& r) {
      std::vector<double> u = multiply(p.W, r);
      for (std::size_t k = 0; k < u.size(); ++k) u[k] += p.q[k];
      return u;
    };
    const auto convex_r = solution.read<double>("ccp_r");
    ASSERT_EQ(convex_r.size(), p.q.size());
    const std::vector<double> convex_u = velocity(convex_r);
    double objective = 0, size = 0;
    for (std::size_t k = 0; k < p.q.size(); ++k) {
      objective += (convex_u[k] + p.q[k]) * convex_r[k] / 2;
      size += std::abs(p.q[k] * convex_r[k]);
    }
    EXPECT_NEAR(objective, f.convex_minimum, 1e-9 * std::abs(f.convex_minimum) + 1e-14 * size);

    std::vector<double> apart = velocity(solution.read<double>("coulomb_r"));
    const auto coulomb_u = solution.read<double>("coulomb_u");
    ASSERT_EQ(coulomb_u.size(), apart.size());
    for (std::size_t k = 0; k < apart.size(); ++k) apart[k] -= coulomb_u[k];
    EXPECT_LE(length_of(apart), 1e-9 * length_of(p.q));
  }
}

TEST_F(FclibCollection, AllFilesAreReadAndKeptByEveryStorage) {
  const test::ScratchDirectory scratch;
  for (const char* folder : {"local", "global"}) {
    for (const fs::path& path : files_in(folder)) {
      SCOPED_TRACE(path.filename());
      const StoredProblem read = read_problem(path);
      for (const FclibStorage storage :
           {FclibStorage::triplets, FclibStorage::columns, FclibStorage::rows}) {
        const fs::path copy = scratch / "copy.hdf5";
        write_problem(copy, read, storage);
        const StoredProblem back = read_problem(copy);
        if (const auto* local = std::get_if<LocalProblem>(&read.form)) {
          EXPECT_EQ(std::get<LocalProblem>(back.form), *local);
        } else {
          EXPECT_EQ(std::get<GlobalProblem>(back.form), std::get<GlobalProblem>(read.form));
        }
        EXPECT_EQ(back.info, read.info);
        EXPECT_EQ(back.solution, read.solution);
        EXPECT_EQ(back.guesses, read.guesses);
      }
    }
  }
}

TEST_F(FclibCollection, GlobalProblemsReduceToTheLocalOnes) {
  const std::vector<fs::path> files = files_in("global");
  EXPECT_FALSE(files.empty());
  for (const fs::path& path : files) {
    SCOPED_TRACE(path.filename());
    const StoredProblem global = read_problem(path);
    const LocalProblem reduced = local_form(std::get<GlobalProblem>(global.form));
    const std::string name = path.stem().stem().string();
    const StoredProblem local = read_problem(shared_file("fclib/local/" + name + ".hdf5"));
    const auto& expected = std::get<LocalProblem>(local.form);
    EXPECT_LE(largest(difference(reduced.W, expected.W)), 1e-12 * largest(expected.W));
    ASSERT_EQ(reduced.q.size(), expected.q.size());
    double apart = 0;
    for (std::size_t k = 0; k < reduced.q.size(); ++k)
      apart = std::max(apart, std::abs(reduced.q[k] - expected.q[k]));
    EXPECT_LE(apart, 1e-12 * length_of(expected.q));
    EXPECT_EQ(reduced.mu, expected.mu);
  }
}

}  // namespace
}  // namespace scree
