// The algebra of a joint against dense matrices: rows that do not act on each other, impulses and
// velocities there and back, absent and redundant rows, bounds.
#include <Eigen/Cholesky>
#include <Eigen/Dense>
#include <algorithm>
#include <random>

#include "kernels/contact/joint_row.h"
#include "tests/backend_fixture.h"

namespace scree {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

constexpr unsigned kAll = 0b111111, kHinge = 0b011111, kBall = 0b000111;

/// Element program: what a joint makes of one impulse and one velocity.
template <class Real>
struct TryJoint {
  static constexpr const char* name = "try_joint";
  Span<const JointRow<Real>> joint;
  Span<const JointValues<Real>> given;
  Span<JointValues<Real>> scaled_velocity;
  Span<JointValues<Real>> velocity;
  Span<JointValues<Real>> scaled_impulse;
  Span<JointValues<Real>> impulse;
  Span<JointValues<Real>> nearest;
  Real step = 1;
  SCREE_HD void operator()(Index k) const {
    scaled_velocity[k] = joint[0].scaled_velocity(given[k]);
    velocity[k] = joint[0].velocity(scaled_velocity[k]);
    scaled_impulse[k] = joint[0].scaled_impulse(given[k]);
    impulse[k] = joint[0].impulse(scaled_impulse[k]);
    nearest[k] = joint[0].project(given[k], step);
  }
};

template <class Real>
class JointRowTest : public BackendTest<Real> {
 protected:
  struct Results {
    std::vector<Vector6> scaled_velocity, velocity, scaled_impulse, impulse, nearest;
  };

  /// Random symmetric positive definite block, its rows of sizes 1 to `spread`.
  Matrix6 random_block(double spread) {
    std::uniform_real_distribution<double> uniform(-1, 1);
    Eigen::Matrix<double, 6, 8> j;
    for (Eigen::Index i = 0; i < j.size(); ++i) j(i) = uniform(random_);
    for (int i = 0; i < 6; ++i) j.row(i) *= std::pow(spread, 0.5 * (1 + uniform(random_)));
    return j * j.transpose();
  }
  Vector6 random_vector() {
    std::uniform_real_distribution<double> uniform(-1, 1);
    Vector6 v;
    for (int i = 0; i < 6; ++i) v(i) = uniform(random_);
    return v;
  }

  static JointRow<Real> joint_of(const Matrix6& block, unsigned held) {
    double triangle[kJointTriangle];
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j <= i; ++j) triangle[triangle_place(i, j)] = block(i, j);
    JointRow<Real> joint;
    factorize(joint, triangle, held);
    joint.most = 1e30f;
    joint.least = -joint.most;
    return joint;
  }

  Results run(const JointRow<Real>& joint, const std::vector<Vector6>& given, double step = 1) {
    TestBackend& b = this->backend();
    const auto n = static_cast<Index>(given.size());
    std::vector<JointValues<Real>> values;
    for (const Vector6& v : given) {
      JointValues<Real> x;
      for (int i = 0; i < 6; ++i) x[i] = static_cast<Real>(v(i));
      values.push_back(x);
    }
    Buffer<TestBackend, JointRow<Real>> joints(b);
    Buffer<TestBackend, JointValues<Real>> in(b), out(b, 5 * static_cast<Offset>(n));
    upload(b, std::vector<JointRow<Real>>{joint}, joints);
    upload(b, values, in);
    const auto part = [&](int k) {
      return Span<JointValues<Real>>{out.data() + static_cast<Offset>(k) * n, n};
    };
    for_each(b, n,
             TryJoint<Real>{joints.view(), in.view(), part(0), part(1), part(2), part(3), part(4),
                            static_cast<Real>(step)});
    Results r;
    std::vector<Vector6>* results[] = {&r.scaled_velocity, &r.velocity, &r.scaled_impulse,
                                       &r.impulse, &r.nearest};
    for (int k = 0; k < 5; ++k)
      for (const JointValues<Real>& x : download(b, part(k))) {
        Vector6 v;
        for (int i = 0; i < 6; ++i) v(i) = x[i];
        results[k]->push_back(v);
      }
    return r;
  }

  static constexpr double kTolerance = std::is_same_v<Real, double> ? 1e-11 : 2e-4;
  std::mt19937 random_{11};
};

