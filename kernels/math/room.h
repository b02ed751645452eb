#pragma once
// Arrays on the stack of an element program.

#include <type_traits>

#include "kernels/types.h"

namespace scree {

/// Room for N values that are written before they are read. An array of T would begin with N initial values: on a device
/// these are stores to memory, of each thread.
template <class T, int N>
class Room {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

 public:
  SCREE_HD Room() {}  // NOLINT(modernize-use-equals-default): it is what leaves the values out
  SCREE_HD T& operator[](int k) { return value_[k]; }
  SCREE_HD const T& operator[](int k) const { return value_[k]; }

 private:
  union {
    T value_[N];
  };
};

}  // namespace scree
