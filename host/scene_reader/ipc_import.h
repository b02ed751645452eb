#pragma once
// A scene of rigid-ipc being read.

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/scene_reader/ipc_surface.h"
#include "host/scene_reader/parts.h"

namespace scree::ipc {

using reader::Node;

enum class Dialect { rigid_ipc, autodesk };

/// A body as joints name it, by the stem of its mesh.
struct NamedBody {
  int id = 0;      ///< in Scene::bodies
  Vec3d scale;     ///< of the coordinates of the mesh
  Vec3d position;  ///< of its origin, world [m]
  Quatd turn;      ///< mesh to world
};

struct Import {
  Dialect dialect = Dialect::rigid_ipc;
  double degree = 1;  ///< of angles [rad]
  double h = 0.01;    ///< time step [s]
  double end = 0;     ///< of the run [s]
  Scene scene;
  std::map<std::string, TriangleMesh> files;             ///< as they are, by path
  std::map<std::string, reader::SharedShape> shapes;     ///< by surface, scale and use
  std::map<std::string, std::vector<NamedBody>> bodies;  ///< by stem
  std::optional<Box> world;                              ///< about all bodies at the start
  int free = 0, fixed = 0, moved = 0, disabled = 0;      ///< how many there are
  int flat_triangles = 0, turned_surfaces = 0;           ///< in how many places it was put right
  std::map<std::string, int> not_used;                   ///< paths of keys, with how often
  std::vector<std::string> notes;
};

/// Notes the keys of an object that are none of these. @param path  how notes name the object
void note_other_keys(const Node& object, const std::string& path,
                     const std::vector<std::string>& known, Import& in);

/// An entry of `rigid_bodies`.
void read_ipc_body(const Node& node, int index, Import& in);
/// An entry of `linear_constraints`; all bodies were read.
void read_ipc_constraint(const Node& node, Import& in);

}  // namespace scree::ipc