/// 0/1 diagonal of the rows that are held.
Matrix6 picked(unsigned held) {
  Matrix6 p = Matrix6::Zero();
  for (int i = 0; i < 6; ++i) p(i, i) = held >> i & 1u;
  return p;
}

TYPED_TEST_SUITE(JointRowTest, Reals);

// u' = L^-1 u, and so L^-1 D L^-T = d: the map that the joint applies to the columns of D, twice,
// leaves d times the identity on its rows.
TYPED_TEST(JointRowTest, HeldRowsDoNotActOnEachOther) {
  for (const unsigned held : {kAll, kHinge, kBall, 0b100111u, 0b110011u}) {
    for (const double spread : {1.0, 30.0}) {
      const Matrix6 block = this->random_block(spread);
      const JointRow<TypeParam> joint = this->joint_of(block, held);
      std::vector<Vector6> unit;
      for (int k = 0; k < 6; ++k) unit.push_back(Vector6::Unit(k));
      const auto r = this->run(joint, unit);
      Matrix6 map;  // L^-1
      for (int k = 0; k < 6; ++k) map.col(k) = r.scaled_velocity[static_cast<std::size_t>(k)];
      const Matrix6 p = picked(held);
      const Matrix6 held_block = p * block * p;
      const double scale = held_block.trace() / p.trace();
      EXPECT_NEAR(joint.scale / scale, 1, this->kTolerance);
      EXPECT_LT((map * held_block * map.transpose() / scale - p).norm(), spread * this->kTolerance)
          << "held " << held << " spread " << spread;
    }
  }
}

TYPED_TEST(JointRowTest, MapsPairAndInvert) {
  for (const unsigned held : {kAll, kHinge, kBall}) {
    const JointRow<TypeParam> joint = this->joint_of(this->random_block(10), held);
    std::vector<Vector6> given;
    for (int k = 0; k < 33; ++k) given.push_back(this->random_vector());
    const auto r = this->run(joint, given);
    const Matrix6 p = picked(held);
    for (std::size_t k = 0; k < given.size(); ++k) {
      const Vector6 g = p * given[k], u = p * given[(k + 1) % given.size()];
      EXPECT_LT((r.velocity[k] - g).norm(), this->kTolerance * 10);
      EXPECT_LT((r.impulse[k] - g).norm(), this->kTolerance * 10);
      // The power of an impulse is the same in both coordinates.
      EXPECT_NEAR(r.scaled_impulse[k].dot(r.scaled_velocity[(k + 1) % given.size()]), g.dot(u),
                  this->kTolerance * 30);
    }
  }
}

// Two rows along the same direction and one that nothing can follow: the rest is held.
TYPED_TEST(JointRowTest, LeavesOutRowsThatAreRedundant) {
  Eigen::Matrix<double, 6, 8> j = Eigen::Matrix<double, 6, 8>::Zero();
  for (int i = 0; i < 6; ++i) j(i, i) = i + 1;
  j.row(4) = 2 * j.row(1);
  j.row(2).setZero();
  const JointRow<TypeParam> joint = this->joint_of(j * j.transpose(), kAll);
  const auto r = this->run(joint, {this->random_vector()});
  for (const int row : {2, 4}) {
    EXPECT_EQ(r.scaled_velocity[0](row), 0);
    EXPECT_EQ(r.impulse[0](row), 0);
  }
  for (const int row : {0, 1, 3, 5}) EXPECT_NE(r.impulse[0](row), 0);
}

TYPED_TEST(JointRowTest, JointOfBodiesThatCannotMoveHasNoRows) {
  const JointRow<TypeParam> joint = this->joint_of(Matrix6::Zero(), kAll);
  EXPECT_EQ(joint.scale, 0);
  const auto r = this->run(joint, {this->random_vector()});
  EXPECT_EQ(r.scaled_impulse[0].norm(), 0);
  EXPECT_EQ(r.impulse[0].norm(), 0);
}

