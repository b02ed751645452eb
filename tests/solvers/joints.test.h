// Joints in the solvers, against dense matrices: joints alone are a linear system; beside contacts
// they are eliminated from the mass matrix, and what is left is a problem of contacts.
#include <Eigen/Dense>
#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "solvers/body_contacts.h"
#include "solvers/solver.h"
#include "solvers/solver_card.h"
#include "tests/backend_fixture.h"
#include "tests/problem_builder.h"
#include "tests/reference/dense_algebra.h"

namespace scree {
namespace {

using fixtures::PlainProblem;
using fixtures::ProblemBuffers;
using fixtures::to_vec3;

/// A joint in plain numbers: rows of its axes, forces first.
struct PlainJoint {
  int a = 0, b = 0;
  Eigen::Vector3d arm_a, arm_b;
  Eigen::Matrix3d axes;  ///< columns
  double length = 1;
  Eigen::Matrix<double, 6, 1> bias;
  int rows = 6;  ///< the first ones are held
  /// What the last of six rows gives when it is driven: a main part, friction at rest, limits.
  bool is_driven = false;
  double least = -1e30, most = 1e30, compliance = 0, friction = 0, rest = 0;
  double slowest = -1e30, fastest = 1e30;
  /// The last three rows instead, with no more than `friction` together.
  bool rubs = false;

  /// Least and largest impulse at a velocity of the row, give or take `near`.
  std::pair<double, double> impulses_at(double w, double near) const {
    const auto main_part = [&](double at) {
      if (compliance > 0) return std::clamp(-at / compliance, least, most);
      return at > 0 ? least : most;
    };
    const auto sum = [&](double at) { return main_part(at) + (at > rest ? -friction : friction); };
    return {w + near > fastest ? -1e30 : sum(w + near), w - near < slowest ? 1e30 : sum(w - near)};
  }

  /// J of the held rows [rows x 6 bodies].
  Eigen::MatrixXd jacobian(int body_count) const {
    Eigen::MatrixXd j = Eigen::MatrixXd::Zero(6, 6 * static_cast<Eigen::Index>(body_count));
    for (const auto& [body, arm, sign] : {std::tuple{a, arm_a, -1.0}, std::tuple{b, arm_b, 1.0}}) {
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d e = axes.col(k);
        j.block<1, 3>(k, 6 * body) = sign * e.transpose();
        j.block<1, 3>(k, 6 * body + 3) = sign * arm.cross(e).transpose();
        j.block<1, 3>(3 + k, 6 * body + 3) = sign * length * e.transpose();
      }
    }
    return rubs ? j.bottomRows(3) : j.topRows(rows);
  }
};

/// Bodies with contacts of the rolling layout and joints between them.
struct JointedSample {
  PlainProblem plain;
  std::vector<PlainJoint> joints;

