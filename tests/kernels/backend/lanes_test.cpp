// Vector registers against plain numbers: what a compiler makes of them is not to be trusted.

#include "kernels/backend/lanes.h"

#include <gtest/gtest.h>

namespace scree {
namespace {

template <class Real>
class LanesTest : public ::testing::Test {};
using Reals = ::testing::Types<float, double>;
TYPED_TEST_SUITE(LanesTest, Reals);

TYPED_TEST(LanesTest, SelectAsPlainNumbersDo) {
  using L = Lanes<TypeParam>;
  alignas(64) TypeParam a[L::kCount], b[L::kCount], least[L::kCount], most[L::kCount],
      within[L::kCount];
  for (int k = 0; k < L::kCount; ++k) {
    a[k] = static_cast<TypeParam>((k % 3 - 1) * (k + 1));
    b[k] = static_cast<TypeParam>(k % 2 == 0 ? -0.5 : 0.5);
  }
  const L x = L::load(a), y = L::load(b);
  select(x <= y, x, y).store(least);
  select(x >= y, x, y).store(most);
  select((x <= y) & (x >= L(-3)), x, y).store(within);
  for (int k = 0; k < L::kCount; ++k) {
    EXPECT_EQ(least[k], a[k] <= b[k] ? a[k] : b[k]) << "lane " << k;
    EXPECT_EQ(most[k], a[k] >= b[k] ? a[k] : b[k]) << "lane " << k;
    EXPECT_EQ(within[k], a[k] <= b[k] && a[k] >= -3 ? a[k] : b[k]) << "lane " << k;
  }
}

}  // namespace
}  // namespace scree
