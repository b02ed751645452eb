#pragma once
// Loops whose numbers are known when they are compiled: arrays that only such loops use stay in registers of a device.

#include <type_traits>
#include <utility>

#include "kernels/types.h"

namespace scree {

/// Calls f(0) to f(kCount - 1), with numbers that are constants: std::integral_constant<int, k>.
template <int kCount, class F>
SCREE_HD void unrolled(F&& f) {
  [&]<int... k>(std::integer_sequence<int, k...>) { (f(std::integral_constant<int, k>{}), ...); }
  (std::make_integer_sequence<int, kCount>{});
}

}  // namespace scree
