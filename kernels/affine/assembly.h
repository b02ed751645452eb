#pragma once
// First and second derivatives of the potential as a linear system of rows of bodies.
//
// Each pair within reach, each that rubs, and each driven joint is an element with a gradient and a matrix of low rank, carried to
// its two bodies; pairs with a mollifier are two. An element has an entry for each of its bodies, sorted by row and then by the row of the other
// body. So entries of a row lie beside each other, and those of two rows too, and each block is summed in one order by who owns it.

#include "kernels/affine/block_system.h"
#include "kernels/affine/contact_modes.h"
#include "kernels/affine/expected_forces.h"
#include "kernels/affine/potential.h"
#include "kernels/backend/ordered_lists.h"

namespace scree::affine {

/// At most three vectors of both bodies, whose outer products are its second derivatives.
struct Element {
  Index body[2] = {};
  int count = 0;                    ///< of its vectors, as of Modes
  AffineVec push[2];                ///< minus the gradient of the potential, of each body
  AffineVec mode[Modes::kMost][2];  ///< of each body; zeros behind the last
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
        barrier.acts(squared_distance(pair.kind, points_of(near, pair, rest, q))) ? 1 : 0;
  }
};

/// Places that are marked, in their order, as often as their marks say. Also of slips and of heads of blocks.
struct ListMarked {
  static constexpr const char* name = "affine_list_marked";
  Span<const Index> mark;
  Span<const Offset> place;
  Span<Index> marked;  ///< out

  SCREE_HD void operator()(Index i) const {
    for (Index k = 0; k < mark[i]; ++k) marked[place[i] + k] = i;
  }
};

/// Items: one an element, or two, a body each: half as much to hold for a device, which has the threads. Bytes: 784 written an
/// element.
struct MakeElements {
  static constexpr const char* name = "affine_elements";
  static constexpr int kBlockThreads = kWaitingThreads;
  Potential p;
  Span<const AffineVec> q;
  /// Near pairs, each as often as it has elements; slips come behind them, then driven joints.
  Span<const Index> active;
  Span<Element> elements;  ///< out
  int parts = 1;           ///< items of an element
  ExpectedForces expected;
  Span<const AffineVec> begun;  ///< by body, where the minimization began

  SCREE_HD void operator()(Index item) const {
    const Index c = item / parts;
    const int own = item % parts, first = parts == 1 ? 0 : own, end = parts == 1 ? 2 : own + 1;
    const auto contacts = static_cast<Index>(active.size);
    const auto slips = static_cast<Index>(p.slips.size);
    Element& to = elements[c];
    if (c >= contacts + slips) {
      for (int side = first; side < end; ++side) write(to, side, p.drives[c - contacts - slips]);
      return;
    }
    PairKind kind;
    Index body[2];
    Four rest, gradient;
    Modes modes;
    if (c < contacts) {
      const NearPair& pair = p.near.pairs[active[c]];
      kind = pair.kind;
      rest = p.near.rest_of(pair);
      for (int side = 0; side < 2; ++side) body[side] = p.near.body_of(pair, side);
      const Four x = points_of(p.near, pair, rest, q);
      const ContactPair contact = p.contact_pair(kind, rest);
      const int part = c > 0 && active[c - 1] == active[c] ? 1 : 0;
      const ContactPlace place = contact_place(contact, p.barrier, x);
      if (part == 0) gradient = contact_gradient(contact, place, x);
      const PairMobility mobility{
          rest, first_points(kind), {p.mobility(body[0]), p.mobility(body[1])}};
      modes = contact_modes(contact, p.barrier, place, x, mobility, part,
                            surplus(pair, rest, place.nearest.squared));
    } else {
      const Slip& slip = p.slips[c - contacts];
      kind = slip.kind;
      rest = p.rest_of(slip);
      for (int side = 0; side < 2; ++side) body[side] = slip.body[side];
      const Four moved = p.moved(slip, rest, q);
      gradient = friction_gradient(slip.contact, p.law, moved);
      modes = friction_modes(slip.contact, p.law, moved);
    }
    for (int side = first; side < end; ++side)
      write(to, side, body[side], kind, rest, gradient, modes);
  }

