#pragma once
// What pair functions need of a body.
//
// A pair function is a struct named like its file, with the shapes it serves as A and B:
// - Two bodies, or a body and a solid wall: contact(a, b, d, feature) with d from the center of A to that of B, and
//   kFeatureBits. With zero bits there is one contact. Else manifold(a, b, d, most, listed) finds those that are
//   listed; contact() gives the geometry of each from its feature alone. Where that takes long, it is in parts:
//   search(a, b, d, most, before) tells how the two lie; finish(a, b, d, search), if there is one, goes on where that is_open(),
//   which takes longer if it is_deep(), and pass(a, b, d, search) where it may_pass after that; contacts(a, b, d, search, most,
//   listed, emit) calls emit(feature, contact), features ascending, and takes longer if the search has_facet. A Search is_beyond()
//   where they are farther apart than was asked for, and holds(most) if one for that would find the same.
// - A body and a plane, B a half-space: contact(a, height, normal, d, corner) and kCorners, so many for each plane.
//   Faces of containers are planes, too.
// - A convex body and a mesh, B a mesh: kTriangleBits, bits that tell its contacts with one triangle apart, and a
//   core (convex_shapes.h). ConvexOnMesh does the rest.
// Shapes with a core have pair functions in one line each: ConvexPair and MeshPair.
// The list of kernels/CMakeLists.txt names them.

#include "kernels/bodies/hull.h"
#include "kernels/narrow_phase/pairs/contact_geometry.h"
#include "shapes/shape_kind.h"

namespace scree {

/// One of the two.
struct PairSide {
  double radius = 0;  ///< of a sphere [m]
  Quatd orientation;
  Vec3d half_extents;  ///< of the box about it, or about its core [m]
  ShapeKind kind = kNoShape;
  Hull hull;                      ///< of a hull, or one that is rounded
  Rounding<double> rounded = {};  ///< of a rounded shape
  Vec3d way = {};  ///< of side B: how far it goes in the step relative to A, see relative_way() [m]
};

}  // namespace scree
