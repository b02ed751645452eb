// URDF files: what they say, checked. urdf_bodies.cpp makes bodies and joints of it.

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <set>

#include "host/error.h"
#include "host/io/printable.h"
#include "host/scene/mesh_reader.h"
#include "host/scene/scene_checks.h"
#include "host/scene/xml.h"
#include "host/urdf.h"
#include "shapes/box.h"
#include "shapes/capsule.h"
#include "shapes/cylinder.h"
#include "shapes/hull.h"
#include "shapes/sphere.h"

namespace scree {
namespace {

namespace fs = std::filesystem;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// An element that knows where it stands.
class Element {
 public:
  /// @param place  "rover.urdf: line 12: link \"wheel\""
  Element(const XmlElement& xml, std::string place) : xml_(&xml), place_(std::move(place)) {}

  const std::string& name() const { return xml_->name; }
  const std::string& place() const { return place_; }

  [[noreturn]] void fail(const std::string& text) const {
    throw InputError(fmt::format("{}: {}", place_, text));
  }
  [[noreturn]] void refuse(const char* key, const std::string& expected) const {
    fail(fmt::format("{} \"{}\" is not allowed: {}", key, printable(*xml_->attribute(key), 60),
                     expected));
  }

  bool has(const char* key) const { return xml_->attribute(key) != nullptr; }
  std::string text(const char* key, const char* expected) const {
    const std::string* value = xml_->attribute(key);
    if (value == nullptr) fail(fmt::format("{} is missing: {}", key, expected));
    if (value->empty()) refuse(key, expected);
    return *value;
  }
  /// Finite numbers with spaces between them.
  template <std::size_t N>
  std::array<double, N> numbers(const char* key, const char* expected) const {
    const std::string value = text(key, expected);
    std::array<double, N> out{};
    const char* at = value.data();
    const char* const end = at + value.size();
    const auto skip = [&] {
      while (at != end && std::isspace(static_cast<unsigned char>(*at)) != 0) ++at;
    };
    for (double& number : out) {
      skip();
      if (at != end && *at == '+') ++at;
      const auto [rest, error] = std::from_chars(at, end, number);
      const bool ends = rest == end || std::isspace(static_cast<unsigned char>(*rest)) != 0;
      if (error != std::errc{} || !ends || !std::isfinite(number)) refuse(key, expected);
      at = rest;
    }
    skip();
    if (at != end) refuse(key, expected);
    return out;
  }
  double number(const char* key, const char* expected) const {
    return numbers<1>(key, expected)[0];
  }
  double positive(const char* key, const char* expected) const {
    const double value = number(key, expected);
    if (!(value > 0)) refuse(key, expected);
    return value;
  }
  double non_negative(const char* key, double otherwise, const char* expected) const {
    if (!has(key)) return otherwise;
    const double value = number(key, expected);
    if (!(value >= 0)) refuse(key, expected);
    return value;
  }
  Vec3d vector(const char* key, const char* expected) const {
    const auto [x, y, z] = numbers<3>(key, expected);
    return {x, y, z};
  }

  /// Children of a name, with their line.
  std::vector<Element> all(const char* child) const {
    std::vector<Element> out;
    for (const XmlElement& one : xml_->children)
      if (one.name == child) out.push_back(below(one));
    return out;
  }
  std::optional<Element> find(const char* child) const {
    const std::vector<Element> found = all(child);
    if (found.size() > 1) found[1].fail("must be there once");
    if (found.empty()) return std::nullopt;
    return found[0];
  }
  std::vector<Element> children() const {
    std::vector<Element> out;
    for (const XmlElement& one : xml_->children) out.push_back(below(one));
    return out;
  }
  const XmlElement& xml() const { return *xml_; }

 private:
  Element below(const XmlElement& one) const {
    return Element(one, fmt::format("{}: <{}>", place_, printable(one.name, 40)));
  }

