#pragma once
// First and second derivatives of the potential as a linear system of rows of bodies.
//
// Each pair within reach, and each that rubs, is an element with a gradient and a matrix for its four points. An element has
// an entry for each of its two bodies, sorted by row and then by the row of the other body. So entries of a row lie beside each
// other, and those of two rows too, and each block is summed in one order by who owns it.

#include "kernels/affine/block_system.h"
#include "kernels/affine/potential.h"
#include "kernels/backend/ordered_lists.h"

namespace scree::affine {

struct Element {
  Index body[2] = {};
  Index vertex[4] = {};
  PairKind kind = PairKind::point_triangle;
  Four push;         ///< minus the gradient of the potential
  Dense<12> matrix;  ///< its second derivatives, semidefinite
};

/// Marks the near pairs that the barrier acts on.
struct MarkActive {
  static constexpr const char* name = "affine_mark_active";
  Barrier barrier;
  NearPairsView near;
  Span<const AffineVec> q;
  Span<Index> is_active;  ///< out

  SCREE_HD void operator()(Index i) const {
    const NearPair& pair = near.pairs[i];
    const Four rest = near.rest_of(pair);
    is_active[i] =
        barrier.acts(nearest_points(pair.kind, points_of(near, pair, rest, q)).squared) ? 1 : 0;
  }
};

/// Places that are marked, in their order. Also of slips and of heads of blocks.
struct ListMarked {
  static constexpr const char* name = "affine_list_marked";
  Span<const Index> is_marked;
  Span<const Offset> place;
  Span<Index> marked;  ///< out

  SCREE_HD void operator()(Index i) const {
    if (is_marked[i] != 0) marked[place[i]] = i;
  }
};

/// Bytes: 1,280 written an element.
struct MakeElements {
  static constexpr const char* name = "affine_elements";
  Potential p;
  Span<const AffineVec> q;
  Span<const Index> active;  ///< near pairs; slips come behind them
  Span<Element> elements;    ///< out

  SCREE_HD void operator()(Index c) const {
    Element e;
    if (c < active.size) {
      const NearPair& pair = p.near.pairs[active[c]];
      const Four rest = p.near.rest_of(pair), x = points_of(p.near, pair, rest, q);
      const ContactPair contact = p.contact_pair(pair.kind, rest);
      e.kind = pair.kind;
      for (int side = 0; side < 2; ++side) e.body[side] = p.near.body_of(pair, side);
      for (int i = 0; i < 4; ++i) e.vertex[i] = pair.vertex[i];
      e.push = contact_gradient(contact, p.barrier, x);
      e.matrix = contact_hessian(contact, p.barrier, x, Projection::parts);
    } else {
      const Slip& slip = p.slips[c - static_cast<Index>(active.size)];
      const Four moved = p.moved(slip, p.rest_of(slip), q);
      e.kind = slip.kind;
      for (int side = 0; side < 2; ++side) e.body[side] = slip.body[side];
      for (int i = 0; i < 4; ++i) e.vertex[i] = slip.vertex[i];
      e.push = friction_gradient(slip.contact, p.law, moved);
      e.matrix = friction_hessian(slip.contact, p.law, moved);
    }
    for (int i = 0; i < 4; ++i) e.push[i] *= -p.scale;
    e.matrix.scale(p.scale);
    elements[c] = e;
  }
};

/// What friction remembers of a pair that the barrier acts on; pairs without friction have a bound of zero.
struct RememberSlip {
  static constexpr const char* name = "affine_remember_slip";
  Potential p;
  Span<const AffineVec> q;
  Span<const Index> active;
  Span<Slip> slips;  ///< out

