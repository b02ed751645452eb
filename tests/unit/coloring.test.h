// Contact coloring against a serial greedy reference, which also proves that backends agree.
#include <chrono>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include "solvers/contact_coloring.h"
#include "tests/problem_builder.h"
#include "tests/unit/backend_fixture.h"

namespace scree {
namespace {

using fixtures::PlainProblem;
using fixtures::ProblemBuffers;

/// Smallest color free on both bodies, contact by contact in order of (priority, index).
std::vector<Index> greedy_colors(const PlainProblem& plain) {
  const Index count = plain.contact_count();
  std::vector<Index> order(count), color(count);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [](Index a, Index b) { return contact_priority(a) < contact_priority(b); });
  std::vector<std::set<Index>> used(plain.data.free_count);
  for (Index c : order) {
    const oracle::Contact& k = plain.data.contacts[c];
    const bool b_is_free = k.b < plain.data.free_count;
    Index pick = 0;
    while (used[k.a].count(pick) || (b_is_free && used[k.b].count(pick))) ++pick;
    used[k.a].insert(pick);
    if (b_is_free) used[k.b].insert(pick);
    color[c] = pick;
  }
  return color;
}

/// Spheres on a face-centered lattice of 4 n^3 sites; a share of the neighbors touches.
PlainProblem lattice_problem(int n, double share, unsigned seed) {
  PlainProblem p;
  std::vector<std::array<int, 3>> sites;
  for (int x = 0; x < 2 * n; ++x)
    for (int y = 0; y < 2 * n; ++y)
      for (int z = 0; z < 2 * n; ++z)
        if ((x + y + z) % 2 == 0) sites.push_back({x, y, z});
  for (std::size_t i = 0; i < sites.size(); ++i) p.add_sphere(1, 0.5);
  p.data.free_count = static_cast<int>(sites.size());
  const auto site = [&](int x, int y, int z) {
    return (x * 2 * n * 2 * n + y * 2 * n + z) / 2;  // every other cell holds a site, in this order
  };
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  const int steps[6][3] = {{1, 1, 0}, {1, -1, 0}, {1, 0, 1}, {1, 0, -1}, {0, 1, 1}, {0, 1, -1}};
  for (std::size_t i = 0; i < sites.size(); ++i) {
    for (const auto& s : steps) {
      const int x = sites[i][0] + s[0], y = sites[i][1] + s[1], z = sites[i][2] + s[2];
      if (x < 0 || y < 0 || z < 0 || x >= 2 * n || y >= 2 * n || z >= 2 * n) continue;
      if (unit(generator) > share) continue;
      const int other = site(x, y, z);
      const int a = static_cast<int>(i);
      p.add_radial_contact(std::min(a, other), std::max(a, other),
                           Eigen::Vector3d(s[0], s[1], s[2]).normalized(), 0.5);
    }
  }
  std::stable_sort(p.data.contacts.begin(), p.data.contacts.end(),
                   [](const auto& x, const auto& y) { return x.a < y.a; });
  return p;
}

class ColoringTest : public BackendTest<double> {
 protected:
  void expect_greedy(const PlainProblem& plain, Index* colors = nullptr) {
    ProblemBuffers<TestBackend, double> buffers(backend(), plain);
    ContactColoring<TestBackend> coloring(backend());
    coloring.compute(backend(), buffers.problem());
    const std::vector<Index> color = download(backend(), coloring.color()),
                             order = download(backend(), coloring.order());
    const std::vector<Index> expected = greedy_colors(plain);
    ASSERT_EQ(color, expected);
    const Index count = *std::max_element(expected.begin(), expected.end()) + 1;
    ASSERT_EQ(coloring.color_count(), count);
    ASSERT_EQ(coloring.starts().size(), static_cast<std::size_t>(count) + 1);
    ASSERT_EQ(coloring.starts().front(), 0);
    ASSERT_EQ(coloring.starts().back(), plain.contact_count());
    // Sorted by (color, contact), and no free body twice in a color.
    for (Index k = 0; k < count; ++k) {
      std::set<int> bodies;
      for (Index i = coloring.starts()[k]; i < coloring.starts()[k + 1]; ++i) {
        ASSERT_EQ(color[order[i]], k);
        if (i > coloring.starts()[k]) {
          ASSERT_LT(order[i - 1], order[i]);
        }
        const oracle::Contact& c = plain.data.contacts[order[i]];
        ASSERT_TRUE(bodies.insert(c.a).second);
        if (c.b < plain.data.free_count) {
          ASSERT_TRUE(bodies.insert(c.b).second);
        }
      }
    }
    if (colors != nullptr) *colors = count;
  }
};

TEST_F(ColoringTest, NoContacts) {
  PlainProblem plain;
  plain.add_sphere(1, 1);
  plain.data.free_count = 1;
  ProblemBuffers<TestBackend, double> buffers(backend(), plain);
  ContactColoring<TestBackend> coloring(backend());
  coloring.compute(backend(), buffers.problem());
  EXPECT_EQ(coloring.color_count(), 0);
  EXPECT_EQ(coloring.starts(), std::vector<Index>{0});
}

TEST_F(ColoringTest, RandomGraphsMatchTheGreedyReference) {
  for (unsigned seed : {1U, 2U, 3U}) {
    expect_greedy(fixtures::random_problem(
        {.free_count = 60, .fixed_count = 3, .contact_count = 200, .seed = seed}));
    expect_greedy(
        fixtures::random_problem({.free_count = 3000, .contact_count = 9000, .seed = seed}));
    // Some 130 contacts on every body: three batches of colors.
    expect_greedy(
        fixtures::random_problem({.free_count = 30, .contact_count = 2000, .seed = seed}));
  }
}

TEST_F(ColoringTest, EqualSpheresNeedFewColors) {
  Index colors = 0;
  expect_greedy(lattice_problem(12, 0.5, 7), &colors);  // six contacts a sphere
  RecordProperty("colors_coordination_6", colors);
  EXPECT_LE(colors, 13);
  expect_greedy(lattice_problem(8, 1.0, 7), &colors);  // twelve: at least 12 colors
  RecordProperty("colors_coordination_12", colors);
  EXPECT_LE(colors, 18);
}

/// A heavy sphere in a bed: one color per contact of it, and time that does not grow with their
/// square.
TEST_F(ColoringTest, BodyWithTwoThousandContacts) {
  PlainProblem plain = lattice_problem(10, 0.5, 9);
  const int heavy = plain.add_sphere(1000, 10);
  ++plain.data.free_count;
  for (int k = 0; k < 2000; ++k)
    plain.add_radial_contact(k * 2, heavy, Eigen::Vector3d::UnitZ(), 0.5);
  std::stable_sort(plain.data.contacts.begin(), plain.data.contacts.end(),
                   [](const auto& x, const auto& y) { return x.a < y.a; });
  Index colors = 0;
  expect_greedy(plain, &colors);
  EXPECT_GE(colors, 2000);
  EXPECT_LE(colors, 2020);

  ProblemBuffers<TestBackend, double> buffers(backend(), plain);
  ContactColoring<TestBackend> coloring(backend());
  coloring.compute(backend(), buffers.problem());
  const auto start = std::chrono::steady_clock::now();
  coloring.compute(backend(), buffers.problem());
  backend().synchronize();
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  RecordProperty("milliseconds", static_cast<int>(1e3 * seconds));
  EXPECT_LT(seconds, 2.0);
}

TEST_F(ColoringTest, ThreadCountDoesNotChangeColors) {
  if constexpr (!TestBackend::kIsDevice) {  // threads belong to the cpu backend
    const PlainProblem plain = lattice_problem(12, 0.5, 7);
    std::vector<Index> first;
    for (int threads : {1, 2, 3}) {
      TestBackend b(threads);
      ProblemBuffers<TestBackend, double> buffers(b, plain);
      ContactColoring<TestBackend> coloring(b);
      coloring.compute(b, buffers.problem());
      const std::vector<Index> order = download(b, coloring.order());
      if (first.empty()) first = order;
      EXPECT_EQ(order, first);
    }
  }
}

}  // namespace
}  // namespace scree
