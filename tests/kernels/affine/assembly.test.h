// Sums of elements over rows and blocks: by one item each, and by pieces. Lists of few entries beside those of all.

#include <map>
#include <random>

#include "kernels/affine/block_gradients.h"
#include "kernels/affine/few_entries.h"
#include "tests/backend_fixture.h"

namespace scree::affine {
namespace {

constexpr Index kRows = 6, kBodies = 8;  // the last two rest

class AssemblyTest : public BackendTest<double> {
 protected:
  /// Row 0 has hundreds of elements with row 1, row 2 has none, others a few or one, some with bodies at rest.
  static std::vector<Element> elements() {
    std::mt19937 generator(5);
    std::normal_distribution<double> normal;
    std::vector<Element> all;
    const auto add = [&](Index a, Index b, int count) {
      for (int n = 0; n < count; ++n) {
        Element e;
        e.body[0] = a, e.body[1] = b;
        e.count = 1 + n % 3;
        for (int side = 0; side < 2; ++side)
          for (int node = 0; node < 4; ++node)
            for (int d = 0; d < 3; ++d) {
              e.push[side].node[node][d] = normal(generator);
              for (int k = 0; k < e.count; ++k) e.mode[k][side].node[node][d] = normal(generator);
            }
        all.push_back(e);
      }
    };
    add(0, 1, 150), add(1, 0, 121), add(3, 4, EntryRuns::kShort), add(0, 4, EntryRuns::kShort + 1);
    add(5, 6, 1), add(7, 3, 40), add(6, 7, 3);
    return all;
  }

  void SetUp() override {
    BackendTest::SetUp();
    if (IsSkipped()) return;
    TestBackend& b = backend();
    std::vector<BodyConstant> bodies(kBodies);
    for (Index k = 0; k < kBodies; ++k)
      bodies[static_cast<std::size_t>(k)].row = k < kRows ? k : -1;
    Buffer<TestBackend, BodyConstant> body(b);
    upload(b, bodies, body);
    element_ = Buffer<TestBackend, Element>(b);
    upload(b, elements(), element_);
    count_ = static_cast<Index>(elements().size());
    const Index entries = 2 * count_;
    key_ = Buffer<TestBackend, std::uint64_t>(b, entries);
    entry_ = Buffer<TestBackend, Index>(b, entries);
    begin_ = Buffer<TestBackend, Index>(b, kRows + 1);
    for_each(b, entries,
             NameEntries{std::as_const(body).view(kBodies), std::as_const(element_).view(count_),
                         keys_, key_.view(entries), entry_.view(entries)});
    SortSpace<TestBackend> space(b);
    sort_pairs(b, space, key_.view(entries), entry_.view(entries), bits_for(keys_.none() + 1));
    for_each(b, kRows + 1, FindRows{keys_, key_.view(entries), begin_.view()});
  }

  Span<const Element> of_elements() { return std::as_const(element_).view(count_); }
  Span<const Index> entry() { return std::as_const(entry_).view(2 * count_); }
  Span<const std::uint64_t> key() { return std::as_const(key_).view(2 * count_); }

