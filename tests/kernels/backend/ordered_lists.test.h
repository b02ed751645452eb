// Lists of bodies with very many contacts or near pairs: the order of a plain sort, in time that
// grows like the number of elements and not like its square.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "solvers/body_contacts.h"
#include "tests/backend_fixture.h"
#include "tests/collision/collision_scene.h"

namespace scree {
namespace {

class OrderedListsTest : public BackendTest<float> {
 protected:
  /// Seconds of the quickest of some runs.
  template <class F>
  static double quickest(const F& run) {
    double least = std::numeric_limits<double>::max();
    for (int k = 0; k < 5; ++k) {
      const auto start = std::chrono::steady_clock::now();
      run();
      const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
      least = std::min(least, spent.count());
    }
    return least;
  }

  /// The lists of bodies B, [owned_count + 1] starts and then the contacts.
  std::vector<Index> lists_as_b(const std::vector<Index>& body_a, const std::vector<Index>& body_b,
                                Index owned_count, double* seconds = nullptr) {
    TestBackend& b = backend();
    Buffer<TestBackend, Index> of_a(b), of_b(b);
    upload(b, body_a, of_a);
    upload(b, body_b, of_b);
    ContactProblem<float> p;
    p.contact_count = static_cast<Index>(body_a.size());
    p.bodies.owned_count = owned_count;
    p.body_a = of_a.view();
    p.body_b = of_b.view();
    BodyContacts<TestBackend> lists(b);
    lists.build(b, p);
    if (seconds != nullptr) *seconds = quickest([&] { lists.build(b, p); });
    expect_starts(download(b, p.a_start), body_a, owned_count);
    std::vector<Index> found = download(b, p.b_start);
    const std::vector<Index> contacts = download(b, p.b_contact.first(found.back()));
    found.insert(found.end(), contacts.begin(), contacts.end());
    return found;
  }

  /// Where the contacts of each body as A start.
  static void expect_starts(const std::vector<Index>& start, const std::vector<Index>& body_a,
                            Index owned_count) {
    ASSERT_EQ(start.size(), static_cast<std::size_t>(owned_count) + 1);
    std::vector<Index> contacts_of(start.size(), 0);
    for (const Index a : body_a) {
      if (a < owned_count) ++contacts_of[static_cast<std::size_t>(a)];
    }
    Index below = 0;
    for (std::size_t i = 0; i < start.size(); ++i) {
      ASSERT_EQ(start[i], below) << "body " << i;
      below += contacts_of[i];
    }
  }

  /// The same by a plain sort.
  static std::vector<Index> sorted_as_b(const std::vector<Index>& body_b, Index owned_count) {
    std::vector<std::vector<Index>> of_body(static_cast<std::size_t>(owned_count));
    for (std::size_t c = 0; c < body_b.size(); ++c) {
      if (body_b[c] < owned_count)
        of_body[static_cast<std::size_t>(body_b[c])].push_back(static_cast<Index>(c));
    }
    std::vector<Index> lists{0}, contacts;
    for (const auto& list : of_body) {
      contacts.insert(contacts.end(), list.begin(), list.end());
      lists.push_back(static_cast<Index>(contacts.size()));
    }
    lists.insert(lists.end(), contacts.begin(), contacts.end());
    return lists;
  }

  /// Spheres in a plane, and a large one on all of them: by its number the first or the last body.
  static CollisionScene<float> plane_under_a_ball(Index count, bool ball_is_first) {
    CollisionScene<float> s;
    s.settings.envelope = 0.5;  // the ball is so large that it reaches all
    s.settings.skin = 0;        // each listing makes a new list
    const auto add_ball = [&] { s.add_free({0, 0, 1e5 + 0.5}, 1e5); };
    if (ball_is_first) add_ball();
    const auto side = static_cast<Index>(std::sqrt(count));
    for (Index k = 0; k < side * side; ++k) {
      s.add_free({1.3 * (k % side - 0.5 * side), 1.3 * (k / side - 0.5 * side), 0}, 0.5);
    }
    if (!ball_is_first) add_ball();
    return s;
  }
};

TEST_F(OrderedListsTest, MixedLengthsAreInTheOrderOfAPlainSort) {
  std::mt19937 random(1);
  const Index owned_count = 300;
  std::vector<Index> body_a, body_b;
  for (Index a = 0; a < owned_count - 10; ++a) {
    for (const Index b : {owned_count - 1, owned_count - 2, owned_count + 1}) {
      for (int k = 0; k < 4; ++k) body_a.push_back(a), body_b.push_back(b);
    }
    for (int k = 0; k < 5; ++k) {
      body_a.push_back(a);
      body_b.push_back(a + 1 + static_cast<Index>(random() % 9));
    }
  }
  const auto found = lists_as_b(body_a, body_b, owned_count);
  EXPECT_EQ(found, sorted_as_b(body_b, owned_count));
}

TEST_F(OrderedListsTest, FewContactsAmongManyBodies) {
  for (const Index first : {0, 1, 700}) {
    std::vector<Index> body_a, body_b;
    for (Index a = first; a < 1000; a += a % 3 == 0 ? 40 : 1 + 100 * (a % 2)) {
      for (int k = 0; k < 2; ++k) body_a.push_back(a), body_b.push_back(a + 5 + 3 * k);
    }
    EXPECT_LT(body_a.size(), 250u);
    EXPECT_EQ(lists_as_b(body_a, body_b, 1000), sorted_as_b(body_b, 1000)) << first;
  }
}

/// Lengths about the one where the way to sort changes.
TEST_F(OrderedListsTest, LengthsAboutTheLongestShortList) {
  for (const Index length : {255, 256, 257, 258}) {
    std::vector<Index> body_a, body_b;
    for (Index a = 0; a < length; ++a) {
      for (const Index b : {length, length + 1}) body_a.push_back(a), body_b.push_back(b);
    }
    EXPECT_EQ(lists_as_b(body_a, body_b, length + 2), sorted_as_b(body_b, length + 2)) << length;
  }
}

TEST_F(OrderedListsTest, TimeIsLinearInTheContactsOfABody) {
  const auto seconds = [&](Index contacts) {
    std::vector<Index> body_a, body_b;
    for (Index a = 0; a < contacts; ++a) body_a.push_back(a), body_b.push_back(contacts);
    double least = INFINITY;
    for (int again = 0; again < 4; ++again) {
      double spent = 0;
      EXPECT_EQ(lists_as_b(body_a, body_b, contacts + 1, &spent),
                sorted_as_b(body_b, contacts + 1));
      least = std::min(least, spent);
    }
    return least;
  };
  const double few = seconds(10000), many = seconds(160000);
  EXPECT_LT(many, 64 * few) << few << " s and " << many << " s; the square of 16 is 256";
}

TEST_F(OrderedListsTest, TimeIsLinearInTheNearPairsOfABody) {
  for (const bool ball_is_first : {true, false}) {
    const auto seconds = [&](Index count) {
      CollisionRun<TestBackend, float> run(backend(), plane_under_a_ball(count, ball_is_first));
      const auto contacts = run.detect();
      EXPECT_TRUE(std::is_sorted(contacts.begin(), contacts.end(),
                                 [](const auto& x, const auto& y) { return x.key < y.key; }));
      EXPECT_GE(contacts.size(), static_cast<std::size_t>(count));
      return quickest([&] { run.detect(); });
    };
    const double few = seconds(10000), many = seconds(160000);
    EXPECT_LT(many, 64 * few) << few << " s and " << many << " s; the square of 16 is 256";
  }
}

}  // namespace
}  // namespace scree
