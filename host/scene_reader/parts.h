#pragma once
// The parts of the scene reader, one function per part of the document.

#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include "host/scene.h"
#include "host/scene/convex_hull.h"
#include "host/scene/scene_checks.h"
#include "host/scene_reader/node.h"

namespace scree::reader {

/// A hull, compound or mesh that several bodies may have.
struct SharedShape {
  Shape shape;
  LocalFrame frame;  ///< of the body in that of the points, or parts
};

/// A scene being read.
struct Draft {
  Scene scene;
  std::map<std::string, SharedShape> shapes;  ///< by points, or parts
  LocalFrame shape_frame;  ///< of the shape read last: the frame of its body in that of the file
  std::map<double, Insertion> inserted;  ///< by time [s], which the values get at the end
  std::unordered_map<std::string, int> material_of_name;
  std::unordered_map<std::string, int> group_of_name;
  std::map<std::string, int> meshes;  ///< of height fields: file and options to index
  /// Of each entry of `bodies`: index in Scene::bodies, or kInserted.
  std::vector<int> body_of_entry;
  std::map<std::string, std::size_t> entry_of_name;  ///< of the bodies that have one
  std::vector<std::string> notes;                    ///< what other files came in as
};

/// In Draft::body_of_entry: a body that joins the run later.
inline constexpr int kInserted = -2;

/// Material named by the key "material" of the node; without the key, the one called "default", or
/// else the first.
int read_material(const Node& node, const Draft& draft);
/// Index of a material name. The node is blamed when there is none.
int material_index(const Node& node, const std::string& name, const Draft& draft);
/// Index of a group name, which is added when new.
int group_index(const std::string& name, Draft& draft);
/// Bits of Lock from "x" or ["x", "rz"].
std::uint8_t read_locks(const Node& node);

/// Whose shape the key "shape" names, which is a choice of shapes.
enum class Named {
  body,       ///< any
  free_body,  ///< one of those that can be free
  part        ///< the same, but for compounds
};

/// Shape that the key "shape" names, from the keys beside it.
/// @param position  of the body [m]; a shape may set it
void read_shape(const Node& node, Named named, Shape& shape, Vec3d& position, Draft& draft);
/// A shape of `parts`, and its frame in the draft.
void read_compound(const Node& node, bool is_free, Shape& shape, Draft& draft);
/// Index of the mesh of a height field.
int read_height_field(const Node& node, Draft& draft);
/// Reads "orientation" or "rotation_deg" where one is given.
void read_orientation(const Node& node, Quatd& orientation);
/// @param index  position in the list `bodies`
void read_body(const Node& node, std::size_t index, Draft& draft);
/// An entry of `urdf`; all of `bodies` were read.
void read_urdf_entry(const Node& node, Draft& draft);
/// @param force_key  of what it gives whatever the speed: "torque" or "force", as the joint turns or moves
JointMotor read_joint_motor(const Node& node, const std::string& force_key);
/// Index in Scene::bodies of one that is there from the start, by its name or number, or kWorldBody.
int read_held_body(const Node& node, const Draft& draft);
/// An entry of `attachments`; all bodies were read.
void read_attachment(const Node& node, Draft& draft);
/// An entry of `joints`; all bodies were read.
void read_joint(const Node& node, Draft& draft);
void read_motion(const Node& node, Motion& motion);
/// @param index  position in the list `particles`, which selects the random sequence
void read_particles(const Node& node, std::size_t index, Draft& draft);

void read_materials(const Node& scene, Draft& draft);
void read_dynamics(const Node& node, DynamicsSettings& dynamics);
void read_output(const Node& node, OutputSettings& output);
void read_settings(const Node& scene, Scene& result);  ///< all but materials, bodies, particles

}  // namespace scree::reader
