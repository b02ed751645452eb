#include "kernels/math/scalar.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace scree {
namespace {

using Limits = std::numeric_limits<float>;

TEST(FloatBelow, ComparesWithFloatsAsTheDoubleDoes) {
  constexpr double kLeast = Limits::denorm_min(), kMost = Limits::max();
  std::vector<double> numbers{0.0,          -0.0,          1.0,    -1.0,          0.1,   -0.1,
                              0.5 * kLeast, -0.5 * kLeast, kLeast, -1.5 * kLeast, kMost, -kMost,
                              1e300,        -1e300,        1e-300, -1e-300};
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> mantissa(-2, 2), exponent(-40, 40);
  for (int k = 0; k < 20000; ++k)
    numbers.push_back(mantissa(generator) * std::exp2(std::floor(exponent(generator))));
  for (const double x : numbers) {
    const auto nearest = static_cast<float>(x);
    for (const float f : {nearest, std::nextafter(nearest, -Limits::infinity()),
                          std::nextafter(nearest, Limits::infinity()), 0.0f}) {
      if (!std::isfinite(f)) continue;
      EXPECT_EQ(float_below(x) >= f, x >= f) << x << " and " << f;
      EXPECT_EQ(float_above(x) <= f, x <= f) << x << " and " << f;
    }
  }
}

}  // namespace
}  // namespace scree
