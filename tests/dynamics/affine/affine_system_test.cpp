// Affine bodies with barrier contact against closed forms: spin of free bodies (A85), free fall,
// torques, the gap at rest (A81), creep and slip on a slope (A80), and no intersection ever (A84).
#include "tests/affine_reference/affine_system.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "kernels/affine/orthogonality.h"
#include "solvers/solver.h"
#include "tests/affine_reference/pair_search.h"
#include "tests/box_mesh.h"
#include "tests/exact_triangles.h"

namespace scree::affine {
namespace {

using scree::test::box_mesh;

/// A tetrahedron below z = 0 whose upper face is large: its edges and corners are far away.
TriangleMesh floor_mesh(double size) {
  TriangleMesh m;
  m.vertices = {{size, 0, 0}, {-size, size, 0}, {-size, -size, 0}, {0, 0, -size}};
  m.triangles = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
  return m;
}

AffineBody solid(const TriangleMesh& mesh, double density, double kappa, const Vec3d& at,
                 const Quat<double>& turn = {}) {
  const SolidMoments moments = moments_of(mesh);
  AffineBody body;
  body.surface = std::make_shared<const Surface>(make_surface(mesh, moments.center));
  body.mass = affine_mass(moments, density);
  body.stiffness = kappa * moments.volume;
  set_pose(body, at + rotate(turn, moments.center), turn);
  return body;
}

AffineBody fixed_floor(double size = 50) {
  AffineBody body = solid(floor_mesh(size), 1000, 1e8, {});
  body.fixed = true;
  return body;
}

/// A body with the moments of inertia of the table of free spins, and no surface to speak of.
AffineBody spinner(const Vec3d& angular_velocity) {
  AffineBody body = solid(box_mesh({0.1, 0.1, 0.1}), 125, 1, {});
  body.mass = affine_mass(1, {0.1, 0.2, 0.3});
  body.stiffness = 1e6;
  set_motion(body, {}, angular_velocity);
  return body;
}

AffineSettings free_settings(StepRule rule, double h) {
  AffineSettings s;
  s.h = h;
  s.gravity = {};
  s.rule = rule;
  s.tolerance = 1e-9;
  return s;
}

struct SpinCase {
  Vec3d w;
  StepRule rule;
  double h, momentum, energy;  ///< what is left of them after ten seconds
};

/// The table of AFFINE free spins: what each rule leaves of momentum and energy.
TEST(AffineSpinTest, A85EachRuleLosesWhatItsLawSays) {
  const Vec3d slow{0, 0, 3.14}, turn{0, 0, 6.28}, fast{0, 0, 20};
  const std::vector<SpinCase> cases{
      {slow, StepRule::implicit_euler, 0.01, 0.580, 0.336},
      {slow, StepRule::bdf2, 0.01, 0.998, 0.997},
      {turn, StepRule::implicit_euler, 0.01, 0.335, 0.112},
      {turn, StepRule::bdf2, 0.01, 0.988, 0.976},
      {fast, StepRule::implicit_euler, 0.01, 0.111, 0.012},
      {fast, StepRule::bdf2, 0.01, 0.704, 0.496},
      {turn, StepRule::rotational, 0.01, 1, 1},
      {fast, StepRule::rotational, 0.01, 1, 1},
  };
  for (const SpinCase& c : cases) {
    SCOPED_TRACE(testing::Message() << c.w.z << " rad/s, rule " << static_cast<int>(c.rule));
    AffineSystem system(free_settings(c.rule, c.h));
    system.add(spinner(c.w));
    const double momentum = norm(angular_momentum(system.bodies()[0]));
    const double energy = kinetic_energy(system.bodies()[0]);
    for (int k = 0; k < 1000; ++k) ASSERT_TRUE(system.step().converged);
    const AffineBody& body = system.bodies()[0];
    EXPECT_NEAR(norm(angular_momentum(body)) / momentum, c.momentum, 1e-3);
    EXPECT_NEAR(kinetic_energy(body) / energy, c.energy, 1e-3);
    EXPECT_LT(strain_norm(body.position), 1e-3);
  }
}

/// Implicit Euler turns by atan(sin p / (2 - cos p)) after a turn by p.
TEST(AffineSpinTest, A85ImplicitEulerFollowsItsRecurrence) {
  AffineSystem system(free_settings(StepRule::implicit_euler, 0.01));
  AffineBody start = spinner({0, 0, 10});
  start.stiffness = 1e9;
  system.add(start);
  double angle = 0;
  const auto step_of = [&] {
    Vec3d before[3], after[3];
    nearest_rotation(system.bodies()[0].position, before);
    system.step();
    nearest_rotation(system.bodies()[0].position, after);
    return std::atan2(dot(cross(before[0], after[0]), {0, 0, 1}), dot(before[0], after[0]));
  };
  angle = step_of();
  for (int k = 0; k < 100; ++k) {
    const double expected = std::atan(std::sin(angle) / (2 - std::cos(angle)));
    angle = step_of();
    EXPECT_NEAR(angle / expected, 1, 1e-3) << k;
  }
}

TEST(AffineSpinTest, TheRotationalRuleKeepsMomentumAndEnergyOfATumblingBody) {
  AffineSettings settings = free_settings(StepRule::rotational, 0.01);
  settings.tolerance = 1e-12;
  AffineSystem system(settings);
  system.add(spinner({0.01, 6.28, 0.02}));  // about the middle axis, which is not stable
  const Vec3d momentum = angular_momentum(system.bodies()[0]);
  const double energy = kinetic_energy(system.bodies()[0]);
  for (int k = 0; k < 1000; ++k) system.step();
  const AffineBody& body = system.bodies()[0];
  EXPECT_LT(norm(angular_momentum(body) - momentum), 1e-10 * norm(momentum));
  EXPECT_NEAR(kinetic_energy(body) / energy, 1, 1e-3);
}

/// Error of the angle after half a second of a spin, for steps and half of them: of first and second
/// order.
TEST(AffineSpinTest, RulesHaveTheirOrder) {
  for (const auto& [rule, order] :
       {std::pair{StepRule::implicit_euler, 1.0}, std::pair{StepRule::bdf2, 2.0}}) {
    double error[2];
    for (int fine = 0; fine < 2; ++fine) {
      const int steps = 200 << fine;
      AffineSystem system(free_settings(rule, 0.5 / steps));
      system.add(spinner({0, 0, 2}));
      for (int k = 0; k < steps; ++k) system.step();
      Vec3d column[3];
      nearest_rotation(system.bodies()[0].position, column);
      error[fine] = std::atan2(column[0].y, column[0].x) - 1;  // w t = 1
    }
    EXPECT_NEAR(std::log2(error[0] / error[1]), order, 0.1) << static_cast<int>(rule);
  }
}

TEST(AffineMotionTest, FallsAndIsPushedAsTheRulesSay) {
  for (const StepRule rule : {StepRule::implicit_euler, StepRule::bdf2, StepRule::rotational}) {
    AffineSettings settings = free_settings(rule, 0.01);
    settings.gravity = {0, 0, -9.81};
    AffineSystem system(settings);
    AffineBody body = spinner({});
    set_motion(body, {1, 2, 3}, {});
    body.force = {0.5, 0, 0};
    body.torque = {0, 0, 0.03};
    system.add(body);
    for (int k = 0; k < 100; ++k) system.step();
    const AffineBody& end = system.bodies()[0];
    const double t = 1, h = 0.01;
    if (rule != StepRule::bdf2) {
      EXPECT_NEAR(end.position.node[0].z, 3 * t - 9.81 * t * (t + h) / 2, 1e-9);
      EXPECT_NEAR(end.position.node[0].x, t + 0.5 * t * (t + h) / 2, 1e-9);
    } else {
      // Second order but for the first step: off by h^2 from the parabola, not by h t.
      EXPECT_NEAR(end.position.node[0].z, 3 * t - 9.81 * t * t / 2, 9.81 * h * h);
    }
    EXPECT_NEAR(end.velocity.node[0].z, 3 - 9.81 * t, 1e-9);
    EXPECT_NEAR(end.position.node[0].y, 2 * t, 1e-9);
    // About a principal axis with moment 0.3: w = torque t / moment. Small enough not to be lost.
    EXPECT_NEAR(angular_momentum(end).z, 0.03 * t, 2e-5);
    EXPECT_NEAR(norm(angular_momentum(end)), angular_momentum(end).z, 1e-12);
  }
}

/// A rod that hangs by one end, let go at 60 degrees.
struct Swing {
  double amplitude = 0;  ///< last largest angle of ten seconds on the side of the first, over it
  double period = 0;     ///< mean one [s]
  double exact = 0;      ///< by the elliptic integral [s]
};

Swing swing(StepRule rule, double h) {
  const double pi = 3.14159265358979323846, start = pi / 3;
  AffineSettings settings = free_settings(rule, h);
  settings.gravity = {0, 0, -9.81};
  settings.tolerance = 1e-7;
  AffineSystem system(settings);
  system.add(solid(box_mesh({0.05, 0.05, 0.5}), 1000, 1e9,
                   {-0.5 * std::sin(start), 0, -0.5 * std::cos(start)},
                   exp_map(Vec3d{0, start, 0})));
  const AffineMass mass = system.bodies()[0].mass;
  system.add(PointJoint{0, {0, 0, 0.5}, -1, {}});
  Swing r;
  std::vector<double> crossings;
  double last = start, before = start;
  for (int k = 1; k * h < 10; ++k) {
    EXPECT_TRUE(system.step().converged) << k;
    const AffineVec& q = system.bodies()[0].position;
    EXPECT_LT(norm(point_of(q, {0, 0, 0.5})), 1e-12);
    const double angle = std::atan2(-q.node[0].x, -q.node[0].z);
    if (last * angle < 0) crossings.push_back(h * (k - angle / (angle - last)));
    if (angle < last && last > before) r.amplitude = last / start;
    before = last;
    last = angle;
  }
  r.period = 2 * (crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1);
  double a = 1, g = std::cos(start / 2);  // arithmetic-geometric mean
  for (int k = 0; k < 10; ++k) {
    const double next = 0.5 * (a + g);
    g = std::sqrt(a * g);
    a = next;
  }
  const double moment = mass.inertia().yy + mass.mass * 0.25;
  r.exact = 2 * pi * std::sqrt(moment / (mass.mass * 9.81 * 0.5)) / a;
  return r;
}

/// Along a curved way implicit Euler damps, with and without a target that turns; BDF2 hardly does.
TEST(AffineJointTest, PendulaKeepOfTheirSwingWhatTheirRuleLeaves) {
  struct Row {
    StepRule rule;
    double h, amplitude, period, within_amplitude, within_period;
  };
  const double exact = 1.76748;  // of the rod of the table
  for (const Row& row : {Row{StepRule::implicit_euler, 0.01, 0.438, 1.691 / exact, 0.01, 2e-3},
                         Row{StepRule::bdf2, 0.01, 0.997, 1.769 / exact, 0.002, 1e-3},
                         Row{StepRule::rotational, 0.01, 0.460, 1.694 / exact, 0.01, 2e-3},
                         Row{StepRule::implicit_euler, 0.002, 0.817, 1.740 / exact, 0.01, 2e-3},
                         Row{StepRule::bdf2, 0.002, 1.000, 1.768 / exact, 0.001, 1e-3},
                         Row{StepRule::rotational, 0.002, 0.834, 1.743 / exact, 0.01, 2e-3}}) {
    SCOPED_TRACE(testing::Message() << "rule " << static_cast<int>(row.rule) << ", h " << row.h);
    const Swing s = swing(row.rule, row.h);
    EXPECT_NEAR(s.amplitude, row.amplitude, row.within_amplitude);
    EXPECT_NEAR(s.period / s.exact, row.period, row.within_period);
  }
}

/// Two points of a door hold its axis: it turns about it by a torque as a rigid body does, and what
/// is hung from it goes along.
TEST(AffineJointTest, HingesTurnAndBodiesShareJoints) {
  AffineSettings settings = free_settings(StepRule::bdf2, 0.01);
  settings.tolerance = 1e-9;
  AffineSystem system(settings);
  AffineBody door = solid(box_mesh({0.4, 0.02, 1}), 500, 1e9, {0.4, 0, 0});
  door.torque = {0, 0, 2};
  system.add(door);
  system.add(PointJoint{0, {-0.4, 0, 1}, -1, {0, 0, 1}});
  system.add(PointJoint{0, {-0.4, 0, -1}, -1, {0, 0, -1}});
  const double moment = door.mass.inertia().zz + door.mass.mass * 0.16;
  for (int k = 0; k < 100; ++k) ASSERT_TRUE(system.step().converged);
  const AffineBody& turned = system.bodies()[0];
  EXPECT_LT(norm(point_of(turned.position, {-0.4, 0, 1}) - Vec3d{0, 0, 1}), 1e-12);
  const Vec3d edge = point_of(turned.position, {0.4, 0, 0}),
              rate = point_of(turned.velocity, {0.4, 0, 0});
  EXPECT_NEAR(norm(edge), 0.8, 1e-6);
  EXPECT_NEAR(norm(rate) / 0.8, 2 / moment, 1e-3 * 2 / moment);
  EXPECT_LT(strain_norm(turned.position), 1e-6);

  // Two boxes that share a point and fall: it stays shared, and their center falls as a stone.
  settings.gravity = {0, 0, -9.81};
  settings.rule = StepRule::implicit_euler;
  AffineSystem pair(settings);
  AffineBody one = solid(box_mesh({0.05, 0.05, 0.05}), 1000, 1e8, {-0.15, 0, 0});
  AffineBody two = solid(box_mesh({0.05, 0.05, 0.05}), 1000, 1e8, {0.15, 0, 0});
  set_motion(one, {}, {0, 3, 1});
  pair.add(one);
  pair.add(two);
  pair.add(PointJoint{0, {0.15, 0, 0}, 1, {-0.15, 0, 0}});
  for (int k = 0; k < 50; ++k) ASSERT_TRUE(pair.step().converged);
  const AffineVec &p = pair.bodies()[0].position, &q = pair.bodies()[1].position;
  EXPECT_LT(norm(point_of(p, {0.15, 0, 0}) - point_of(q, {-0.15, 0, 0})), 1e-12);
  EXPECT_NEAR(0.5 * (p.node[0] + q.node[0]).z, -9.81 * 0.5 * (0.5 + 0.01) / 2, 1e-8);
  EXPECT_NEAR((p.node[0] + q.node[0]).x, 0, 1e-8);
}

/// Half the distance of bisection where `f` goes from above to below zero.
template <class F>
double root(const F& f, double low, double high) {
  for (int k = 0; k < 200; ++k) {
    const double middle = 0.5 * (low + high);
    (f(middle) > 0 ? low : high) = middle;
  }
  return low;
}

AffineSettings contact_settings() {
  AffineSettings s;
  s.barrier.reach = 0.01;
  s.barrier.stiffness = 1e9;
  s.tolerance = 1e-7;
  return s;
}

/// Four corners over the inside of one triangle carry the weight.
TEST(AffineContactTest, A81ABoxComesToRestWhereTheBarrierCarriesIt) {
  for (const StepRule rule : {StepRule::implicit_euler, StepRule::bdf2}) {
    AffineSettings settings = contact_settings();
    settings.rule = rule;
    AffineSystem system(settings);
    system.add(fixed_floor());
    system.add(solid(box_mesh({0.5, 0.5, 0.5}), 1000, 1e8, {0, 0, 0.55}));
    AffineReport report;
    double least = 1;
    for (int k = 0; k < 800; ++k) {
      report = system.step();
      ASSERT_TRUE(report.converged) << k;
      least = std::min(least, report.gap);
    }
    EXPECT_GT(least, 0);
    const double expected = root(
        [](double d) {  // with the derivative of -(y - s)^2 ln(y / s), y = d^2, written out
          const double y = d * d, s = 1e-4;
          const double slope = 2 * (y - s) * std::log(y / s) + (y - s) * (y - s) / y;
          return 4 * 1e9 * slope * 2 * d - 1000 * 9.81;
        },
        1e-6, 0.01);
    EXPECT_EQ(report.contacts, 4);
    EXPECT_NEAR(report.gap / expected, 1, 1e-3);
    EXPECT_LT(norm(system.bodies()[1].velocity.node[0]), 1e-4);
    EXPECT_LT(strain_norm(system.bodies()[1].position), 1e-3);
  }
}

AffineSystem block_on_slope(double degrees, double mu, double slip_speed) {
  AffineSettings settings = contact_settings();
  settings.rule = StepRule::implicit_euler;
  settings.mu = mu;
  settings.slip_speed = slip_speed;
  settings.tolerance = 1e-8;
  const double angle = degrees * 3.14159265358979323846 / 180;
  settings.gravity = {9.81 * std::sin(angle), 0, -9.81 * std::cos(angle)};
  AffineSystem system(settings);
  system.add(fixed_floor());
  system.add(solid(box_mesh({0.5, 0.5, 0.1}), 1000, 1e8, {0, 0, 0.108}));
  return system;
}

/// At rest on a slope a block creeps at a share of the speed below which contacts stick.
TEST(AffineContactTest, A80FrictionCreeps) {
  for (const double slip_speed : {1e-3, 0.5e-3}) {
    AffineSystem system = block_on_slope(20, 0.5, slip_speed);
    for (int k = 0; k < 200; ++k) ASSERT_TRUE(system.step().converged) << k;
    EXPECT_NEAR(system.bodies()[1].velocity.node[0].x / slip_speed, 0.47840, 0.01 * 0.47840);
    EXPECT_NEAR(system.bodies()[1].velocity.node[0].y, 0, 1e-3 * slip_speed);
  }
}

TEST(AffineContactTest, ABlockSlidesDownASlopeThatIsTooSteep) {
  AffineSystem system = block_on_slope(20, 0.2, 1e-3);
  for (int k = 0; k < 100; ++k) ASSERT_TRUE(system.step().converged) << k;
  const double early = system.bodies()[1].velocity.node[0].x;
  for (int k = 0; k < 50; ++k) ASSERT_TRUE(system.step().converged) << k;
  const double angle = 20 * 3.14159265358979323846 / 180;
  const double expected = 9.81 * (std::sin(angle) - 0.2 * std::cos(angle));
  EXPECT_NEAR((system.bodies()[1].velocity.node[0].x - early) / 0.5 / expected, 1, 0.01);
}

/// All pairs of all bodies that come near each other on their ways, looked at many times.
TEST(AffineContactTest, TheSearchOfPairsMissesNone) {
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto vector = [&] { return Vec3d{unit(random), unit(random), unit(random)}; };
  std::vector<AffineBody> bodies;
  std::vector<AffineVec> from, to;
  for (int k = 0; k < 5; ++k) {
    bodies.push_back(solid(box_mesh({0.3, 0.2, 0.1}), 1, 1, 0.5 * vector(), exp_map(vector())));
    bodies.back().fixed = k < 2;
    from.push_back(bodies.back().position);
    to.push_back(from.back());
    for (Vec3d& n : to.back().node) n += 0.2 * vector();
  }
  const double distance = 0.02;
  using Name = std::array<int, 7>;  // kind, bodies, vertices
  std::vector<Name> found;
  for (const SurfacePair& p : pairs_near(bodies, from, to, distance))
    found.push_back({static_cast<int>(p.kind), p.body[0], p.body[1], p.vertex[0], p.vertex[1],
                     p.vertex[2], p.vertex[3]});
  std::sort(found.begin(), found.end());
  EXPECT_EQ(std::unique(found.begin(), found.end()), found.end());
  int near = 0, all = 0;
  const auto look = [&](const SurfacePair& p) {
    ++all;
    const Four rest = rest_points(bodies, p), a = points_of(from, p, rest),
               b = points_of(to, p, rest);
    double least = 1;
    for (int s = 0; s <= 10; ++s) {
      Four x;
      for (int i = 0; i < 4; ++i) x[i] = a[i] + 0.1 * s * (b[i] - a[i]);
      least = std::min(least, std::sqrt(nearest_points(p.kind, x).squared));
    }
    if (least > distance) return;
    ++near;
    EXPECT_TRUE(std::binary_search(found.begin(), found.end(),
                                   Name{static_cast<int>(p.kind), p.body[0], p.body[1], p.vertex[0],
                                        p.vertex[1], p.vertex[2], p.vertex[3]}));
  };
  for (int a = 0; a < 5; ++a) {
    for (int b = 0; b < 5; ++b) {
      if (a == b || (a < 2 && b < 2)) continue;
      const Surface& own = *bodies[static_cast<std::size_t>(a)].surface;
      const Surface& other = *bodies[static_cast<std::size_t>(b)].surface;
      for (int v = 0; v < 8; ++v)
        for (const auto& t : other.triangles)
          look({PairKind::point_triangle, {a, b}, {v, t[0], t[1], t[2]}});
      if (a < b)
        for (const auto& e : own.edges)
          for (const auto& f : other.edges)
            look({PairKind::edge_edge, {a, b}, {e[0], e[1], f[0], f[1]}});
    }
  }
  EXPECT_GT(near, 100);
  EXPECT_LT(found.size(), static_cast<std::size_t>(all));
}

std::vector<exact::Triangle> triangles_of(const AffineBody& body) {
  std::vector<exact::Triangle> r;
  for (const auto& t : body.surface->triangles) {
    exact::Triangle x;
    for (std::size_t k = 0; k < 3; ++k)
      x[k] = point_of(body.position, body.surface->vertices[static_cast<std::size_t>(t[k])]);
    r.push_back(x);
  }
  return r;
}

bool any_touch(const AffineSystem& system) {
  std::vector<std::vector<exact::Triangle>> all;
  for (const AffineBody& body : system.bodies()) all.push_back(triangles_of(body));
  for (std::size_t a = 0; a < all.size(); ++a)
    for (std::size_t b = a + 1; b < all.size(); ++b)
      for (const exact::Triangle& s : all[a])
        for (const exact::Triangle& t : all[b])
          if (exact::triangles_touch(s, t)) return true;
  return false;
}

/// Boxes thrown at each other and at the floor, turning, with friction: exact arithmetic finds no
/// common point of two surfaces after any step.
TEST(AffineContactTest, NoStateEverIntersects) {
  AffineSettings settings = contact_settings();
  settings.mu = 0.4;
  settings.tolerance = 1e-3;
  AffineSystem system(settings);
  system.add(fixed_floor());
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto vector = [&] { return Vec3d{unit(random), unit(random), unit(random)}; };
  for (int k = 0; k < 3; ++k) {
    AffineBody box = solid(box_mesh({0.2, 0.15, 0.1}), 1000, 1e8, {0.1 * k, 0, 0.4 + 0.6 * k},
                           exp_map(vector()));
    set_motion(box, {0, 0, -3.0 * k}, 5.0 * vector());
    system.add(box);
  }
  ASSERT_FALSE(any_touch(system));
  int contacts = 0, unfinished = 0;
  for (int k = 0; k < 120; ++k) {
    const AffineReport report = system.step();
    unfinished += report.converged ? 0 : 1;
    contacts = std::max(contacts, report.contacts);
    EXPECT_GT(report.gap, 0) << k;
    ASSERT_FALSE(any_touch(system)) << k;
  }
  EXPECT_EQ(unfinished, 0);
  EXPECT_GT(contacts, 8);
}

/// Case A84: a card at 100 m/s against a thin plate, 1 m in a step.
TEST(AffineContactTest, A84FastCardsDoNotPass) {
  for (const double mu : {0.0, 0.3}) {
    AffineSettings settings = contact_settings();
    settings.gravity = {};
    settings.mu = mu;
    AffineSystem system(settings);
    AffineBody plate = solid(box_mesh({0.5, 0.5, 0.005}), 1000, 1e8, {});
    plate.fixed = true;
    system.add(plate);
    AffineBody card = solid(box_mesh({0.2, 0.1, 0.005}), 1000, 1e8, {0.03, 0.02, 0.8},
                            exp_map(Vec3d{0.2, 1.2, 0.1}));
    set_motion(card, {0, 0, -100}, {});
    system.add(card);
    for (int k = 0; k < 20; ++k) {
      const AffineReport report = system.step();
      EXPECT_GT(report.gap, 0);
      ASSERT_FALSE(any_touch(system)) << k;
      EXPECT_GT(system.bodies()[1].position.node[0].z, 0) << k;
    }
  }
}

template <class F>
std::string message_of(const F& f) {
  try {
    f();
  } catch (const InvalidParameter& e) {
    return e.what();
  }
  return "nothing was thrown";
}

TEST(AffineInputTest, BadInputIsNamed) {
  const auto of_settings = [](void (*change)(AffineSettings&)) {
    AffineSettings s;
    change(s);
    return message_of([&] { AffineSystem system(s); });
  };
  EXPECT_EQ(of_settings([](AffineSettings& s) { s.h = 0; }), "h must be positive, got 0");
  EXPECT_EQ(of_settings([](AffineSettings& s) { s.mu = -0.5; }),
            "mu must be zero or more, got -0.5");
  EXPECT_THAT(of_settings([](AffineSettings& s) { s.barrier.reach = std::nan(""); }),
              testing::HasSubstr("barrier.reach must be positive"));
  EXPECT_THAT(of_settings([](AffineSettings& s) { s.barrier.form = BarrierForm::physical; }),
              testing::HasSubstr("barrier.form must be original"));
  EXPECT_EQ(of_settings([](AffineSettings& s) { s.most_iterations = 0; }),
            "most_iterations must be 1 or more, got 0");
  AffineSystem system(AffineSettings{});
  EXPECT_THAT(message_of([&] { system.add(AffineBody{}); }), testing::HasSubstr("surface"));
  AffineBody flat = solid(box_mesh({1, 1, 1}), 1, 1, {});
  flat.mass.second.zz = 0;
  EXPECT_THAT(message_of([&] { system.add(flat); }), testing::HasSubstr("second moments"));
  TriangleMesh mesh = box_mesh({1, 1, 1});
  mesh.name = "box.obj";
  mesh.triangles[3][1] = 8;
  EXPECT_EQ(message_of([&] { make_surface(mesh, {}); }),
            "box.obj: triangle 3 has vertex 8, but there are 8");
}

TEST(AffineInputTest, JointsThatCannotHoldAreRefused) {
  AffineSystem system(AffineSettings{});
  system.add(solid(box_mesh({1, 1, 1}), 1, 1, {}));
  AffineBody fixed = solid(box_mesh({1, 1, 1}), 1, 1, {5, 0, 0});
  fixed.fixed = true;
  system.add(fixed);
  const auto message = [&](const PointJoint& joint) {
    return message_of([&] { system.add(joint); });
  };
  EXPECT_EQ(message({0, {}, 2, {}}), "a joint holds body 2, but there are 2");
  EXPECT_THAT(message({1, {}, -1, {5, 0, 0}}), testing::HasSubstr("holds nothing that moves"));
  EXPECT_EQ(message({0, {1, 0, 0}, 1, {-3, 0, 0}}),
            "the points of a joint of body 0 are 1 m apart, expected none");
  system.add(PointJoint{0, {1, 0, 0}, 1, {-4, 0, 0}});
  EXPECT_THAT(message({0, {1, 0, 0}, -1, {1, 0, 0}}), testing::HasSubstr("repeats or contradicts"));
  for (const Vec3d& corner : {Vec3d{0, 1, 0}, Vec3d{0, 0, 1}, Vec3d{0, 0, 0}})
    system.add(PointJoint{0, corner, -1, corner});  // four points: all of the body
  EXPECT_THAT(message({0, {1, 1, 1}, -1, {1, 1, 1}}), testing::HasSubstr("repeats or contradicts"));
}

}  // namespace
}  // namespace scree::affine
