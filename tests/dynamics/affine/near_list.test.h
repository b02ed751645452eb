// How long a list of near pairs serves, and that it holds all pairs within reach wherever bodies are.

#include <random>

#include "dynamics/affine/near_list.h"
#include "tests/backend_fixture.h"
#include "tests/box_mesh.h"
#include "tests/dynamics/affine/brute_pairs.h"

namespace scree::affine {
namespace {

constexpr double kListReach = 0.002;  // [m]
constexpr double kListStep = 0.01;    // [s]

/// Boxes that go on as they are told, and a list that follows them as Newton's method would.
class AffineNearListTest : public BackendTest<double> {
 protected:
  /// 27 boxes some 5 cm from each other, each turned a little.
  AffineNearListTest() {
    surfaces_.push_back(
        std::make_shared<Surface>(make_surface(scree::test::box_mesh({0.5, 0.4, 0.3}), {})));
    std::mt19937 random(7);
    std::uniform_real_distribution<double> part(-1, 1);
    for (int k = 0; k < 27; ++k) {
      AffineVec q;
      q.node[0] = {1.05 * (k % 3), 0.85 * (k / 3 % 3), 0.65 * (k / 9)};
      const Quat<double> turn = exp_map(0.01 * Vec3d{part(random), part(random), part(random)});
      for (int i = 0; i < 3; ++i) {
        Vec3d axis;
        axis[i] = 1;
        q.node[i + 1] = rotate(turn, axis);
      }
      q_.push_back(q);
      surface_.push_back(0);
      group_.push_back(-1);
      BodyConstant body;
      body.radius = surfaces_[0]->radius;
      body.row = k;
      bodies_.push_back(body);
      row_.push_back(k);
    }
    v_.assign(q_.size(), AffineVec{});
  }
  void SetUp() override {
    BackendTest<double>::SetUp();
    if (IsSkipped()) return;
    on_ = std::make_unique<OnBackend>(backend(), *this);
    near().keep_places(on_->put(backend(), q_, on_->start));
    near().begin_at_rest(on_->tables, barrier());
  }

  NearList<TestBackend>& near() { return on_->near; }
  static Barrier barrier() {
    Barrier b;
    b.reach = kListReach;
    return b;
  }

  /// A step whose Newton steps end at these places of all bodies. @return lists that it took
  int step(const std::vector<std::vector<AffineVec>>& places, bool anew = false) {
    TestBackend& b = backend();
    Potential p;
    p.bodies = on_->constants.view(std::ssize(bodies_));
    p.body_of_row = on_->rows.view(std::ssize(row_));
    p.start = on_->put(b, q_, on_->start);
    p.barrier = barrier();
    near().begin(on_->tables, p, on_->put(b, v_, on_->v), kListStep, anew);
    expect_all(q_, q_);
    int lists = 0;
    bool is_first = true;
    for (const std::vector<AffineVec>& place : places) {
      const Span<const AffineVec> from = on_->put(b, q_, on_->from);
      const Span<const AffineVec> to = on_->put(b, place, on_->to);
      double size = 0;
      for (std::size_t k = 0; k < q_.size(); ++k)
        size = std::max(size, corner_way(place[k] - q_[k], bodies_[k].radius));
      Strays strays = reduce_to_host<Strays>(
          b, p.rows(), StrayOfBody{p.bodies, p.body_of_row, to, near().ways()});
      if (!near().serves(strays)) {
        strays = near().renew(p, from, to, size, is_first);
        ++lists;
      }
      EXPECT_TRUE(near().serves(strays));
      is_first = false;
      expect_all(q_, place);
      near().follow(strays, 1);
      q_ = place;
    }
    return lists;
  }
  /// Whether the list holds what comes within reach on a way.
  void expect_all(const std::vector<AffineVec>& from, const std::vector<AffineVec>& to) {
    const SearchedBodies of{surfaces_, surface_, group_, held_};
    std::vector<NamedPair> found = named_pairs(backend(), near().view(), of);
    std::sort(found.begin(), found.end());
    const ExpectedPairs wanted = expected_pairs(of, from, to, kListReach);
    EXPECT_TRUE(
        std::includes(found.begin(), found.end(), wanted.least.begin(), wanted.least.end()));
    most_ = std::max(most_, wanted.least.size());
  }
  /// Where bodies go in a step if gravity is all that changes their velocities.
  std::vector<AffineVec> fallen() {
    std::vector<AffineVec> next = q_;
    for (std::size_t k = 0; k < q_.size(); ++k) {
      fall_[k].node[0].z -= 9.81 * kListStep;
      next[k] = q_[k] + kListStep * fall_[k];
    }
    return next;
  }
  /// A step of a fall. @return lists that it took
  int fall() {
    fall_ = v_;
    const int lists = step({fallen()});
    v_ = fall_;
    return lists;
  }