  int body_count() const { return static_cast<int>(plain.data.bodies.size()); }
  Eigen::MatrixXd jacobian() const {
    Eigen::MatrixXd all(0, 6 * static_cast<Eigen::Index>(body_count()));
    for (const PlainJoint& joint : joints) {
      const Eigen::MatrixXd own = joint.jacobian(body_count());
      Eigen::MatrixXd grown(all.rows() + own.rows(), all.cols());
      grown << all, own;
      all = grown;
    }
    return all;
  }
  Eigen::VectorXd bias() const {
    std::vector<double> all;
    for (const PlainJoint& joint : joints)
      for (int k = 0; k < joint.rows; ++k) all.push_back(joint.bias(k));
    return Eigen::Map<Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
  }
};

/// Gives joints a bias with which a velocity exists that joints and contacts allow, the latter with
/// room: that of free bodies when they start from rest.
inline void allow_a_velocity(JointedSample& s) {
  oracle::Problem resting = s.plain.data;
  for (int i = 0; i < resting.free_count; ++i) {
    resting.bodies[i].velocity.setZero();
    resting.bodies[i].angular_velocity.setZero();
  }
  const Eigen::VectorXd allowed =
      oracle::free_velocity(resting) + oracle::inverse_mass(resting) *
                                           oracle::jacobian(resting).transpose() *
                                           oracle::solve_convex(resting).gamma;
  for (PlainJoint& joint : s.joints) {
    PlainJoint whole = joint;
    whole.rows = 6;
    joint.bias = -whole.jacobian(s.body_count()) * allowed;
  }
  for (oracle::Contact& contact : s.plain.data.contacts) contact.bias += 0.1;
}

/// A tree of joints, sizes of bodies and arms mixed; the eighth joint goes to a fixed body.
JointedSample random_sample(unsigned seed, int joints, int contacts) {
  JointedSample s;
  s.plain = fixtures::random_problem({.layout = ContactLayout::rolling,
                                      .free_count = 8,
                                      .fixed_count = 2,
                                      .contact_count = contacts,
                                      .seed = seed});
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto vector = [&] {
    return Eigen::Vector3d(normal(random), normal(random), normal(random));
  };
  const int rows[] = {5, 3, 6, 5, 5, 3, 5, 3};
  for (int b = 1; b <= joints; ++b) {
    PlainJoint joint;
    joint.a = b == 8 ? 0 : (b - 1) / 2;  // the last one to a fixed body
    joint.b = b;
    joint.arm_a = vector();
    joint.arm_b = 3 * vector();
    joint.axes = Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
                     .normalized()
                     .toRotationMatrix();
    joint.length = 0.5 + std::abs(normal(random));
    for (int k = 0; k < 6; ++k) joint.bias(k) = 0.1 * normal(random);
    joint.rows = rows[b - 1];
    s.joints.push_back(joint);
  }
  if (contacts > 0) allow_a_velocity(s);
  std::stable_sort(s.joints.begin(), s.joints.end(),
                   [](const PlainJoint& x, const PlainJoint& y) { return x.a < y.a; });
  return s;
}

template <class Real>
class JointedBuffers {
 public:
  JointedBuffers(TestBackend& b, const JointedSample& sample)
      : b_(b),
        sample_(sample),
        contacts_(b, sample.plain),
        body_a_(b),
        body_b_(b),
        normal_(b),
        row_(b),
        gamma_(b),
        lists_(b) {
    ContactProblem<Real>& p = problem_ = contacts_.problem();
    const Index before = p.contact_count, count = static_cast<Index>(sample.joints.size());
    auto body_a = download(b, p.body_a), body_b = download(b, p.body_b);
    auto normal = download(b, p.normal);
    std::vector<JointRow<Real>> rows;
    for (const PlainJoint& joint : sample.joints) {
      body_a.push_back(joint.a);
      body_b.push_back(joint.b);
      normal.push_back(to_vec3<Real>(joint.axes.col(2)));
      rows.push_back(row_of(joint));
    }
    upload(b, body_a, body_a_);
    upload(b, body_b, body_b_);
    upload(b, normal, normal_);
    upload(b, rows, row_);
    p.layout = ContactLayout::jointed;
    p.contact_count = before + count;
    p.body_a = body_a_.view();
    p.body_b = body_b_.view();
    p.normal = normal_.view();
    p.joint_begin = before;
    p.joints = row_.view();
    p.later[0] = lists_.build(b, p.bodies.owned_count, {body_a_.data() + before, count},
                              {body_b_.data() + before, count});
    p.later[0].first = before;
    gamma_.reserve_discard(2 * static_cast<Offset>(p.contact_count));
    fill(b, gamma_.view(), Vec3<Real>{});
  }

  const ContactProblem<Real>& problem() const { return problem_; }
  Span<Vec3<Real>> gamma() { return gamma_.view(); }
  ProblemBuffers<TestBackend, Real>& contacts() { return contacts_; }
  /// Impulses of the contacts, world vectors.
  std::vector<Eigen::Vector3d> contact_impulses() {
    std::vector<Eigen::Vector3d> out;
    for (const Vec3<Real>& v : download(b_, gamma().first(2 * problem_.joint_begin)))
      out.push_back(fixtures::to_eigen(Vec3<double>(v)));
    return out;
  }