  SCREE_HD void operator()(Index c) const {
    const NearPair& pair = p.near.pairs[active[c]];
    const Four rest = p.near.rest_of(pair), x = points_of(p.near, pair, rest, q);
    Slip s;
    s.kind = pair.kind;
    for (int side = 0; side < 2; ++side) s.body[side] = p.near.body_of(pair, side);
    for (int i = 0; i < 4; ++i) s.vertex[i] = pair.vertex[i];
    const Index a = p.bodies[s.body[0]].material, b = p.bodies[s.body[1]].material;
    s.contact = friction_contact(nearest_points(pair.kind, x), p.friction[a * p.material_count + b],
                                 normal_force(p.contact_pair(pair.kind, rest), p.barrier, x));
    slips[c] = s;
  }
};

/// Names of entries: row * (rows + 1) + row of the other body, `rows` where that is fixed; and one for those without a row.
struct EntryKeys {
  std::uint64_t rows = 0;
  SCREE_HD std::uint64_t key(Index row, Index other) const {
    if (row < 0) return none();
    return static_cast<std::uint64_t>(row) * (rows + 1) +
           (other < 0 ? rows : static_cast<std::uint64_t>(other));
  }
  SCREE_HD std::uint64_t none() const { return rows * (rows + 1); }
  SCREE_HD Index row(std::uint64_t key) const { return static_cast<Index>(key / (rows + 1)); }
  SCREE_HD Index other(std::uint64_t key) const { return static_cast<Index>(key % (rows + 1)); }
};

struct NameEntries {
  static constexpr const char* name = "affine_name_entries";
  Span<const BodyConstant> bodies;
  Span<const Element> elements;
  EntryKeys keys;
  Span<std::uint64_t> key;  ///< out, two an element
  Span<Index> entry;        ///< out: 2 element + side

  SCREE_HD void operator()(Index k) const {
    const Element& e = elements[k / 2];
    const int side = k % 2;
    key[k] = keys.key(bodies[e.body[side]].row, bodies[e.body[1 - side]].row);
    entry[k] = k;
  }
};

/// Where entries of rows begin: rows + 1 numbers.
struct FindRows {
  static constexpr const char* name = "affine_find_rows";
  EntryKeys keys;
  Span<const std::uint64_t> key;
  Span<Index> begin;  ///< out

  SCREE_HD void operator()(Index row) const {
    begin[row] = first_not_below(key, Index(0), static_cast<Index>(key.size),
                                 static_cast<std::uint64_t>(row) * (keys.rows + 1));
  }
};

/// Marks the first entry of each block above the diagonal.
struct MarkBlocks {
  static constexpr const char* name = "affine_mark_blocks";
  EntryKeys keys;
  Span<const std::uint64_t> key;
  Span<Index> is_first;  ///< out

  SCREE_HD void operator()(Index k) const {
    const std::uint64_t own = key[k];
    const bool is_block = own < keys.none() && keys.other(own) < static_cast<Index>(keys.rows) &&
                          keys.row(own) < keys.other(own);
    is_first[k] = is_block && (k == 0 || key[k - 1] != own) ? 1 : 0;
  }
};

/// Adds row i of J_side^T matrix J_to of an element: twelve numbers.
SCREE_HD inline void add_row(const Element& e, const Four& rest, int side, int to, int i,
                             double* row) {
  const int split = first_points(e.kind), k = i / 3, c = i % 3;
  const int from_p = side == 0 ? 0 : split, end_p = side == 0 ? split : 4;
  const int from_q = to == 0 ? 0 : split, end_q = to == 0 ? split : 4;
  for (int q = from_q; q < end_q; ++q) {
    double sum[3] = {0, 0, 0};
    for (int p = from_p; p < end_p; ++p) {
      const double weight = node_weight(rest[p], k);
      for (int d = 0; d < 3; ++d) sum[d] += weight * e.matrix(3 * p + c, 3 * q + d);
    }
    for (int l = 0; l < 4; ++l) {
      const double weight = node_weight(rest[q], l);
      for (int d = 0; d < 3; ++d) row[3 * l + d] += weight * sum[d];
    }
  }
}

SCREE_HD inline Four rest_of(const Element& e, Span<const Vec3d> corners) {
  Four rest;
  for (int i = 0; i < 4; ++i) rest[i] = corners[e.vertex[i]];
  return rest;
}

/// Inertia and elastic energy of a row: its diagonal block and right-hand side without elements.
struct BeginRows {
  static constexpr const char* name = "affine_begin_rows";
  Potential p;
  Span<const AffineVec> q;
  Span<Dense<12>> diagonal;  ///< out
  Span<AffineVec> right;     ///< out

