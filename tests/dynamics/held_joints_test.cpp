// Impulses of joints that are worked out all at once, against dense matrices: which cables are taut by trying all that may be,
// motors, friction, limits and springs by their laws.

#include "dynamics/rigid/held_joints.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <bit>
#include <random>
#include <tuple>
#include <vector>

namespace scree {
namespace {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

/// Bodies at random, each with its own mass and moments.
struct Bodies {
  Matrix inverse_mass;  ///< [6 bodies x 6 bodies]
  Vector velocity;
};

Bodies random_bodies(int count, std::mt19937& random) {
  std::uniform_real_distribution<double> size(0.3, 3);
  std::normal_distribution<double> normal;
  Bodies out{Matrix::Zero(6 * count, 6 * count), Vector(6 * count)};
  for (int i = 0; i < 6 * count; ++i) out.velocity(i) = normal(random);
  for (int k = 0; k < count; ++k) {
    out.inverse_mass.block<3, 3>(6 * k, 6 * k) = size(random) * Eigen::Matrix3d::Identity();
    for (int i = 3; i < 6; ++i) out.inverse_mass(6 * k + i, 6 * k + i) = size(random);
  }
  return out;
}

/// A joint between two of the bodies, or one and the world (-1): rows of forces along its axes, then moments about them.
struct Linked {
  int a = -1, b = 0;
  Eigen::Vector3d arm_a, arm_b;
  Eigen::Matrix3d axes;
  unsigned rows = 0;  ///< bit k: row k is there
  bool is_driven = false;
  double least = -1e300, most = 1e300, compliance = 0, friction = 0, rest = 0;
  double slowest = -1e300, fastest = 1e300;