 private:
  JointRow<Real> row_of(const PlainJoint& joint) const {
    JointRow<Real> row;
    row.arm_a = to_vec3<Real>(joint.arm_a);
    row.arm_b = to_vec3<Real>(joint.arm_b);
    for (int k = 0; k < 3; ++k) row.axes[k] = to_vec3<Real>(joint.axes.col(k));
    row.length = static_cast<Real>(joint.length);
    for (int k = 0; k < kJointRows; ++k) row.bias[k] = static_cast<Real>(joint.bias(k));
    PlainJoint whole = joint;
    whole.rows = 6;
    whole.rubs = false;
    const Eigen::MatrixXd j = whole.jacobian(sample_.body_count());
    const Eigen::MatrixXd dense = j * oracle::inverse_mass(sample_.plain.data) * j.transpose();
    double block[kJointTriangle];
    for (int i = 0; i < kJointRows; ++i)
      for (int k = 0; k <= i; ++k) block[triangle_place(i, k)] = dense(i, k);
    factorize(row, block, joint.rubs ? kJointMoments : (1u << joint.rows) - 1);
    row.rubs = joint.rubs;
    // The last row of the factor scales velocities by its inverse, impulses by itself.
    const double inverse = joint.is_driven ? row.inverse_pivot(kJointAxisRow) : 1;
    const auto real = [](double x) { return static_cast<Real>(x); };
    row.most = real(joint.most / inverse);
    row.least = real(joint.least / inverse);
    row.compliance = real(joint.compliance * inverse * inverse);
    row.friction = real(joint.friction / inverse);
    row.rest = real(joint.rest * inverse);
    if (joint.slowest > -1e29) row.slowest = real(joint.slowest * inverse);
    if (joint.fastest < 1e29) row.fastest = real(joint.fastest * inverse);
    return row;
  }

  TestBackend& b_;
  const JointedSample& sample_;
  ProblemBuffers<TestBackend, Real> contacts_;
  ContactProblem<Real> problem_;
  Buffer<TestBackend, Index> body_a_, body_b_;
  Buffer<TestBackend, Vec3<Real>> normal_;
  Buffer<TestBackend, JointRow<Real>> row_;
  Buffer<TestBackend, Vec3<Real>> gamma_;
  GroupContacts<TestBackend> lists_;
};

/// Impulses that make of velocities what they changed by; where joints are redundant the least ones.
/// @param effect  M^-1 J^T
inline Eigen::VectorXd impulses_behind(const Eigen::VectorXd& change, const Eigen::MatrixXd& effect,
                                       double tolerance) {
  const Eigen::VectorXd gamma = oracle::least_norm(effect, change);
  EXPECT_LT((effect * gamma - change).norm(), tolerance);
  return gamma;
}

template <class Real>
class JointsTest : public BackendTest<Real> {
 protected:
  static constexpr double kTolerance = std::is_same_v<Real, double> ? 1e-10 : 2e-5;

