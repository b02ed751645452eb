#pragma once
// Element programs between parts, of which contacts are found, and the bodies that have them.

#include "kernels/bodies/parts.h"

namespace scree {

/// Hands contacts of parts over to their bodies.
template <class Real>
struct MoveContactsToBodies {
  static constexpr const char* name = "move_contacts_to_bodies";
  BodyParts<Real> parts;
  Span<Index> body_a, body_b;
  Span<Vec3<Real>> arm_a, arm_b;

  SCREE_HD void operator()(Index c) const {
    const Index a = body_a[c], b = body_b[c];
    body_a[c] = parts.owner[a];
    body_b[c] = parts.owner[b];
    arm_a[c] += parts.from_body[a];
    arm_b[c] += parts.from_body[b];
  }
};

/// Gives parts the margins of their bodies.
struct SpreadToParts {
  static constexpr const char* name = "spread_to_parts";
  Span<const Index> owner;
  Span<const float> of_body;
  Span<float> of_part;
  SCREE_HD void operator()(Index p) const { of_part[p] = of_body[owner[p]]; }
};

}  // namespace scree
