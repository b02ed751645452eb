// Bodies and joints of a scene from what a URDF file says.

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "host/error.h"
#include "host/io/printable.h"
#include "host/scene/compound.h"
#include "host/scene/convex_hull.h"
#include "host/scene/joint_cards.h"
#include "host/scene/scene_checks.h"
#include "host/scene/urdf_checks.h"
#include "host/urdf.h"
#include "kernels/math/sym3.h"
#include "shapes/shape_card.h"

namespace scree {
namespace {

/// Centers and axes of mass may be off those of a shape by this, in sizes of it.
constexpr double kRounding = 1e-6;

UrdfPose operator*(const UrdfPose& a, const UrdfPose& b) {
  return {a.position + rotate(a.orientation, b.position),
          normalized(a.orientation * b.orientation)};
}

bool can_be_driven(const UrdfJoint& joint) {
  return joint.kind == UrdfJointKind::revolute || joint.kind == UrdfJointKind::continuous ||
         joint.kind == UrdfJointKind::prismatic;
}

/// Of a joint that is not floating.
JointKind kind_of_joint(const UrdfJoint& joint) {
  if (joint.kind == UrdfJointKind::fixed) return JointKind::fixed;
  return joint.kind == UrdfJointKind::prismatic ? JointKind::slider : JointKind::hinge;
}

double position_of(const UrdfJoint& joint, const UrdfPlacement& placement) {
  const auto found = placement.joint_positions.find(joint.name);
  return found == placement.joint_positions.end() ? 0 : found->second;
}

/// Links in the frame of the root.
std::vector<UrdfPose> link_poses(const UrdfModel& model, const UrdfPlacement& placement) {
  std::vector<UrdfPose> poses(model.links.size());
  for (const UrdfJoint& joint : model.joints) {
    UrdfPose moved;
    const Vec3d way = position_of(joint, placement) * joint.axis;
    if (joint.kind == UrdfJointKind::prismatic)
      moved.position = way;
    else if (can_be_driven(joint))
      moved.orientation = exp_map(way);
    poses[joint.child] = poses[joint.parent] * joint.origin * moved;
  }
  return poses;
}

/// A shape where it is in the frame of the root.
struct PlacedShape {
  std::size_t link;
  const UrdfCollision* collision;
  UrdfPose pose;
};

/// Links that move as one.
struct Cluster {
  std::size_t first = 0;  ///< its link nearest to the root
  std::size_t owner = 0;  ///< the link that it has name, material and group of
  bool rests = false;
  double mass = 0;
  Vec3d center;          ///< frame of the root
  Sym3<double> inertia;  ///< about the center, axes of the root
  std::vector<PlacedShape> shapes;
  int body = kWorldBody;
};

Sym3<double> sum(const Sym3<double>& a, const Sym3<double>& b) {
  Sym3<double> s;
  s.xx = a.xx + b.xx, s.yy = a.yy + b.yy, s.zz = a.zz + b.zz;
  s.xy = a.xy + b.xy, s.xz = a.xz + b.xz, s.yz = a.yz + b.yz;
  return s;
}

/// Moments of a mass at a point about the origin.
Sym3<double> of_point(double mass, const Vec3d& x) {
  Sym3<double> s;
  s.xx = mass * (x.y * x.y + x.z * x.z);
  s.yy = mass * (x.z * x.z + x.x * x.x);
  s.zz = mass * (x.x * x.x + x.y * x.y);
  s.xy = -mass * x.x * x.y, s.xz = -mass * x.x * x.z, s.yz = -mass * x.y * x.z;
  return s;
}

void add_link(const UrdfModel& model, std::size_t number, const UrdfPose& pose, Cluster& cluster) {
  const UrdfLink& link = model.links[number];
  if (cluster.shapes.empty() && !link.collisions.empty()) cluster.owner = number;
  for (const UrdfCollision& collision : link.collisions)
    cluster.shapes.push_back({number, &collision, pose * collision.pose});
  if (!(link.mass > 0)) return;
  const UrdfPose center = pose * link.center;
  const Sym3<double> own = rotated_diagonal(center.orientation, link.inertia);
  const double mass = cluster.mass + link.mass;
  const Vec3d apart = center.position - cluster.center;
  cluster.inertia = cluster.mass > 0 ? sum(sum(cluster.inertia, own),
                                           of_point(cluster.mass * link.mass / mass, apart))
                                     : own;
  cluster.center = cluster.mass > 0 ? cluster.center + (link.mass / mass) * apart : center.position;
  cluster.mass = mass;
}

/// What moves as one, from the root on; of each link its cluster.
std::vector<Cluster> clusters_of(const UrdfModel& model, const std::vector<UrdfPose>& poses,
                                 bool is_fixed, std::vector<std::size_t>& cluster_of) {
  std::vector<Cluster> clusters(1);
  clusters[0].rests = is_fixed;
  cluster_of.assign(model.links.size(), 0);
  add_link(model, 0, poses[0], clusters[0]);
  for (const UrdfJoint& joint : model.joints) {
    const std::size_t above = cluster_of[joint.parent];
    const bool is_one = joint.kind == UrdfJointKind::fixed;
    if (!is_one) {
      clusters.emplace_back();
      clusters.back().first = clusters.back().owner = joint.child;
    }
    cluster_of[joint.child] = is_one ? above : clusters.size() - 1;
    add_link(model, joint.child, poses[joint.child], clusters[cluster_of[joint.child]]);
  }
  return clusters;
}

/// The tensor along the axes of a frame.
Sym3<double> seen_from(const Quatd& axes, const Sym3<double>& m) {
  const Vec3d e[3] = {rotate(axes, Vec3d{1, 0, 0}), rotate(axes, Vec3d{0, 1, 0}),
                      rotate(axes, Vec3d{0, 0, 1})};
  Sym3<double> s;
  s.xx = dot(e[0], m * e[0]), s.yy = dot(e[1], m * e[1]), s.zz = dot(e[2], m * e[2]);
  s.xy = dot(e[0], m * e[1]), s.xz = dot(e[0], m * e[2]), s.yz = dot(e[1], m * e[2]);
  return s;
}

bool is_round(const Shape& shape) {
  return shape.half_extents.x == shape.half_extents.y && shape_card(shape.kind).rounding != nullptr;
}

class Builder {
 public:
  Builder(Scene& scene, const UrdfModel& model, const UrdfPlacement& placement)
      : scene_(scene), model_(model), placement_(placement) {
    if (placement_.name.empty()) placement_.name = model.name;
    result_.first_body = static_cast<int>(scene.bodies.size());
    result_.first_joint = static_cast<int>(scene.joints.size());
  }

