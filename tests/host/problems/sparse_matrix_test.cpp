#include "host/problems/sparse_matrix.h"

#include <gtest/gtest.h>

namespace scree {
namespace {

TEST(SparseMatrix, EntriesAreSortedAndAdded) {
  const SparseMatrix a = compress(3, 4, {{2, 3, 1}, {0, 1, 2}, {2, 0, 3}, {0, 1, 0.5}, {2, 3, -1}});
  EXPECT_EQ(a.row_start, (std::vector<std::int32_t>{0, 1, 1, 3}));
  EXPECT_EQ(a.column, (std::vector<std::int32_t>{1, 0, 3}));
  EXPECT_EQ(a.value, (std::vector<double>{2.5, 3, 0}));  // the zero stays
}

TEST(SparseMatrix, EmptyOnesHaveRows) {
  const SparseMatrix a = compress(2, 0, {});
  EXPECT_EQ(a.row_start, (std::vector<std::int32_t>{0, 0, 0}));
  EXPECT_TRUE(a.empty());
  EXPECT_TRUE(SparseMatrix{}.empty());
}

TEST(SparseMatrix, TransposeTwiceIsTheSame) {
  const SparseMatrix a = compress(2, 3, {{0, 2, 1}, {1, 0, 2}, {1, 2, 3}});
  const SparseMatrix t = transpose(a);
  EXPECT_EQ(t, compress(3, 2, {{2, 0, 1}, {0, 1, 2}, {2, 1, 3}}));
  EXPECT_EQ(transpose(t), a);
}

TEST(SparseMatrix, OneTriangleIsMirroredTwoAreNot) {
  const SparseMatrix whole = compress(2, 2, {{0, 0, 1}, {0, 1, 2}, {1, 0, 2}, {1, 1, 3}});
  EXPECT_EQ(with_both_triangles(compress(2, 2, {{0, 0, 1}, {0, 1, 2}, {1, 1, 3}})), whole);
  EXPECT_EQ(with_both_triangles(compress(2, 2, {{0, 0, 1}, {1, 0, 2}, {1, 1, 3}})), whole);
  // Zeros that are stored in the other triangle do not fill it.
  EXPECT_EQ(with_both_triangles(compress(2, 2, {{0, 0, 1}, {0, 1, 2}, {1, 0, 0}, {1, 1, 3}})),
            whole);
  const SparseMatrix unsymmetric = compress(2, 2, {{0, 1, 2}, {1, 0, 5}});
  EXPECT_EQ(with_both_triangles(unsymmetric), unsymmetric);
  const SparseMatrix diagonal = compress(2, 2, {{0, 0, 1}, {1, 1, 3}});
  EXPECT_EQ(with_both_triangles(diagonal), diagonal);
}

TEST(SparseMatrix, Product) {
  const SparseMatrix a = compress(2, 3, {{0, 0, 1}, {0, 2, 2}, {1, 1, -1}});
  EXPECT_EQ(multiply(a, {1, 2, 3}), (std::vector<double>{7, -2}));
}

}  // namespace
}  // namespace scree
