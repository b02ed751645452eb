// Queries of continuous collision detection with their exact answers, gathered by others. The files
// are not part of the source tree.
#include <gtest/gtest.h>

#include "kernels/affine/first_contact.h"
#include "tests/exact_contact.h"
#include "tests/physics/shared_data.h"

namespace scree::affine {
namespace {

/// A quotient of whole numbers that is a double: p / 2^k with less than 54 bits.
double quotient(const std::string& above, const std::string& below) {
  const double p = std::strtod(above.c_str(), nullptr), q = std::strtod(below.c_str(), nullptr);
  int exponent = 0;
  EXPECT_EQ(std::frexp(q, &exponent), 0.5) << below;
  EXPECT_LE(std::abs(p), 9007199254740992.0) << above;
  return p / q;
}

struct Query {
  Four from, to;
  bool touches = false;
};

/// Eight lines a query: the four points at the start and at the end, three quotients each, and the
/// answer.
std::vector<Query> queries_of(const std::filesystem::path& file) {
  std::vector<Query> queries;
  std::istringstream lines(physics::shared_text(file));
  int line_of_query = 0;
  for (std::string line; std::getline(lines, line); line_of_query = (line_of_query + 1) % 8) {
    if (line_of_query == 0) queries.emplace_back();
    Query& q = queries.back();
    std::vector<std::string> field;
    std::istringstream fields(line);
    for (std::string f; std::getline(fields, f, ',');) field.push_back(f);
    if (field.size() != 7) ADD_FAILURE() << file << ": " << line;
    Vec3d& x = (line_of_query < 4 ? q.from : q.to)[line_of_query % 4];
    for (std::size_t k = 0; k < 3; ++k)
      x[static_cast<int>(k)] = quotient(field[2 * k], field[2 * k + 1]);
    q.touches = field[6].front() == '1';
  }
  return queries;
}

class CcdQueries : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::filesystem::path folder = physics::shared_file("rigid_ipc/ccd_queries");
    std::error_code error;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder, error))
      if (entry.path().extension() == ".csv") files_.push_back(entry.path());
    std::sort(files_.begin(), files_.end());
    if (files_.empty()) GTEST_SKIP() << "there are no queries in " << folder;
  }
  std::vector<std::filesystem::path> files_;
};

TEST_F(CcdQueries, NoneIsMissedOrFoundLate) {
  int count = 0, touching = 0, early = 0, clear = 0;
  for (const std::filesystem::path& file : files_) {
    const PairKind kind = file.parent_path().filename() == "edge-edge" ? PairKind::edge_edge
                                                                       : PairKind::point_triangle;
    const std::vector<Query> queries = queries_of(file);
    for (std::size_t k = 0; k < queries.size(); ++k) {
      SCOPED_TRACE(file.string() + ", query " + std::to_string(k));
      const Query& q = queries[k];
      ++count;
      touching += q.touches ? 1 : 0;
      const FirstContact found = first_contact(kind, q.from, q.to, {});
      EXPECT_GE(found.hit, q.touches);
      if (!q.touches && found.hit) ++early;
      // The oracle of the other tests, against the answers too.
      const exact::FirstTouch truth = exact::first_touch(kind, q.from, q.to);
      if (truth.touch == exact::Touch::unclear) continue;
      ++clear;
      EXPECT_EQ(truth.touch == exact::Touch::within, q.touches);
      EXPECT_TRUE(!q.touches || exact::Number(found.time) <= truth.to) << found.time;
    }
  }
  EXPECT_EQ(count, 4779);
  EXPECT_GT(clear, 4700);  // the rest touches with a corner or an edge end
  RecordProperty("touching", touching);
  RecordProperty("held_though_free", early);
  RecordProperty("clear", clear);
}

}  // namespace
}  // namespace scree::affine
