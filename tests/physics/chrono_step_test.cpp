// One step of a settled pile of 1000 spheres, against the same step done by Project Chrono: same
// contacts, convex model, no push-out of overlaps (its bias is max(depth / h, 0), ours with
// recovery speed 0).

#include <gtest/gtest.h>

#include "tests/physics/scene_builder.h"
#include "tests/physics/shared_data.h"

namespace scree::physics {
namespace {

constexpr double kBallRadius = 0.05;
constexpr double kDensity = 2500;

struct PileStates {
  std::vector<Vec3d> position, velocity, angular_velocity;
  std::vector<Quatd> orientation;
};

/// Rows id, x, y, z, qw, qx, qy, qz, vx, vy, vz, wx, wy, wz; the last three in the body frame.
PileStates pile_states(const std::vector<std::vector<double>>& rows) {
  PileStates s;
  for (const auto& r : rows) {
    if (r.size() != 14) continue;
    s.position.push_back({r[1], r[2], r[3]});
    s.orientation.push_back(normalized(Quatd{r[4], r[5], r[6], r[7]}));
    s.velocity.push_back({r[8], r[9], r[10]});
    s.angular_velocity.push_back(rotate(s.orientation.back(), Vec3d{r[11], r[12], r[13]}));
  }
  return s;
}

Scene pile_scene(const PileStates& pile, double h) {
  Scene scene = empty_scene(h, 0.5);
  solve_to(scene, 1e-9);
  scene.solver.max_iterations = 100000;
  scene.solver.check_every = 50;
  scene.stepping.max_recovery_speed = 0;
  for (std::size_t i = 0; i < pile.position.size(); ++i) {
    BodyDescription& body = add_sphere(scene, pile.position[i], kBallRadius, 1);
    set_mass_from_density(body, kDensity);
    body.orientation = pile.orientation[i];
    body.velocity = pile.velocity[i];
    body.angular_velocity = pile.angular_velocity[i];
  }
  add_tank(scene, 0, 1, 0, 1);
  return scene;
}

/// What impulses do to the pile: f = gamma . (J V + bias) - 1/2 |V - v*|_M^2, equal to
/// 1/2 gamma^T N gamma + r^T gamma, and V.
struct StoredAnswer {
  double objective = 0;
  std::vector<Vec3d> velocity, angular_velocity;
};

/// Contacts as stored: bodyA, bodyB (0: container), normal from A to B, points on A and B,
/// depth, impulse.
StoredAnswer evaluate_stored(const PileStates& pile,
                             const std::vector<std::vector<double>>& contacts, double h,
                             double mass) {
  const double moment = 0.4 * mass * kBallRadius * kBallRadius;
  const std::size_t n = pile.position.size();
  std::vector<Vec3d> force(n), torque(n);
  struct Contact {
    Vec3d impulse, normal, arm_a, arm_b;
    std::size_t a, b;
    double bias;
  };
  std::vector<Contact> list;
  for (const auto& r : contacts) {
    if (r.size() != 15) continue;
    Contact c;
    c.a = static_cast<std::size_t>(r[0]);
    c.b = static_cast<std::size_t>(r[1]);
    c.normal = {r[2], r[3], r[4]};
    const Vec3d y{0, 1, 0}, x{1, 0, 0};
    Vec3d w = cross(c.normal, y);
    if (norm(w) < 1e-4) w = cross(c.normal, x);
    w = normalized(w);
    const Vec3d v = cross(w, c.normal);
    c.impulse = r[12] * c.normal + r[13] * v + r[14] * w;
    c.bias = std::max(r[11] / h, 0.0);
    if (c.a > 0) c.arm_a = Vec3d{r[5], r[6], r[7]} - pile.position[c.a - 1];
    if (c.b > 0) c.arm_b = Vec3d{r[8], r[9], r[10]} - pile.position[c.b - 1];
    if (c.a > 0) {
      force[c.a - 1] += -c.impulse;
      torque[c.a - 1] += cross(c.arm_a, -c.impulse);
    }
    if (c.b > 0) {
      force[c.b - 1] += c.impulse;
      torque[c.b - 1] += cross(c.arm_b, c.impulse);
    }
    list.push_back(c);
  }
  StoredAnswer answer;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3d dv = 1 / mass * force[i], dw = 1 / moment * torque[i];
    answer.velocity.push_back(pile.velocity[i] + Vec3d{0, 0, -kGravity * h} + dv);
    answer.angular_velocity.push_back(pile.angular_velocity[i] + dw);
    answer.objective -= 0.5 * (mass * norm2(dv) + moment * norm2(dw));
  }
  const auto speed = [&](std::size_t id, const Vec3d& arm) {
    if (id == 0) return Vec3d{};
    return answer.velocity[id - 1] + cross(answer.angular_velocity[id - 1], arm);
  };
  for (const Contact& c : list) {
    const Vec3d u = speed(c.b, c.arm_b) - speed(c.a, c.arm_a) + c.bias * c.normal;
    answer.objective += dot(c.impulse, u);
  }
  return answer;
}

/// Between two sets of velocities of the pile.
struct Difference {
  double rms = 0;         ///< over the spheres, of velocity and surface speed r w together [m/s]
  double linear_rms = 0;  ///< over the components of the velocities [m/s]
  double energy = 0;      ///< 1/2 |V - V'|_M^2 [J]
};
Difference difference_of(const std::vector<Vec3d>& v, const std::vector<Vec3d>& w,
                         const PileStates& other, double mass) {
  Difference d;
  const std::size_t n = other.velocity.size();
  for (std::size_t i = 0; i < n; ++i) {
    const double linear = norm2(v[i] - other.velocity[i]);
    const double surface = norm2(kBallRadius * (w[i] - other.angular_velocity[i]));
    d.rms += (linear + surface) / static_cast<double>(n);
    d.linear_rms += linear / (3 * static_cast<double>(n));
    d.energy += 0.5 * mass * (linear + 0.4 * surface);
  }
  d.rms = std::sqrt(d.rms);
  d.linear_rms = std::sqrt(d.linear_rms);
  return d;
}

class ChronoStep : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Pile, ChronoStep, ::testing::Values("1e-3", "5e-3"),
                         [](const auto& info) { return std::string("h") + info.param[0] + "ms"; });