  SCREE_HD void operator()(Index row) const {
    const Index b = p.body_of_row[row];
    const BodyConstant& body = p.bodies[b];
    const double factor = p.inertia_factor(body);
    right[row] = factor * body.mass.product(p.target[row] - q[b]) +
                 (-p.scale) * orthogonality_gradient(body.stiffness, q[b]);
    const Dense<9> elastic = projected_orthogonality_hessian(body.stiffness, q[b]);
    Dense<12> block;
    for (int i = 0; i < 9; ++i)
      for (int j = 0; j < 9; ++j) block(3 + i, 3 + j) = p.scale * elastic(i, j);
    for (int k = 0; k < 4; ++k) {
      AffineVec unit;
      unit.node[k].x = 1;
      const AffineVec column = body.mass.product(unit);
      for (int l = 0; l < 4; ++l) block.add_identity(l, k, factor * column.node[l].x);
    }
    diagonal[row] = block;
  }
};

/// Adds the elements of a row to one line of its diagonal block and to its right-hand side. An element of the pass: twelve a row.
struct AddElements {
  static constexpr const char* name = "affine_add_elements";
  Span<const Element> elements;
  Span<const Vec3d> corners;
  Span<const Index> entry;
  Span<const Index> begin;
  Span<Dense<12>> diagonal;
  Span<AffineVec> right;

  SCREE_HD void operator()(Index item) const {
    const Index row = item / 12;
    const int i = item % 12;
    double line[12] = {}, push = 0;
    for (Index k = begin[row]; k < begin[row + 1]; ++k) {
      const Element& e = elements[entry[k] / 2];
      const int side = entry[k] % 2, split = first_points(e.kind);
      const Four rest = rest_of(e, corners);
      add_row(e, rest, side, side, i, line);
      for (int p = side == 0 ? 0 : split; p < (side == 0 ? split : 4); ++p)
        push += node_weight(rest[p], i / 3) * e.push[p][i % 3];
    }
    for (int j = 0; j < 12; ++j) diagonal[row](i, j) += line[j];
    right[row].node[i / 3][i % 3] += push;
  }
};

/// One line of a block above the diagonal: twelve a block.
struct AddMixed {
  static constexpr const char* name = "affine_add_mixed";
  Span<const Element> elements;
  Span<const Vec3d> corners;
  EntryKeys keys;
  Span<const std::uint64_t> key;
  Span<const Index> entry;
  Span<const Index> first;  ///< entry that a block begins with
  Span<MixedBlock> mixed;   ///< out

  SCREE_HD void operator()(Index item) const {
    const Index block = item / 12;
    const int i = item % 12;
    const std::uint64_t own = key[first[block]];
    double line[12] = {};
    for (Index k = first[block]; k < key.size && key[k] == own; ++k) {
      const Element& e = elements[entry[k] / 2];
      const int side = entry[k] % 2;
      add_row(e, rest_of(e, corners), side, 1 - side, i, line);
    }
    if (i == 0) {
      mixed[block].row = keys.row(own);
      mixed[block].column = keys.other(own);
    }
    for (int j = 0; j < 12; ++j) mixed[block].value(i, j) = line[j];
  }
};

/// Products of the gradients of the barrier and of all else, for the stiffness that balances them.
struct BalanceSums {
  double mixed = 0, barrier = 0;
  SCREE_HD void combine(const BalanceSums& o) {
    mixed += o.mixed;
    barrier += o.barrier;
  }
};
struct BalanceOfRow {
  static constexpr const char* name = "affine_balance";
  Span<const AffineVec> with, without;  ///< minus the gradients, with the elements and without

  SCREE_HD BalanceSums operator()(Index row) const {
    const AffineVec push = with[row] - without[row];
    return {dot(push, without[row]), dot(push, push)};
  }
};

}  // namespace scree::affine