  /// Calls check(solver name, velocities, buffers, stats) for all solvers that know joints.
  template <class F>
  void for_each_solver(const JointedSample& sample, F check) {
    int found = 0;
    for (const std::string& name : solver_names(TestBackend::kIsDevice)) {
      if (!solver_card(name).knows(ContactLayout::jointed)) continue;
      SCOPED_TRACE(name);
      ++found;
      JointedBuffers<Real> buffers(this->backend(), sample);
      const auto solver =
          make_solver<TestBackend, Real>(name, {.max_iterations = 200000, .check_every = 50});
      const SolveStats stats =
          solver->solve(this->backend(), buffers.problem(), buffers.gamma(), kTolerance);
      EXPECT_TRUE(stats.converged) << stats.residual.rms;
      check(buffers.contacts().velocities(solver->velocity()), buffers, stats);
    }
    EXPECT_GE(found, TestBackend::kIsDevice ? 3 : 4);
  }
};
TYPED_TEST_SUITE(JointsTest, Reals);

// gamma = -(J M^-1 J^T)^-1 (J v* + bias), and V = v* + M^-1 J^T gamma.
TYPED_TEST(JointsTest, SolvesJointsAsALinearSystem) {
  for (const unsigned seed : {1u, 2u, 3u}) {
    JointedSample sample = random_sample(seed, 8, 0);
    fixtures::round_to<TypeParam>(sample.plain);
    const Eigen::MatrixXd j = sample.jacobian(), m = oracle::inverse_mass(sample.plain.data);
    const Eigen::VectorXd start = oracle::free_velocity(sample.plain.data);
    const Eigen::VectorXd right = j * start + sample.bias();
    const Eigen::MatrixXd n = j * m * j.transpose();
    const Eigen::VectorXd gamma = -oracle::least_norm(n, right);
    ASSERT_LT((n * gamma + right).norm(), 1e-10);
    const Eigen::VectorXd expected = start + m * j.transpose() * gamma;
    const double objective = 0.5 * gamma.dot(n * gamma) + right.dot(gamma);
    this->for_each_solver(sample, [&](const Eigen::VectorXd& v, auto&, const SolveStats& stats) {
      EXPECT_LT((v - expected).cwiseAbs().maxCoeff(), this->tolerance(1e-7, 1e-3));
      EXPECT_NEAR(stats.residual.objective / objective, 1, this->tolerance(1e-8, 1e-3));
      // The residual is what is left in the rows, RMS over joints.
      const double left = (j * v + sample.bias()).norm() / std::sqrt(8.0);
      EXPECT_NEAR(stats.residual.rms, left, 0.3 * this->kTolerance);
    });
  }
}

// With the joints in the mass matrix, M'^-1 = M^-1 - M^-1 J^T (J M^-1 J^T)^-1 J M^-1, contacts have
// impulses that are their own projection.
TYPED_TEST(JointsTest, SolvesContactsAndJointsTogether) {
  for (const unsigned seed : {4u, 5u, 6u}) {
    JointedSample sample = random_sample(seed, 4, 8);
    fixtures::round_to<TypeParam>(sample.plain);
    const oracle::Problem& data = sample.plain.data;
    const Eigen::MatrixXd j = sample.jacobian(), m = oracle::inverse_mass(data);
    const Eigen::MatrixXd n = j * m * j.transpose();
    const Eigen::MatrixXd held = m - m * j.transpose() * oracle::least_norm(n, j * m);
    const Eigen::VectorXd start = oracle::free_velocity(data);
    const Eigen::VectorXd held_start =
        start - m * j.transpose() * oracle::least_norm(n, j * start + sample.bias());
    const Eigen::MatrixXd contacts = oracle::jacobian(data);
    // Biases of contacts that the sample was made with: r = J v* + bias.
    const Eigen::VectorXd bias = oracle::right_side(data) - contacts * start;
    this->for_each_solver(sample, [&](const Eigen::VectorXd& v, auto& buffers, const SolveStats&) {
      const Eigen::VectorXd gamma = oracle::rows_from_world(data, buffers.contact_impulses());
      const Eigen::VectorXd expected = held_start + held * contacts.transpose() * gamma;
      EXPECT_LT((v - expected).cwiseAbs().maxCoeff(), this->tolerance(1e-6, 1e-3));
      const Eigen::VectorXd u = contacts * expected + bias;
      EXPECT_LT((gamma - oracle::project(data, gamma - u)).cwiseAbs().maxCoeff(),
                this->tolerance(1e-7, 1e-3));
      EXPECT_GT(gamma.norm(), 0.1);
      EXPECT_LT((j * v + sample.bias()).cwiseAbs().maxCoeff(), this->tolerance(1e-8, 5e-4));
    });
  }
}

// Springs, motors with bounds, friction and limits in the last rows. Impulses are those that change the
// momentum as it was found to change; each row that is driven gives one that its parts give at its
// velocity, the others have none left.
TYPED_TEST(JointsTest, SolvesDrivenRows) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (const unsigned seed : {7u, 8u, 9u, 10u}) {
    JointedSample sample = random_sample(seed, 8, 0);
    int kind = static_cast<int>(seed);
    for (PlainJoint& joint : sample.joints) {
      if (joint.rows != 5) continue;
      joint.rows = 6;
      joint.is_driven = true;
      ++kind;
      if (kind % 3 == 0) joint.compliance = uniform(random);
      if (kind % 3 == 1) joint.most = uniform(random), joint.least = -joint.most;
      if (kind % 3 == 2) joint.most = joint.least = 0;
      if (kind % 2 == 0) joint.friction = 0.3 * uniform(random), joint.rest = 0.1;
      if (kind % 4 < 2 || kind % 3 == 2) joint.fastest = 0.2 * uniform(random) - 0.1;
    }
    fixtures::round_to<TypeParam>(sample.plain);
    const Eigen::MatrixXd j = sample.jacobian(), m = oracle::inverse_mass(sample.plain.data);
    const Eigen::VectorXd start = oracle::free_velocity(sample.plain.data);
    this->for_each_solver(sample, [&](const Eigen::VectorXd& v, auto&, const SolveStats&) {
      const Eigen::VectorXd gamma =
          impulses_behind(v - start, m * j.transpose(), this->tolerance(1e-9, 1e-3));
      const Eigen::VectorXd u = j * v + sample.bias();
      Eigen::Index row = 0;
      for (const PlainJoint& joint : sample.joints) {
        for (int k = 0; k < joint.rows; ++k, ++row) {
          if (k < 5 || !joint.is_driven) {
            EXPECT_NEAR(u(row), 0, this->tolerance(1e-8, 5e-4));
            continue;
          }
          const double off = this->tolerance(1e-7, 2e-3);
          const auto [low, high] = joint.impulses_at(u(row), off);
          EXPECT_GT(gamma(row), low - off) << "u " << u(row);
          EXPECT_LT(gamma(row), high + off) << "u " << u(row);
          EXPECT_LT(u(row), joint.fastest + off);
        }
      }
    });
  }
}