TEST_P(ChronoStep, OneStepOfASettledPile) {
  const std::string h_text = GetParam();
  const double h = std::stod(h_text);
  const std::string folder = "chrono/", tail = "_N1000_mu0.5_rec0_h" + h_text + ".csv.gz";
  std::vector<std::vector<std::vector<double>>> tables;
  for (const std::string& name :
       {folder + "state_N1000_mu0.5.csv.gz", folder + "post" + tail, folder + "contacts" + tail}) {
    tables.push_back(number_rows(shared_text(shared_file(name))));
    if (tables.back().empty())
      GTEST_SKIP() << "cannot read " << shared_file(name) << " (with zcat)";
  }
  const PileStates before = pile_states(tables[0]), after = pile_states(tables[1]);
  ASSERT_EQ(before.position.size(), 1000u);
  ASSERT_EQ(after.position.size(), 1000u);

  const Scene scene = pile_scene(before, h);
  const double mass = scene.bodies[0].mass;
  const StoredAnswer stored = evaluate_stored(before, tables[2], h, mass);
  // The reading of the file is right: its impulses give its velocities.
  ASSERT_LT(difference_of(stored.velocity, stored.angular_velocity, after, mass).rms, 1e-12);

  World world(scene, cpu_options(0));
  const StepReport report = world.step();
  EXPECT_TRUE(report.converged) << report.residual_rms;
  const BodyStates s = world.states();
  const Difference d = difference_of(s.velocity, s.angular_velocity, after, mass);
  RecordProperty("objective", std::to_string(report.objective));
  RecordProperty("objective_below_stored_ppm",
                 std::to_string((report.objective / stored.objective - 1) * 1e6));
  RecordProperty("velocity_difference_um_per_s", std::to_string(d.rms * 1e6));
  RecordProperty("iterations", report.iterations);
  EXPECT_LT(report.objective, 0);
  EXPECT_LE(report.objective, stored.objective + 1e-9 * std::abs(stored.objective))
      << "stored " << stored.objective;

  // The objective grows at least like 1/2 |V - V_min|_M^2 away from its minimum, so the stored
  // velocities may be this far from the true ones. For h = 1e-3 that is nothing.
  // The stored impulses of h = 5e-3 are cruder: their objective is 7e-6 above ours,
  // and whichever solver finds the minimum, the velocities lie 1.2e-5 m/s from it
  // (RMS of components; 5e-5 with r w, per sphere).
  const double allowance = stored.objective - report.objective;
  EXPECT_LE(d.energy, allowance + 1e-9 * std::abs(stored.objective));
  EXPECT_LT(d.linear_rms, 2e-5);
  if (allowance < 1e-7 * std::abs(stored.objective)) {
    EXPECT_LT(d.rms, 2e-5);
  }
}

}  // namespace
}  // namespace scree::physics
