#pragma once
// Bodies that pass each other within a step.
//
// Contacts are along the normal that parts two bodies best at the start of the step. A body that slides over the seam of two
// others, or flies closely past an edge, would be stopped there: by the plane of a side, which it never reaches. Of all planes that part
// two bodies which move straight, they touch along that which they reach last, if they touch at all (the last of the separating axes
// to overlap). And any of them is safe: gap + h u_n >= 0 keeps bodies apart along n.
// So where a face parts two bodies at the start of the step, and longer than the plane between them does, it takes its place. Contacts
// with it are those of the end of the step, where one body is over the other, less the way that leads there.

#include "kernels/narrow_phase/pairs/contact_geometry.h"

namespace scree {

/// Compares planes that part two bodies.
struct Passing {
  /// Bodies that overlap by less than this part of the smaller one's least half thickness count as parted: what rests on
  /// two bodies lies a little deep in both.
  static constexpr double kGrazing = 1e-3;
  /// Ways that decide, in the same measure, and those along a plane: at rest corners would change from one plane to another.
  static constexpr double kLeastWay = 1e-4, kLeastSliding = 1e-5;
  /// Bodies slide along a plane that they come nearer by less than this part of the way to another.
  static constexpr double kSliding = 1e-2;
  /// Planes must be better by so much.
  static constexpr double kLater = 1 + 1e-3;
  /// Cosine of the least angle by which two planes differ.
  static constexpr double kSame = 1 - 1e-6;

  double thickness;  ///< least half thickness of the two bodies [m]

  SCREE_HD bool parts(double separation) const { return separation >= -kGrazing * thickness; }
  /// Whether bodies that come nearer so much along one plane, and so much along another, go far enough for the second one [m].
  SCREE_HD bool goes_far(double approach, double other) const {
    return approach > kLeastWay * thickness ||
           (approach > kLeastSliding * thickness && other < kSliding * approach);
  }
  /// When the bodies reach the plane, in steps.
  /// @param separation  along its normal [m]
  /// @param approach    the way that they come nearer along it in the step [m]
  SCREE_HD double time(double separation, double approach) const {
    const double least = 1e-12 * thickness;
    return (separation + kGrazing * thickness) / (approach > least ? approach : least);
  }
};

/// A contact of bodies at the end of the step, as one of the start. Its points lie over each other again, in the middle between where
/// both are: an impulse keeps the angular momentum.
/// @param way  of B relative to A in the step [m]
SCREE_HD inline ContactGeometry at_start(ContactGeometry g, const Vec3d& way) {
  const double along = dot(g.normal, way);
  const Vec3d aside = way - along * g.normal;
  g.gap -= along;
  g.arm_a -= 0.5 * aside;
  g.arm_b += 0.5 * aside;
  return g;
}

}  // namespace scree
