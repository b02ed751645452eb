#pragma once
// The linear system of bodies whose nodes follow others: of tetrahedra that share their corners, and of corners that another body
// carries. Bodies have rows of their own at first, as if each were free. With x = T y, where y are the unknowns, the system
// H x = f becomes T^T H T y = T^T f. T is a 4x4 matrix for each body and each row of unknowns that it follows, the same along
// all three axes. Four free corners make a row of unknowns.
// docs/theory.md, "Elastic bodies".

#include "kernels/affine/assembly.h"

namespace scree::affine {

/// Node j of the body moves with the sum over k of weight[j][k] times node k of the row.
struct Link {
  Index body = 0;  ///< its row in the system of bodies
  Index row = 0;   ///< of unknowns
  double weight[4][4] = {};
};

struct LinksView {
  Span<const Link> links;       ///< body by body
  Span<const Index> begin;      ///< of the links of a body, and their end
  Span<const Index> of_row;     ///< links of rows, row by row
  Span<const Index> row_begin;  ///< of these
  Span<const Index> used;       ///< by row: nodes that are unknowns; the others stay where they are

  SCREE_HD Index bodies() const { return static_cast<Index>(begin.size) - 1; }
  SCREE_HD Index rows() const { return static_cast<Index>(used.size); }
  SCREE_HD Index count(Index body) const { return begin[body + 1] - begin[body]; }
};

/// The share of a block of bodies in a block of unknowns: that of two of their links.
struct Piece {
  Index block = 0;              ///< a body: its block on the diagonal; behind them: mixed blocks
  Index first = 0, second = 0;  ///< links, the row of the first is not the higher one
};

/// T^T f. Bytes: 232 a link.
struct CarryForce {
  static constexpr const char* name = "affine_carry_force";
  LinksView of;
  Span<const AffineVec> force;  ///< by body
  Span<AffineVec> carried;      ///< out, by row

  SCREE_HD void operator()(Index row) const {
    AffineVec sum;
    for (Index i = of.row_begin[row]; i < of.row_begin[row + 1]; ++i) {
      const Link& link = of.links[of.of_row[i]];
      for (int j = 0; j < 4; ++j)
        for (int k = 0; k < 4; ++k) sum.node[k] += link.weight[j][k] * force[link.body].node[j];
    }
    carried[row] = sum;
  }
};

/// x = T y. Bytes: 232 a link.
struct FollowRows {
  static constexpr const char* name = "affine_follow_rows";
  LinksView of;
  Span<const AffineVec> step;  ///< by row
  Span<AffineVec> followed;    ///< out, by body

  SCREE_HD void operator()(Index body) const {
    AffineVec sum;
    for (Index i = of.begin[body]; i < of.begin[body + 1]; ++i) {
      const Link& link = of.links[i];
      for (int j = 0; j < 4; ++j)
        for (int k = 0; k < 4; ++k) sum.node[j] += link.weight[j][k] * step[link.row].node[k];
    }
    followed[body] = sum;
  }
};

/// Pieces of the blocks of bodies, counted or named. Bytes: 12 read, 4 written a block; 24 written a piece.
struct NamePieces {
  static constexpr const char* name = "affine_name_pieces";
  LinksView of;
  Span<const MixedBlock> mixed;
  EntryKeys keys;
  Span<Index> count;         ///< out, without `begin`
  Span<const Offset> begin;  ///< running sum of count
  Span<std::uint64_t> key;   ///< out, with it
  Span<Piece> pieces;        ///< out
  Span<Index> order;         ///< out: their numbers