 private:
  SCREE_HD double surplus(const NearPair& pair, const Four& rest, double squared) const {
    if (!expected.may_have_surplus(p.barrier, squared)) return 0;
    return expected.surplus(p.barrier, squared,
                            squared_distance(pair.kind, points_of(p.near, pair, rest, begun)));
  }
  SCREE_HD void write(Element& to, int side, const DriveTerm& drive) const {
    const double way = drive.way(p.start, q);
    const double push = -p.scale * drive.first(way), stiffness = p.scale * drive.second(way);
    to.body[side] = drive.body[side];
    to.push[side] = push * drive.slope[side];
    for (AffineVec(&mode)[2] : to.mode) mode[side] = {};
    if (stiffness > 0) to.mode[0][side] = std::sqrt(stiffness) * drive.slope[side];
    if (side == 0) to.count = stiffness > 0 ? 1 : 0;
  }
  SCREE_HD void write(Element& to, int side, Index body, PairKind kind, const Four& rest,
                      const Four& gradient, const Modes& modes) const {
    const double root = std::sqrt(p.scale);
    const int split = first_points(kind);
    AffineVec push, mode[Modes::kMost];
    for (int i = 0; i < 4; ++i) {
      if ((i < split) != (side == 0)) continue;
      add_force(push, rest[i], -p.scale * gradient[i]);
      for (int k = 0; k < Modes::kMost; ++k)
        if (k < modes.count) add_force(mode[k], rest[i], root * modes.at[k][i]);
    }
    to.body[side] = body;
    to.push[side] = push;
    for (int k = 0; k < Modes::kMost; ++k) to.mode[k][side] = mode[k];
    if (side == 0) to.count = modes.count;
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

/// Adds row i of the block of an element that two of its sides have: twelve numbers.
SCREE_HD inline void add_row(const Element& e, int side, int to, int i, double* row, int modes) {
  for (int k = 0; k < modes; ++k) {
    const double own = entry_of(e.mode[k][side], i);
    for (int l = 0; l < 4; ++l)
      for (int d = 0; d < 3; ++d) row[3 * l + d] += own * e.mode[k][to].node[l][d];
  }
}
SCREE_HD inline void add_row(const Element& e, int side, int to, int i, double* row) {
  add_row(e, side, to, i, row, e.count);
}

/// Inertia and elastic energy of a row.
struct RowPotential {
  Potential p;
  Span<const AffineVec> q;
  double damping = 0;  ///< inertia beside that of bodies, over it, in the matrix alone

  SCREE_HD double held(const BodyConstant& body) const {
    return p.inertia_factor(body) * (1 + damping);
  }
  /// Minus the gradient. @param elastic  that of the elastic energy
  SCREE_HD AffineVec force(Index row, const AffineVec& elastic) const {
    const Index b = p.body_of_row[row];
    const BodyConstant& body = p.bodies[b];
    return p.inertia_factor(body) * body.mass.product(p.target[row] - q[b]) + (-p.scale) * elastic;
  }
  /// What the mass matrix has in the first coordinate of each node, of that of node k; it is symmetric.
  static SCREE_HD AffineVec mass_column(const BodyConstant& body, int k) {
    AffineVec unit;
    unit.node[k].x = 1;
    return body.mass.product(unit);
  }
};

/// A row without elements: its diagonal block and right-hand side.
struct BeginRows {
  static constexpr const char* name = "affine_begin_rows";
  static constexpr int kBlockThreads = kWaitingThreads;
  RowPotential of;
  Span<Dense<12>> diagonal;  ///< out
  Span<AffineVec> right;     ///< out

  SCREE_HD void operator()(Index row) const {
    const Index b = of.p.body_of_row[row];
    const BodyConstant& body = of.p.bodies[b];
    const AffineVec& q = of.q[b];
    const bool is_elastic = body.lame.is_elastic();
    right[row] = of.force(row, is_elastic ? neo_hookean_gradient(body.lame, q)
                                          : orthogonality_gradient(body.stiffness, q));
    const Dense<9> elastic = is_elastic ? projected_neo_hookean_hessian(body.lame, q)
                                        : projected_orthogonality_hessian(body.stiffness, q);
    Dense<12> block;
    for (int i = 0; i < 9; ++i)
      for (int j = 0; j < 9; ++j) block(3 + i, 3 + j) = of.p.scale * elastic(i, j);
    const double held = of.held(body);
    for (int k = 0; k < 4; ++k) {
      const AffineVec column = RowPotential::mass_column(body, k);
      for (int l = 0; l < 4; ++l) block.add_identity(l, k, held * column.node[l].x);
    }
    diagonal[row] = block;
  }
};

/// The same of stiff bodies, a line an item: a device has more threads than rows. Items: 12 a row.
struct BeginStiffRows {
  static constexpr const char* name = "affine_begin_stiff_rows";
  static constexpr int kBlockThreads = kWaitingThreads;
  RowPotential of;
  Span<Dense<12>> diagonal;  ///< out
  Span<AffineVec> right;     ///< out

  SCREE_HD void operator()(Index item) const {
    const Index row = item / 12;
    const int i = item % 12;
    const BodyConstant& body = of.p.bodies[of.p.body_of_row[row]];
    const AffineVec q = of.q[of.p.body_of_row[row]];
    const AffineVec force = of.force(row, orthogonality_gradient(body.stiffness, q));
    double elastic[9] = {};
    if (i >= 3) projected_orthogonality_line(body.stiffness, q, i - 3, elastic);
    const AffineVec mass = RowPotential::mass_column(body, i / 3);
    const double held = of.held(body);
    // Places in vectors are known when this is compiled, so that they stay in registers.
    double push = 0;
    for (int j = 0; j < 12; ++j) {
      push = j == i ? entry_of(force, j) : push;
      diagonal[row](i, j) = (j < 3 ? 0 : of.p.scale * elastic[j < 3 ? 0 : j - 3]) +
                            (j % 3 == i % 3 ? held * mass.node[j / 3].x : 0);
    }
    right[row].node[i / 3][i % 3] = push;
  }
};

/// Adds the elements of a row to its diagonal block and to its right-hand side: one item goes through all of them.
struct AddElements {
  static constexpr const char* name = "affine_add_elements";
  Span<const Element> elements;
  Span<const Index> entry;
  Span<const Index> begin;
  Span<Dense<12>> diagonal;
  Span<AffineVec> right;

  SCREE_HD void operator()(Index row) const {
    double line[12][12] = {}, push[12] = {};
    for (Index k = begin[row]; k < begin[row + 1]; ++k) {
      const Element& e = elements[entry[k] / 2];
      const int side = entry[k] % 2;
      for (int i = 0; i < 12; ++i) {
        add_row(e, side, side, i, line[i]);
        push[i] += entry_of(e.push[side], i);
      }
    }
    for (int i = 0; i < 12; ++i) {
      for (int j = 0; j < 12; ++j) diagonal[row](i, j) += line[i][j];
      right[row].node[i / 3][i % 3] += push[i];
    }
  }
};

/// A block above the diagonal, in the same way.
struct AddMixed {
  static constexpr const char* name = "affine_add_mixed";
  Span<const Element> elements;
  EntryKeys keys;
  Span<const std::uint64_t> key;
  Span<const Index> entry;
  Span<const Index> first;  ///< entry that a block begins with
  Span<MixedBlock> mixed;   ///< out

  SCREE_HD void operator()(Index block) const {
    const std::uint64_t own = key[first[block]];
    double line[12][12] = {};
    for (Index k = first[block]; k < key.size && key[k] == own; ++k) {
      const Element& e = elements[entry[k] / 2];
      const int side = entry[k] % 2;
      for (int i = 0; i < 12; ++i) add_row(e, side, 1 - side, i, line[i]);
    }
    mixed[block].row = keys.row(own);
    mixed[block].column = keys.other(own);
    for (int i = 0; i < 12; ++i)
      for (int j = 0; j < 12; ++j) mixed[block].value(i, j) = line[i][j];
  }
};

/// Entries of rows, or of blocks, cut into pieces: on a device many items add up the entries of one, each a line of a piece.
struct EntryRuns {
  Span<const Index> begin, end;  ///< of each row or block
  /// Entries of a piece: short pieces keep a device busy that has few, long ones need less memory.
  static constexpr Index kShort = 4, kLong = 16;
  Index piece = kLong;

  static Index piece_of(Index entries) { return entries < 100'000 ? kShort : kLong; }
  /// Above the number of any piece.
  Index piece_end(Index entries) const { return entries / piece + static_cast<Index>(begin.size); }
  /// Pieces of a run have numbers from here on, those of the next one higher numbers.
  SCREE_HD Index first_piece(Index run) const { return begin[run] / piece + run; }
  SCREE_HD Index run_of(Index number) const {
    Index run = 0, after = static_cast<Index>(begin.size);
    while (after - run > 1) {
      const Index middle = run + (after - run) / 2;
      (first_piece(middle) <= number ? run : after) = middle;
    }
    return run;
  }
  SCREE_HD Index piece_count(Index run) const {
    return (end[run] - begin[run] + piece - 1) / piece;
  }
  /// Entries of a piece; there are numbers of pieces that have none.
  struct Piece {
    Index run, from, to;
  };
  SCREE_HD Piece piece_of_run(Index number) const {
    const Index run = run_of(number);
    const Index from = begin[run] + (number - first_piece(run)) * piece;
    return {run, from, from + piece < end[run] ? from + piece : end[run]};
  }
};

/// Where the entries of blocks end.
struct EndBlocks {
  static constexpr const char* name = "affine_end_blocks";
  static constexpr int kBlockThreads = kWaitingThreads;
  Span<const std::uint64_t> key;
  Span<const Index> first;
  Span<Index> end;  ///< out

  SCREE_HD void operator()(Index block) const {
    end[block] =
        first_not_below(key, first[block], static_cast<Index>(key.size), key[first[block]] + 1);
  }
};

/// What the entries of a piece add to a line of a block, and to a number of the right-hand side.
struct LineSum {
  static constexpr int kNumbers = 13;
  double line[12] = {};
  double push = 0;

  SCREE_HD double number(int k) const { return k < 12 ? line[k] : push; }
};

/// Adds up pieces, of which a number may have no entries. Items: 12 a piece.
struct AddPieces {
  static constexpr const char* name = "affine_add_pieces";
  static constexpr int kBlockThreads = kWaitingThreads;
  Span<const Element> elements;
  Span<const Index> entry;
  EntryRuns runs;
  bool is_mixed = false;  ///< blocks above the diagonal
  Span<LineSum> sum;      ///< out

  SCREE_HD void operator()(Index item) const {
    const EntryRuns::Piece piece = runs.piece_of_run(item / 12);
    LineSum mine;
    for (Index k = piece.from; k < piece.to; ++k) {
      const Element& e = elements[entry[k] / 2];
      const int side = entry[k] % 2, line = item % 12;
      // All of them: a device would wait for their number, and then for each.
      add_row(e, side, is_mixed ? 1 - side : side, line, mine.line, Modes::kMost);
      mine.push += entry_of(e.push[side], line);
    }
    sum[item] = mine;
  }
};

/// A number of a sum over the pieces of a run: one of its lines, or of its right-hand side.
struct PieceNumber {
  static constexpr int kCount = 12 * LineSum::kNumbers;  ///< of a run
  Index run;
  int line, number;  ///< the last number of a line belongs to the right-hand side

  SCREE_HD explicit PieceNumber(Index item)
      : run(item / kCount),
        line(item % kCount / LineSum::kNumbers),
        number(item % LineSum::kNumbers) {}
  SCREE_HD double sum(const EntryRuns& runs, Span<const LineSum> sums) const {
    double all = 0;
    const Index first = runs.first_piece(run), end = first + runs.piece_count(run);
    for (Index piece = first; piece < end; ++piece) all += sums[12 * piece + line].number(number);
    return all;
  }
};

/// Adds pieces to the diagonal block and the right-hand side of their row. Items: PieceNumber::kCount a row.
struct AddPiecesToRows {
  static constexpr const char* name = "affine_add_pieces_to_rows";
  static constexpr int kBlockThreads = kWaitingThreads;
  EntryRuns runs;
  Span<const LineSum> sum;
  Span<Dense<12>> diagonal;
  Span<AffineVec> right;

  SCREE_HD void operator()(Index item) const {
    const PieceNumber of(item);
    const double all = of.sum(runs, sum);
    if (of.number < 12) {
      diagonal[of.run](of.line, of.number) += all;
    } else {
      right[of.run].node[of.line / 3][of.line % 3] += all;
    }
  }
};

/// Makes blocks of pieces, zeros where there are none. Items: PieceNumber::kCount a block.
struct AddPiecesToBlocks {
  static constexpr const char* name = "affine_add_pieces_to_blocks";
  static constexpr int kBlockThreads = kWaitingThreads;
  EntryKeys keys;
  Span<const std::uint64_t> key;
  EntryRuns runs;
  Span<const LineSum> sum;
  Span<MixedBlock> mixed;  ///< out

  SCREE_HD void operator()(Index item) const {
    const PieceNumber of(item);
    MixedBlock& block = mixed[of.run];
    if (of.number < 12) {
      block.value(of.line, of.number) = of.sum(runs, sum);
    } else if (of.line == 0) {
      const Index first = runs.begin[of.run];
      const bool is_empty = first == runs.end[of.run];
      block.row = is_empty ? 0 : keys.row(key[first]);
      block.column = is_empty ? 0 : keys.other(key[first]);
    }
  }
};

}  // namespace scree::affine
