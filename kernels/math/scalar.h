#pragma once
// Quotients and roots as the contact passes need them: on a device the short instruction sequences
// with errors of one or two units in the last place, on the host IEEE arithmetic.

#include <cmath>

#include "kernels/types.h"

namespace scree {

/// 1 / x for normal x of less than 2^126.
SCREE_HD inline float inverse(float x) {
#ifdef __CUDA_ARCH__
  return __fdividef(1.0f, x);
#else
  return 1.0f / x;
#endif
}
SCREE_HD inline double inverse(double x) { return 1.0 / x; }

/// 1 / sqrt(x) for x >= 0; a number below the smallest normal one counts as that.
SCREE_HD inline float inverse_sqrt(float x) {
  constexpr float kLeast = 1.17549435e-38f;
  x = x > kLeast ? x : kLeast;
#ifdef __CUDA_ARCH__
  return rsqrtf(x);
#else
  return 1.0f / std::sqrt(x);
#endif
}
SCREE_HD inline double inverse_sqrt(double x) {
  constexpr double kLeast = 2.2250738585072014e-308;
  x = x > kLeast ? x : kLeast;
#ifdef __CUDA_ARCH__
  return rsqrt(x);
#else
  return 1.0 / std::sqrt(x);
#endif
}

}  // namespace scree
