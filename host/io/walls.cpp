#include "host/io/walls.h"

#include <fmt/format.h>

#include <iterator>
#include <string>

#include "host/io/atomic_file.h"
#include "host/io/wall_surfaces.h"
#include "host/scene/motion.h"
#include "shapes/shape_card.h"

namespace scree {
namespace {

const char* name_of(const BodyDescription& body) {
  if (body.kind == BodyKind::kinematic) return "kinematic";
  return shape_card(body.shape.kind).name;
}

}  // namespace

bool write_walls(const std::filesystem::path& path, const Scene& scene) {
  std::string text = "# Fixed and kinematic bodies at time zero [m]\n";
  const auto out = std::back_inserter(text);
  int next_vertex = 1;  // the format counts from one over the whole file
  for (const WallSurface& wall : wall_surfaces(scene)) {
    const BodyDescription& body = scene.bodies[wall.body];
    const Pose at = pose_at(body, 0);
    fmt::format_to(out, "o body_{}_{}\n", wall.body, name_of(body));
    for (const Vec3d& v : wall.surface.vertices) {
      const Vec3d x = at.position + rotate(at.orientation, v);
      fmt::format_to(out, "v {:.9g} {:.9g} {:.9g}\n", x.x, x.y, x.z);
    }
    for (const std::vector<int>& face : wall.surface.faces) {
      text += 'f';
      for (const int vertex : face) fmt::format_to(out, " {}", vertex + next_vertex);
      text += '\n';
    }
    next_vertex += static_cast<int>(wall.surface.vertices.size());
  }
  if (next_vertex == 1) return false;
  write_file_atomically(path, text);
  return true;
}

}  // namespace scree