  UrdfBodies build() {
    poses_ = link_poses(model_, placement_);
    clusters_ = clusters_of(model_, poses_,
                            placement_.fixed_base || model_.links[0].name == "world", cluster_of_);
    body_of_link_.assign(model_.links.size(), kWorldBody);
    for (Cluster& cluster : clusters_) {
      if (cluster.rests)
        add_fixed(cluster);
      else
        add_free(cluster);
    }
    for (const auto& [link, body] : names_)
      if (!scene_.body_names.emplace(fmt::format("{}/{}", placement_.name, link), body).second)
        throw InputError(fmt::format(
            "{}: a body called \"{}/{}\" is there already; give each copy a name of its own",
            model_.file, printable(placement_.name, 60), printable(link, 60)));
    for (const UrdfJoint& joint : model_.joints) add_joint(joint);
    result_.body_count = static_cast<int>(scene_.bodies.size()) - result_.first_body;
    result_.joint_count = static_cast<int>(scene_.joints.size()) - result_.first_joint;
    return std::move(result_);
  }

 private:
  UrdfPose in_world(const UrdfPose& pose) const { return placement_.pose * pose; }

  int add(BodyDescription body, std::size_t link) {
    const UrdfSurface& surface = surface_of(link);
    body.material = surface.material;
    body.group = surface.group;
    if (const auto fault = body_fault(scene_, body))
      throw InputError(fmt::format("{}: as a body: {}", model_.links[link].place,
                                   fault_text(fault->field, fault->value, fault->expected)));
    scene_.bodies.push_back(std::move(body));
    return static_cast<int>(scene_.bodies.size()) - 1;
  }

  /// Gives a body the shape, in its own size and with its own frame.
  /// @param pose  of the collision
  void set_shape(const PlacedShape& placed, const UrdfPose& pose, BodyDescription& body) {
    body.shape = placed.collision->shape;
    body.position = pose.position;
    body.orientation = pose.orientation;
    if (!shape_card(body.shape.kind).is_hull) return;
    try {
      set_hull(scene_, body, placed.collision->points);
    } catch (const std::invalid_argument& error) {
      throw InputError(fmt::format("{}: the vertices of its mesh {}",
                                   model_.links[placed.link].place, error.what()));
    }
  }

