#include "dynamics/affine/affine_setup.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <tuple>

#include "dynamics/affine/affine_card.h"
#include "host/error.h"
#include "host/scene/bodies_by_id.h"
#include "host/scene/body_name.h"
#include "host/scene/scene_checks.h"
#include "kernels/affine/surface_tree.h"
#include "shapes/polyhedron.h"
#include "shapes/shape_card.h"

namespace scree::affine {
namespace {

/// Unbounded walls are triangles whose inner circle is so many times the scene.
constexpr double kWallSize = 1000;

/// Polygons as fans of triangles, corners at one place as one.
TriangleMesh triangulated(const scree::Surface& surface) {
  TriangleMesh mesh;
  std::map<std::tuple<double, double, double>, int> known;
  std::vector<int> place;
  for (const Vec3d& v : surface.vertices) {
    const auto [at, is_new] = known.emplace(std::tuple(v.x, v.y, v.z), std::ssize(mesh.vertices));
    if (is_new) mesh.vertices.push_back(v);
    place.push_back(at->second);
  }
  for (const std::vector<int>& face : surface.faces) {
    for (std::size_t k = 2; k < face.size(); ++k) {
      const std::array<int, 3> t{place[static_cast<std::size_t>(face[0])],
                                 place[static_cast<std::size_t>(face[k - 1])],
                                 place[static_cast<std::size_t>(face[k])]};
      if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) mesh.triangles.push_back(t);
    }
  }
  return mesh;
}

/// Planes as large triangles, which have no edge near the bodies.
/// @param middle  of the bodies
TriangleMesh large_triangles(const std::vector<WallFace>& faces, const Vec3d& middle,
                             double inner_radius) {
  TriangleMesh mesh;
  for (const WallFace& face : faces) {
    const Vec3d across = any_orthogonal(face.normal), along = cross(face.normal, across);
    const Vec3d at = middle - dot(middle - face.point, face.normal) * face.normal;
    const int first = static_cast<int>(mesh.vertices.size());
    for (int k = 0; k < 3; ++k) {
      const double angle = 2 * M_PI / 3 * k;
      mesh.vertices.push_back(at + (2 * inner_radius * std::cos(angle)) * across +
                              (2 * inner_radius * std::sin(angle)) * along);
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

bool is_unbounded(const Shape& shape) {
  const ShapeCard& card = shape_card(shape.kind);
  return card.faces != nullptr;
}

class Builder {
 public:
  explicit Builder(const Scene& scene)
      : scene_(scene), stiffness_(kAffineStiffness.of(scene.dynamics.parameters)) {}

  AffineSetup build() {
    for_each_by_id(
        scene_,
        [&](std::size_t id, const BodyDescription& body) {
          all_.push_back({id, body});
        },
        [&](std::size_t first, const ParticleSet& set) {
          for (std::size_t i = 0; i < set.position.size(); ++i)
            all_.push_back({first + i, particle_body(set, i)});
        });
    std::stable_sort(all_.begin(), all_.end(), [](const Body& a, const Body& b) {
      return (a.body.kind == BodyKind::free) > (b.body.kind == BodyKind::free);
    });
    measure();
    body_of_id_.resize(all_.size());
    for (const Body& body : all_) add(body);
    number_rows();
    for (std::size_t b = 0; b < all_.size(); ++b) lock(static_cast<int>(b));
    for (std::size_t j = 0; j < scene_.joints.size(); ++j) hold(j);
    std::vector<ElasticBody> elastic;
    for (std::size_t b = 0; b < all_.size(); ++b)
      if (all_[b].body.elastic->is_on())
        elastic.push_back({static_cast<Index>(b), static_cast<Index>(all_[b].id), &all_[b].body});
    add_solids(scene_, elastic, body_of_id_, setup_);
    for (const Index b : setup_.body_of_row) {
      BodyConstant& body = setup_.bodies[static_cast<std::size_t>(b)];
      body.mobility = body.mass.mobility();
    }
    let_bend();
    return std::move(setup_);
  }

 private:
  struct Body {
    std::size_t id = 0;
    BodyDescription body;
  };

  /// Where a body is at the start: motions may begin elsewhere than at its position.
  static Pose place_of(const BodyDescription& body) {
    if (body.kind == BodyKind::kinematic) return pose_at(body, 0);
    return {body.position, body.orientation};
  }

  /// The box about all that is bounded.
  void measure() {
    Bounds box;
    for (const Body& each : all_) {
      if (is_unbounded(each.body.shape)) continue;
      const AffineVec q = pose_coordinates(place_of(each.body));
      Bounds own;
      for (const Vec3d& v : surface_of(each.body).first->vertices) own.add(point_of(q, v));
      box.add(own);
      if (each.body.kind != BodyKind::free) continue;
      const double size = norm(own.high - own.low);
      setup_.least_free_size = setup_.free_size > 0 ? std::min(setup_.least_free_size, size) : size;
      setup_.free_size = std::max(setup_.free_size, size);
    }
    if (box.low.x > box.high.x) return;
    setup_.size = norm(box.high - box.low);
    for (int k = 0; k < 3; ++k)
      setup_.farthest = std::max({setup_.farthest, -box.low[k], box.high[k]});
    if (!(setup_.free_size > 0)) setup_.free_size = setup_.least_free_size = setup_.size;
    middle_ = 0.5 * (box.low + box.high);
  }

  /// The surface of a body and its number.
  std::pair<const Surface*, int> surface_of(const BodyDescription& body) {
    const Shape& shape = body.shape;
    const ShapeCard& card = shape_card(shape.kind);
    if (is_unbounded(shape)) {
      const Pose at = place_of(body);
      const Vec3d middle = rotate_back(at.orientation, middle_ - at.position);
      return added(large_triangles(card.faces(shape), middle, kWallSize * setup_.size));
    }
    const Vec3d& e = shape.half_extents;
    const Key key{shape.kind,
                  shape.mesh,
                  shape.radius,
                  e.x,
                  e.y,
                  e.z,
                  shape.rounded.core,
                  shape.rounded.radius,
                  shape.rounded.shift,
                  shape.normal.x,
                  shape.normal.y,
                  shape.normal.z,
                  shape.open_faces};
    const auto [place, is_new] = known_.emplace(key, static_cast<int>(setup_.surfaces.size()));
    if (is_new) return added(triangulated(card.surface(shape, mesh_of(scene_, shape), 1)));
    return {setup_.surfaces[static_cast<std::size_t>(place->second)].get(), place->second};
  }
  std::pair<const Surface*, int> added(const TriangleMesh& mesh) {
    setup_.surfaces.push_back(std::make_shared<Surface>(make_surface(mesh, Vec3d{})));
    moments_.push_back(moments_of(mesh));
    return {setup_.surfaces.back().get(), static_cast<int>(setup_.surfaces.size()) - 1};
  }

  void add(const Body& each) {
    const BodyDescription& body = each.body;
    const auto [surface, number] = surface_of(body);
    const SolidMoments& moments = moments_[static_cast<std::size_t>(number)];
    BodyConstant c;
    c.radius = surface->radius;
    c.material = body.material;
    c.is_led = body.kind == BodyKind::kinematic;
    if (body.elastic->is_on()) {
      c.mass = affine_mass(body.mass, body.mass * body.shape.moments);
    } else if (body.kind == BodyKind::free) {
      c.mass = affine_mass(body.mass, body.inertia);
      c.stiffness = stiffness_ * (body.shape.volume > 0 ? body.shape.volume : moments.volume);
      c.force = body.load->force, c.torque = body.load->torque;
      const Sym3<double>& s = c.mass.second;
      const double least = std::min({s.xx, s.yy, s.zz});
      if (!(c.stiffness > 0) || !(least > 1e-12 * s.trace())) refuse_moments(each, s);
    } else if (c.is_led) {
      box_mass(*surface, c);
    }
    AffineVec q = pose_coordinates(place_of(body)), v;
    if (body.kind == BodyKind::free || c.is_led) {
      const double h = 1e-3 * scene_.stepping.time_step;  // a step may be more than half a turn
      const Rates rates = c.is_led ? rates_between(pose_at(body, 0), pose_at(body, h), h)
                                   : Rates{body.velocity, body.angular_velocity};
      v.node[0] = rates.velocity;
      for (int k = 1; k < 4; ++k) v.node[k] = cross(rates.angular_velocity, q.node[k]);
    }
    const auto storage = static_cast<Index>(setup_.bodies.size());
    body_of_id_[each.id] = storage;
    if (c.is_led) setup_.led.push_back({storage, body});
    setup_.bodies.push_back(c);
    setup_.position.push_back(q);
    setup_.velocity.push_back(v);
    setup_.surface_of_body.push_back(number);
    setup_.id_of_body.push_back(static_cast<Index>(each.id));
    const bool has_own = body.kind == BodyKind::free || body.collision_group >= 0;
    setup_.collision_group.push_back(has_own ? body.collision_group : kRestingGroup);
  }

  /// @param s  of a body that has no extent along one of its axes
  [[noreturn]] void refuse_moments(const Body& each, const Sym3<double>& s) const {
    std::string keys;
    for (const ShapeKey& key : shape_card(each.body.shape.kind).keys)
      if (key.type != ShapeKey::Type::flag && key.key != kRoundingKey.key)
        keys += fmt::format("{}\"{}\"", keys.empty() ? "; see its " : ", ", key.key);
    throw InputError(fmt::format(
        "{}: second moments of [{:g}, {:g}, {:g}] kg m^2 are not allowed: an affine body must "
        "have a volume and be extended along all axes{}",
        body_name(BodyConstants(scene_), static_cast<int>(each.id), scene_.body_names), s.xx, s.yy,
        s.zz, keys));
  }

  /// A body that is led resists as a box of water about it.
  void box_mass(const Surface& surface, BodyConstant& c) const {
    Bounds box;
    for (const Vec3d& v : surface.vertices) box.add(v);
    Vec3d half = 0.5 * (box.high - box.low);
    for (int k = 0; k < 3; ++k) half[k] = std::max(half[k], 1e-3 * surface.radius);
    const double volume = 8 * half.x * half.y * half.z;
    c.mass.mass = 1000 * volume;
    c.mass.second.xx = c.mass.mass * half.x * half.x / 3;
    c.mass.second.yy = c.mass.mass * half.y * half.y / 3;
    c.mass.second.zz = c.mass.mass * half.z * half.z / 3;
    c.stiffness = stiffness_ * volume;
  }

  /// Points that joints hold together stay so on straight ways.
  void let_bend() {
    for (BodyConstant& body : setup_.bodies)
      body.may_bend = body.row >= 0 && !body.is_led && !body.lame.is_elastic();
    for (const NodeEquation& e : setup_.equations)
      for (const Index row : e.row)
        if (e.row[1] >= 0) setup_.bodies[body_of(row)].may_bend = false;
  }
  std::size_t body_of(Index row) const {
    return static_cast<std::size_t>(setup_.body_of_row[static_cast<std::size_t>(row)]);
  }

  void number_rows() {
    double mass = 0;
    Index free = 0;
    setup_.scene_bodies = all_.size();
    for (const bool led : {false, true}) {
      setup_.first_led_row = static_cast<Index>(setup_.body_of_row.size());
      for (std::size_t b = 0; b < all_.size(); ++b) {
        BodyConstant& body = setup_.bodies[b];
        const bool is_free = all_[b].body.kind == BodyKind::free;
        if (led ? !body.is_led : !is_free) continue;
        if (is_free) mass += body.mass.mass, ++free;
        if (all_[b].body.elastic->is_on()) continue;
        body.row = static_cast<Index>(setup_.body_of_row.size());
        setup_.body_of_row.push_back(static_cast<Index>(b));
      }
    }
    setup_.mean_mass = free > 0 ? mass / free : 1;
  }

  void lock(int body) {
    const auto b = static_cast<std::size_t>(body);
    const BodyDescription& d = all_[b].body;
    const int row = setup_.bodies[b].row;
    if (d.kind != BodyKind::free) return;
    if (const unsigned moves = d.locks & 7u; moves != 0) {
      NodeEquation e;
      e.row[0] = row, e.weight[0][0] = 1, e.count = 0;
      for (int k = 0; k < 3; ++k) {
        Vec3d axis;
        axis[k] = 1;
        if ((moves >> k & 1u) != 0) e.direction[e.count++] = axis;
      }
      setup_.equations.push_back(e);
    }
    const unsigned turns = d.locks >> 3 & 7u;
    if (turns == 7) {
      hold_turns(row);
    } else if (turns != 0) {  // the axis that is left stays where it is
      Vec3d axis;
      for (int k = 0; k < 3; ++k) axis[k] = turns >> k & 1u ? 0 : 1;
      const Vec3d own = rotate_back(d.orientation, axis);
      NodeEquation e;
      e.row[0] = row;
      for (int k = 0; k < 3; ++k) e.weight[0][k + 1] = own[k];
      setup_.equations.push_back(e);
    }
  }

  /// All turns of a body; of one without a row, which rests, nothing.
  void hold_turns(int row) {
    if (row < 0) return;
    for (int k = 1; k < 4; ++k) {
      NodeEquation e;
      e.row[0] = row, e.weight[0][k] = 1;
      setup_.equations.push_back(e);
    }
  }

  /// A point of two bodies, or of one and the world. @param free  an axis along which it may move; zero: none
  void hold_point(const std::array<int, 2>& body, const Vec3d& at, const Vec3d& free = {}) {
    NodeEquation e;
    if (norm2(free) > 0) {
      e.direction[0] = any_orthogonal(free);
      e.direction[1] = cross(free, e.direction[0]);
      e.count = 2;
    }
    int used = 0;
    for (const int b : body) {
      if (b < 0 || setup_.bodies[static_cast<std::size_t>(b)].row < 0) continue;
      const Body& each = all_[static_cast<std::size_t>(b)];
      const Pose place = place_of(each.body);
      const Vec3d own = rotate_back(place.orientation, at - place.position);
      e.row[used] = setup_.bodies[static_cast<std::size_t>(b)].row;
      for (int k = 0; k < 4; ++k) e.weight[used][k] = (used == 0 ? 1 : -1) * node_weight(own, k);
      ++used;
    }
    if (used > 0) setup_.equations.push_back(e);
  }

  void hold(std::size_t number) {
    const Joint& joint = scene_.joints[number];
    std::array<int, 2> body{-1, -1};
    double reach = 0;  // of points about the anchor
    for (std::size_t k = 0; k < 2; ++k) {
      if (joint.bodies[k] == kWorldBody) continue;
      body[k] = body_of_id_[static_cast<std::size_t>(joint.bodies[k])];
      const double radius = setup_.bodies[static_cast<std::size_t>(body[k])].radius;
      reach = reach == 0 ? radius : std::min(reach, radius);
    }
    const bool slides = joint.kind == JointKind::slider || joint.kind == JointKind::cylindrical;
    const Vec3d free = slides ? joint.axis : Vec3d{};
    hold_point(body, joint.anchor, free);
    if (joint.kind == JointKind::hinge || joint.kind == JointKind::cylindrical)
      hold_point(body, joint.anchor + reach * joint.axis, free);
    if (joint.kind == JointKind::slider) {
      for (const int b : body)
        if (b >= 0) hold_turns(setup_.bodies[static_cast<std::size_t>(b)].row);
    }
    if (joint.kind == JointKind::fixed) {
      for (int k = 0; k < 3; ++k) {
        Vec3d away;
        away[k] = reach;
        hold_point(body, joint.anchor + away);
      }
    }
    if (body[0] >= 0 && body[1] >= 0) setup_.held_pairs.push_back(body);
    drive(number, body, joint.drive(), slides);
    drive(number, body, joint.turn, false);
  }

  /// What acts along or about the axis of a joint.
  void drive(std::size_t number, const std::array<int, 2>& body, const AxisDrive& own,
             bool slides) {
    const Joint& joint = scene_.joints[number];
    DrivenJoint d;
    d.slides = slides;
    d.axis = joint.axis;
    const Vec3d across = any_orthogonal(joint.axis);
    double inertia = 0, reach = 0;
    for (std::size_t k = 0; k < 2; ++k) {
      d.body[k] = body[k];
      d.point[k] = joint.anchor;
      d.across[k][0] = across, d.across[k][1] = cross(joint.axis, across);
      if (body[k] < 0) continue;
      const Pose place = place_of(all_[static_cast<std::size_t>(body[k])].body);
      d.point[k] = rotate_back(place.orientation, joint.anchor - place.position);
      for (Vec3d& each : d.across[k]) each = rotate_back(place.orientation, each);
      const BodyConstant& constant = setup_.bodies[static_cast<std::size_t>(body[k])];
      if (constant.row < 0) continue;
      const double lever = d.slides ? 1 : constant.radius;
      const double its = constant.mass.mass * lever * lever;
      inertia = inertia == 0 ? its : std::min(inertia, its);
      reach = std::max(reach, lever);
    }
    DriveLaw& law = d.law;
    law.lower = own.limits[0], law.upper = own.limits[1];
    law.friction = own.friction;
    law.inertia = inertia;
    law.slip = kSlipSpeed.of(scene_.dynamics.parameters) / reach;
    if (const auto& motor = own.motor) {
      law.speed = motor->speed, law.rest = motor->position;
      law.stiffness = motor->stiffness, law.damping = motor->damping;
      law.most = motor->most_beside_force();
      law.force = motor->force.value_or(0);
    }
    if (!law.is_used()) return;
    setup_.drives.push_back(d);
    setup_.joint_of_drive.push_back(number);
  }

  using Key = std::tuple<ShapeKind, int, double, double, double, double, ShapeKind, double, double,
                         double, double, double, unsigned>;

  const Scene& scene_;
  double stiffness_;
  AffineSetup setup_;
  std::vector<Body> all_;  ///< as they are stored
  std::vector<int> body_of_id_;
  std::map<Key, int> known_;
  Vec3d middle_;                       ///< of the box about all that is bounded [m]
  std::vector<SolidMoments> moments_;  ///< of surfaces
};

}  // namespace

AffineVec pose_coordinates(const Pose& pose) {
  AffineVec q;
  q.node[0] = pose.position;
  for (int k = 0; k < 3; ++k) {
    Vec3d axis;
    axis[k] = 1;
    q.node[k + 1] = rotate(pose.orientation, axis);
  }
  return q;
}

bool may_touch(const AffineSetup& setup, Index a, Index b) {
  const auto group = [&](Index body) {
    return setup.collision_group[static_cast<std::size_t>(body)];
  };
  if (group(a) >= 0 && group(a) == group(b)) return false;
  return std::none_of(setup.held_pairs.begin(), setup.held_pairs.end(), [&](const auto& held) {
    return std::minmax(held[0], held[1]) == std::minmax(a, b);
  });
}

AffineSetup affine_setup(const Scene& scene) { return Builder(scene).build(); }

bool is_too_stiff(const BodyConstant& body, double time_step) {
  constexpr double kMost = 1e8;  // from there on cubes lost a tenth of their spin in a second
  if (body.row < 0 || body.is_led || body.lame.is_elastic()) return false;
  const Sym3<double>& s = body.mass.second;
  return body.stiffness * time_step * time_step > kMost * std::min({s.xx, s.yy, s.zz});
}

std::string stiff_warning(const std::string& body) {
  return fmt::format(
      "{} is very stiff for its size and the time step: it may stop turning; take a smaller "
      "\"stiffness\" or time step",
      body);
}

std::string tolerance_warning(double tolerance, double gained, double fitting) {
  if (!(gained > 0))
    return fmt::format(
        "dynamics.tolerance is {:.3g} m/s: steps end so early that spins and loads may be wrong by "
        "much more; {:.3g} would be accurate",
        tolerance, fitting);
  return fmt::format(
      "dynamics.tolerance is {:.3g} m/s, {:.0f} % of what gravity changes a velocity by in a step: "
      "friction, spins and loads may be wrong by as much and more; {:.3g} would be accurate",
      tolerance, 100 * tolerance / gained, fitting);
}

std::string strain_warning(double strain, std::int64_t step) {
  return fmt::format(
      "a stiff body was strained by {:.2g} in step {} (max_strain): its \"stiffness\" is too small "
      "for what presses or hits it, and from about 1.5 times the stiffness a pressure makes it "
      "flat",
      strain, step);
}

std::string blocked_warning(std::int64_t stayed, std::int64_t slow, double delay) {
  return fmt::format(
      "kinematic bodies went a part of their way in {} steps, where the whole would squeeze what "
      "they push, and stayed in {} where they were blocked (blocked_bodies): their motions are "
      "{:.3g} s late",
      slow - stayed, stayed, delay);
}

}  // namespace scree::affine
