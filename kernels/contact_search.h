#pragma once
// Finds the contacts of one body: a walk over the neighboring bins, then the walls.

#include "kernels/wall_contacts.h"

namespace scree {

/// Bins as the search reads them, positions in cell order.
struct BinView {
  const BinGrid* grid = nullptr;
  Span<const BinRecord> record;
  Span<const std::uint64_t> cell;
  Span<const Index> body;
  Span<const CellRange> cells;
};

/// Coordinates of the cells that overlap [x - reach, x + reach] along an axis, each once.
struct CellSpan {
  Index first;  ///< may be negative: coordinates wrap
  Index count;
  bool is_whole;  ///< all cells of the axis: which image of a body is near is not known from its
                  ///< cell
};

SCREE_HD inline CellSpan cells_around(const BinLevel& l, int axis, float x, float reach) {
  const float inv = l.inv_edge[axis];
  const Index n = l.cells[axis];
  const auto low = static_cast<Index>(std::floor((x - reach) * inv));
  const auto high = static_cast<Index>(std::floor((x + reach) * inv));
  if (high - low + 1 >= n) return {0, n, true};
  return {low, high - low + 1, false};
}

/// A coordinate that wraps, and what to add to positions in its cell to bring them near.
struct WrappedCell {
  Index cell;
  float shift;
};

SCREE_HD inline WrappedCell wrapped_cell(Index c, Index n, float wrap) {
  if (c < 0) return {c + n, -wrap};
  if (c >= n) return {c - n, wrap};
  return {c, 0};
}

/// Shortest difference of two wrapped coordinates.
SCREE_HD inline float wrapped_difference(float d, float wrap, float inv_wrap) {
  return d - wrap * std::rint(d * inv_wrap);
}

template <ShapeMix kMix, class Real>
struct ContactSearch {
  BodyView<Real> bodies;
  Span<const ShapeRecord<Real>> shapes;
  BinView bins;
  WallView<Real> walls;
  ContactRange range;
  ContactKeys keys;

  /// Calls emit(found) for each contact that position p in cell order finds: with bodies later in
  /// the cells around it in its own level, with all bodies around it in coarser levels, and with
  /// walls. Over all positions every contact is found once. `found` is what the body touches: the
  /// element of a wall, or body_element of the other body, whichever of the two is the lower; see
  /// found_key().
  template <class Emit>
  SCREE_HD void operator()(Index p, Emit&& emit) const {
    const auto own_cell = static_cast<Index>(bins.cell[p]);
    const BinGrid& grid = *bins.grid;
    if (own_cell >= grid.cell_count) return;
    const Index i = bins.body[p];
    const BinRecord own = bins.record[p];
    const BodySample body = load_body<kMix>(bodies, shapes, i);
    const Index own_level = level_of_cell(grid, own_cell);
    const float inflated = own.radius - grid.level[own_level].slack;

    Candidates near_bodies;
    search_level(grid.level[own_level], own.position, own.radius, own_cell, p + 1, i, body,
                 near_bodies, emit);
    for (Index k = own_level + 1; k < grid.level_count; ++k) {
      const BinLevel& l = grid.level[k];
      search_level(l, Vec3<float>(wrapped(grid, l, body.position)), inflated + l.slack, 0, 0, i,
                   body, near_bodies, emit);
    }
    test_all(near_bodies, i, body, emit);
    if (i < bodies.free_count) {
      visit_walls<kMix>(walls, range, keys, body, range.envelope + range.margin_of(i), inflated,
                        emit);
    }
  }

 private:
  /// Positions of bodies that may touch. They are gathered before they are tested, so that the
  /// threads of a device walk the cells together and then test together.
  struct Candidates {
    static constexpr int kMost = 12;
    Index position[kMost];
    int count = 0;
  };