// A motor: the moment about the axis has bounds. The minimizer of 1/2 g D g + r g under them is one
// step with 1/d, projected in the coordinates of solvers; by hand it is that of the other five rows
// at the bound that the free minimizer breaks.
TYPED_TEST(JointRowTest, OneStepSolvesAJointWithBounds) {
  for (int trial = 0; trial < 20; ++trial) {
    const Matrix6 block = this->random_block(5);
    const Vector6 r = this->random_vector();
    const double bound = 0.05 * (trial + 1) * std::abs(block.ldlt().solve(r)(5));
    Vector6 expected = -block.ldlt().solve(r);
    if (std::abs(expected(5)) > bound) {
      expected(5) = std::copysign(bound, expected(5));
      expected.head<5>() = -block.topLeftCorner<5, 5>().ldlt().solve(
          r.head<5>() + block.topRightCorner<5, 1>() * expected(5));
    }
    JointRow<TypeParam> joint = this->joint_of(block, kAll);
    JointValues<TypeParam> limit;
    limit[5] = static_cast<TypeParam>(bound);
    joint.most = joint.scaled_impulse(limit)[5];
    joint.least = -joint.most;
    const Vector6 step = -this->run(joint, {r}).scaled_velocity[0] / joint.scale;
    const Vector6 nearest = this->run(joint, {step}).nearest[0];
    JointValues<TypeParam> z;
    for (int i = 0; i < 6; ++i) z[i] = static_cast<TypeParam>(nearest(i));
    const JointValues<TypeParam> found = joint.impulse(z);
    Vector6 g;
    for (int i = 0; i < 6; ++i) g(i) = found[i];
    EXPECT_LT((g - expected).norm() / expected.norm(), 100 * this->kTolerance) << trial;
  }
}

/// Impulses that a drive gives at a velocity: all from .first to .second. Written from its parts.
std::pair<double, double> impulses_at(const JointRow<double>& d, double w) {
  constexpr double kAll = 1e30, kNear = 1e-9;
  double low = 0, high = 0;
  if (d.compliance > 0) {
    low = high = std::clamp(-w / d.compliance, d.least, d.most);
  } else {
    low = w > -kNear ? d.least : d.most;
    high = w < kNear ? d.most : d.least;
  }
  low += w > d.rest - kNear ? -d.friction : d.friction;
  high += w < d.rest + kNear ? d.friction : -d.friction;
  if (w > d.fastest - kNear) low = -kAll;
  if (w < d.slowest + kNear) high = kAll;
  return {low, high};
}

// Motor or spring, friction and limits together: what is found is an impulse that they give at the
// velocity that the impulse leaves, beside that by which the row gives way.
TYPED_TEST(JointRowTest, DrivenRowGivesWhatItsPartsGive) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0, 1);
  int at_limit = 0, sticking = 0, bounded = 0, free = 0;
  for (int trial = 0; trial < 500; ++trial) {
    JointRow<TypeParam> row = this->joint_of(Matrix6::Identity(), kAll);
    const auto some = [&] { return static_cast<TypeParam>(uniform(random)); };
    row.most = some() * TypeParam(trial % 3);
    row.least = trial % 5 == 0 ? TypeParam(0) : -some();
    if (trial % 2 == 0) row.compliance = some();
    if (trial % 4 < 2) row.friction = some();
    row.rest = some() - TypeParam(0.5);
    if (trial % 7 < 4) row.fastest = some() - TypeParam(0.2);
    if (trial % 9 < 3) row.give = some();
    if (trial % 7 > 2) row.slowest = (row.fastest < 1 ? row.fastest : TypeParam(0)) - some();
    const double step = 0.1 + 3 * uniform(random);
    const double given = 6 * uniform(random) - 3;
    const double found = this->run(row, {given * Vector6::Unit(5)}, step).nearest[0](5);
    const double w = (found - given) / step + row.give * found;
    JointRow<double> same;
    same.least = row.least, same.most = row.most, same.compliance = row.compliance;
    same.friction = row.friction, same.rest = row.rest;
    same.slowest = row.slowest, same.fastest = row.fastest;
    // Somewhere within rounding of w.
    const double off = this->kTolerance;
    const double low = impulses_at(same, w + off).first, high = impulses_at(same, w - off).second;
    EXPECT_GE(found, low - off) << trial;
    EXPECT_LE(found, high + off) << trial;
    EXPECT_LE(w, row.fastest + off) << trial;
    EXPECT_GE(w, row.slowest - off) << trial;
    const bool is_limited = w > row.fastest - 1e-5 || w < row.slowest + 1e-5;
    const bool sticks = row.friction > 0 && std::abs(w - row.rest) < 1e-5;
    ++(is_limited ? at_limit : sticks ? sticking : row.compliance > 0 ? free : bounded);
  }
  for (const int count : {at_limit, sticking, bounded, free}) EXPECT_GT(count, 15);
}

