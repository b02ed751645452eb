// Contact coloring against a serial greedy reference, which also proves that backends agree.
#include <algorithm>
#include <chrono>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include "solvers/contact_coloring.h"
#include "tests/backend_fixture.h"
#include "tests/problem_builder.h"

namespace scree {
namespace {

using fixtures::lattice_problem;
using fixtures::PlainProblem;
using fixtures::ProblemBuffers;

/// Smallest color free on both bodies, contact by contact in order of (priority, index); those that
/// have a color keep it.
std::vector<Index> greedy_colors(const PlainProblem& plain, std::vector<Index> color) {
  std::vector<Index> order(color.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [](Index a, Index b) { return contact_priority(a) < contact_priority(b); });
  std::vector<std::set<Index>> used(plain.data.bodies.size());
  const auto take = [&](Index c) {
    const oracle::Contact& k = plain.data.contacts[c];
    used[k.a].insert(color[c]);
    if (k.b < plain.data.free_count) used[k.b].insert(color[c]);
  };
  for (Index c : order) {
    if (color[c] >= 0) take(c);
  }
  for (Index c : order) {
    if (color[c] >= 0) continue;
    const oracle::Contact& k = plain.data.contacts[c];
    color[c] = 0;
    while (used[k.a].count(color[c]) || used[k.b].count(color[c])) ++color[c];
    take(c);
  }
  return color;
}
std::vector<Index> greedy_colors(const PlainProblem& plain) {
  return greedy_colors(plain, std::vector<Index>(plain.data.contacts.size(), -1));
}

/// The same with marks: few contacts of the last color give it up, and when most contacts are then
/// without one, all are colored from scratch.
std::vector<Index> carried_colors(const PlainProblem& plain, std::vector<Index> mark) {
  const auto n = static_cast<Index>(mark.size());
  const Index last = *std::max_element(mark.begin(), mark.end());
  if (std::count(mark.begin(), mark.end(), last) <= n / kRareShare)
    std::replace(mark.begin(), mark.end(), last, -1);
  if (std::count(mark.begin(), mark.end(), -1) > n / 2) return greedy_colors(plain);
  return greedy_colors(plain, mark);
}

class ColoringTest : public BackendTest<double> {
 protected:
  void expect_greedy(const PlainProblem& plain, Index* colors = nullptr) {
    ProblemBuffers<TestBackend, double> buffers(backend(), plain);
    ContactColoring<TestBackend> coloring(backend());
    coloring.compute(backend(), buffers.problem());
    EXPECT_EQ(coloring.colored_count(), plain.contact_count());
    expect_colors(plain, coloring, greedy_colors(plain), colors);
  }

  /// Colors the problem, whose contacts bring `mark` along, and leaves the colors there.
  void expect_carried(const PlainProblem& plain, ContactColoring<TestBackend>& coloring,
                      std::vector<Index>& mark, Index* colors = nullptr) {
    ProblemBuffers<TestBackend, double> buffers(backend(), plain);
    Buffer<TestBackend, Index> marks(backend());
    upload(backend(), mark, marks);
    ContactProblem<double> p = buffers.problem();
    p.mark = marks.view();
    coloring.compute(backend(), p);
    expect_colors(plain, coloring, carried_colors(plain, mark), colors);
    mark = download(backend(), marks.view());
    EXPECT_EQ(mark, download(backend(), coloring.color()));
  }