  /// @param x           position of the body, wrapped in this level
  /// @param radius      inflated, with slack
  /// @param first_cell  cells before this one are left out
  /// @param first       positions before this one are left out
  template <class Emit>
  SCREE_HD void search_level(const BinLevel& l, const Vec3<float>& x, float radius,
                             Index first_cell, Index first, Index i, const BodySample& body,
                             Candidates& near_bodies, Emit& emit) const {
    const float reach =
        radius + (0.5f * static_cast<float>(l.max_diameter) * (1 + 2e-7f) + 2 * l.slack);
    const CellSpan sx = cells_around(l, 0, x.x, reach);
    const CellSpan sy = cells_around(l, 1, x.y, reach);
    const CellSpan sz = cells_around(l, 2, x.z, reach);
    const bool is_small = sx.is_whole || sy.is_whole || sz.is_whole;
    for (Index kz = 0; kz < sz.count; ++kz) {
      const WrappedCell cz = wrapped_cell(sz.first + kz, l.cells[2], l.wrap_f.z);
      const Index plane = l.first_cell + cell_part(l, 2, cz.cell);
      for (Index ky = 0; ky < sy.count; ++ky) {
        const WrappedCell cy = wrapped_cell(sy.first + ky, l.cells[1], l.wrap_f.y);
        const Index row = plane + cell_part(l, 1, cy.cell);
        for (Index kx = 0; kx < sx.count; ++kx) {
          const WrappedCell cx = wrapped_cell(sx.first + kx, l.cells[0], l.wrap_f.x);
          const Index cell = row + cell_part(l, 0, cx.cell);
          if (cell < first_cell) continue;
          const CellRange inside = bins.cells[cell];
          const Vec3<float> near{x.x - cx.shift, x.y - cy.shift, x.z - cz.shift};
          for (Index q = inside.begin > first ? inside.begin : first; q < inside.end; ++q) {
            const BinRecord other = bins.record[q];
            Vec3<float> d = other.position - near;
            if (is_small) {
              d = {wrapped_difference(d.x, l.wrap_f.x, l.inv_wrap.x),
                   wrapped_difference(d.y, l.wrap_f.y, l.inv_wrap.y),
                   wrapped_difference(d.z, l.wrap_f.z, l.inv_wrap.z)};
            }
            const float sum = radius + other.radius;
            if (norm2(d) > sum * sum * 1.00001f) continue;
            near_bodies.position[near_bodies.count++] = q;
            if (near_bodies.count == Candidates::kMost) test_all(near_bodies, i, body, emit);
          }
        }
      }
    }
  }

  template <class Emit>
  SCREE_HD void test_all(Candidates& near_bodies, Index i, const BodySample& body,
                         Emit& emit) const {
    for (int k = 0; k < near_bodies.count; ++k) test_pair(i, body, near_bodies.position[k], emit);
    near_bodies.count = 0;
  }

  template <class Emit>
  SCREE_HD void test_pair(Index i, const BodySample& body, Index q, Emit& emit) const {
    const Index j = bins.body[q];
    if (i >= bodies.fixed_begin && j >= bodies.fixed_begin) return;
    const Vec3d d = minimum_image(bodies.position[j] - body.position, range.period);
    const double envelope = range.envelope + range.margin_of(i) + range.margin_of(j);
    if constexpr (kMix != ShapeMix::any) {
      const double distance = norm(d);
      const double gap = distance - body.radius - static_cast<double>(bodies.radius[j]);
      if (gap > envelope) {
        const double speed = dot(Vec3d(bodies.velocity[j]) - body.motion.linear, d) / distance;
        if (!is_listed(gap, speed, envelope, range.h)) return;
      }
      emit(keys.body_element(j, 0));
    } else {
      const BodySample other = load_body<kMix>(bodies, shapes, j);
      const int features = pair_features(body.kind, other.kind);
      for (int k = 0; k < features; ++k) {
        // Evaluated with the lower body first, exactly as when the contact is filled in.
        const auto feature = static_cast<std::uint32_t>(k);
        const ContactGeometry g = i < j ? body_pair<kMix>(body, other, d, feature)
                                        : body_pair<kMix>(other, body, -d, feature);
        const double speed = i < j ? separation_speed(g, body.motion, other.motion)
                                   : separation_speed(g, other.motion, body.motion);
        if (is_listed(g.gap, speed, envelope, range.h)) emit(keys.body_element(j, feature));
      }
    }
  }
};

/// Contact as it is sorted: body a above the bits of an element.
SCREE_HD inline std::uint64_t packed_key(const ContactKeys& keys, Index a, std::uint32_t element) {
  return static_cast<std::uint64_t>(a) << keys.element_bits | element;
}

/// What body i found, as a contact whose body a is the lower one.
SCREE_HD inline std::uint64_t found_key(const ContactKeys& keys, Index i, std::uint32_t found) {
  if (keys.is_body(found) && keys.body(found) < i) {
    return packed_key(keys, keys.body(found), keys.body_element(i, keys.feature(found)));
  }
  return packed_key(keys, i, found);
}

}  // namespace scree