  std::vector<AffineVec> q_, v_, fall_;
  std::size_t most_ = 0;  ///< pairs within reach

 private:
  struct OnBackend {
    OnBackend(TestBackend& b, const AffineNearListTest& of)
        : tables(b, of.surfaces_, of.surface_, of.group_, of.held_),
          near(b, static_cast<Index>(of.q_.size())),
          constants(b),
          rows(b),
          start(b),
          v(b),
          from(b),
          to(b) {
      upload(b, of.bodies_, constants);
      upload(b, of.row_, rows);
    }
    Span<const AffineVec> put(TestBackend& b, const std::vector<AffineVec>& values,
                              Buffer<TestBackend, AffineVec>& buffer) {
      upload(b, values, buffer);
      return std::as_const(buffer).view(std::ssize(values));
    }
    SurfaceTables<TestBackend> tables;
    NearList<TestBackend> near;
    Buffer<TestBackend, BodyConstant> constants;
    Buffer<TestBackend, Index> rows;
    Buffer<TestBackend, AffineVec> start, v, from, to;
  };

  std::vector<std::shared_ptr<const Surface>> surfaces_;
  std::vector<int> surface_, group_;
  std::vector<std::array<int, 2>> held_;
  std::vector<BodyConstant> bodies_;
  std::vector<Index> row_;
  std::unique_ptr<OnBackend> on_;
};

TEST_F(AffineNearListTest, OfBodiesAtRestServesForever) {
  int lists = 0;
  for (int k = 0; k < 20; ++k) lists += step({q_, q_});
  EXPECT_EQ(lists, 0);
  for (AffineVec& q : q_) q.node[0].x *= 0.955;  // somebody moved them nearer
  EXPECT_EQ(step({q_}, /*anew=*/true), 0);
  EXPECT_GT(most_, 100u);
}

TEST_F(AffineNearListTest, OfBodiesThatFallServesForSeveralSteps) {
  int lists = 0;
  for (int k = 0; k < 40; ++k) lists += fall();
  EXPECT_LT(lists, 20);
  EXPECT_GE(lists, 5);  // of eight steps at most
}

/// Each box has a velocity of its own, so that some come near, and a few are thrown back.
TEST_F(AffineNearListTest, HoldsWhatComesNearAmongBodiesThatFlyAndBounce) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> part(-0.2, 0.2);
  for (AffineVec& v : v_)
    for (Vec3d& node : v.node) node += Vec3d{part(random), part(random), part(random)};
  int lists = 0;
  for (int k = 0; k < 30; ++k) {
    fall_ = v_;
    std::vector<AffineVec> first = fallen(), second = first;
    if (k % 7 == 6) {
      for (std::size_t body = 0; body < q_.size(); body += 4) {
        fall_[body] = -0.5 * fall_[body];
        second[body] = q_[body] + (0.3 * kListStep) * fall_[body];
      }
    }
    lists += step({first, second});
    v_ = fall_;
  }
  EXPECT_LT(lists, 40);
  EXPECT_GT(most_, 50u);
}

}  // namespace
}  // namespace scree::affine