  EntryKeys keys_{kRows};
  Index count_ = 0;
  Buffer<TestBackend, Element> element_;
  Buffer<TestBackend, std::uint64_t> key_;
  Buffer<TestBackend, Index> entry_, begin_;
};

void expect_near(const Dense<12>& a, const Dense<12>& b, double tolerance) {
  for (int i = 0; i < 12; ++i)
    for (int j = 0; j < 12; ++j) ASSERT_NEAR(a(i, j), b(i, j), tolerance) << i << ", " << j;
}

TEST_F(AssemblyTest, RowsAreTheSumsOfTheirElements) {
  TestBackend& b = backend();
  Buffer<TestBackend, Dense<12>> block(b, kRows), in_pieces(b, kRows);
  Buffer<TestBackend, AffineVec> right(b, kRows), right_in_pieces(b, kRows);
  for (auto* blocks : {&block, &in_pieces}) fill(b, blocks->view(), Dense<12>{});
  for (auto* vectors : {&right, &right_in_pieces}) fill(b, vectors->view(), AffineVec{});
  for_each(b, kRows,
           AddElements{of_elements(), entry(), begin_.view(), block.view(), right.view()});
  const EntryRuns runs{
      begin_.view(kRows), {begin_.data() + 1, kRows}, EntryRuns::piece_of(2 * count_)};
  ASSERT_EQ(runs.piece, EntryRuns::kShort);
  const Index items = 12 * runs.piece_end(2 * count_);
  Buffer<TestBackend, LineSum> sum(b, items);
  for_each(b, items, AddPieces{of_elements(), entry(), runs, false, sum.view()});
  for_each(b, PieceNumber::kCount * kRows,
           AddPiecesToRows{runs, sum.view(), in_pieces.view(), right_in_pieces.view()});

  std::vector<Dense<12>> expected(kRows);
  std::vector<AffineVec> expected_right(kRows);
  for (const Element& e : elements())
    for (int side = 0; side < 2; ++side) {
      if (e.body[side] >= kRows) continue;
      const auto row = static_cast<std::size_t>(e.body[side]);
      for (int k = 0; k < e.count; ++k)
        for (int i = 0; i < 12; ++i)
          for (int j = 0; j < 12; ++j)
            expected[row](i, j) += entry_of(e.mode[k][side], i) * entry_of(e.mode[k][side], j);
      expected_right[row] += e.push[side];
    }
  const auto found = download(b, block.view()), pieces = download(b, in_pieces.view());
  const auto pushes = download(b, right.view()), of_pieces = download(b, right_in_pieces.view());
  for (std::size_t row = 0; row < kRows; ++row) {
    SCOPED_TRACE(row);
    expect_near(found[row], expected[row], 1e-11);
    expect_near(pieces[row], expected[row], 1e-11);
    for (int i = 0; i < 12; ++i) {
      ASSERT_NEAR(entry_of(pushes[row], i), entry_of(expected_right[row], i), 1e-11);
      ASSERT_NEAR(entry_of(of_pieces[row], i), entry_of(expected_right[row], i), 1e-11);
    }
  }
}

TEST_F(AssemblyTest, BlocksAreTheSumsOfTheirElements) {
  TestBackend& b = backend();
  const Index entries = 2 * count_;
  Buffer<TestBackend, Index> mark(b, entries);
  for_each(b, entries, MarkBlocks{keys_, key(), mark.view()});
  std::vector<Index> firsts;
  const std::vector<Index> marks = download(b, mark.view());
  for (Index k = 0; k < entries; ++k)
    if (marks[static_cast<std::size_t>(k)] != 0) firsts.push_back(k);
  const auto blocks = static_cast<Index>(firsts.size());
  ASSERT_EQ(blocks, 3);  // of rows 0 and 1, 0 and 4, 3 and 4
  Buffer<TestBackend, Index> first(b), end(b, blocks);
  upload(b, firsts, first);
  Buffer<TestBackend, MixedBlock> mixed(b, blocks), in_pieces(b, blocks);
  const Span<const Index> of_first = std::as_const(first).view(blocks);
  for_each(b, blocks, AddMixed{of_elements(), keys_, key(), entry(), of_first, mixed.view()});
  for_each(b, blocks, EndBlocks{key(), of_first, end.view()});
  const EntryRuns runs{of_first, end.view()};
  const Index items = 12 * runs.piece_end(entries);
  Buffer<TestBackend, LineSum> sum(b, items);
  for_each(b, items, AddPieces{of_elements(), entry(), runs, true, sum.view()});
  for_each(b, PieceNumber::kCount * blocks,
           AddPiecesToBlocks{keys_, key(), runs, sum.view(), in_pieces.view()});

  std::map<std::pair<Index, Index>, Dense<12>> expected;
  for (const Element& e : elements()) {
    const int low = e.body[0] < e.body[1] ? 0 : 1;
    if (e.body[1 - low] >= kRows) continue;
    Dense<12>& block = expected[{e.body[low], e.body[1 - low]}];
    for (int k = 0; k < e.count; ++k)
      for (int i = 0; i < 12; ++i)
        for (int j = 0; j < 12; ++j)
          block(i, j) += entry_of(e.mode[k][low], i) * entry_of(e.mode[k][1 - low], j);
  }
  ASSERT_EQ(expected.size(), 3u);
  for (const auto& found : {download(b, mixed.view()), download(b, in_pieces.view())})
    for (const MixedBlock& block : found) {
      SCOPED_TRACE(testing::Message() << block.row << ", " << block.column);
      ASSERT_EQ(expected.count({block.row, block.column}), 1u);
      expect_near(block.value, expected[{block.row, block.column}], 1e-11);
    }
}

/// What is listed of entries.
struct EntryLists {
  std::vector<std::uint64_t> key;
  std::vector<Index> entry, row_begin, block_begin, block_end, half, half_begin;

  void expect_same(const EntryLists& o) const {
    EXPECT_EQ(key, o.key);
    EXPECT_EQ(entry, o.entry);
    EXPECT_EQ(row_begin, o.row_begin);
    EXPECT_EQ(block_begin, o.block_begin);
    EXPECT_EQ(block_end, o.block_end);
    EXPECT_EQ(half, o.half);
    EXPECT_EQ(half_begin, o.half_begin);
  }
};

class FewEntriesTest : public BackendTest<double> {
 protected:
  /// Elements of bodies at random, of which the last few rest.
  void make(Index rows, Index count) {
    rows_ = rows, count_ = count;
    const Index bodies = rows + 3;
    std::mt19937 generator(static_cast<unsigned>(count));
    std::vector<BodyConstant> constants(static_cast<std::size_t>(bodies));
    for (Index k = 0; k < rows; ++k) constants[static_cast<std::size_t>(k)].row = k;
    std::vector<Element> elements(static_cast<std::size_t>(count));
    for (Element& e : elements) {
      e.body[0] = static_cast<Index>(generator() % static_cast<unsigned>(bodies));
      // Some with the next one, so that many are of the same two.
      const bool is_next = generator() % 2 == 0;
      e.body[1] = is_next ? (e.body[0] + 1) % bodies
                          : static_cast<Index>(generator() % static_cast<unsigned>(bodies));
    }
    bodies_ = Buffer<TestBackend, BodyConstant>(backend());
    elements_ = Buffer<TestBackend, Element>(backend());
    upload(backend(), constants, bodies_);
    upload(backend(), elements, elements_);
  }