  const XmlElement* xml_;
  std::string place_;
};

Quatd turned(const Vec3d& axis, double angle) { return exp_map(angle * axis); }

UrdfPose read_origin(const Element& element) {
  UrdfPose pose;
  const auto origin = element.find("origin");
  if (!origin) return pose;
  if (origin->has("xyz")) pose.position = origin->vector("xyz", "must be three numbers [m]");
  if (origin->has("rpy")) {
    const Vec3d angles = origin->vector("rpy", "must be three angles [rad]");
    // Turned about the fixed axes x, y and z, one after the other.
    pose.orientation = normalized(turned({0, 0, 1}, angles.z) * turned({0, 1, 0}, angles.y) *
                                  turned({1, 0, 0}, angles.x));
  }
  return pose;
}

Quatd quaternion_of(Eigen::Matrix3d axes) {
  if (axes.determinant() < 0) axes.col(2) *= -1;
  const Eigen::Quaterniond q(axes);
  return normalized(Quatd{q.w(), q.x(), q.y(), q.z()});
}

void read_inertial(const Element& element, UrdfLink& link) {
  const auto mass = element.find("mass");
  if (!mass) element.fail("<mass> is missing: must have a value [kg]");
  link.mass = mass->number("value", "must be zero or positive [kg]");
  if (link.mass < 0) mass->refuse("value", "must be zero or positive [kg]");
  if (link.mass == 0) return;  // such links are frames only, whatever their inertia is
  link.center = read_origin(element);
  const auto inertia = element.find("inertia");
  if (!inertia)
    element.fail("<inertia> is missing: must have ixx, ixy, ixz, iyy, iyz, izz [kg m^2]");
  const auto entry = [&](const char* key) {
    return inertia->number(key, "must be a number [kg m^2]");
  };
  const auto mixed = [&](const char* key) { return inertia->has(key) ? entry(key) : 0.0; };
  Eigen::Matrix3d tensor;
  tensor(0, 0) = entry("ixx"), tensor(1, 1) = entry("iyy"), tensor(2, 2) = entry("izz");
  tensor(0, 1) = tensor(1, 0) = mixed("ixy");
  tensor(0, 2) = tensor(2, 0) = mixed("ixz");
  tensor(1, 2) = tensor(2, 1) = mixed("iyz");
  Vec3d moments{tensor(0, 0), tensor(1, 1), tensor(2, 2)};
  if (!tensor.isDiagonal(0)) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(tensor);
    const Eigen::Vector3d& values = solver.eigenvalues();
    moments = {values(0), values(1), values(2)};
    link.center.orientation = link.center.orientation * quaternion_of(solver.eigenvectors());
  }
  const double least = std::min({moments.x, moments.y, moments.z});
  const double most = std::max({moments.x, moments.y, moments.z});
  if (!(least > 1e-12 * most))
    inertia->fail(
        fmt::format("ixx {:g}, ixy {:g}, ixz {:g}, iyy {:g}, iyz {:g}, izz {:g} is not "
                    "allowed: must be positive definite; the principal moments are {:g} "
                    "to {:g} [kg m^2]",
                    tensor(0, 0), tensor(0, 1), tensor(0, 2), tensor(1, 1), tensor(1, 2),
                    tensor(2, 2), least, most));
  link.inertia = moments;
}

/// The file that a mesh names: relative to the URDF file, or package://PACKAGE/PATH, where PACKAGE is a folder
/// above the URDF file or in one of these.
fs::path mesh_file(const Element& mesh, const fs::path& urdf) {
  const std::string name = mesh.text("filename", "must be the name of an .stl or .obj file");
  std::error_code error;
  const auto is_there = [&](const fs::path& path) { return fs::is_regular_file(path, error); };
  const fs::path folder = urdf.parent_path();
  constexpr std::string_view package = "package://", file = "file://";
  if (!name.starts_with(package)) {
    fs::path path = folder / (name.starts_with(file) ? name.substr(file.size()) : name);
    if (!is_there(path))
      mesh.refuse("filename", fmt::format("no such file (looked for {})", path.string()));
    return path;
  }
  const fs::path rest = name.substr(package.size());
  const fs::path within = rest.lexically_relative(*rest.begin());
  for (fs::path above = fs::absolute(folder).lexically_normal();; above = above.parent_path()) {
    const fs::path base = above.filename().empty() ? above.parent_path() : above;
    if (base.filename() == *rest.begin() && is_there(base / within)) return base / within;
    if (is_there(base / rest)) return base / rest;
    if (above == above.parent_path()) break;
  }
  mesh.refuse("filename", fmt::format("no folder from {} upward has such a file",
                                      fs::absolute(folder).string()));
}

void read_mesh_collision(const Element& mesh, const fs::path& urdf, UrdfCollision& collision) {
  const char* const scales = "must be three factors other than zero";
  Vec3d scale{1, 1, 1};
  if (mesh.has("scale")) {
    scale = mesh.vector("scale", scales);
    // A negative factor mirrors: the hull of points has no sense that it could turn.
    if (scale.x == 0 || scale.y == 0 || scale.z == 0) mesh.refuse("scale", scales);
  }
  collision.shape.kind = shapes::Hull::kind;
  MeshOptions options;
  options.closed = false;  // only its vertices count
  try {
    collision.points = read_mesh(mesh_file(mesh, urdf), options).vertices;
  } catch (const InputError& error) {
    const std::string text = error.what();
    if (text.starts_with(mesh.place())) throw;
    mesh.fail(text);
  }
  for (Vec3d& v : collision.points) v = {scale.x * v.x, scale.y * v.y, scale.z * v.z};
}

UrdfCollision read_collision(const Element& element, const fs::path& urdf) {
  UrdfCollision collision;
  collision.pose = read_origin(element);
  const auto geometry = element.find("geometry");
  if (!geometry) element.fail("<geometry> is missing");
  const std::vector<Element> all = geometry->children();
  if (all.size() != 1)
    geometry->fail(fmt::format("{} elements: must hold one of box, cylinder, sphere, capsule, mesh",
                               all.size()));
  const Element& one = all[0];
  Shape& shape = collision.shape;
  const char* const length = "must be positive [m]";
  if (one.name() == "box") {
    shape.kind = shapes::Box::kind;
    const Vec3d edges = one.vector("size", "must be three positive edges [m]");
    if (!(edges.x > 0 && edges.y > 0 && edges.z > 0))
      one.refuse("size", "must be three positive edges [m]");
    shape.half_extents = 0.5 * edges;
  } else if (one.name() == "sphere") {
    shape.kind = shapes::Sphere::kind;
    shape.radius = one.positive("radius", length);
  } else if (one.name() == "cylinder") {
    shape.kind = shapes::Cylinder::kind;
    const double r = one.positive("radius", length);
    shape.half_extents = {r, r, 0.5 * one.positive("length", length)};
  } else if (one.name() == "capsule") {
    shape.kind = shapes::Capsule::kind;
    const double r = one.positive("radius", length);
    shape.half_extents = {r, r, r + 0.5 * one.positive("length", length)};
  } else if (one.name() == "mesh") {
    read_mesh_collision(one, urdf, collision);
  } else {
    geometry->fail(
        fmt::format("<{}> is not a known shape: must be box, cylinder, sphere, capsule or mesh",
                    printable(one.name(), 40)));
  }
  return collision;
}

class UrdfReader {
 public:
  explicit UrdfReader(const fs::path& file) : file_(file) { model_.file = file.string(); }

