#include "tests/affine_reference/affine_system.h"

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>
#include <string>
#include <utility>

#include "kernels/affine/first_contact.h"
#include "kernels/affine/friction.h"
#include "kernels/affine/impact.h"
#include "kernels/affine/orthogonality.h"
#include "solvers/solver.h"
#include "tests/affine_reference/hessians.h"
#include "tests/affine_reference/pair_search.h"
#include "tests/affine_reference/reduction.h"

namespace scree::affine {
namespace {

using State = std::vector<AffineVec>;

/// Leading minors of S: all positive where it is positive definite.
Vec3d leading_minors(const Sym3<double>& s) {
  const double two = s.xx * s.yy - s.xy * s.xy;
  return {s.xx, two, two * s.zz + 2 * s.xy * s.yz * s.xz - s.xx * s.yz * s.yz - s.yy * s.xz * s.xz};
}

}  // namespace

void set_pose(AffineBody& body, const Vec3d& center, const Quat<double>& turn) {
  body.position.node[0] = center;
  for (int k = 0; k < 3; ++k) {
    Vec3d axis;
    axis[k] = 1;
    body.position.node[k + 1] = rotate(turn, axis);
  }
}

void set_motion(AffineBody& body, const Vec3d& velocity, const Vec3d& angular_velocity) {
  body.velocity.node[0] = velocity;
  for (int k = 1; k < 4; ++k)
    body.velocity.node[k] = cross(angular_velocity, body.position.node[k]);
}

Vec3d angular_momentum(const AffineBody& body) {
  return angular_momentum(body.mass, body.position, body.velocity);
}

double kinetic_energy(const AffineBody& body) {
  return 0.5 * dot(body.velocity, body.mass.product(body.velocity));
}

void validate(const AffineSettings& s) {
  const auto refuse = [](const char* name, double value, const char* range) {
    std::ostringstream text;
    text << name << " must be " << range << ", got " << value;
    throw InvalidParameter(text.str());
  };
  const std::pair<const char*, double> positive[] = {{"h", s.h},
                                                     {"barrier.stiffness", s.barrier.stiffness},
                                                     {"barrier.reach", s.barrier.reach},
                                                     {"slip_speed", s.slip_speed},
                                                     {"tolerance", s.tolerance}};
  for (const auto& [name, value] : positive)
    if (!(value > 0)) refuse(name, value, "positive");
  if (s.barrier.form != BarrierForm::original)
    throw InvalidParameter("barrier.form must be original: pairs have no areas here");
  if (!(s.barrier.separation >= 0))
    refuse("barrier.separation", s.barrier.separation, "zero or more");
  if (!(s.mu >= 0)) refuse("mu", s.mu, "zero or more");
  if (s.friction_solves < 1) refuse("friction_solves", s.friction_solves, "1 or more");
  if (s.most_iterations < 1) refuse("most_iterations", s.most_iterations, "1 or more");
}

AffineSystem::AffineSystem(const AffineSettings& settings) : settings_(settings) {
  validate(settings);
}

std::size_t AffineSystem::add(AffineBody body) {
  const Vec3d minors = leading_minors(body.mass.second);
  if (body.surface == nullptr) throw InvalidParameter("an affine body needs a surface");
  if (!body.fixed &&
      !(body.stiffness > 0 && body.mass.mass > 0 && minors.x > 0 && minors.y > 0 && minors.z > 0))
    throw InvalidParameter(
        "an affine body needs a mass, a stiffness and second moments about all axes");
  bodies_.push_back(std::move(body));
  earlier_position_.clear();
  return bodies_.size() - 1;
}

/// One minimization: the potential 1/2 |q - target|_M^2 + scale (elastic + barrier + friction).
struct AffineSystem::Impl {
  const AffineSettings& settings;
  const std::vector<AffineBody>& bodies;
  const std::vector<PointJoint>& joints;
  State start;   ///< where the step began
  State target;  ///< where bodies would be without forces but loads
  double scale;  ///< h^2 or, with bdf2, 4/9 h^2

  struct Slip {
    SurfacePair pair;
    Four rest, start;
    FrictionContact contact;
  };
  std::vector<Slip> slips;
  SlipLaw law;

  Barrier barrier() const { return settings.barrier; }
  double reach() const { return barrier().separation + barrier().reach; }

