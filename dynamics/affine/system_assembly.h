#pragma once
// Makes the linear system of a Newton step: elements of contacts, slips and driven joints, added up by rows and blocks.

#include "dynamics/affine/marked_list.h"
#include "dynamics/affine/piece_space.h"
#include "kernels/affine/few_entries.h"
#include "kernels/backend/both.h"

namespace scree::affine {

/// Memory: 784 bytes an element and 24 an entry of its two; on a device twice 104 for each of the 12 lines of a piece of four entries.
template <class B>
class SystemAssembly {
 public:
  /// @param has_elastic  whether some rows are parts of elastic bodies
  SystemAssembly(B& b, Index rows, bool has_elastic)
      : has_elastic_(has_elastic),
        diagonal_(b, rows),
        right_(b, rows),
        mixed_(b),
        marked_(b),
        active_(b),
        elements_(b),
        key_(b),
        entry_(b),
        begin_(b, static_cast<Offset>(rows) + 1),
        sort_(b),
        mark_(b),
        first_(b),
        end_(b),
        half_(b),
        half_begin_(b, static_cast<Offset>(rows) + 1),
        pieces_(b) {}

  /// The system at q, valid until the next call. Host reads: none for few elements on a device, else the number of blocks.
  /// @param of_pair   elements of each near pair, as EnergyOfTerm found them at q
  /// @param contacts  their sum
  /// @param damping   see RowPotential
  /// @param begun, expected  see MakeElements
  BlockSystemView assemble(B& b, const Potential& p, Span<const AffineVec> q,
                           const Buffer<B, Index>& of_pair, Index contacts, double damping,
                           Span<const AffineVec> begun, const ExpectedForces& expected) {
    const Index rows = p.rows();
    const Index count = contacts + static_cast<Index>(p.slips.size + p.drives.size);
    const RowPotential of{p, q, damping};
    if (count == 0) {
      begin_rows(b, rows, of);
      return {diagonal_.view(), {}, right_.view()};
    }
    marked_.write(b, of_pair, static_cast<Index>(p.near.pairs.size), contacts, active_);
    elements_.reserve_discard(count);
    const MakeElements make{
        p, q, active_.view(contacts), elements_.view(count), kSideItems, expected, begun};
    reserve_entries(2 * count);
    make_elements(b, rows, of, make);
    if constexpr (B::kIsDevice)
      if (FewEntries::fit(rows, 2 * count)) return add_few(b, p, count);
    return add_all(b, p, count);
  }

 private:
  /// Whether rows and elements are made by several items: a device has more threads than there are of them.
  static constexpr bool kSplits = B::kIsDevice;
  static constexpr int kSideItems = kSplits ? 2 : 1;

  void begin_rows(B& b, Index rows, const RowPotential& of) {
    if constexpr (kSplits) {
      if (!has_elastic_) return for_each(b, 12 * rows, begin_stiff(of));
    }
    for_each(b, rows, BeginRows{of, diagonal_.view(), right_.view()});
  }
  void make_elements(B& b, Index rows, const RowPotential& of, const MakeElements& make) {
    const Index items = kSideItems * static_cast<Index>(make.elements.size);
    if constexpr (kSplits) {
      if (!has_elastic_) {
        const Both<BeginStiffRows, MakeElements> both{begin_stiff(of), 12 * rows, make};
        return for_each(b, both.items(items), both);
      }
    }
    begin_rows(b, rows, of);
    for_each(b, items, make);
  }
  BeginStiffRows begin_stiff(const RowPotential& of) {
    return {of, diagonal_.view(), right_.view()};
  }

  Span<const Element> elements(Index count) const { return elements_.view(count); }
  Span<const Index> entry(Index count) const { return entry_.view(2 * count); }
  Span<const std::uint64_t> key(Index count) const { return key_.view(2 * count); }
  static EntryKeys keys_of(Index rows) { return {static_cast<std::uint64_t>(rows)}; }

  void reserve_entries(Index entries) {
    key_.reserve_discard(entries);
    entry_.reserve_discard(entries);
  }

