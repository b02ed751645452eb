#pragma once
// Bodies of collision tests: filled on the host, uploaded once, and the contacts read back.

#include <array>
#include <map>
#include <random>
#include <vector>

#include "collision/body_order.h"
#include "collision/contact_detector.h"
#include "shapes/box.h"
#include "shapes/container.h"
#include "shapes/half_space.h"
#include "shapes/mesh.h"
#include "tests/box_mesh.h"

namespace scree {
using BuildBackend = TestBackend;
}
#include "collision/compiled_parts.inst.h"

namespace scree {

/// Bodies and obstacles on the host, in storage order: owned bodies, ghosts, room, fixed bodies.
template <class Real>
struct CollisionScene {
  std::vector<Vec3<double>> position;
  std::vector<Quat<Real>> orientation;
  std::vector<Vec3<Real>> velocity, angular_velocity;
  std::vector<Real> radius;
  std::vector<Index> shape;
  Index owned_count = 0;
  Index ghost_count = 0;
  Index room = 0;  ///< unused storage between ghosts and fixed bodies
  ObstacleData<Real> obstacles;
  CollisionSettings settings;
  double h = 1e-3;
  Vec3<double> gravity;             ///< [m/s^2]
  std::vector<std::uint8_t> locks;  ///< of the first bodies; the others have none

  Index add(Vec3<double> x, double r, Vec3<double> v = {}) {
    position.push_back(x);
    orientation.push_back({});
    velocity.push_back(Vec3<Real>(v));
    angular_velocity.push_back({});
    radius.push_back(static_cast<Real>(r));
    shape.push_back(-1);
    return static_cast<Index>(position.size()) - 1;
  }
  /// Free spheres come before everything that does not move.
  Index add_free(Vec3<double> x, double r, Vec3<double> v = {}) {
    ++owned_count;
    return add(x, r, v);
  }
  /// The body added last gets a shape.
  ShapeRecord<Real>& give_shape(ShapeKind kind, bool is_wall) {
    ShapeRecord<Real> s;
    s.kind = kind;
    s.body = static_cast<Index>(position.size()) - 1;
    shape.back() = static_cast<Index>(obstacles.shapes.size());
    if (is_wall) obstacles.walls.push_back(shape.back());
    obstacles.shapes.push_back(s);
    return obstacles.shapes.back();
  }
  Index add_half_space(Vec3<double> x, Vec3<double> normal) {
    const Index i = add(x, 0);
    give_shape(shapes::HalfSpace::kind, true).normal = Vec3<Real>(normal);
    return i;
  }
  Index add_container(Vec3<double> x, Vec3<double> half, unsigned open_faces = 0) {
    const Index i = add(x, 0);
    ShapeRecord<Real>& s = give_shape(shapes::Container::kind, true);
    s.half_extents = Vec3<Real>(half);
    s.open_faces = static_cast<std::uint8_t>(open_faces);
    return i;
  }
  Index add_box_wall(Vec3<double> x, Vec3<double> half) {
    const Index i = add(x, norm(half));
    give_shape(shapes::Box::kind, true).half_extents = Vec3<Real>(half);
    return i;
  }
  Index add_mesh_wall(Vec3<double> x, const MeshSource& mesh) {
    const Index i = add(x, 0);
    give_shape(shapes::Mesh::kind, true).mesh = static_cast<Index>(obstacles.meshes.size());
    obstacles.meshes.push_back(mesh);
    return i;
  }
  Index add_free_box(Vec3<double> x, Vec3<double> half, Quat<Real> q = {}) {
    const Index i = add_free(x, norm(half));
    orientation.back() = q;
    give_shape(shapes::Box::kind, false).half_extents = Vec3<Real>(half);
    return i;
  }
};

/// One contact on the host.
struct HostContact {
  std::uint64_t key;
  Index a, b;
  Vec3<double> normal;
  double gap;
  Vec3<double> arm_a, arm_b;

