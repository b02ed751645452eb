// Sums of elements over rows and blocks: by one item each, and by pieces.

#include <map>
#include <random>

#include "kernels/affine/assembly.h"
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

}  // namespace
}  // namespace scree::affine