  EntryLists of_all() {
    TestBackend& b = backend();
    const Index entries = 2 * count_;
    Buffer<TestBackend, std::uint64_t> key(b, entries);
    Buffer<TestBackend, Index> entry(b, entries), begin(b, rows_ + 1), mark(b, entries);
    SortSpace<TestBackend> space(b);
    for_each(b, entries,
             NameEntries{bodies_.view(), elements_.view(), keys(), key.view(), entry.view()});
    sort_pairs(b, space, key.view(), entry.view(), bits_for(keys().none() + 1));
    for_each(b, rows_ + 1, FindRows{keys(), key.view(), begin.view()});
    EntryLists lists{download(b, key.view()),
                     download(b, entry.view()),
                     download(b, begin.view()),
                     {},
                     {},
                     {},
                     {}};
    for_each(b, entries, MarkBlocks{keys(), key.view(), mark.view()});
    const std::vector<Index> marks = download(b, mark.view());
    std::vector<MixedBlock> blocks;
    for (std::size_t k = 0; k < marks.size(); ++k) {
      if (marks[k] == 0) continue;
      lists.block_begin.push_back(static_cast<Index>(k));
      MixedBlock block;
      block.row = keys().row(lists.key[k]), block.column = keys().other(lists.key[k]);
      blocks.push_back(block);
    }
    const auto found = static_cast<Index>(blocks.size()), halves = 2 * found;
    Buffer<TestBackend, Index> first(b), end(b, found), half(b, halves);
    Buffer<TestBackend, MixedBlock> mixed(b);
    Buffer<TestBackend, std::uint64_t> half_key(b, halves);
    upload(b, lists.block_begin, first);
    upload(b, blocks, mixed);
    for_each(b, found, EndBlocks{key.view(), first.view(), end.view()});
    lists.block_end = download(b, end.view());
    for_each(b, halves, NameHalves{keys(), mixed.view(), half_key.view(), half.view()});
    sort_pairs(b, space, half_key.view(), half.view(), bits_for(keys().none() + 1));
    for_each(b, rows_ + 1, FindRows{keys(), half_key.view(), begin.view()});
    lists.half = download(b, half.view());
    lists.half_begin = download(b, begin.view());
    return lists;
  }

  template <class B>
  EntryLists of_few(B& b) {
    EntryLists lists;
    if constexpr (B::kIsDevice) {
      const Index entries = 2 * count_;
      Buffer<B, std::uint64_t> key(b, entries);
      Buffer<B, Index> entry(b, entries), begin(b, rows_ + 1), first(b, count_), end(b, count_),
          half(b, entries), half_begin(b, rows_ + 1);
      list_few_entries(
          b, FewEntries{bodies_.view(), elements_.view(), keys(), key.view(), entry.view(),
                        begin.view(), first.view(), end.view(), half.view(), half_begin.view()});
      lists = {download(b, key.view()),       download(b, entry.view()), download(b, begin.view()),
               download(b, first.view()),     download(b, end.view()),   download(b, half.view()),
               download(b, half_begin.view())};
      const auto halves = static_cast<std::size_t>(lists.half_begin.back());
      for (std::size_t k = halves / 2; k < lists.block_begin.size(); ++k) {
        EXPECT_EQ(lists.block_begin[k], entries);
        EXPECT_EQ(lists.block_end[k], entries);
      }
      lists.block_begin.resize(halves / 2), lists.block_end.resize(halves / 2);
      lists.half.resize(halves);
    }
    return lists;
  }

  EntryKeys keys() const { return {static_cast<std::uint64_t>(rows_)}; }

  Index rows_ = 0, count_ = 0;
  Buffer<TestBackend, BodyConstant> bodies_;
  Buffer<TestBackend, Element> elements_;
};

TEST_F(FewEntriesTest, OneLaunchListsWhatManyDo) {
  if (!TestBackend::kIsDevice) GTEST_SKIP() << "a processor has no launches to spare";
  for (const auto& [rows, count] :
       std::vector<std::pair<Index, Index>>{{1, 1},
                                            {1, 40},
                                            {2, 3},
                                            {101, 32},
                                            {7, 512},
                                            {300, 512},
                                            {60, 513},
                                            {700, 2048},
                                            {FewEntries::kMostRows, 2048}}) {
    SCOPED_TRACE(testing::Message() << rows << " rows, " << count << " elements");
    make(rows, count);
    of_few(backend()).expect_same(of_all());
  }
}

}  // namespace
}  // namespace scree::affine
