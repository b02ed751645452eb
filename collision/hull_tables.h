#pragma once
// Prepares convex hulls for contact and pictures, once per run, on the host.

#include <vector>

#include "collision/mesh_topology.h"
#include "kernels/bodies/hull.h"

namespace scree {

/// All hulls, concatenated; see HullSet for the fields.
struct HullTables {
  std::vector<Vec3d> points;
  std::vector<std::uint32_t> first_face;
  std::vector<FaceAtPoint> face_at;
  std::vector<HullFace> faces;
  std::vector<std::uint32_t> corners;
  std::vector<HullInfo> hulls;
};

/// The tables, where they are.
inline HullSet view_of(const HullTables& t) {
  const auto whole = []<class T>(const std::vector<T>& v) {
    return Span<const T>(v.data(), static_cast<Offset>(v.size()));
  };
  return {whole(t.points), whole(t.first_face), whole(t.face_at),
          whole(t.faces),  whole(t.corners),    whole(t.hulls)};
}

/// Triangles that lie in one plane become one face; points within faces are left out.
/// @throws std::runtime_error for a surface that is not closed, or has fewer than four faces
HullTables build_hull_tables(const std::vector<MeshSource>& meshes);

}  // namespace scree
