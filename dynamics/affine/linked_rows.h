#pragma once
// The unknowns of bodies whose nodes follow others, see kernels/affine/linked_rows.h.

#include <vector>

#include "collision/numbering.h"
#include "dynamics/affine/marked_list.h"
#include "kernels/affine/linked_rows.h"

namespace scree::affine {

/// Links of all bodies. Without any, each row of bodies is a row of unknowns.
struct LinkTable {
  std::vector<Link> links;   ///< body by body
  std::vector<Index> begin;  ///< of the links of a body, and their end; empty without any
  std::vector<Index> used;   ///< by row: nodes that are unknowns

  bool empty() const { return begin.empty(); }
};

/// Memory: 144 bytes a link, 24 a piece with its key and place twice: ten pieces a tetrahedron, up to sixteen a mixed block.
template <class B>
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
    const PieceSums sums{view_,
                         system.diagonal,
                         system.mixed,
                         key_.view(count),
                         pieces_.view(count),
                         order_.view(count)};
    for_each(b, rows, CarryForce{view_, system.right, right_.view(rows)});
    for_each(b, 12 / kLines * rows, CarryDiagonal<kLines>{sums, keys, diagonal_.view(rows)});
    mark_.reserve_discard(count);
    for_each(b, count, MarkBlocks{keys, key_.view(count), mark_.view(count)});
    const Index mixed = marked_.list(b, mark_, count, first_);
    mixed_.reserve_discard(mixed);
    for_each(b, 12 / kLines * mixed,
             CarryMixed<kLines>{sums, keys, first_.view(mixed), mixed_.view(mixed)});
    return {diagonal_.view(rows), mixed_.view(mixed), right_.view(rows)};
  }

  /// Steps of unknowns, to be written, and what bodies make of them.
  Span<AffineVec> step() { return step_.view(view_.rows()); }
  void follow(B& b, Span<AffineVec> followed) {
    for_each(b, view_.bodies(), FollowRows{view_, step_.view(view_.rows()), followed});
  }

 private:
  /// Lines of a block that an item adds up.
  static constexpr int kLines = B::kIsDevice ? 1 : 12;

  LinksView view_;
  Buffer<B, Link> links_;
  Buffer<B, Index> begin_, of_row_, row_begin_, used_, count_;
  Buffer<B, Offset> place_;
  Buffer<B, std::uint64_t> key_;
  Buffer<B, Piece> pieces_;
  Buffer<B, Index> order_;
  SortSpace<B> sort_;
  Buffer<B, Index> mark_, first_;
  MarkedList<B> marked_;
  Buffer<B, AffineVec> right_, step_;
  Buffer<B, Dense<12>> diagonal_;
  Buffer<B, MixedBlock> mixed_;
};

}  // namespace scree::affine