  UrdfModel read(const XmlElement& xml) {
    const Element root(
        xml, fmt::format("{}: line {}: <{}>", model_.file, xml.line, printable(xml.name, 40)));
    if (root.name() != "robot") root.fail("the root of a URDF file must be <robot>");
    model_.name = root.text("name", "a robot must have a name");
    for (const XmlElement& child : xml.children) {
      if (child.name == "link")
        read_link(named(child, "link", links_, static_cast<int>(model_.links.size())));
      else if (child.name == "joint")
        joint_elements_.push_back(&child);
      else if (child.name.starts_with("xacro:"))
        Element(child, fmt::format("{}: line {}: <{}>", model_.file, child.line,
                                   printable(child.name, 40)))
            .fail("is a macro: expand the file with xacro first");
      else
        ++model_.not_read[printable(child.name, 40)];
    }
    if (model_.links.empty()) root.fail("no <link>");
    for (const XmlElement* joint : joint_elements_)
      read_joint(named(*joint, "joint", joint_names_, static_cast<int>(model_.joints.size())));
    put_in_order(root);
    return std::move(model_);
  }

 private:
  /// An element with a name of its own.
  Element named(const XmlElement& xml, const char* what, std::map<std::string, int>& names,
                int number) {
    const std::string start = fmt::format("{}: line {}: ", model_.file, xml.line);
    const std::string name = Element(xml, start + what).text("name", "must have a name");
    Element element(xml, fmt::format("{}{} \"{}\"", start, what, printable(name, 60)));
    if (!names.emplace(name, number).second)
      element.fail(fmt::format("a second {} of this name", what));
    return element;
  }