  SCREE_HD void operator()(Index block) const {
    const bool is_diagonal = block < of.bodies();
    const Index a = is_diagonal ? block : mixed[block - of.bodies()].row;
    const Index b = is_diagonal ? block : mixed[block - of.bodies()].column;
    const Index many = of.count(a);
    if (begin.empty()) {
      count[block] = is_diagonal ? many * (many + 1) / 2 : many * of.count(b);
      return;
    }
    auto place = static_cast<Index>(begin[block]);
    for (Index i = of.begin[a]; i < of.begin[a + 1]; ++i) {
      for (Index j = is_diagonal ? i : of.begin[b]; j < of.begin[b + 1]; ++j, ++place) {
        const bool is_risen = of.links[i].row <= of.links[j].row;
        pieces[place] = {block, is_risen ? i : j, is_risen ? j : i};
        key[place] =
            keys.key(of.links[pieces[place].first].row, of.links[pieces[place].second].row);
        order[place] = place;
      }
    }
  }
};

/// Lines of pieces of blocks of unknowns.
struct PieceLines {
  LinksView of;
  Span<const Dense<12>> diagonal;  ///< by body
  Span<const MixedBlock> mixed;
  Span<const std::uint64_t> key;  ///< rising
  Span<const Piece> pieces;
  Span<const Index> order;  ///< of these, by key

  /// Adds line i of the piece at a place in the order.
  SCREE_HD void add_line(Index place, int i, double (&line)[12]) const {
    const Piece& piece = pieces[order[place]];
    const Link &first = of.links[piece.first], &second = of.links[piece.second];
    add(piece, first, second, i, line);
    // Two bodies that follow one row have their mixed block there once as it is and once transposed.
    if (piece.block >= of.bodies() && first.row == second.row) add(piece, second, first, i, line);
  }
  /// Number i of T^T f that goes with the piece: each link has one of a diagonal block with itself.
  SCREE_HD double push(Index place, int i, Span<const AffineVec> force) const {
    const Piece& piece = pieces[order[place]];
    double sum = 0;
    // Blocks that are not there are zeros, of body 0 and itself.
    if (piece.first != piece.second || piece.block >= of.bodies()) return sum;
    const Link& link = of.links[piece.first];
    for (int j = 0; j < 4; ++j) sum += link.weight[j][i / 3] * force[link.body].node[j][i % 3];
    return sum;
  }
  /// First place with a key, or with a higher one.
  SCREE_HD Index place_of(std::uint64_t wanted) const {
    return first_not_below(key, Index(0), static_cast<Index>(key.size), wanted);
  }
  /// Lines of a block on the diagonal that no unknown goes with are those of a unit matrix.
  SCREE_HD bool is_unknown(Index row, int i) const { return i < 3 * of.used[row]; }

 private:
  SCREE_HD void add(const Piece& piece, const Link& first, const Link& second, int i,
                    double (&line)[12]) const {
    const bool is_diagonal = piece.block < of.bodies();
    const MixedBlock* const block = is_diagonal ? nullptr : &mixed[piece.block - of.bodies()];
    const Dense<12>& value = is_diagonal ? diagonal[piece.block] : block->value;
    const bool is_turned = !is_diagonal && first.body != block->row;
    const int node = i / 3, axis = i % 3;
    double left[12] = {};  // line of the block that the first link makes of its own lines
    for (int j = 0; j < 4; ++j) {
      const double w = first.weight[j][node];
      if (w == 0) continue;
      for (int l = 0; l < 12; ++l)
        left[l] += w * (is_turned ? value(l, 3 * j + axis) : value(3 * j + axis, l));
    }
    for (int l = 0; l < 4; ++l)
      for (int k = 0; k < 4; ++k)
        for (int d = 0; d < 3; ++d) line[3 * k + d] += second.weight[l][k] * left[3 * l + d];
  }
};

/// Diagonal blocks of unknowns: one item goes through all pieces of a row. Bytes: 12 + 2 x 136 a piece, and its block of 1,152.
struct CarryDiagonal {
  static constexpr const char* name = "affine_carry_diagonal";
  PieceLines lines;
  EntryKeys keys;
  Span<Dense<12>> carried;  ///< out, by row

