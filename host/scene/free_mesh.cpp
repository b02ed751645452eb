#include "host/scene/free_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "shapes/mesh.h"

namespace scree {
namespace {

/// By so much, in sizes of the mesh, frames may be off that did not come from here.
constexpr double kFrameTolerance = 1e-6;
/// Of the cube of the size, and of its square: less volume, or less of a second moment, is none.
constexpr double kFlat = 1e-13;

double size_of(const TriangleMesh& mesh) {
  Vec3d low = mesh.vertices.at(0), high = low;
  for (const Vec3d& v : mesh.vertices)
    for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], v[k]), high[k] = std::max(high[k], v[k]);
  return norm(high - low);
}

bool has_solid(const SolidMoments& solid, double size) {
  if (!(solid.volume > kFlat * size * size * size)) return false;
  // Of a surface with holes the mean of x_i x_i need not be positive.
  const LocalFrame frame = principal_frame(solid);
  for (const Vec3d axis : {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}}) {
    const Vec3d n = rotate(frame.axes, axis);
    double second = 0;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        second +=
            n[i] * n[j] * solid.second[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    if (!(second > kFlat * size * size)) return false;
  }
  return true;
}

}  // namespace

SolidMoments moments_inside(const TriangleMesh& mesh) {
  SolidMoments solid = moments_of(mesh);
  const double size = size_of(mesh);
  // A closed surface is done after one round. Holes are small where this converges at all.
  constexpr int kRounds = 30;
  for (int round = 0; round < kRounds && solid.volume > 0; ++round) {
    const Vec3d before = solid.center;
    solid = moments_about(mesh, before);
    if (!(norm(solid.center - before) > 1e-14 * size)) break;
  }
  return solid;
}

std::optional<LocalFrame> move_inside_to_principal_frame(TriangleMesh& mesh) {
  const SolidMoments solid = moments_inside(mesh);
  const double size = size_of(mesh);
  if (!has_solid(solid, size) ||
      norm(moments_about(mesh, solid.center).center - solid.center) > kFrameTolerance * size)
    return std::nullopt;
  const LocalFrame frame = principal_frame(solid);
  for (std::vector<Vec3d>* points : {&mesh.vertices, &mesh.inner})
    for (Vec3d& v : *points) v = rotate_back(frame.axes, v - frame.origin);
  return frame;
}

std::optional<std::string> free_mesh_fault(const TriangleMesh& mesh) {
  const double size = size_of(mesh);
  const SolidMoments solid = moments_about(mesh, {});
  if (!has_solid(solid, size)) return "has no solid inside";
  if (norm(solid.center) > kFrameTolerance * size) return "has its center of mass off the origin";
  for (const auto& [i, j] : {std::pair{0, 1}, {1, 2}, {2, 0}}) {
    const double mixed = solid.second[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    if (std::abs(mixed) > kFrameTolerance * size * size) return "has principal axes of its own";
  }
  return std::nullopt;
}

void set_free_mesh(Scene& scene, BodyDescription& body, TriangleMesh mesh) {
  const auto frame = mesh.vertices.empty() ? std::nullopt : move_inside_to_principal_frame(mesh);
  if (!frame) throw std::invalid_argument("the surface has no solid inside");
  body.position += rotate(body.orientation, frame->origin);
  body.orientation = body.orientation * frame->axes;
  shapes::Mesh::measure(mesh, body.shape);
  body.shape.mesh = static_cast<int>(scene.meshes.size());
  scene.meshes.push_back(std::move(mesh));
}

}  // namespace scree