/// Friction about the anchors of the ball joints of a sample, in the axes in which moments do not act on each other.
void add_rubbing(JointedSample& s, std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(0, 1);
  const Eigen::MatrixXd m = oracle::inverse_mass(s.plain.data);
  std::vector<PlainJoint> all;
  for (const PlainJoint& joint : s.joints) {
    all.push_back(joint);
    if (joint.rows != 3) continue;
    PlainJoint rub = joint;
    rub.rubs = true;
    rub.bias.setZero();
    rub.least = rub.most = 0;
    rub.friction = std::pow(10, 2.5 * uniform(random) - 1);
    const Eigen::Matrix3d sum = m.block<3, 3>(6 * joint.a + 3, 6 * joint.a + 3) +
                                m.block<3, 3>(6 * joint.b + 3, 6 * joint.b + 3);
    rub.axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(sum).eigenvectors();
    all.push_back(rub);
  }
  s.joints = all;
}

// Friction in any direction: moments of no more than it gives, which are all of it and against the turning where there is some.
TYPED_TEST(JointsTest, SolvesMomentsThatRub) {
  std::mt19937 random(4);
  int sticking = 0, sliding = 0;
  for (const unsigned seed : {11u, 12u, 13u, 14u}) {
    JointedSample sample = random_sample(seed, 8, 0);
    fixtures::round_to<TypeParam>(sample.plain);
    add_rubbing(sample, random);
    const Eigen::MatrixXd j = sample.jacobian(), m = oracle::inverse_mass(sample.plain.data);
    const Eigen::VectorXd start = oracle::free_velocity(sample.plain.data);
    this->for_each_solver(sample, [&](const Eigen::VectorXd& v, auto&, const SolveStats&) {
      const Eigen::VectorXd gamma =
          impulses_behind(v - start, m * j.transpose(), this->tolerance(1e-9, 1e-3));
      const Eigen::VectorXd u = j * v + sample.bias();
      const double off = this->tolerance(1e-6, 5e-3);
      Eigen::Index row = 0;
      for (const PlainJoint& joint : sample.joints) {
        const Eigen::VectorXd own = u.segment(row, joint.rows), g = gamma.segment(row, joint.rows);
        row += joint.rows;
        if (!joint.rubs) {
          EXPECT_LT(own.norm(), this->tolerance(1e-8, 1e-3));
          continue;
        }
        EXPECT_LT(g.norm(), joint.friction + off);
        if (g.norm() < joint.friction - 2 * off) {
          EXPECT_LT(own.norm(), off);
          ++sticking;
        } else if (own.norm() > 0.05) {
          EXPECT_LT((g + joint.friction * own.normalized()).norm(), 20 * off) << own.norm();
          ++sliding;
        }
      }
    });
  }
  EXPECT_GT(sticking, 5);
  EXPECT_GT(sliding, 5);
}

}  // namespace
}  // namespace scree
