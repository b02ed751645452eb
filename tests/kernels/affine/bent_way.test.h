// Newton steps that go on as a turn does, against rotations about points.

#include <random>

#include "kernels/affine/bent_way.h"
#include "kernels/affine/orthogonality.h"
#include "tests/backend_fixture.h"

namespace scree::affine {
namespace {

struct RunBentEnd {
  static constexpr const char* name = "run_bent_end";
  AffineMass mass;
  Span<const AffineVec> q, step;
  Span<const Vec3d> free;
  Span<AffineVec> end;
  SCREE_HD void operator()(Index k) const { end[k] = bent_end(mass, q[k], step[k], free[k]); }
};

class BentWayTest : public BackendTest<double> {
 protected:
  static constexpr int kCount = 50;
  std::mt19937 random{5};
  std::normal_distribution<double> normal;
  std::vector<AffineVec> q, step;
  std::vector<Vec3d> free, turn;

  Vec3d vector(double size) { return size * Vec3d{normal(random), normal(random), normal(random)}; }
  std::vector<AffineVec> run() {
    TestBackend& b = backend();
    Buffer<TestBackend, AffineVec> at(b), way(b), end(b, kCount);
    Buffer<TestBackend, Vec3d> to(b);
    upload(b, q, at), upload(b, step, way), upload(b, free, to);
    AffineMass mass;
    mass.mass = 2;
    mass.second = {.xx = 3, .yy = 1, .zz = 0.5, .xy = 0.2, .xz = -0.1, .yz = 0.3};
    for_each(b, kCount,
             RunBentEnd{mass, std::as_const(at).view(kCount), std::as_const(way).view(kCount),
                        std::as_const(to).view(kCount), end.view()});
    return download(b, end.view());
  }
  /// A rotated body and a straight step that turns it. @param about  a point of the body that stays
  void add_turn(const Vec3d& about, double angle) {
    const Quat<double> pose = exp_map(vector(2));
    AffineVec at, way;
    at.node[0] = vector(1);
    for (int k = 0; k < 3; ++k) {
      Vec3d axis;
      axis[k] = 1;
      at.node[k + 1] = rotate(pose, axis);
    }
    const Vec3d w = angle * normalized(vector(1));
    for (int k = 1; k < 4; ++k) way.node[k] = cross(w, at.node[k]);
    way.node[0] = cross(w, at.node[0] - point_of(at, about));
    q.push_back(at), step.push_back(way), turn.push_back(w);
  }
};

// The straight step takes the point that stays along, and stretches the body by half the square of the angle.
TEST_F(BentWayTest, GuidedBodiesTurnAboutThePointThatStays) {
  std::vector<Vec3d> about;
  for (int k = 0; k < kCount; ++k) {
    about.push_back(vector(1));
    add_turn(about.back(), k < 10 ? 1e-5 * k : 0.02 * k);
    free.push_back(q.back().node[0] + vector(100));
  }
  const std::vector<AffineVec> end = run();
  for (std::size_t k = 0; k < end.size(); ++k) {
    EXPECT_LT(strain_norm(end[k]), 1e-14);
    EXPECT_LT(norm(point_of(end[k], about[k]) - point_of(q[k], about[k])), 1e-13) << k;
    const AffineVec expected = turned(q[k], turn[k]);
    for (int n = 1; n < 4; ++n) EXPECT_LT(norm(end[k].node[n] - expected.node[n]), 1e-14);
  }
}

TEST_F(BentWayTest, CentersOfFlyingBodiesGoStraight) {
  for (int k = 0; k < kCount; ++k) {
    add_turn(vector(1), 0.02 * k);
    free.push_back(q.back().node[0] + step.back().node[0]);
  }
  const std::vector<AffineVec> end = run();
  for (std::size_t k = 0; k < end.size(); ++k) {
    EXPECT_EQ(end[k].node[0], q[k].node[0] + step[k].node[0]);
    EXPECT_LT(strain_norm(end[k]), 1e-14);
  }
}

// What a step does beside turning it does: a stretch, in axes that turn along.
TEST_F(BentWayTest, StretchesStay) {
  for (int k = 0; k < kCount; ++k) {
    add_turn(Vec3d{}, 0);
    free.push_back(q.back().node[0]);
    for (int n = 1; n < 4; ++n) step.back().node[n] = 0.01 * n * q.back().node[n];
  }
  const std::vector<AffineVec> end = run();
  for (std::size_t k = 0; k < end.size(); ++k)
    for (int n = 0; n < 3; ++n) EXPECT_NEAR(strain(end[k], n, n), 0.02 * (n + 1), 1e-3);
}

TEST(BendOf, IsNoLessThanTheWayFromTheStraightEnd) {
  for (const double angle : {1e-3, 0.1, 0.5}) {
    AffineVec q, way;
    for (int k = 0; k < 3; ++k) q.node[k + 1][k] = 1;
    const Vec3d w{0, 0, angle}, corner{0.3, 0.4, 0}, about{-2, 1, 0};
    for (int k = 1; k < 4; ++k) way.node[k] = cross(w, q.node[k]);
    way.node[0] = cross(w, -about);
    const AffineVec turn = turned(q, w);
    const Vec3d end = about + point_of(turn, corner - about), straight = point_of(q + way, corner);
    EXPECT_GE(bend_of(way, norm(corner)), norm(end - straight));
    EXPECT_LE(bend_of(way, norm(corner)), 3 * norm(end - straight));
  }
}

}  // namespace
}  // namespace scree::affine