  ContactPair contact_pair(const SurfacePair& pair, const Four& rest) const {
    ContactPair c;
    c.kind = pair.kind;
    if (pair.kind == PairKind::edge_edge)
      c.parallel_below = mollifier_threshold(rest[1] - rest[0], rest[3] - rest[2]);
    return c;
  }

  /// Friction of the contacts at a state, for slips from the start of the step on.
  void remember_friction(const State& q) {
    slips.clear();
    if (settings.mu == 0) return;
    for (const SurfacePair& pair : pairs_near(bodies, q, q, reach())) {
      const Four rest = rest_points(bodies, pair), x = points_of(q, pair, rest);
      const double force = normal_force(contact_pair(pair, rest), barrier(), x);
      if (force > 0)
        slips.push_back({pair, rest, points_of(start, pair, rest),
                         friction_contact(nearest_points(pair.kind, x), settings.mu, force)});
    }
  }
  static Four moved(const Slip& slip, const State& q) {
    Four m = points_of(q, slip.pair, slip.rest);
    for (int i = 0; i < 4; ++i) m[i] -= slip.start[i];
    return m;
  }

  double energy(const State& q, const std::vector<SurfacePair>& pairs) const {
    double inertial = 0, rest_energy = 0;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (bodies[b].fixed) continue;
      const AffineVec off = q[b] - target[b];
      inertial += 0.5 * dot(off, bodies[b].mass.product(off));
      rest_energy += orthogonality_energy(bodies[b].stiffness, q[b]);
    }
    for (const SurfacePair& pair : pairs) {
      const Four rest = rest_points(bodies, pair);
      rest_energy += contact_energy(contact_pair(pair, rest), barrier(), points_of(q, pair, rest));
    }
    for (const Slip& slip : slips)
      rest_energy += friction_energy(slip.contact, law, moved(slip, q));
    return inertial + scale * rest_energy;
  }

  /// What rounding may make of the energy: near the minimum steps gain less. A^T A - I is what is left
  /// of numbers near one.
  double rounding(const State& q, double energy_there) const {
    double sum = 1e-14 * std::abs(energy_there);
    for (std::size_t b = 0; b < bodies.size(); ++b)
      if (!bodies[b].fixed)
        sum += 1e-14 * scale * bodies[b].stiffness * (strain_norm(q[b]) + 1e-14);
    return sum;
  }

  using Triplets = std::vector<Eigen::Triplet<double>>;

  /// Where the unknowns of bodies begin; -1 for fixed ones.
  std::vector<int> places() const {
    std::vector<int> r;
    int next = 0;
    for (const AffineBody& b : bodies) {
      r.push_back(b.fixed ? -1 : next);
      if (!b.fixed) next += 12;
    }
    return r;
  }
  static void add_block(Triplets& matrix, int row, int column, const Dense<12>& block, bool turn) {
    if (row < 0 || column < 0) return;
    for (int i = 0; i < 12; ++i)
      for (int j = 0; j < 12; ++j)
        matrix.emplace_back(row + i, column + j, turn ? block(j, i) : block(i, j));
  }

  /// The equations of joints, three rows each, as triplets.
  Triplets joint_rows() const {
    const std::vector<int> place = places();
    Triplets rows;
    const auto add_point = [&](int row, std::size_t body, const Vec3d& rest, double sign) {
      for (int k = 0; k < 4 && place[body] >= 0; ++k)
        for (int i = 0; i < 3; ++i)
          rows.emplace_back(row + i, place[body] + 3 * k + i, sign * node_weight(rest, k));
    };
    int row = 0;
    for (const PointJoint& joint : joints) {
      add_point(row, joint.body, joint.rest, 1);
      if (joint.other >= 0)
        add_point(row, static_cast<std::size_t>(joint.other), joint.other_rest, -1);
      row += 3;
    }
    return rows;
  }
  static Vec3d apart(const PointJoint& joint, const State& q) {
    const Vec3d on = joint.other < 0
                         ? joint.other_rest
                         : point_of(q[static_cast<std::size_t>(joint.other)], joint.other_rest);
    return point_of(q[joint.body], joint.rest) - on;
  }