  BlockSystemView add_all(B& b, const Potential& p, Index count) {
    const Index rows = p.rows(), entries = 2 * count;
    const EntryKeys keys = keys_of(rows);
    for_each(
        b, entries,
        NameEntries{p.bodies, elements(count), keys, key_.view(entries), entry_.view(entries)});
    sort_pairs(b, sort_, key_.view(entries), entry_.view(entries), bits_for(keys.none() + 1));
    for_each(b, rows + 1, FindRows{keys, key(count), begin_.view()});
    mark_.reserve_discard(entries);
    for_each(b, entries, MarkBlocks{keys, key(count), mark_.view(entries)});
    const Index blocks = marked_.list(b, mark_, entries, first_);
    mixed_.reserve_discard(blocks);
    const Span<const Index> first = first_.view(blocks);
    if constexpr (kSplits) {
      end_.reserve_discard(blocks);
      for_each(b, blocks, EndBlocks{key(count), first, end_.view(blocks)});
      add_pieces(b, rows, count, blocks);
    } else {
      for_each(b, rows,
               AddElements{elements(count), entry(count), begin_.view(), diagonal_.view(),
                           right_.view()});
      for_each(
          b, blocks,
          AddMixed{elements(count), keys, key(count), entry(count), first, mixed_.view(blocks)});
    }
    return {diagonal_.view(), mixed_.view(blocks), right_.view()};
  }

  /// The same by three launches. There are no more blocks than elements, so their number need not be known.
  BlockSystemView add_few(B& b, const Potential& p, Index count) {
    const Index rows = p.rows(), entries = 2 * count;
    for (Buffer<B, Index>* each : {&first_, &end_}) each->reserve_discard(count);
    half_.reserve_discard(entries), mixed_.reserve_discard(count);
    list_few_entries(b, FewEntries{p.bodies, elements(count), keys_of(rows), key_.view(entries),
                                   entry_.view(entries), begin_.view(), first_.view(count),
                                   end_.view(count), half_.view(entries), half_begin_.view()});
    add_pieces(b, rows, count, count);
    return {diagonal_.view(),
            mixed_.view(count),
            right_.view(),
            {half_.view(entries), half_begin_.view()}};
  }

  // A processor goes through the entries of a row once. A device has items for pieces of them: rows are few, and some have
  // hundreds of entries.
  void add_pieces(B& b, Index rows, Index count, Index blocks) {
    const auto [of_rows, of_blocks] =
        pieces_.reserve(begin_.view(rows), {begin_.data() + 1, rows}, first_.view(blocks),
                        end_.view(blocks), 2 * count);
    const Both<AddPieces, AddPieces> pieces{
        {elements(count), entry(count), of_rows.runs, false, of_rows.sum},
        of_rows.items,
        {elements(count), entry(count), of_blocks.runs, true, of_blocks.sum}};
    for_each(b, pieces.items(of_blocks.items), pieces);
    const Both<AddPiecesToRows, AddPiecesToBlocks> sums{
        {of_rows.runs, of_rows.sum, diagonal_.view(), right_.view()},
        PieceNumber::kCount * rows,
        {keys_of(rows), key(count), of_blocks.runs, of_blocks.sum, mixed_.view(blocks)}};
    for_each(b, sums.items(PieceNumber::kCount * blocks), sums);
  }

  bool has_elastic_;
  Buffer<B, Dense<12>> diagonal_;
  Buffer<B, AffineVec> right_;
  Buffer<B, MixedBlock> mixed_;
  MarkedList<B> marked_;
  Buffer<B, Index> active_;  ///< near pairs, see MakeElements
  Buffer<B, Element> elements_;
  Buffer<B, std::uint64_t> key_;
  Buffer<B, Index> entry_, begin_;
  SortSpace<B> sort_;
  Buffer<B, Index> mark_, first_, end_;  ///< of blocks
  Buffer<B, Index> half_, half_begin_;   ///< see BlockHalves
  PieceSpace<B> pieces_;
};

}  // namespace scree::affine