  void add_fixed(Cluster& cluster) {
    for (const PlacedShape& placed : cluster.shapes) {
      BodyDescription body;
      body.kind = BodyKind::fixed;
      set_shape(placed, in_world(placed.pose), body);
      const int id = add(std::move(body), placed.link);
      if (names_.emplace(model_.links[placed.link].name, id).second)
        body_of_link_[placed.link] = id;
    }
  }

  void add_free(Cluster& cluster) {
    const UrdfLink& first = model_.links[cluster.first];
    if (!(cluster.mass > 0))
      throw InputError(
          first.place +
          ": no mass: a link that moves must have an <inertial>, or be fixed to one that has");
    if (cluster.shapes.empty())
      throw InputError(first.place +
                       ": no <collision>: a body must have a shape; give it one, or fix it to a "
                       "link that has one");
    BodyDescription body;
    body.mass = cluster.mass;
    const std::size_t meshes = scene_.meshes.size();
    if (cluster.shapes.size() > 1 || !has_frame_of_shape(cluster, body)) {
      scene_.meshes.resize(meshes);
      set_parts(cluster, body);
    }
    const Vec3d arm = body.position - placement_.pose.position;
    body.velocity = placement_.velocity + cross(placement_.angular_velocity, arm);
    body.angular_velocity = placement_.angular_velocity;
    result_.mass += body.mass;
    refuse_other_surfaces(cluster);
    cluster.body = add(std::move(body), cluster.owner);
    for (std::size_t i = 0; i < model_.links.size(); ++i)
      if (&clusters_[cluster_of_[i]] == &cluster) {
        body_of_link_[i] = cluster.body;
        names_.emplace(model_.links[i].name, cluster.body);
      }
  }

  const UrdfSurface& surface_of(std::size_t link) const {
    const auto own = placement_.surfaces.find(model_.links[link].name);
    return own == placement_.surfaces.end() ? placement_.surface : own->second;
  }
  /// A body has one material and one group.
  void refuse_other_surfaces(const Cluster& cluster) const {
    const UrdfSurface& one = surface_of(cluster.owner);
    for (std::size_t i = 0; i < model_.links.size(); ++i) {
      if (&clusters_[cluster_of_[i]] != &cluster ||
          placement_.surfaces.count(model_.links[i].name) == 0)
        continue;
      const UrdfSurface& other = surface_of(i);
      if (other.material != one.material || other.group != one.group)
        throw InputError(
            fmt::format("{}: has a material or group of its own, but is one body with link \"{}\": "
                        "give both the same",
                        model_.links[i].place, printable(model_.links[cluster.owner].name, 60)));
    }
  }

  /// Makes a body the one shape, if center of mass and principal axes are those of it.
  bool has_frame_of_shape(const Cluster& cluster, BodyDescription& body) {
    set_shape(cluster.shapes[0], in_world(cluster.shapes[0].pose), body);
    const Vec3d center = in_world({cluster.center, {}}).position;
    if (norm(center - body.position) > kRounding * bounding_size(body)) return false;
    body.position = center;
    const Quatd to_root = conjugate(placement_.pose.orientation);
    Sym3<double> m = seen_from(to_root * body.orientation, cluster.inertia);
    if (shape_card(body.shape.kind).is_ball) {
      Eigen::Matrix3d tensor;
      tensor << m.xx, m.xy, m.xz, m.xy, m.yy, m.yz, m.xz, m.yz, m.zz;
      if (std::abs(m.xy) + std::abs(m.xz) + std::abs(m.yz) > 1e-12 * m.trace()) {
        Eigen::Matrix3d axes =
            Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(tensor).eigenvectors();
        if (axes.determinant() < 0) axes.col(2) *= -1;
        const Eigen::Quaterniond q(axes);
        turn(cluster, normalized(Quatd{q.w(), q.x(), q.y(), q.z()}), body, m);
      }
    } else if (is_round(body.shape) && std::abs(m.xy) > 1e-12 * m.trace()) {
      const double angle = 0.5 * std::atan2(2 * m.xy, m.xx - m.yy);
      turn(cluster, exp_map(Vec3d{0, 0, angle}), body, m);
    }
    if (std::max({std::abs(m.xy), std::abs(m.xz), std::abs(m.yz)}) > kRounding * m.trace())
      return false;
    body.inertia = {m.xx, m.yy, m.zz};
    return true;
  }