  void read_link(const Element& element) {
    UrdfLink link;
    link.name = *element.xml().attribute("name");
    link.place = element.place();
    if (const auto inertial = element.find("inertial")) read_inertial(*inertial, link);
    for (const Element& collision : element.all("collision"))
      link.collisions.push_back(read_collision(collision, file_));
    count_others(element, {"inertial", "collision"});
    model_.links.push_back(std::move(link));
  }

  std::size_t link_of(const Element& joint, const char* end) const {
    const auto element = joint.find(end);
    if (!element) joint.fail(fmt::format("<{}> is missing: must name a link", end));
    const std::string name = element->text("link", "must name a link");
    const auto found = links_.find(name);
    if (found == links_.end()) element->refuse("link", "no link has this name");
    return static_cast<std::size_t>(found->second);
  }

  void read_joint(const Element& element) {
    UrdfJoint joint;
    joint.name = *element.xml().attribute("name");
    joint.place = element.place();
    const char* const types = "must be one of fixed, revolute, continuous, prismatic, floating";
    const std::string type = element.text("type", types);
    if (type == "planar")
      element.refuse("type", "planar joints are not represented; take two prismatic ones");
    const std::vector<std::pair<const char*, UrdfJointKind>> kinds{
        {"fixed", UrdfJointKind::fixed},
        {"revolute", UrdfJointKind::revolute},
        {"continuous", UrdfJointKind::continuous},
        {"prismatic", UrdfJointKind::prismatic},
        {"floating", UrdfJointKind::floating}};
    const auto kind = std::find_if(kinds.begin(), kinds.end(),
                                   [&](const auto& one) { return type == one.first; });
    if (kind == kinds.end()) element.refuse("type", types);
    joint.kind = kind->second;
    joint.parent = link_of(element, "parent");
    joint.child = link_of(element, "child");
    joint.origin = read_origin(element);
    if (element.find("mimic"))
      element.fail(
          "<mimic> is not represented: joints do not follow each other; drive both by motors");
    if (joint.kind != UrdfJointKind::fixed && joint.kind != UrdfJointKind::floating)
      read_drive(element, joint);
    count_others(element, {"parent", "child", "origin", "axis", "limit", "dynamics"});
    model_.joints.push_back(std::move(joint));
  }

  static void read_drive(const Element& element, UrdfJoint& joint) {
    if (const auto axis = element.find("axis")) {
      const Vec3d direction = axis->vector("xyz", "must be a direction, three numbers");
      const double length = norm(direction);
      if (!(length > 0) || !std::isfinite(length))
        axis->refuse("xyz", "must be a direction, not of zero length");
      joint.axis = direction * (1 / length);
    }
    const auto limit = element.find("limit");
    const bool has_ends = joint.kind != UrdfJointKind::continuous;
    if (!limit && has_ends)
      element.fail("<limit> is missing: a revolute or prismatic joint must have one");
    if (limit) {
      const char* const end = "must be a number [rad], or [m]";
      if (has_ends) {
        joint.limits = {limit->has("lower") ? limit->number("lower", end) : 0,
                        limit->has("upper") ? limit->number("upper", end) : 0};
        if (joint.limits[0] > joint.limits[1])
          limit->fail(fmt::format(
              "lower {:g} and upper {:g} are not allowed: lower must not be above upper",
              joint.limits[0], joint.limits[1]));
      }
      joint.effort =
          limit->non_negative("effort", kInfinite, "must be zero or positive [N m], or [N]");
      joint.velocity =
          limit->non_negative("velocity", kInfinite, "must be zero or positive [rad/s], or [m/s]");
    }
    if (const auto dynamics = element.find("dynamics")) {
      joint.damping =
          dynamics->non_negative("damping", 0, "must be zero or positive [N m s/rad], or [N s/m]");
      joint.friction =
          dynamics->non_negative("friction", 0, "must be zero or positive [N m], or [N]");
    }
  }

