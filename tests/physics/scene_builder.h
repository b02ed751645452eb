#pragma once
// Scenes in code, for tests with closed-form answers. They are solved to a residual
// of 1e-8 m/s where their digits ask for it; most closed forms here need less to show their own digits.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "host/world.h"
#include "shapes/box.h"
#include "shapes/half_space.h"
#include "shapes/mesh.h"
#include "shapes/sphere.h"

namespace scree::physics {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kGravity = 9.81;

inline double radians(double degrees) { return degrees * kPi / 180; }

/// Friction by the convex problem, or by Coulomb's law.
enum class Model { convex, exact };
inline const char* name_of(Model model) { return model == Model::convex ? "convex" : "exact"; }

/// Stops at an RMS residual [m/s], with room for all the iterations that takes.
inline void solve_to(Scene& scene, double residual) {
  scene.solver.stop = {StopRule::Level::absolute, residual};
  scene.solver.max_iterations = 20000;
  scene.solver.max_outer_iterations = 200;
}

/// No bodies; one material.
inline Scene empty_scene(double time_step, double friction, Model model = Model::convex) {
  Scene scene;
  scene.stepping.time_step = time_step;
  scene.materials[0].friction = friction;
  scene.precision = "double";
  scene.solver.exact_coulomb = model == Model::exact;
  solve_to(scene, 1e-11);
  return scene;
}

/// Gravity as seen from an incline whose surface is horizontal in the scene: +x is downhill.
inline void tilt(Scene& scene, double degrees) {
  const double angle = radians(degrees);
  scene.gravity = {kGravity * std::sin(angle), 0, -kGravity * std::cos(angle)};
}

inline int last_id(const Scene& scene) { return static_cast<int>(scene.bodies.size()) - 1; }

/// Half-space below z = 0, or any other.
inline BodyDescription& add_plane(Scene& scene, const Vec3d& normal = {0, 0, 1},
                                  const Vec3d& point = {}) {
  BodyDescription body;
  body.kind = BodyKind::fixed;
  body.shape.kind = shapes::HalfSpace::kind;
  body.shape.normal = normal;
  body.position = point;
  scene.bodies.push_back(body);
  return scene.bodies.back();
}

/// A free solid sphere.
inline BodyDescription sphere(const Vec3d& position, double radius, double mass) {
  BodyDescription body;
  body.shape.kind = shapes::Sphere::kind;
  body.shape.radius = radius;
  body.position = position;
  body.mass = mass;
  const double moment = 0.4 * mass * radius * radius;
  body.inertia = {moment, moment, moment};
  return body;
}
inline BodyDescription& add_sphere(Scene& scene, const Vec3d& position, double radius,
                                   double mass) {
  scene.bodies.push_back(sphere(position, radius, mass));
  return scene.bodies.back();
}

/// A free solid box.
inline BodyDescription& add_box(Scene& scene, const Vec3d& position, const Vec3d& half_extents,
                                double mass) {
  BodyDescription body;
  body.shape.kind = shapes::Box::kind;
  body.shape.half_extents = half_extents;
  set_mass_from_density(body, mass / (8 * half_extents.x * half_extents.y * half_extents.z));
  body.position = position;
  scene.bodies.push_back(body);
  return scene.bodies.back();
}

/// Boxes that turn, every third body a sphere, on a lattice of nx by ny sites a layer.
inline void add_boxes_and_spheres(Scene& scene, int count, int nx, int ny) {
  for (int k = 0; k < count; ++k) {
    const Vec3d at{0.024 * (k % nx), 0.024 * (k / nx % ny), 0.012 + 0.024 * (k / (nx * ny))};
    if (k % 3 == 0) {
      add_sphere(scene, at, 0.01, 0.01);
    } else {
      add_box(scene, at, {0.01, 0.008, 0.009}, 0.01).angular_velocity = {3, 1.0 * (k % 4), 2};
    }
  }
}

/// A fixed or kinematic box.
inline BodyDescription& add_wall_box(Scene& scene, const Vec3d& position, const Vec3d& half_extents,
                                     BodyKind kind = BodyKind::fixed) {
  BodyDescription body;
  body.kind = kind;
  body.shape.kind = shapes::Box::kind;
  body.shape.half_extents = half_extents;
  body.position = position;
  scene.bodies.push_back(body);
  return scene.bodies.back();
}

/// A fixed mesh.
inline BodyDescription& add_mesh(Scene& scene, const TriangleMesh& mesh) {
  BodyDescription body;
  body.kind = BodyKind::fixed;
  body.shape.kind = shapes::Mesh::kind;
  body.shape.mesh = static_cast<int>(scene.meshes.size());
  scene.meshes.push_back(mesh);
  scene.bodies.push_back(body);
  return scene.bodies.back();
}

/// A fixed square valley of four triangles that slope toward the middle.
inline BodyDescription& add_valley(Scene& scene) {
  TriangleMesh valley;
  valley.name = "valley";
  valley.closed = false;
  valley.vertices = {
      {-0.1, -0.1, 0.01}, {0.1, -0.1, 0.01}, {0.1, 0.1, 0.01}, {-0.1, 0.1, 0.01}, {0, 0, 0}};
  valley.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  return add_mesh(scene, valley);
}

/// Floor z = 0 and the walls of an upright box without a lid.
inline void add_tank(Scene& scene, double x_low, double x_high, double y_low, double y_high) {
  add_plane(scene);
  add_plane(scene, {1, 0, 0}, {x_low, 0, 0});
  add_plane(scene, {-1, 0, 0}, {x_high, 0, 0});
  add_plane(scene, {0, 1, 0}, {0, y_low, 0});
  add_plane(scene, {0, -1, 0}, {0, y_high, 0});
}

/// A loose block of spheres on a jittered lattice, from the bottom up: nx by ny sites per layer.
inline void add_lattice(Scene& scene, int count, int nx, int ny, const Vec3d& lowest_center,
                        double spacing, double radius, double density, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> shift(-0.5, 0.5);
  const double room = spacing - 2 * radius;
  for (int k = 0; k < count; ++k) {
    const Vec3d site{static_cast<double>(k % nx), static_cast<double>(k / nx % ny),
                     static_cast<double>(k / (nx * ny))};
    const double sx = shift(random), sy = shift(random), sz = shift(random);
    const Vec3d center = lowest_center + spacing * site + room * Vec3d{sx, sy, sz};
    set_mass_from_density(add_sphere(scene, center, radius, 1), density);
  }
}

inline WorldOptions cpu_options(int threads = 1,
                                Precision precision = Precision::double_precision) {
  WorldOptions options;
  options.backend = BackendKind::cpu;
  options.precision = precision;
  options.threads = threads;
  return options;
}

/// On one CPU thread, in double precision.
inline World reference_world(const Scene& scene) { return World(scene, cpu_options()); }

inline int steps_for(const Scene& scene, double duration) {
  return static_cast<int>(std::lround(duration / scene.stepping.time_step));
}

/// Steps until `duration` [s] has passed; the report of the last step.
inline StepReport run_for(World& world, const Scene& scene, double duration) {
  StepReport report;
  const int steps = steps_for(scene, duration);
  for (int k = 0; k < steps; ++k) report = world.step();
  return report;
}

/// Angle by which an orientation differs from the identity [rad].
inline double rotation_angle(const Quatd& q) {
  return 2 * std::atan2(norm(q.vec()), std::abs(q.w));
}

/// Of two sets of vectors, row by row; infinite where their numbers differ.
inline double largest_difference(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b) {
  double largest = a.size() == b.size() ? 0 : std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    largest = std::max(largest, norm(a[i] - b[i]));
  return largest;
}

/// Normal impulse of all contacts of a body with others in the last step [N s].
inline double normal_impulse(const World& world, int id) {
  double sum = 0;
  for (const ContactRecord& c : world.contacts())
    if (c.body_a == id || c.body_b == id) sum += dot(c.impulse, c.normal);
  return sum;
}

struct Momenta {
  Vec3d linear, angular;
};
/// Of bodies that are all free, about the origin.
inline Momenta momenta_of(const BodyStates& s, const Scene& scene) {
  Momenta m;
  for (std::size_t i = 0; i < s.position.size(); ++i) {
    const BodyDescription& body = scene.bodies[i];
    const Vec3d p = body.mass * s.velocity[i];
    const Vec3d w = rotate_back(s.orientation[i], s.angular_velocity[i]);
    const Vec3d spin{body.inertia.x * w.x, body.inertia.y * w.y, body.inertia.z * w.z};
    m.linear += p;
    m.angular += cross(s.position[i], p) + rotate(s.orientation[i], spin);
  }
  return m;
}

}  // namespace scree::physics
