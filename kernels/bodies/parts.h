#pragma once
// Bodies and their parts. Collision detection and pictures see the parts of compounds, and all other bodies as one part
// each; contacts and velocities are those of bodies.

#include "kernels/bodies/body_view.h"
#include "shapes/compound.h"

namespace scree {

/// A part of a compound of the run, in the frame of its body.
template <class Real>
struct PartRecord {
  Index shape = -1;  ///< index of a ShapeRecord; -1: a sphere
  Real radius = 0;   ///< of the sphere about it [m]
  Vec3<double> position;
  Quat<double> orientation;
};

/// The parts of all compounds of the run.
template <class Real>
struct PartSet {
  Span<const PartRecord<Real>> records;
  Span<const Index> first;  ///< [compounds + 1] ShapeRecord::mesh of a compound points here
};

/// Number of the compound that a body is; -1: it is none.
template <class Real>
SCREE_HD Index compound_of(const BodyView<Real>& bodies, Span<const ShapeRecord<Real>> shapes,
                           Index i) {
  const Index shape = bodies.shape[i];
  if (shape < 0 || shapes[shape].kind != shapes::Compound::kind) return -1;
  return shapes[shape].mesh;
}

/// Spheres about the centers of compounds that hold the spheres about their parts. Those about a body hold its surface only,
/// which takes less: corners of a hull are nearer to the center of the body than its center and radius tell.
template <class Real>
struct PartReach {
  Span<const ShapeRecord<Real>> shapes;  ///< that BodyView::shape points to
  Span<const double> radius;             ///< [compounds] [m]; empty: there are none

  /// Radius about body i that holds what collision detection sees of it [m].
  SCREE_HD double operator()(const BodyView<Real>& bodies, Index i) const {
    const double own = bodies.radius[i];
    if (radius.empty()) return own;
    const Index k = compound_of(bodies, shapes, i);
    return k >= 0 && radius[k] > own ? radius[k] : own;
  }
};

/// Parts as bodies of their own, in the order of storage: those of owned bodies, room, those of fixed ones.
template <class Real>
struct BodyParts {
  BodyView<Real> bodies;             ///< that have the parts
  Span<const Index> owner;           ///< body of each part; empty: bodies are their own parts
  Span<const Vec3<Real>> from_body;  ///< from the center of the body to that of the part [m]

  SCREE_HD bool is_used() const { return !owner.empty(); }
};

}  // namespace scree
