// No speed, no bounce and no motion of the walls leads out of a container drawn as a mesh. On every
// backend there is.

#include <algorithm>
#include <cmath>
#include <limits>

#include "shapes/mesh.h"
#include "tests/parity/parity.h"

namespace scree::parity {
namespace {

/// Rings of the same polygon one above the other, joined by a surface, with a lid on either end.
/// What is inside is known without its triangles.
struct Vessel {
  int sides;
  std::vector<std::array<double, 2>> rings;  ///< distance of the sides from the axis, height [m]

  Vec3d corner(int side, double apothem, double z) const {
    const double angle = 2 * kPi * (side + 0.5) / sides, r = apothem / std::cos(kPi / sides);
    return {r * std::cos(angle), r * std::sin(angle), z};
  }

  /// Normals toward the inside.
  TriangleMesh mesh(bool closed) const {
    TriangleMesh m;
    m.name = "vessel";
    m.closed = closed;
    std::vector<std::vector<int>> ring;
    for (const auto& [apothem, z] : rings) {
      auto& vertices = ring.emplace_back();
      for (int k = 0; k < sides; ++k) {
        if (k == 0 || apothem > 0) m.vertices.push_back(corner(k, apothem, z));
        vertices.push_back(static_cast<int>(m.vertices.size()) - 1);
      }
    }
    const auto add = [&](int a, int b, int c) {
      if (a != b && b != c && c != a) m.triangles.push_back({a, b, c});
    };
    for (std::size_t r = 0; r + 1 < ring.size(); ++r) {
      for (int k = 0; k < sides; ++k) {
        const auto i = static_cast<std::size_t>(k), j = static_cast<std::size_t>((k + 1) % sides);
        add(ring[r][i], ring[r + 1][i], ring[r][j]);
        add(ring[r][j], ring[r + 1][i], ring[r + 1][j]);
      }
    }
    for (const bool is_top : {false, true}) {
      const auto& lid = is_top ? ring.back() : ring.front();
      if (lid[0] == lid[1]) continue;
      const auto middle = static_cast<int>(m.vertices.size());
      m.vertices.push_back({0, 0, is_top ? rings.back()[1] : rings.front()[1]});
      for (int k = 0; k < sides; ++k) {
        const int a = lid[static_cast<std::size_t>(k)];
        const int b = lid[static_cast<std::size_t>((k + 1) % sides)];
        is_top ? add(middle, b, a) : add(middle, a, b);
      }
    }
    return m;
  }

  /// Above zero inside [m].
  double depth(const Vec3d& x) const {
    double apothem = -std::numeric_limits<double>::infinity();
    for (int k = 0; k < sides; ++k) {
      const double angle = 2 * kPi * k / sides;
      apothem = std::max(apothem, x.x * std::cos(angle) + x.y * std::sin(angle));
    }
    double least = std::min(x.z - rings.front()[1], rings.back()[1] - x.z);
    for (std::size_t r = 0; r + 1 < rings.size(); ++r) {
      const auto [a, low] = rings[r];
      const auto [b, high] = rings[r + 1];
      if (x.z < low || x.z > high) continue;
      least = std::min(least, a + (b - a) * (x.z - low) / (high - low) - apothem);
    }
    return least;
  }
};

const Vessel kBox{4, {{3, -2}, {3, 3}}};
const Vessel kDrum{24, {{3, -2}, {3, 2}}};
const Vessel kWedge{3, {{2, -3}, {2, 3}}};
const Vessel kCone{12, {{0, -4}, {4, 2}}};  // 12 triangles meet at its tip
const Vessel kFunnel{12, {{0.8, -4}, {0.8, -1}, {4, 2}, {4, 4}}};
const std::pair<const char*, Vessel> kVessels[] = {
    {"box", kBox}, {"drum", kDrum}, {"wedge", kWedge}, {"cone", kCone}, {"funnel", kFunnel}};

/// How a vessel moves.
enum class Course { rest, turns, turns_far, shakes };
const std::pair<const char*, Course> kCourses[] = {{"at rest", Course::rest},
                                                   {"turns", Course::turns},
                                                   {"turns far", Course::turns_far},
                                                   {"shakes", Course::shakes}};

class MeshContainers : public ::testing::TestWithParam<std::tuple<BackendKind, Precision>> {
 protected:
  static constexpr double kStep = 0.01;
  /// Six are every law and every restitution, with gravity and without. A step of one sphere takes a GPU twenty times as long.
  int trials() const { return backend() == BackendKind::cpu ? 6 : 2; }
  void SetUp() override {
    std::string reason;
    if (!backend_available(backend(), &reason)) GTEST_SKIP() << "no such backend: " << reason;
  }
  BackendKind backend() const { return std::get<0>(GetParam()); }
  bool is_single() const { return std::get<1>(GetParam()) == Precision::single_precision; }
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  Vec3d direction() {
    for (;;) {
      const Vec3d v{uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)};
      if (norm(v) > 0.1 && norm(v) < 1) return normalized(v);
    }
  }

