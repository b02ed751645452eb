#pragma once
// Ways of several steps that near pairs are listed for. docs/theory.md, "Barrier contact".

#include "kernels/affine/potential.h"

namespace scree::affine {

/// Ways of bodies that go on to move as in a step, and as their velocity changes in it. Bytes: 600 a row.
struct SetWaysAhead {
  static constexpr const char* name = "affine_set_ways_ahead";
  Span<const Index> body_of_row;
  Span<const AffineVec> q, next;  ///< by body: before and after a step
  Span<const AffineVec> v;        ///< by body, before it
  double h = 0;                   ///< of a step [s]
  double steps = 1;
  Span<AffineVec> from, to;  ///< out, by body; those that rest are not written

  SCREE_HD void operator()(Index row) const {
    const Index b = body_of_row[row];
    const AffineVec way = next[b] - q[b], more = way - h * v[b];
    from[b] = q[b];
    to[b] = q[b] + steps * way + (0.5 * steps * (steps - 1)) * more;
  }
};

/// How far bodies are from listed ways. Bytes: 400 a row.
struct StrayOfBody {
  static constexpr const char* name = "affine_stray";
  Span<const BodyConstant> bodies;
  Span<const Index> body_of_row;
  Span<const AffineVec> q;  ///< by body
  ListedWays ways;

  SCREE_HD Strays operator()(Index row) const {
    const Index b = body_of_row[row];
    return ways.strays(b, bodies[b].radius, q[b]);
  }
};

}  // namespace scree::affine