  /// Notes what else an element holds.
  void count_others(const Element& element, const std::set<std::string>& known) {
    for (const XmlElement& child : element.xml().children)
      if (!known.contains(child.name)) ++model_.not_read[printable(child.name, 40)];
  }

  /// Links from the root on, each with the joint above it: the joints must make a tree.
  void put_in_order(const Element& root) {
    const std::size_t count = model_.links.size();
    std::vector<int> joint_of_child(count, -1);
    for (std::size_t k = 0; k < model_.joints.size(); ++k) {
      const UrdfJoint& joint = model_.joints[k];
      if (joint.parent == joint.child)
        throw InputError(joint.place + ": its parent and its child are one link");
      int& above = joint_of_child[joint.child];
      if (above >= 0)
        throw InputError(fmt::format(
            "{}: the link \"{}\" is the child of joint \"{}\" already: a link has one parent",
            joint.place, printable(model_.links[joint.child].name, 60),
            printable(model_.joints[static_cast<std::size_t>(above)].name, 60)));
      above = static_cast<int>(k);
    }
    std::vector<std::vector<std::size_t>> joints_of(count);
    for (std::size_t k = 0; k < model_.joints.size(); ++k)
      joints_of[model_.joints[k].parent].push_back(k);
    std::vector<std::size_t> order;  // old numbers
    for (std::size_t i = 0; i < count; ++i) {
      if (joint_of_child[i] >= 0) continue;
      if (!order.empty())
        throw InputError(fmt::format(
            "{}: no joint leads to it, nor to link \"{}\": the links of a robot must be one tree",
            model_.links[i].place, printable(model_.links[order[0]].name, 60)));
      order.push_back(i);
    }
    if (order.empty()) root.fail("the joints go round in a circle: one link must have no parent");
    for (std::size_t k = 0; k < order.size(); ++k)
      for (const std::size_t joint : joints_of[order[k]])
        order.push_back(model_.joints[joint].child);
    std::vector<std::size_t> place(count, count);
    for (std::size_t k = 0; k < order.size(); ++k) place[order[k]] = k;
    for (std::size_t i = 0; i < count; ++i)
      if (place[i] == count)
        throw InputError(model_.links[i].place + ": the joints to it go round in a circle");
    std::vector<UrdfLink> links;
    std::vector<UrdfJoint> joints;
    for (const std::size_t i : order) {
      if (!links.empty()) {
        joints.push_back(std::move(model_.joints[static_cast<std::size_t>(joint_of_child[i])]));
        joints.back().parent = place[joints.back().parent];
        joints.back().child = place[joints.back().child];
      }
      links.push_back(std::move(model_.links[i]));
    }
    model_.links = std::move(links);
    model_.joints = std::move(joints);
  }

  fs::path file_;
  UrdfModel model_;
  std::map<std::string, int> links_, joint_names_;
  std::vector<const XmlElement*> joint_elements_;
};

}  // namespace

UrdfModel parse_urdf(const std::string& text, const fs::path& file) {
  return UrdfReader(file).read(parse_xml(text, file.string()));
}

UrdfModel read_urdf(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) throw InputError(file.string() + ": no such file");
  std::ifstream stream(file, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream) throw InputError(file.string() + ": cannot be read");
  return parse_urdf(text, file);
}

}  // namespace scree