  Scene scene(int trial) {
    Scene s = empty_scene(kStep, trial % 2 == 0 ? 0.0 : 0.4);
    solve_to(s, is_single() ? 1e-3 : 1e-6);
    s.gravity = trial % 3 == 0 ? Vec3d{0, 0, -100} : Vec3d{};
    // Newton's law gains energy without bound where walls meet at less than a right angle.
    const bool is_newton = trial / 3 % 2 != 0;
    constexpr double kRestitution[] = {0, 0.5, 1};
    s.materials[0].restitution =
        is_newton ? 0.5 * kRestitution[trial % 3] : kRestitution[trial % 3];
    s.stepping.restitution_law = is_newton ? RestitutionLaw::newton : RestitutionLaw::poisson;
    return s;
  }

  /// A sphere inside that moves by 0.1 to 10 diameters in a step.
  void add_fast_sphere(Scene& s, const Vessel& vessel, const Vec3d& above, double height) {
    for (;;) {
      const Vec3d x{uniform(-4, 4), uniform(-4, 4), uniform(-4, 4)};
      if (vessel.depth(x) < 0.75 || dot(x, above) < height + 0.5) continue;
      bool is_clear = true;
      for (const BodyDescription& other : s.bodies) {
        if (other.kind == BodyKind::free) is_clear = is_clear && norm(other.position - x) > 1;
      }
      if (!is_clear) continue;
      add_sphere(s, x, 0.5, 1).velocity = std::pow(10, uniform(-1, 1)) / kStep * direction();
      return;
    }
  }

  void add_vessel(Scene& s, const Vessel& vessel, bool closed, Course course) {
    s.meshes.push_back(vessel.mesh(closed));
    BodyDescription body;
    body.kind = course == Course::rest ? BodyKind::fixed : BodyKind::kinematic;
    body.shape.kind = shapes::Mesh::kind;
    body.shape.mesh = 0;
    Motion motion;
    motion.kind = course == Course::shakes ? Motion::Kind::oscillating : Motion::Kind::rotating;
    motion.axis = kAxis;
    motion.rate = rate(course);
    motion.amplitude = 3;
    motion.frequency = kFrequency;
    if (course != Course::rest) body.motion = motion;
    s.bodies.push_back(body);
  }

  /// Where a point of space is in the frame of the vessel.
  static Vec3d in_vessel(const Vec3d& x, Course course, double time) {
    if (course == Course::rest) return x;
    if (course == Course::shakes) return x - 3 * std::sin(2 * kPi * kFrequency * time) * kAxis;
    const double angle = -rate(course) * time, cosine = std::cos(angle);
    return cosine * x + std::sin(angle) * cross(kAxis, x) + ((1 - cosine) * dot(kAxis, x)) * kAxis;
  }