  /// The Newton step -H^-1 g with semidefinite second derivatives, and its slope g.step.
  State newton_step(const State& q, double& slope) const {
    const std::vector<int> place = places();
    const auto unknowns = static_cast<Eigen::Index>(
        12 * std::count_if(place.begin(), place.end(), [](int p) { return p >= 0; }));
    State force(bodies.size());
    Triplets matrix;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (bodies[b].fixed) continue;
      force[b] = bodies[b].mass.product(target[b] - q[b]) +
                 (-scale) * orthogonality_gradient(bodies[b].stiffness, q[b]);
      const Dense<9> elastic = projected_orthogonality_hessian(bodies[b].stiffness, q[b]);
      Dense<12> block;
      for (int i = 0; i < 9; ++i)
        for (int j = 0; j < 9; ++j) block(3 + i, 3 + j) = scale * elastic(i, j);
      for (int k = 0; k < 4; ++k) {
        AffineVec unit;
        unit.node[k].x = 1;
        const AffineVec column = bodies[b].mass.product(unit);
        for (int l = 0; l < 4; ++l) block.add_identity(l, k, column.node[l].x);
      }
      add_block(matrix, place[b], place[b], block, false);
    }
    const auto add_pair = [&](const SurfacePair& pair, const Four& rest, const Four& gradient,
                              Dense<12> h) {
      const auto a = static_cast<std::size_t>(pair.body[0]);
      const auto b = static_cast<std::size_t>(pair.body[1]);
      Four push;
      for (int i = 0; i < 4; ++i) push[i] = -scale * gradient[i];
      add_forces(pair.kind, rest, push, force[a], force[b]);
      h.scale(scale);
      BodyBlocks blocks;
      add_blocks(pair.kind, rest, h, blocks);
      add_block(matrix, place[a], place[a], blocks.first, false);
      add_block(matrix, place[a], place[b], blocks.mixed, false);
      add_block(matrix, place[b], place[a], blocks.mixed, true);
      add_block(matrix, place[b], place[b], blocks.second, false);
    };
    for (const SurfacePair& pair : pairs_near(bodies, q, q, reach())) {
      const Four rest = rest_points(bodies, pair), x = points_of(q, pair, rest);
      if (!barrier().acts(nearest_points(pair.kind, x).squared)) continue;
      const ContactPair c = contact_pair(pair, rest);
      add_pair(pair, rest, contact_gradient(c, barrier(), x),
               contact_hessian(c, barrier(), x, Projection::eigenvalues));
    }
    for (const Slip& slip : slips) {
      const Four m = moved(slip, q);
      add_pair(slip.pair, slip.rest, friction_gradient(slip.contact, law, m),
               friction_hessian(slip.contact, law, m));
    }
    const auto rows = static_cast<Eigen::Index>(3 * joints.size());
    for (const Eigen::Triplet<double>& t : joint_rows()) {
      const int row = static_cast<int>(unknowns) + t.row();
      matrix.emplace_back(row, t.col(), t.value());
      matrix.emplace_back(t.col(), row, t.value());
    }
    Eigen::SparseMatrix<double> h(unknowns + rows, unknowns + rows);
    h.setFromTriplets(matrix.begin(), matrix.end());
    Eigen::VectorXd right(unknowns + rows);
    for (std::size_t b = 0; b < bodies.size(); ++b)
      for (int i = 0; i < 12 && place[b] >= 0; ++i)
        right(place[b] + i) = force[b].node[i / 3][i % 3];
    for (std::size_t k = 0; k < joints.size(); ++k)
      for (int i = 0; i < 3; ++i)
        right(unknowns + static_cast<Eigen::Index>(3 * k) + i) = -apart(joints[k], q)[i];
    using Matrix = Eigen::SparseMatrix<double>;
    const Eigen::VectorXd all = joints.empty()
                                    ? Eigen::SimplicialLDLT<Matrix>(h).solve(right).eval()
                                    : Eigen::SparseLU<Matrix>(h).solve(right).eval();
    const Eigen::VectorXd step = all.head(unknowns);
    slope = -right.head(unknowns).dot(step);
    State r(bodies.size());
    for (std::size_t b = 0; b < bodies.size(); ++b)
      for (int i = 0; i < 12 && place[b] >= 0; ++i) r[b].node[i / 3][i % 3] = step(place[b] + i);
    return r;
  }

  /// Largest way of a corner, nearly [m].
  double size_of(const State& step) const {
    double most = 0;
    for (std::size_t b = 0; b < bodies.size(); ++b)
      most = std::max(most, corner_way(step[b], bodies[b].surface->radius));
    return most;
  }

  static State moved_by(const State& q, double share, const State& step) {
    State r = q;
    for (std::size_t b = 0; b < q.size(); ++b) r[b] += share * step[b];
    return r;
  }

  /// Moves q to the minimum.
  void minimize(State& q, AffineReport& report) const {
    for (int iteration = 0;; ++iteration) {
      double slope = 0;
      const State step = newton_step(q, slope);
      report.residual = size_of(step) / settings.h;
      if (report.residual < settings.tolerance) return;
      if (iteration == settings.most_iterations) break;
      ++report.iterations;
      const State full = moved_by(q, 1, step);
      const std::vector<SurfacePair> pairs = pairs_near(bodies, q, full, reach());
      double share = 1;
      for (const SurfacePair& pair : pairs) {
        const Four rest = rest_points(bodies, pair);
        FirstContactParameters parameters;
        parameters.separation = barrier().separation;
        share = std::min(share, first_contact(pair.kind, points_of(q, pair, rest),
                                              points_of(full, pair, rest), parameters)
                                    .time);
      }
      const double before = energy(q, pairs);
      State next = moved_by(q, share, step);
      const double noise = rounding(q, before);
      const auto lower = [&] {
        return energy(next, pairs) <= before + 1e-4 * share * slope + noise;
      };
      while (share > 1e-12 && !lower()) {
        share *= 0.5;
        next = moved_by(q, share, step);
      }
      if (share <= 1e-12) break;
      q = next;
    }
    report.converged = false;
  }
};