  /// Makes a body the compound of all shapes, with the center of mass and the principal axes of the links.
  void set_parts(const Cluster& cluster, BodyDescription& body) {
    std::vector<ShapePart> parts;
    for (const PlacedShape& placed : cluster.shapes) {
      BodyDescription one;
      set_shape(placed, placed.pose, one);
      ShapePart part;
      part.shape = one.shape;
      part.position = one.position;
      part.orientation = one.orientation;
      parts.push_back(part);
    }
    const Sym3<double>& m = cluster.inertia;
    const double half = 0.5 * m.trace();
    SolidMoments solid;
    solid.center = cluster.center;
    solid.second = {
        {{half - m.xx, -m.xy, -m.xz}, {-m.xy, half - m.yy, -m.yz}, {-m.xz, -m.yz, half - m.zz}}};
    const LocalFrame frame = principal_frame(solid);
    try {
      CompoundBody made = make_compound_in(scene_, std::move(parts), frame);
      made.mesh.name = model_.links[cluster.owner].name;
      body.shape = made.shape;
      body.shape.mesh = static_cast<int>(scene_.meshes.size());
      scene_.meshes.push_back(std::move(made.mesh));
    } catch (const std::invalid_argument& error) {
      throw InputError(
          fmt::format("{}: its collisions: {}", model_.links[cluster.owner].place, error.what()));
    }
    const UrdfPose pose = in_world({frame.origin, frame.axes});
    body.position = pose.position;
    body.orientation = pose.orientation;
    const Sym3<double> own = seen_from(frame.axes, cluster.inertia);
    body.inertia = {own.xx, own.yy, own.zz};
  }

  /// Turns the frame of a round body.
  void turn(const Cluster& cluster, const Quatd& by, BodyDescription& body, Sym3<double>& m) const {
    body.orientation = normalized(body.orientation * by);
    m = seen_from(conjugate(placement_.pose.orientation) * body.orientation, cluster.inertia);
  }

  double bounding_size(const BodyDescription& body) const {
    return shape_card(body.shape.kind).bounding_radius(body.shape, mesh_of(scene_, body.shape));
  }

  void add_joint(const UrdfJoint& from) {
    const std::size_t parent = cluster_of_[from.parent], child = cluster_of_[from.child];
    if (parent == child || from.kind == UrdfJointKind::floating) return;
    Joint joint;
    joint.bodies = {body_of_link_[from.parent], body_of_link_[from.child]};
    const UrdfPose at = in_world(poses_[from.child]);
    joint.anchor = at.position;
    joint.kind = kind_of_joint(from);
    if (can_be_driven(from)) {
      // A joint's motion leaves its own axis where it was.
      joint.axis = normalized(rotate(at.orientation, from.axis));
      const double start = position_of(from, placement_);
      for (std::size_t k = 0; k < 2; ++k) joint.limits[k] = from.limits[k] - start;
      joint.friction = from.friction;
      set_motor(from, start, joint);
    }
    if (const auto fault = joint_fault(scene_, joint))
      throw InputError(fmt::format("{}: as a joint: {}", from.place,
                                   fault_text(fault->field, fault->value, fault->expected)));
    result_.joints[from.name] = static_cast<int>(scene_.joints.size());
    scene_.joints.push_back(joint);
  }

  void set_motor(const UrdfJoint& from, double start, Joint& joint) {
    const auto found = placement_.motors.find(from.name);
    if (found == placement_.motors.end()) {
      if (from.damping > 0) {
        JointMotor damper;
        damper.damping = from.damping;
        joint.motor = damper;
      }
      return;
    }
    JointMotor motor = found->second;
    if (!motor.force) {
      motor.position -= start;
      if (std::isinf(motor.max_force)) motor.max_force = from.effort;
    }
    if (!motor.keeps_speed())
      motor.damping += from.damping;
    else if (from.damping > 0)
      result_.notes.push_back(
          fmt::format("the motor of joint \"{}\" keeps a speed, so its damping does nothing",
                      printable(from.name, 60)));
    joint.motor = motor;
  }