  void expect_colors(const PlainProblem& plain, const ContactColoring<TestBackend>& coloring,
                     const std::vector<Index>& expected, Index* colors) {
    const std::vector<Index> color = download(backend(), coloring.color()),
                             order = download(backend(), coloring.order());
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
    expect_greedy(fixtures::random_problem(
        {.layout = ContactLayout::mixed, .free_count = 3000, .contact_count = 9000, .seed = seed}));
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

/// A heavy sphere in a bed: one color per contact of it, and time that does not grow
/// with their square.
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

/// Contacts of a larger problem that come and go, with their colors.
struct ChangingContacts {
  PlainProblem all;
  std::vector<bool> touches;
  std::vector<Index> color;
  std::mt19937 random{3};

  explicit ChangingContacts(PlainProblem problem, double share)
      : all(std::move(problem)), color(all.data.contacts.size(), -1) {
    for (std::size_t c = 0; c < color.size(); ++c) touches.push_back(chance(share));
  }
  bool chance(double share) { return std::uniform_real_distribution<double>(0, 1)(random) < share; }
  /// A share of the contacts ends, and of the others so many begin that their number stays.
  void change(double share) {
    const auto count = static_cast<double>(std::count(touches.begin(), touches.end(), true));
    const double to_begin = share * count / (static_cast<double>(touches.size()) - count);
    for (std::size_t c = 0; c < touches.size(); ++c) {
      if (chance(touches[c] ? share : to_begin)) touches[c] = !touches[c];
      if (!touches[c]) color[c] = -1;
    }
  }
  PlainProblem present(std::vector<Index>& mark) const {
    PlainProblem p = all;
    p.data.contacts.clear();
    mark.clear();
    for (std::size_t c = 0; c < touches.size(); ++c) {
      if (!touches[c]) continue;
      p.data.contacts.push_back(all.data.contacts[c]);
      mark.push_back(color[c]);
    }
    return p;
  }
  void keep(const std::vector<Index>& mark) {
    std::size_t k = 0;
    for (std::size_t c = 0; c < touches.size(); ++c) {
      if (touches[c]) color[c] = mark[k++];
    }
  }
};

TEST_F(ColoringTest, ContactsKeepTheirColors) {
  ChangingContacts contacts(lattice_problem(10, 1.0, 7), 0.5);
  ContactColoring<TestBackend> coloring(backend());
  std::vector<Index> mark;
  Index colors = 0;
  for (int step = 0; step < 40; ++step) {
    const PlainProblem plain = contacts.present(mark);
    expect_carried(plain, coloring, mark, &colors);
    contacts.keep(mark);
    if (step == 0) {
      EXPECT_EQ(coloring.colored_count(), plain.contact_count());
    } else {  // new contacts and those of a rare color
      EXPECT_LE(coloring.colored_count(), 0.15 * plain.contact_count());
    }
    EXPECT_LE(colors, 14);
    contacts.change(0.05);
  }
  // Most contacts are new.
  contacts.change(0.7);
  const PlainProblem plain = contacts.present(mark);
  expect_carried(plain, coloring, mark);
  EXPECT_EQ(coloring.colored_count(), plain.contact_count());
}

TEST_F(ColoringTest, UnchangedContactsLoseARareLastColorOrNothing) {
  ChangingContacts contacts(lattice_problem(8, 1.0, 7), 1.0);
  ContactColoring<TestBackend> coloring(backend());
  std::vector<Index> mark;
  const PlainProblem plain = contacts.present(mark);
  expect_carried(plain, coloring, mark);
  const Index fresh_count = coloring.color_count();
  for (int step = 0; step < 4; ++step) {
    expect_carried(plain, coloring, mark);
    EXPECT_LE(coloring.colored_count(), plain.contact_count() / kRareShare);
    EXPECT_LE(coloring.color_count(), fresh_count);
  }
}

TEST_F(ColoringTest, ColorsAreKeptInManyBatches) {  // some 130 contacts on every body
  ChangingContacts contacts(
      fixtures::random_problem({.free_count = 30, .contact_count = 3000, .seed = 5}), 0.66);
  ContactColoring<TestBackend> coloring(backend());
  std::vector<Index> mark;
  for (int step = 0; step < 10; ++step) {
    const PlainProblem plain = contacts.present(mark);
    expect_carried(plain, coloring, mark);
    contacts.keep(mark);
    contacts.change(0.1);
  }
}

TEST_F(ColoringTest, AColorMayLoseAllItsContacts) {
  const PlainProblem plain = lattice_problem(6, 0.5, 7);
  std::vector<Index> mark = greedy_colors(plain);
  for (Index& color : mark) color *= 3;
  ContactColoring<TestBackend> coloring(backend());
  ProblemBuffers<TestBackend, double> buffers(backend(), plain);
  Buffer<TestBackend, Index> marks(backend());
  upload(backend(), mark, marks);
  ContactProblem<double> p = buffers.problem();
  p.mark = marks.view();
  coloring.compute(backend(), p);
  const std::vector<Index> color = download(backend(), coloring.color());
  EXPECT_EQ(color, carried_colors(plain, mark));
  const std::vector<Index>& starts = coloring.starts();
  for (Index k = 0; k < coloring.color_count(); ++k)
    EXPECT_EQ(starts[k + 1] - starts[k], std::count(color.begin(), color.end(), k)) << k;
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
