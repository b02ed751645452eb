#pragma once
// Bodies and their parts. Collision detection and pictures see the parts of compounds, and all other bodies as one part
// each; contacts and velocities are those of bodies.

#include "kernels/bodies/body_view.h"

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

/// Parts as bodies of their own, in the order of storage: those of owned bodies, room, those of fixed ones.
template <class Real>
struct BodyParts {
  BodyView<Real> bodies;             ///< that have the parts
  Span<const Index> owner;           ///< body of each part; empty: bodies are their own parts
  Span<const Vec3<Real>> from_body;  ///< from the center of the body to that of the part [m]

  SCREE_HD bool is_used() const { return !owner.empty(); }
};

}  // namespace scree