  Scene& scene_;
  const UrdfModel& model_;
  UrdfPlacement placement_;
  UrdfBodies result_;
  std::vector<UrdfPose> poses_;  ///< of the links, frame of the root
  std::vector<Cluster> clusters_;
  std::vector<std::size_t> cluster_of_;
  std::vector<int> body_of_link_;
  std::map<std::string, int> names_;  ///< of links with a body
};

std::optional<Fault> motor_fault(const UrdfJoint& joint, const JointMotor& motor) {
  const std::string path = fmt::format("motors.{}", printable(joint.name, 60));
  if (joint.effort == 0)
    return Fault{path, "a motor", "the effort of this joint is 0 in the URDF file"};
  if (motor.keeps_speed() && std::abs(motor.speed) > joint.velocity)
    return Fault{path + ".speed", fmt::format("{:g}", motor.speed),
                 fmt::format("the velocity of this joint is limited to {:g} [rad/s, or m/s]",
                             joint.velocity)};
  const auto effort_fault = [&](const char* key, double value) {
    return Fault{
        fmt::format("{}.{}", path, key), fmt::format("{:g}", value),
        fmt::format("the effort of this joint is limited to {:g} [N m, or N]", joint.effort)};
  };
  if (!std::isinf(motor.max_force) && motor.max_force > joint.effort)
    return effort_fault("max_force", motor.max_force);
  if (motor.force && std::abs(*motor.force) > joint.effort)
    return effort_fault(joint_card(kind_of_joint(joint)).drive, *motor.force);
  return std::nullopt;
}

/// Null: there is none that can be driven.
const UrdfJoint* driven_joint(const UrdfModel& model, const std::string& name) {
  for (const UrdfJoint& joint : model.joints)
    if (joint.name == name && can_be_driven(joint)) return &joint;
  return nullptr;
}

}  // namespace

std::optional<Fault> placement_fault(const UrdfModel& model, const UrdfPlacement& placement) {
  const auto unknown = [&](const char* key, const std::string& name) {
    return Fault{
        fmt::format("{}.{}", key, printable(name, 60)), "this name",
        fmt::format("{} has no revolute, continuous or prismatic joint so called", model.file)};
  };
  for (const auto& [name, position] : placement.joint_positions) {
    const UrdfJoint* joint = driven_joint(model, name);
    if (joint == nullptr) return unknown("joint_positions", name);
    if (!(position >= joint->limits[0] && position <= joint->limits[1] && std::isfinite(position)))
      return Fault{
          fmt::format("joint_positions.{}", printable(name, 60)), fmt::format("{:g}", position),
          fmt::format("must be from {:g} to {:g} [rad, or m]", joint->limits[0], joint->limits[1])};
  }
  for (const UrdfJoint& joint : model.joints)
    if (can_be_driven(joint) && placement.joint_positions.count(joint.name) == 0 &&
        !(0 >= joint.limits[0] && 0 <= joint.limits[1]))
      return Fault{
          fmt::format("joint_positions.{}", printable(joint.name, 60)), "0, the default,",
          fmt::format("must be from {:g} to {:g} [rad, or m]", joint.limits[0], joint.limits[1])};
  if (placement.fixed_base && norm2(placement.velocity) + norm2(placement.angular_velocity) > 0)
    return Fault{"velocity", vector_text(placement.velocity),
                 "must be 0, as the angular velocity, where the base is fixed"};
  for (const auto& [name, motor] : placement.motors) {
    const UrdfJoint* joint = driven_joint(model, name);
    if (joint == nullptr) return unknown("motors", name);
    if (auto fault = motor_fault(*joint, motor)) return fault;
  }
  for (const auto& surface : placement.surfaces) {
    const std::string& name = surface.first;
    if (std::none_of(model.links.begin(), model.links.end(),
                     [&](const UrdfLink& link) { return link.name == name; }))
      return Fault{fmt::format("links.{}", printable(name, 60)), "this name",
                   fmt::format("{} has no link so called", model.file)};
  }
  return std::nullopt;
}

const char* urdf_motor_key(const UrdfModel& model, const std::string& name) {
  const UrdfJoint* const joint = driven_joint(model, name);
  return joint == nullptr ? nullptr : joint_card(kind_of_joint(*joint)).drive;
}

UrdfBodies add_urdf(Scene& scene, const UrdfModel& model, const UrdfPlacement& placement) {
  if (model.links.empty()) throw InputError("a URDF model without links");
  if (const auto fault = placement_fault(model, placement))
    throw InputError(
        fmt::format("{}: {}", model.file, fault_text(fault->field, fault->value, fault->expected)));
  return Builder(scene, model, placement).build();
}

}  // namespace scree
