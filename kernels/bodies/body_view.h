#pragma once
// Bodies as structures of arrays, and records of the shapes that are not spheres.

#include "kernels/bodies/body_ranges.h"
#include "kernels/bodies/hull.h"
#include "kernels/bodies/per_body.h"
#include "kernels/math/quat.h"
#include "shapes/shape_kind.h"

namespace scree {

/// Geometry of a body that is not a sphere, in its body frame.
template <class Real>
struct ShapeRecord {
  ShapeKind kind = kNoShape;
  std::uint8_t open_faces = 0;  ///< container: bit 0..5 = -x +x -y +y -z +z face missing
  Index mesh = -1;              ///< mesh: index into MeshSetView::ranges; hull: into HullSet::hulls
  Index body = -1;              ///< storage index of the body that has this shape
  Vec3<Real> half_extents;      ///< of the box about it, or about its core [m]
  Real rounding = 0;            ///< by how much its vertices are rounded [m]
  Vec3<Real> normal;            ///< half_space: unit, bodies are on this side
  Rounding<Real> rounded;       ///< of a rounded shape

  /// Of the box about all of it [m].
  SCREE_HD Vec3<Real> reach() const {
    const Real more = rounded.reach();
    return half_extents + Vec3<Real>{more, more, more};
  }
};

/// What is known of shapes besides their kinds.
template <class Real>
struct ShapeSet {
  Span<const ShapeRecord<Real>> records;
  HullSet hulls;
};

struct TriangleIndices {
  Index v[3] = {0, 0, 0};
};

/// The triangles of one mesh inside the concatenated arrays of a MeshSetView.
struct MeshRange {
  Index first_triangle = 0;
  Index triangle_count = 0;
};

/// All meshes of a scene, concatenated; vertices in the frame of the body that carries the mesh.
template <class Real>
struct MeshSetView {
  Span<const Vec3<Real>> vertices;  ///< [m]
  /// Vertex indices into `vertices`, outside counter-clockwise.
  Span<const TriangleIndices> triangles;
  Span<const MeshRange> ranges;  ///< [mesh_count]
  HullSet hulls;
};

/// Bodies in storage, see BodyRanges; owned ones in Morton order. Free bodies are those that move.
template <class Real>
struct BodyView : BodyRanges {
  Span<Vec3<double>> position;        ///< center of mass, world [m]; always double
  Span<Quat<Real>> orientation;       ///< body to world, unit
  Span<Vec3<Real>> velocity;          ///< [m/s]
  Span<Vec3<Real>> angular_velocity;  ///< world frame [rad/s]
  Span<Index> id;                     ///< index in the scene; stable when storage is reordered
  PerBody<Real> inv_mass;             ///< [1/kg]; 0 for fixed and kinematic bodies
  /// Principal moments, body frame [kg m^2]; 0 when not free. Empty when all free bodies are solid
  /// spheres: see moments().
  Span<const Vec3<Real>> inertia;
  PerBody<Real> radius;  ///< sphere radius, else radius of the bounding sphere [m]; 0: unbounded
  PerBody<Index> shape;  ///< -1: sphere, else index of a ShapeRecord
  PerBody<std::uint8_t> locks;     ///< Lock bits (host/scene.h): x y z rx ry rz
  PerBody<std::uint8_t> material;  ///< index of the material
  PerBody<Index> group;            ///< index of the group, for colors and outputs

  /// Principal moments of body i, body frame [kg m^2]; 0 when not free.
  SCREE_HD Vec3<Real> moments(Index i) const {
    if (!inertia.empty()) return inertia[i];
    const Real m = inv_mass[i], r = radius[i];
    const Real solid = m > Real(0) ? Real(0.4) * r * r / m : Real(0);
    return {solid, solid, solid};
  }
};

}  // namespace scree