  /// [6 x 6 bodies]
  Matrix jacobian(Eigen::Index columns) const {
    Matrix j = Matrix::Zero(6, columns);
    for (const auto& [body, arm, sign] : {std::tuple{a, arm_a, -1.0}, std::tuple{b, arm_b, 1.0}}) {
      if (body < 0) continue;
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d e = axes.col(k);
        j.block<1, 3>(k, 6 * body) = sign * e.transpose();
        j.block<1, 3>(k, 6 * body + 3) = sign * arm.cross(e).transpose();
        j.block<1, 3>(3 + k, 6 * body + 3) = sign * e.transpose();
      }
    }
    return j;
  }
  /// Least and largest impulse at a velocity of the last row, give or take `near`.
  std::pair<double, double> impulses_at(double w, double near) const {
    const auto sum = [&](double at) {
      const double main =
          compliance > 0 ? std::clamp(-at / compliance, least, most) : (at > 0 ? least : most);
      return main + (at > rest ? -friction : friction);
    };
    return {w + near > fastest ? -1e300 : sum(w + near),
            w - near < slowest ? 1e300 : sum(w - near)};
  }
};

Linked random_joint(int a, int b, std::mt19937& random) {
  std::normal_distribution<double> normal;
  const auto vector = [&] {
    return Eigen::Vector3d(normal(random), normal(random), normal(random));
  };
  Linked out;
  out.a = a, out.b = b;
  out.arm_a = vector(), out.arm_b = vector();
  out.axes = Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
                 .normalized()
                 .toRotationMatrix();
  return out;
}

Vec3<double> vec(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// The joint as HeldJoints takes it.
JointEnds<double> ends_of(const Linked& joint, const Bodies& bodies) {
  JointEnds<double> out;
  out.is_here = true;
  JointRow<double>& row = out.row;
  row.arm_a = vec(joint.arm_a), row.arm_b = vec(joint.arm_b);
  for (int k = 0; k < 3; ++k) row.axes[k] = vec(joint.axes.col(k));
  row.length = 1;
  const Matrix j = joint.jacobian(bodies.velocity.size());
  const Matrix dense = j * bodies.inverse_mass * j.transpose();
  double block[kJointTriangle];
  for (int i = 0; i < kJointRows; ++i)
    for (int k = 0; k <= i; ++k) block[triangle_place(i, k)] = dense(i, k);
  factorize(row, block, joint.rows);
  const double inverse = row.inverse_pivot(kJointAxisRow);
  const auto bound = [](double x, double unit) { return std::abs(x) < 1e299 ? x * unit : x; };
  row.least = bound(joint.is_driven ? joint.least : -1e300, 1 / inverse);
  row.most = bound(joint.is_driven ? joint.most : 1e300, 1 / inverse);
  if (joint.is_driven) {
    row.compliance = joint.compliance * inverse * inverse;
    row.friction = joint.friction / inverse;
    row.rest = joint.rest * inverse;
    row.slowest = bound(joint.slowest, inverse), row.fastest = bound(joint.fastest, inverse);
  }
  for (int side = 0; side < 2; ++side) {
    const int body = side == 0 ? joint.a : joint.b;
    auto& end = out.end[side];
    if (body < 0) continue;
    end.moves = true;
    const auto m = [&](int i) { return bodies.inverse_mass(6 * body + i, 6 * body + i); };
    end.inv_mass = {m(0), m(1), m(2)};
    end.inv_inertia = {m(3), m(4), m(5), 0, 0, 0};
    end.velocity = {vec(bodies.velocity.segment<3>(6 * body)),
                    vec(bodies.velocity.segment<3>(6 * body + 3))};
  }
  return out;
}

std::vector<HeldJoints::Known> known_of(const std::vector<Linked>& joints) {
  std::vector<HeldJoints::Known> out;
  for (const Linked& joint : joints)
    out.push_back({{joint.a, joint.b},
                   std::popcount(joint.rows),
                   joint.is_driven && joint.compliance > 0,
                   false});
  return out;
}

/// What HeldJoints finds: impulses of all rows, and whether it says that they are right.
struct Found {
  std::vector<Vector> impulse;  ///< [6] of each joint
  bool is_solved = false;
  Vector velocity;
};

Found find(const std::vector<Linked>& joints, const Bodies& bodies) {
  const Eigen::Index columns = bodies.velocity.size();
  std::vector<JointEnds<double>> ends;
  for (const Linked& joint : joints) ends.push_back(ends_of(joint, bodies));
  HeldJoints held(known_of(joints), static_cast<Index>(columns / 6));
  Found out;
  out.is_solved = held.improve(ends);
  out.velocity = bodies.velocity;
  for (std::size_t k = 0; k < joints.size(); ++k) {
    const JointValues<double> g = ends[k].row.impulse(ends[k].impulse);
    Vector rows(6);
    for (int r = 0; r < 6; ++r) rows(r) = g[r];
    out.impulse.push_back(rows);
    out.velocity += bodies.inverse_mass * joints[k].jacobian(columns).transpose() * rows;
  }
  return out;
}

/// A cable: the last row is a moment here, which is as good as a force.
Linked random_cable(int a, int b, std::mt19937& random) {
  std::uniform_real_distribution<double> room(-0.1, 1);
  Linked out = random_joint(a, b, random);
  out.rows = 1u << kJointAxisRow;
  out.is_driven = true;
  out.least = out.most = 0;
  out.fastest = room(random);
  return out;
}

/// The only impulses g <= 0 with w = N g + r <= bound where g = 0, and w = bound where not: by trying all sets.
Vector taut_impulses(const Matrix& n, const Vector& right, const Vector& bound) {
  const Eigen::Index count = n.rows();
  for (unsigned set = 0; set < 1u << count; ++set) {
    std::vector<Eigen::Index> taut;
    for (Eigen::Index k = 0; k < count; ++k)
      if ((set >> k & 1u) != 0) taut.push_back(k);
    Vector gamma = Vector::Zero(count);
    if (!taut.empty()) {
      const Matrix block = n(taut, taut);
      const Vector missing = (bound - right)(taut);
      gamma(taut) = Vector(block.ldlt().solve(missing));
    }
    const Vector over = n * gamma + right - bound;
    if (gamma.maxCoeff() < 1e-12 && over.maxCoeff() < 1e-12) return gamma;
  }
  ADD_FAILURE() << "no set of taut cables";
  return Vector::Zero(count);
}

TEST(HeldJoints, FindsTheCablesThatAreTaut) {
  int taut = 0, slack = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    std::mt19937 random(seed);
    constexpr int kBodies = 6, kCables = 10;
    const Bodies bodies = random_bodies(kBodies, random);
    std::vector<Linked> joints;
    for (int k = 0; k < kCables; ++k) {  // with loops
      const int b = k % kBodies;
      joints.push_back(random_cable(k < kBodies ? b - 1 : (b + 3) % kBodies, b, random));
    }
    Matrix j(kCables, 6 * kBodies);
    Vector bound(kCables);
    for (int k = 0; k < kCables; ++k) {
      const Linked& joint = joints[static_cast<std::size_t>(k)];
      j.row(k) = joint.jacobian(6 * kBodies).row(kJointAxisRow);
      bound(k) = joint.fastest;
    }
    const Vector expected =
        taut_impulses(j * bodies.inverse_mass * j.transpose(), j * bodies.velocity, bound);
    const Found found = find(joints, bodies);
    EXPECT_TRUE(found.is_solved) << seed;
    for (int k = 0; k < kCables; ++k) {
      EXPECT_NEAR(found.impulse[static_cast<std::size_t>(k)](kJointAxisRow), expected(k), 1e-7)
          << seed << ", " << k;
      (expected(k) < 0 ? taut : slack) += 1;
    }
  }
  EXPECT_GT(taut, 100);
  EXPECT_GT(slack, 100);
}

TEST(HeldJoints, FindsWhatDrivesOfAllKindsGive) {
  std::uniform_real_distribution<double> uniform(0, 1);
  int solved = 0;
  constexpr int kSeeds = 40;
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    std::mt19937 random(100 + seed);
    constexpr int kBodies = 8;
    const Bodies bodies = random_bodies(kBodies, random);
    std::vector<Linked> joints;
    for (int b = 0; b < kBodies; ++b) {  // a tree, and hinges, balls and fixed joints by turns
      Linked joint = random_joint((b + 1) / 2 - 1, b, random);
      joint.rows = b % 4 == 1 ? 0b000111u : 0b111111u;
      joint.is_driven = b % 4 != 1 && b % 4 != 3;
      if (b % 3 == 0) joint.compliance = uniform(random);
      if (b % 3 == 1) joint.most = uniform(random), joint.least = -joint.most;
      if (b % 3 == 2) joint.most = joint.least = 0;
      if (seed % 2 == 0) joint.friction = 0.3 * uniform(random), joint.rest = 0.1;
      if (b % 2 == 0) joint.fastest = 0.4 * uniform(random) - 0.1, joint.slowest = -0.2;
      joints.push_back(joint);
    }
    const Found found = find(joints, bodies);
    solved += found.is_solved ? 1 : 0;
    if (!found.is_solved) continue;
    constexpr double kNear = 1e-6;
    for (std::size_t k = 0; k < joints.size(); ++k) {
      const Vector u = joints[k].jacobian(6 * kBodies) * found.velocity;
      for (int r = 0; r < kJointRows; ++r) {
        if ((joints[k].rows >> r & 1u) == 0) continue;
        if (r < kJointAxisRow || !joints[k].is_driven) {
          EXPECT_NEAR(u(r), 0, kNear) << seed << ", " << k << ", " << r;
          continue;
        }
        const auto [low, high] = joints[k].impulses_at(u(r), kNear);
        EXPECT_GT(found.impulse[k](r), low - 1e-4) << seed << ", " << k;
        EXPECT_LT(found.impulse[k](r), high + 1e-4) << seed << ", " << k;
        EXPECT_LT(u(r), joints[k].fastest + kNear);
        EXPECT_GT(u(r), joints[k].slowest - kNear);
      }
    }
  }
  EXPECT_GE(solved, kSeeds - 2);
}

// One of two cables side by side would do; a load is shared, by cables too.
TEST(HeldJoints, SharesALoadAmongCablesThatAreTaut) {
  std::mt19937 random(5);
  Bodies bodies = random_bodies(1, random);
  bodies.velocity.setZero();
  Linked cable = random_cable(-1, 0, random);
  bodies.velocity.tail<3>() = cable.axes.col(2);
  cable.fastest = 0;
  const Found found = find({cable, cable}, bodies);
  EXPECT_TRUE(found.is_solved);
  EXPECT_LT(found.impulse[0](kJointAxisRow), -0.1);
  EXPECT_NEAR(found.impulse[0](kJointAxisRow), found.impulse[1](kJointAxisRow), 1e-6);
}

}  // namespace
}  // namespace scree
