#pragma once
// Robots and vehicles from URDF files, for scenes in code.

#include <array>
#include <cstddef>
#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "host/scene.h"

namespace scree {

/// A frame in another.
struct UrdfPose {
  Vec3d position;     ///< [m]
  Quatd orientation;  ///< from the one to the other
};

struct UrdfCollision {
  UrdfPose pose;              ///< in the frame of the link
  Shape shape;                ///< a hull has no sizes yet
  std::vector<Vec3d> points;  ///< of a hull, in the frame of the collision [m]
};

struct UrdfLink {
  std::string name;
  std::string place;  ///< "rover.urdf: line 12: link \"wheel\"", for messages
  double mass = 0;    ///< [kg]; 0: none
  UrdfPose center;    ///< center of mass and principal axes, in the frame of the link
  Vec3d inertia;      ///< principal moments [kg m^2]
  std::vector<UrdfCollision> collisions;
};

enum class UrdfJointKind { fixed, revolute, continuous, prismatic, floating };

struct UrdfJoint {
  std::string name;
  std::string place;  ///< for messages
  UrdfJointKind kind = UrdfJointKind::fixed;
  std::size_t parent = 0;  ///< index of a link
  std::size_t child = 0;
  UrdfPose origin;      ///< of the joint, in the frame of the parent
  Vec3d axis{1, 0, 0};  ///< unit, frame of the joint
  std::array<double, 2> limits{-std::numeric_limits<double>::infinity(),
                               std::numeric_limits<double>::infinity()};  ///< [rad], [m]
  /// Most that a motor gives [N m], [N].
  double effort = std::numeric_limits<double>::infinity();
  /// Most that a motor keeps [rad/s], [m/s].
  double velocity = std::numeric_limits<double>::infinity();
  double damping = 0;   ///< [N m s/rad], [N s/m]
  double friction = 0;  ///< [N m], [N]
};

/// What a URDF file says. Parents come before their children.
struct UrdfModel {
  std::string name;
  std::string file;  ///< for messages
  std::vector<UrdfLink> links;
  std::vector<UrdfJoint> joints;        ///< the one whose child is links[k + 1] at k
  std::map<std::string, int> not_read;  ///< elements that say nothing here, and how often
};

/// Reads and checks a URDF file.
/// @throws InputError naming file, line, element and value; also when scree was built without tinyxml2
UrdfModel read_urdf(const std::filesystem::path& file);

/// The same for a text already in memory.
/// @param file  how messages name it; meshes are relative to its folder
UrdfModel parse_urdf(const std::string& text, const std::filesystem::path& file);

/// What a scene says of the surface of a link.
struct UrdfSurface {
  int material = 0;  ///< index into Scene::materials
  int group = 0;     ///< index into Scene::groups
};

/// Where and how a model stands in a scene.
struct UrdfPlacement {
  /// Of this copy: its bodies are called NAME/LINK. Empty: that of the model.
  std::string name = {};
  UrdfPose pose = {};           ///< of the root link
  Vec3d velocity = {};          ///< of the root link, and of all others with it [m/s]
  Vec3d angular_velocity = {};  ///< about the origin of the root link, world [rad/s]
  bool fixed_base = false;      ///< the root link rests; so it does where its name is "world"
  UrdfSurface surface = {};
  std::map<std::string, UrdfSurface> surfaces = {};    ///< of links that have another
  std::map<std::string, double> joint_positions = {};  ///< at the start, else 0 [rad], [m]
  /// By joint. Their position is one of the joint, as its limits are. Those with a speed or a position and
  /// without a largest force have the effort of the joint.
  std::map<std::string, JointMotor> motors = {};
};

/// What came in.
struct UrdfBodies {
  int first_body = 0;  ///< in Scene::bodies
  int body_count = 0;
  int first_joint = 0;  ///< in Scene::joints
  int joint_count = 0;
  double mass = 0;                         ///< of the free bodies [kg]
  std::map<std::string, int> joints = {};  ///< index in Scene::joints by name
  std::vector<std::string> notes = {};     ///< what of the placement does nothing
};

/// Adds a model to a scene: its links as bodies, and the joints between them. Links that fixed joints hold are one
/// body, whose shape is a compound where it has several. Links fixed to a root that rests are fixed bodies, one for
/// each collision. Scene::body_names has NAME/LINK for links with a body, so add models before there are names
/// of particles or of bodies that join later: these have higher ids.
/// @throws InputError naming what the engine cannot represent
UrdfBodies add_urdf(Scene& scene, const UrdfModel& model, const UrdfPlacement& placement = {});

}  // namespace scree
