#pragma once
// The unknowns of bodies whose nodes follow others, see kernels/affine/linked_rows.h.

#include <vector>

#include "collision/numbering.h"
#include "dynamics/affine/marked_list.h"
#include "dynamics/affine/piece_space.h"
#include "kernels/affine/linked_rows.h"
#include "kernels/backend/both.h"

namespace scree::affine {

/// Links of all bodies. Without any, each row of bodies is a row of unknowns.
struct LinkTable {
  std::vector<Link> links;   ///< body by body
  std::vector<Index> begin;  ///< of the links of a body, and their end; empty without any
  std::vector<Index> used;   ///< by row: nodes that are unknowns

  bool empty() const { return begin.empty(); }
};

/// Memory: 144 bytes a link, 24 a piece with its key and place twice: ten pieces a tetrahedron, up to sixteen a mixed block. On a device
/// also twice 104 for each of the 12 lines of a part of four pieces.
/// @tparam kSplits  whether several items add up a block: a device has more threads than there are of these
template <class B, bool kSplits = B::kIsDevice>
class LinkedRows {
 public:
  LinkedRows(B& b, const LinkTable& table)
      : links_(b),
        begin_(b),
        of_row_(b),
        row_begin_(b),
        used_(b),
        count_(b),
        place_(b),
        key_(b),
        pieces_(b),
        order_(b),
        sort_(b),
        mark_(b),
        first_(b),
        end_(b),
        row_first_(b),
        row_end_(b),
        parts_(b),
        marked_(b),
        right_(b),
        step_(b),
        diagonal_(b),
        mixed_(b) {
    if (table.empty()) return;
    const std::size_t rows = table.used.size();
    std::vector<Index> row_begin(rows + 1), of_row(table.links.size());
    for (const Link& link : table.links) ++row_begin[static_cast<std::size_t>(link.row) + 1];
    for (std::size_t r = 0; r < rows; ++r) row_begin[r + 1] += row_begin[r];
    std::vector<Index> next(row_begin.begin(), row_begin.end() - 1);
    for (std::size_t k = 0; k < table.links.size(); ++k)
      of_row[static_cast<std::size_t>(next[static_cast<std::size_t>(table.links[k].row)]++)] =
          static_cast<Index>(k);
    upload(b, table.links, links_);
    upload(b, table.begin, begin_);
    upload(b, of_row, of_row_);
    upload(b, row_begin, row_begin_);
    upload(b, table.used, used_);
    view_ = {links_.view(std::ssize(table.links)), begin_.view(std::ssize(table.begin)),
             of_row_.view(std::ssize(of_row)), row_begin_.view(std::ssize(row_begin)),
             used_.view(std::ssize(table.used))};
    right_.reserve_discard(view_.rows());
    step_.reserve_discard(view_.rows());
    diagonal_.reserve_discard(view_.rows());
    for (Buffer<B, Index>* each : {&row_first_, &row_end_}) each->reserve_discard(view_.rows());
  }

  /// Whether there are links.
  bool is_on() const { return view_.rows() > 0; }

  /// The system of unknowns of a system of bodies, valid until the next call; two host reads.
  BlockSystemView carry(B& b, const BlockSystemView& system) {
    const Index rows = view_.rows();
    const auto blocks = static_cast<Index>(view_.bodies() + system.mixed.size);
    const EntryKeys keys{static_cast<std::uint64_t>(rows)};
    count_.reserve_discard(blocks);
    place_.reserve_discard(static_cast<Offset>(blocks) + 1);
    NamePieces name{view_, system.mixed, keys, count_.view(blocks), {}, {}, {}, {}};
    for_each(b, blocks, name);
    exclusive_scan(b, Span<const Index>(count_.view(blocks)),
                   place_.view(static_cast<Offset>(blocks) + 1));
    const Offset total = fetch(b, place_.data() + blocks);
    const Index count = checked_index(total, can_number(total), "blocks of elastic bodies");
    key_.reserve_discard(count), pieces_.reserve_discard(count), order_.reserve_discard(count);
    name.begin = place_.view(static_cast<Offset>(blocks) + 1);
    name.key = key_.view(count), name.pieces = pieces_.view(count), name.order = order_.view(count);
    for_each(b, blocks, name);
    sort_pairs(b, sort_, key_.view(count), order_.view(count), bits_for(keys.none() + 1));
    const PieceLines lines{view_,
                           system.diagonal,
                           system.mixed,
                           key_.view(count),
                           pieces_.view(count),
                           order_.view(count)};
    mark_.reserve_discard(count);
    const MarkBlocks mark{keys, lines.key, mark_.view(count)};
    const Index mixed = carry_lines(b, lines, mark, system.right);
    return {diagonal_.view(rows), mixed_.view(mixed), right_.view(rows)};
  }

