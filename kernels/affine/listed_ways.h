#pragma once
// Straight ways of bodies, which near pairs are listed for, and how far bodies are from them.

#include "kernels/affine/inertial_target.h"

namespace scree::affine {

/// How far bodies are from their ways, all at one time [m].
struct Strays {
  double here = 0;       ///< from where the ways are now
  double from_goal = 0;  ///< from where they are at the end of the step
  SCREE_HD double least() const { return here < from_goal ? here : from_goal; }
  SCREE_HD void combine(const Strays& o) {
    here = o.here > here ? o.here : here;
    from_goal = o.from_goal > from_goal ? o.from_goal : from_goal;
  }
};

/// Ways of bodies, all at one time that goes from 0 to 1.
struct ListedWays {
  Span<const AffineVec> from, to;  ///< by body
  double time = 0;                 ///< about where bodies are
  double goal = 1;                 ///< about where they are at the end of the step

  /// @param q  where the body is, or may be
  SCREE_HD Strays strays(Index body, double radius, const AffineVec& q) const {
    return {corner_way(q - at(body, time), radius), corner_way(q - at(body, goal), radius)};
  }

 private:
  SCREE_HD AffineVec at(Index body, double when) const {
    return from[body] + when * (to[body] - from[body]);
  }
};

}  // namespace scree::affine