  /// Least depth of a sphere's center in the vessel over some steps [m].
  double least_depth(const Scene& s, const Vessel& vessel, Course course) {
    World w = world_on(backend(), s, std::get<1>(GetParam()));
    double least = 1;
    for (int k = 0; k < 30 && least > 0; ++k) {
      w.step();
      const BodyStates states = w.states();
      for (std::size_t i = 0; i < s.bodies.size(); ++i) {
        if (s.bodies[i].kind != BodyKind::free) continue;
        least = std::min(least, vessel.depth(in_vessel(states.position[i], course, w.time())));
      }
    }
    return least;
  }

  static double rate(Course course) { return (course == Course::turns ? 0.1 : 1.7) / kStep; }
  static constexpr double kFrequency = 7;
  static constexpr Vec3d kAxis{0.6, 0, 0.8};
  std::mt19937 random_{11};
};
INSTANTIATE_TEST_SUITE_P(All, MeshContainers,
                         ::testing::Combine(::testing::ValuesIn(kBackends),
                                            ::testing::ValuesIn(kPrecisions)),
                         [](const auto& info) {
                           return std::string(name_of(std::get<0>(info.param))) + "_" +
                                  name_of(std::get<1>(info.param));
                         });

TEST_P(MeshContainers, NothingEscapesAtAnySpeedHoweverItBounces) {
  for (const auto& [name, vessel] : kVessels) {
    for (const auto& [course_name, course] : kCourses) {
      int escapes = 0;
      for (int trial = 0; trial < trials(); ++trial) {
        Scene s = scene(trial);
        add_vessel(s, vessel, trial % 4 == 3, course);
        const int count = name == std::string("funnel") ? 1 : 1 + trial % 3;
        for (int k = 0; k < count; ++k) add_fast_sphere(s, vessel, {}, -1);
        escapes += least_depth(s, vessel, course) <= 0;
      }
      EXPECT_EQ(escapes, 0) << name << ", " << course_name << ", of " << trials();
    }
  }
}

TEST_P(MeshContainers, ABounceAcrossARoomEndsAtItsCeiling) {
  Scene s = scene(2);  // elastic
  s.materials[0].friction = 0;
  add_vessel(s, kBox, false, Course::rest);  // heights -2 to 3
  add_sphere(s, {0.3, 0.2, 0}, 0.5, 1).velocity = {50, 0, -600};
  World w = world_on(backend(), s, std::get<1>(GetParam()));
  for (const double height : {2.5, -1.5, 2.5}) {
    EXPECT_EQ(w.step().stopped, 1);
    const BodyStates states = w.states();
    EXPECT_NEAR(states.position[1].z, height, 1e-5);
    EXPECT_NEAR(states.velocity[1].z, height > 0 ? 600 : -600, 0.1);
    EXPECT_NEAR(states.velocity[1].x, 50, 0.1);
  }
  EXPECT_NEAR(w.states().position[1].x, 0.3 + 3 * 0.5, 1e-3);
}

TEST_P(MeshContainers, NothingEscapesThatSlidesOffAnotherWall) {
  for (const auto& [name, vessel] : {kVessels[0], kVessels[1], kVessels[3]}) {
    for (const bool is_box : {false, true}) {
      int escapes = 0;
      for (int trial = 0; trial < trials(); ++trial) {
        Scene s = scene(trial);
        s.materials[0].restitution = 0;
        add_vessel(s, vessel, trial % 4 == 3, Course::rest);
        const double slope = uniform(-0.6, 0.6);
        const Vec3d up{std::sin(slope), 0, std::cos(slope)};
        if (is_box) {
          BodyDescription& box = add_wall_box(s, -1.5 * up, {5, 5, 0.5});
          box.orientation = {std::cos(slope / 2), 0, std::sin(slope / 2), 0};
        } else {
          add_plane(s, up, -1 * up);
        }
        add_fast_sphere(s, vessel, up, -1);
        escapes += least_depth(s, vessel, Course::rest) <= 0;
      }
      EXPECT_EQ(escapes, 0) << name << ", " << (is_box ? "box" : "half space") << ", of "
                            << trials();
    }
  }
}

}  // namespace
}  // namespace scree::parity
