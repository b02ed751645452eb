#pragma once
// Quotients, roots and choices as the contact passes need them: on a device the short instruction
// sequences with errors of one or two units in the last place, on the host IEEE arithmetic. They
// are functions so that Lanes, many numbers at a time, can take the place of one.

#include <bit>
#include <cmath>
#include <cstdint>

#include "kernels/types.h"

namespace scree {

/// The first value where the condition holds, else the second.
template <class Real>
SCREE_HD Real select(bool condition, const Real& yes, const Real& no) {
  return condition ? yes : no;
}
SCREE_HD inline bool is_zero(float x) { return x == 0.0f; }
SCREE_HD inline bool is_zero(double x) { return x == 0.0; }

/// The largest float not above x: x >= f is float_below(x) >= f for every float f.
SCREE_HD inline float float_below(double x) {
#ifdef __CUDA_ARCH__
  return __double2float_rd(x);
#else
  const auto f = static_cast<float>(x);
  if (!(static_cast<double>(f) > x)) return f;
  const auto bits = std::bit_cast<std::int32_t>(f);  // one unit less in the last place
  return std::bit_cast<float>(bits > 0 ? bits - 1 : bits + 1);
#endif
}
/// The smallest float not below x.
SCREE_HD inline float float_above(double x) { return -float_below(-x); }

/// 1 / x for normal x of less than 2^126.
SCREE_HD inline float inverse(float x) {
#ifdef __CUDA_ARCH__
  float y;
  asm("rcp.approx.ftz.f32 %0, %1;" : "=f"(y) : "f"(x));
  return y;
#else
  return 1.0f / x;
#endif
}
SCREE_HD inline double inverse(double x) { return 1.0 / x; }

/// 1 / sqrt(x) for x >= 0; a number below the smallest normal one counts as that.
SCREE_HD inline float inverse_sqrt(float x) {
  constexpr float kMinNormal = 1.17549435e-38f;
  x = x > kMinNormal ? x : kMinNormal;
#ifdef __CUDA_ARCH__
  float y;
  asm("rsqrt.approx.ftz.f32 %0, %1;" : "=f"(y) : "f"(x));
  return y;
#else
  return 1.0f / std::sqrt(x);
#endif
}
SCREE_HD inline double inverse_sqrt(double x) {
  constexpr double kMinNormal = 2.2250738585072014e-308;
  x = x > kMinNormal ? x : kMinNormal;
#ifdef __CUDA_ARCH__
  return rsqrt(x);
#else
  return 1.0 / std::sqrt(x);
#endif
}

}  // namespace scree