void AffineSystem::add(const PointJoint& joint) {
  const auto count = static_cast<int>(bodies_.size());
  for (const int body : {static_cast<int>(joint.body), joint.other})
    if (body >= count)
      throw InvalidParameter("a joint holds body " + std::to_string(body) + ", but there are " +
                             std::to_string(count));
  if (bodies_[joint.body].fixed &&
      (joint.other < 0 || bodies_[static_cast<std::size_t>(joint.other)].fixed))
    throw InvalidParameter("a joint of body " + std::to_string(joint.body) +
                           " holds nothing that moves");
  State q;
  for (const AffineBody& body : bodies_) q.push_back(body.position);
  const double gap = norm(Impl::apart(joint, q));
  if (!(gap <= 1e-9 * (1 + bodies_[joint.body].surface->radius))) {
    std::ostringstream text;
    text << "the points of a joint of body " << joint.body << " are " << gap
         << " m apart, expected none";
    throw InvalidParameter(text.str());
  }
  joints_.push_back(joint);
  const Impl impl{settings_, bodies_, joints_, {}, {}, 1, {}, {}};
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(3 * joints_.size()),
                                               static_cast<Eigen::Index>(12 * bodies_.size()));
  for (const Eigen::Triplet<double>& t : impl.joint_rows()) rows(t.row(), t.col()) = t.value();
  if (Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(rows).rank() < rows.rows()) {
    joints_.pop_back();
    throw InvalidParameter("a joint of body " + std::to_string(joint.body) +
                           " repeats or contradicts the joints before it");
  }
}

void AffineSystem::join(std::vector<std::size_t>& label, std::vector<bool>& is_held,
                        const std::vector<AffineVec>& q) const {
  std::vector<SurfacePair> near =
      pairs_near(bodies_, q, q, settings_.barrier.separation + settings_.barrier.reach);
  std::erase_if(near, [&](const SurfacePair& pair) {
    return !settings_.barrier.acts(
        nearest_points(pair.kind, points_of(q, pair, rest_points(bodies_, pair))).squared);
  });
  for (bool changes = true; changes;) {
    changes = false;
    const auto meet = [&](std::size_t a, std::size_t b) {
      if (bodies_[a].fixed) is_held[b] = true;
      if (bodies_[b].fixed) is_held[a] = true;
      if (bodies_[a].fixed || bodies_[b].fixed || label[a] == label[b]) return;
      label[a] = label[b] = std::min(label[a], label[b]);
      changes = true;
    };
    for (const SurfacePair& pair : near)
      meet(static_cast<std::size_t>(pair.body[0]), static_cast<std::size_t>(pair.body[1]));
    for (const PointJoint& joint : joints_) {
      if (joint.other >= 0) meet(joint.body, static_cast<std::size_t>(joint.other));
      if (joint.other < 0) is_held[joint.body] = true;
    }
  }
}