  /// Steps of unknowns, to be written, and what bodies make of them.
  Span<AffineVec> step() { return step_.view(view_.rows()); }
  void follow(B& b, Span<AffineVec> followed) {
    for_each(b, view_.bodies(), FollowRows{view_, step_.view(view_.rows()), followed});
  }

 private:
  /// @return blocks above the diagonal
  Index carry_lines(B& b, const PieceLines& lines, const MarkBlocks& mark,
                    Span<const AffineVec> force) {
    if constexpr (kSplits) {
      return carry_parts(b, lines, mark, force);
    } else {
      return carry_whole(b, lines, mark, force);
    }
  }
  Index carry_whole(B& b, const PieceLines& lines, const MarkBlocks& mark,
                    Span<const AffineVec> force) {
    const Index rows = view_.rows(), count = static_cast<Index>(lines.key.size);
    for_each(b, rows, CarryForce{view_, force, right_.view(rows)});
    for_each(b, rows, CarryDiagonal{lines, mark.keys, diagonal_.view(rows)});
    for_each(b, count, mark);
    const Index mixed = marked_.list(b, mark_, count, first_);
    mixed_.reserve_discard(mixed);
    for_each(b, mixed, CarryMixed{lines, mark.keys, first_.view(mixed), mixed_.view(mixed)});
    return mixed;
  }
  Index carry_parts(B& b, const PieceLines& lines, const MarkBlocks& mark,
                    Span<const AffineVec> force) {
    const Index rows = view_.rows(), count = static_cast<Index>(lines.key.size);
    for_each(b, count, mark);
    const Index mixed = marked_.list(b, mark_, count, first_);
    mixed_.reserve_discard(mixed), end_.reserve_discard(mixed);
    const Both<FindDiagonals, EndBlocks> find{
        {mark.keys, lines.key, row_first_.view(rows), row_end_.view(rows)},
        rows,
        {lines.key, first_.view(mixed), end_.view(mixed)}};
    for_each(b, find.items(mixed), find);
    const auto [of_rows, of_blocks] = parts_.reserve(row_first_.view(rows), row_end_.view(rows),
                                                     first_.view(mixed), end_.view(mixed), count);
    const Both<CarryParts, CarryParts> parts{{lines, of_rows.runs, force, of_rows.sum},
                                             of_rows.items,
                                             {lines, of_blocks.runs, {}, of_blocks.sum}};
    for_each(b, parts.items(of_blocks.items), parts);
    const Both<JoinPartsOfRows, AddPiecesToBlocks> join{
        {lines, of_rows.runs, of_rows.sum, diagonal_.view(rows), right_.view(rows)},
        PieceNumber::kCount * rows,
        {mark.keys, lines.key, of_blocks.runs, of_blocks.sum, mixed_.view(mixed)}};
    for_each(b, join.items(PieceNumber::kCount * mixed), join);
    return mixed;
  }

  LinksView view_;
  Buffer<B, Link> links_;
  Buffer<B, Index> begin_, of_row_, row_begin_, used_, count_;
  Buffer<B, Offset> place_;
  Buffer<B, std::uint64_t> key_;
  Buffer<B, Piece> pieces_;
  Buffer<B, Index> order_;
  SortSpace<B> sort_;
  Buffer<B, Index> mark_, first_, end_;   ///< of blocks above the diagonal, among pieces
  Buffer<B, Index> row_first_, row_end_;  ///< of diagonal blocks
  PieceSpace<B> parts_;
  MarkedList<B> marked_;
  Buffer<B, AffineVec> right_, step_;
  Buffer<B, Dense<12>> diagonal_;
  Buffer<B, MixedBlock> mixed_;
};

}  // namespace scree::affine