  bool operator==(const HostContact& o) const {
    return key == o.key && a == o.a && b == o.b && normal == o.normal && gap == o.gap &&
           arm_a == o.arm_a && arm_b == o.arm_b;
  }
};

/// A scene in backend memory with its detector.
template <class B, class Real>
class CollisionRun {
 public:
  CollisionRun(B& b, const CollisionScene<Real>& scene)
      : b_(&b),
        scene_(scene),
        position_(b),
        orientation_(b),
        velocity_(b),
        angular_velocity_(b),
        radius_(b),
        shape_(b),
        locks_(b),
        detector_(b, scene.settings, scene.obstacles) {
    load();
  }

  CollisionScene<Real>& scene() { return scene_; }
  ContactDetector<B, Real>& detector() { return detector_; }

  /// Uploads the scene again, after a change.
  void load() {
    put(scene_.position, position_);
    put(scene_.orientation, orientation_);
    put(scene_.velocity, velocity_);
    put(scene_.angular_velocity, angular_velocity_);
    put(scene_.radius, radius_);
    put(scene_.shape, shape_);
    std::vector<std::uint8_t> locks = scene_.locks;
    locks.resize(scene_.position.size());
    put(locks, locks_);
  }

  BodyView<Real> bodies() {
    BodyView<Real> v;
    const auto n = static_cast<Index>(scene_.position.size());
    v.owned_count = scene_.owned_count;
    v.moving_count = v.owned_count + scene_.ghost_count;
    v.fixed_begin = v.moving_count + scene_.room;
    v.count = n;
    v.position = position_.view(n);
    v.orientation = orientation_.view(n);
    v.velocity = velocity_.view(n);
    v.angular_velocity = angular_velocity_.view(n);
    v.radius = radius_.view(n);
    v.shape = shape_.view(n);
    v.locks = locks_.view(n);
    return v;
  }

  /// Sorts bodies, which differ in place and radius only, and kept contacts as a run does.
  void reorder() {
    BodyOrder<B> order(*b_);
    const BodyView<Real> v = bodies();
    order.compute(*b_, v.position.first(v.owned_count));
    order.apply(*b_, v.position);
    order.apply(*b_, radius_.view(v.count));
    detector_.remap(*b_, v, order.new_of_old());
    scene_.position = download(*b_, v.position);
  }

  std::vector<HostContact> detect() {
    detector_.detect(*b_, bodies(), scene_.h, scene_.h * scene_.gravity);
    const ContactView<Real> view = detector_.contacts();
    const auto key = download(*b_, view.key);
    const auto a = download(*b_, view.body_a), b = download(*b_, view.body_b);
    const auto normal = download(*b_, view.normal);
    const auto gap = download(*b_, view.gap);
    const auto arm_a = download(*b_, view.arm_a), arm_b = download(*b_, view.arm_b);
    std::vector<HostContact> out;
    for (std::size_t c = 0; c < key.size(); ++c) {
      HostContact contact{key[c], a[c], b[c], Vec3<double>(normal[c]), gap[c], {}, {}};
      if (!arm_a.empty()) {
        contact.arm_a = Vec3<double>(arm_a[c]);
        contact.arm_b = Vec3<double>(arm_b[c]);
      }
      out.push_back(contact);
    }
    return out;
  }

 private:
  template <class T>
  void put(const std::vector<T>& from, Buffer<B, T>& to) {
    upload(*b_, from, to);
  }

  B* b_;
  CollisionScene<Real> scene_;
  Buffer<B, Vec3<double>> position_;
  Buffer<B, Quat<Real>> orientation_;
  Buffer<B, Vec3<Real>> velocity_, angular_velocity_;
  Buffer<B, Real> radius_;
  Buffer<B, Index> shape_;
  Buffer<B, std::uint8_t> locks_;
  ContactDetector<B, Real> detector_;
};

/// A square floor in the plane z = 0 of n x n cells, two triangles each, facing up.
inline MeshSource flat_floor(int n, double cell) {
  MeshSource m;
  m.closed = false;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) m.vertices.push_back({(i - n / 2) * cell, (j - n / 2) * cell, 0});
  }
  const auto at = [n](int i, int j) { return static_cast<Index>(j * (n + 1) + i); };
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      m.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      m.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return m;
}

/// A closed box of 12 triangles.
inline MeshSource box_mesh(Vec3<double> half) {
  const TriangleMesh box = test::box_mesh(half);
  MeshSource m;
  m.vertices = box.vertices;
  m.triangles = box.triangles;
  return m;
}

}  // namespace scree