AffineReport AffineSystem::step(const std::vector<AffineVec>& other) {
  const bool second_order = settings_.rule == StepRule::bdf2 && !earlier_position_.empty();
  const StepScheme scheme{settings_.rule, second_order, settings_.h, settings_.gravity};
  Impl impl{settings_, bodies_, joints_, {}, {}, scheme.scale(), {}, {}};
  impl.law.slip = settings_.slip_speed * settings_.h;
  std::vector<StepStart> starts;
  std::vector<InertialTarget> targets;
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const AffineBody& body = bodies_[b];
    StepStart s{body.position, body.velocity, {}, {}};
    if (second_order) s.earlier_q = earlier_position_[b], s.earlier_v = earlier_velocity_[b];
    starts.push_back(s);
    targets.push_back(body.fixed ? InertialTarget{body.position, {}}
                                 : inertial_target(scheme, body.mass, s, body.force, body.torque));
    impl.start.push_back(body.position);
    impl.target.push_back(targets.back().q);
  }
  AffineReport report;
  State q = impl.start;
  const int solves = settings_.mu > 0 ? settings_.friction_solves : 1;
  for (int solve = 0; solve < solves; ++solve) {
    impl.remember_friction(q);
    impl.minimize(q, report);
  }
  const auto energy = [&](const State& at) {
    return impl.energy(at, pairs_near(bodies_, at, at, impl.reach()));
  };
  if (!other.empty()) report.above = energy(other) - energy(q);
  const std::vector<AffineVec> last_velocity = [&] {
    State r;
    for (const AffineBody& body : bodies_) r.push_back(body.velocity);
    return r;
  }();
  std::vector<bool> hit(bodies_.size(), false);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    AffineBody& body = bodies_[b];
    if (body.fixed) continue;
    hit[b] = second_order && is_hit(scheme, body.mass, starts[b], q[b], settings_.tolerance);
    body.velocity = velocity_after(scheme, starts[b], targets[b], q[b]);
    body.position = q[b];
  }
  earlier_position_ = impl.start;
  earlier_velocity_ = last_velocity;
  std::vector<std::size_t> label(bodies_.size());
  std::iota(label.begin(), label.end(), std::size_t{0});
  std::vector<bool> is_held(bodies_.size());
  for (std::size_t round = 0; round < bodies_.size(); ++round)
    for (const State& state : {impl.start, q}) join(label, is_held, state);
  for (std::size_t island = 0; island < bodies_.size(); ++island) {
    bool starts_anew = false, stays = true;
    Vec3d owed;
    double mass = 0;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      if (label[b] != island) continue;
      starts_anew = starts_anew || hit[b];
      stays = stays && !is_held[b];
      // Of free flight the mean velocity is the sum of both ends over two, and bdf2 goes on to (3 v' - v) / 2 without forces.
      const AffineBody& body = bodies_[b];
      const Vec3d gain = scheme.gravity + (1 / body.mass.mass) * body.force;
      const Vec3d mean = (1 / scheme.h) * (q[b].node[0] - impl.start[b].node[0]);
      const Vec3d settled = 1.5 * body.velocity.node[0] - 0.5 * last_velocity[b].node[0];
      owed += body.mass.mass * (settled - scheme.h * gain - mean);
      mass += body.mass.mass;
    }
    if (!starts_anew) continue;
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      if (label[b] != island) continue;
      AffineBody& body = bodies_[b];
      StepVelocities flown =
          free_flight(scheme, body.mass, impl.start[b], q[b],
                      free_gain(body.mass, q[b], scheme.gravity, body.force, body.torque), false);
      if (stays)
        flown.before.node[0] += (1 / mass) * owed, flown.after.node[0] += (1 / mass) * owed;
      earlier_velocity_[b] = flown.before;
      body.velocity = flown.after;
    }
  }

  report.gap = 2 * impl.reach();
  for (const SurfacePair& pair : pairs_near(bodies_, q, q, report.gap)) {
    const double squared =
        nearest_points(pair.kind, points_of(q, pair, rest_points(bodies_, pair))).squared;
    report.gap = std::min(report.gap, std::sqrt(squared));
    report.contacts += settings_.barrier.acts(squared) ? 1 : 0;
  }
  return report;
}

}  // namespace scree::affine