// All rows that give way do so by the same times their impulse.
TYPED_TEST(JointRowTest, RowsThatGiveWayAreSprings) {
  JointRow<TypeParam> row = this->joint_of(Matrix6::Identity(), kAll);
  row.least = -largest_number<TypeParam>(), row.most = largest_number<TypeParam>();
  row.give = TypeParam(0.5);
  const Vector6 given = this->random_vector();
  const Vector6 found = this->run(row, {given}, 0.25).nearest[0];
  EXPECT_LT(((found - given) / 0.25 + 0.5 * found).norm(), 20 * this->kTolerance);
}

// Friction in any direction: the moments nearest to those given, in the coordinates of solvers, that are no more than it gives in
// the rows themselves. Pivots of all sizes, and impulses whose squares are no floats.
TYPED_TEST(JointRowTest, RubbingMomentsAreTheNearestWithinABall) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> uniform(-1, 1);
  int inside = 0, outside = 0;
  for (int trial = 0; trial < 300; ++trial) {
    Matrix6 block = Matrix6::Identity();
    const double spread = trial % 3 == 0 ? 1 : trial % 3 == 1 ? 10 : 1000;
    for (int k = 3; k < 6; ++k) block(k, k) = std::pow(spread, uniform(random));
    JointRow<TypeParam> row = this->joint_of(block, kJointMoments);
    row.rubs = true;
    row.least = row.most = 0;
    const double unit = trial % 5 == 0 ? 1e-25 : 1;
    row.friction = static_cast<TypeParam>(unit * std::pow(10, 2 * uniform(random)));
    Vector6 given = unit * this->random_vector();
    const Vector6 found = this->run(row, {given}, 0.5).nearest[0];
    // Of z_k / (1 + x p_k^2) the one on the ball, by bisection of x over all that can be.
    const Eigen::Vector3d p(row.inverse_pivot(3), row.inverse_pivot(4), row.inverse_pivot(5));
    const double most = row.friction;
    const Eigen::Vector3d z = given.tail<3>() / unit;
    const auto at = [&](double x) {
      return Eigen::Vector3d(z.cwiseQuotient((1 + x * p.array().square()).matrix()));
    };
    const auto moments = [&](double x) { return at(x).cwiseProduct(p).norm(); };
    double low = 0, high = 1;
    while (moments(high) > most / unit) high *= 2;
    if (moments(0) > most / unit)
      for (int k = 0; k < 200; ++k)
        (moments((low + high) / 2) > most / unit ? low : high) = (low + high) / 2;
    const bool is_inside = moments(0) <= most / unit;
    ++(is_inside ? inside : outside);
    const Eigen::Vector3d expected = is_inside ? z : at(high);
    EXPECT_LT((found.tail<3>() / unit - expected).norm(), 10 * this->kTolerance) << trial;
    EXPECT_EQ(found.template head<3>().norm(), 0);
    EXPECT_LT(found.tail<3>().cwiseProduct(p).norm() / most, 1 + this->kTolerance) << trial;
  }
  EXPECT_GT(inside, 30);
  EXPECT_GT(outside, 100);
  JointRow<TypeParam> none = this->joint_of(Matrix6::Identity(), kJointMoments);
  none.rubs = true;
  none.least = none.most = 0;
  EXPECT_EQ(this->run(none, {Vector6::Ones()}, 0.5).nearest[0].norm(), 0);
}

// Before the first step a guess is made one that the drive may give.
TYPED_TEST(JointRowTest, GuessBecomesOneThatTheDriveMayGive) {
  JointRow<TypeParam> row = this->joint_of(Matrix6::Identity(), kAll);
  row.most = 2, row.least = -1, row.friction = TypeParam(0.5);
  const auto nearest = [&](double z) {
    return this->run(row, {z * Vector6::Unit(5)}, 0).nearest[0](5);
  };
  EXPECT_EQ(nearest(5), 2.5);
  EXPECT_EQ(nearest(-5), -1.5);
  EXPECT_EQ(nearest(1), 1);
  row.fastest = 3;  // its limit gives any impulse against the motion
  EXPECT_EQ(nearest(-5), -5);
  EXPECT_EQ(nearest(5), 2.5);
}

}  // namespace
}  // namespace scree