  SCREE_HD void operator()(Index row) const {
    const std::uint64_t own = keys.key(row, row);
    const Index first = lines.place_of(own), end = lines.place_of(own + 1);
    for (int i = 0; i < 12; ++i) {
      double line[12] = {};
      if (lines.is_unknown(row, i)) {
        for (Index k = first; k < end; ++k) lines.add_line(k, i, line);
      } else {
        line[i] = 1;
      }
      for (int j = 0; j < 12; ++j) carried[row](i, j) = line[j];
    }
  }
};

/// Blocks of unknowns above the diagonal, in the same way.
struct CarryMixed {
  static constexpr const char* name = "affine_carry_mixed";
  PieceLines lines;
  EntryKeys keys;
  Span<const Index> first;   ///< piece that a block begins with
  Span<MixedBlock> carried;  ///< out

  SCREE_HD void operator()(Index block) const {
    const std::uint64_t own = lines.key[first[block]];
    carried[block].row = keys.row(own);
    carried[block].column = keys.other(own);
    for (int i = 0; i < 12; ++i) {
      double line[12] = {};
      for (Index k = first[block]; k < lines.key.size && lines.key[k] == own; ++k)
        lines.add_line(k, i, line);
      for (int j = 0; j < 12; ++j) carried[block].value(i, j) = line[j];
    }
  }
};

// On a device many items add up the pieces of a block, as they do with those of elements: a stiff body has one with each of the
// hundreds of tetrahedra that it carries. What is called a piece of a run there is a part here.

/// Where pieces of diagonal blocks begin and end.
struct FindDiagonals {
  static constexpr const char* name = "affine_find_diagonals";
  static constexpr int kBlockThreads = kWaitingThreads;
  EntryKeys keys;
  Span<const std::uint64_t> key;
  Span<Index> begin, end;  ///< out, by row

  SCREE_HD void operator()(Index row) const {
    const std::uint64_t own = keys.key(row, row);
    const auto all = static_cast<Index>(key.size);
    begin[row] = first_not_below(key, Index(0), all, own);
    end[row] = first_not_below(key, begin[row], all, own + 1);
  }
};

/// Adds up parts, of which a number may have no pieces. Items: 12 a part. Bytes as of CarryDiagonal, and 104 written an item.
struct CarryParts {
  static constexpr const char* name = "affine_carry_parts";
  static constexpr int kBlockThreads = kWaitingThreads;
  PieceLines lines;
  EntryRuns runs;
  Span<const AffineVec> force;  ///< by body; empty: blocks above the diagonal
  Span<LineSum> sum;            ///< out

  SCREE_HD void operator()(Index item) const {
    const EntryRuns::Piece part = runs.piece_of_run(item / 12);
    const int i = item % 12;
    LineSum mine;
    for (Index k = part.from; k < part.to; ++k) {
      lines.add_line(k, i, mine.line);
      if (!force.empty()) mine.push += lines.push(k, i, force);
    }
    sum[item] = mine;
  }
};

/// Makes diagonal blocks and the right-hand side of parts. Items: PieceNumber::kCount a row. Blocks above the diagonal:
/// AddPiecesToBlocks.
struct JoinPartsOfRows {
  static constexpr const char* name = "affine_join_parts_of_rows";
  static constexpr int kBlockThreads = kWaitingThreads;
  PieceLines lines;
  EntryRuns runs;
  Span<const LineSum> sum;
  Span<Dense<12>> diagonal;  ///< out
  Span<AffineVec> right;     ///< out

  SCREE_HD void operator()(Index item) const {
    const PieceNumber of(item);
    const double all = of.sum(runs, sum);
    if (of.number == 12) {
      right[of.run].node[of.line / 3][of.line % 3] = all;
    } else {
      const double unit = of.number == of.line ? 1 : 0;
      diagonal[of.run](of.line, of.number) = lines.is_unknown(of.run, of.line) ? all : unit;
    }
  }
};

}  // namespace scree::affine
