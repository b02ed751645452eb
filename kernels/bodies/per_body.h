#pragma once
// Constants of bodies that are often the same for all of them.

#include "kernels/types.h"

namespace scree {

/// A constant of every body: stored for each, or shared by all bodies below `first` and
/// stored for those behind.
template <class T>
struct PerBody {
  Span<const T> values;  ///< of the bodies [first, ...)
  Index first = 0;
  T shared{};

  PerBody() = default;
  template <class U>
  requires(std::is_same_v<std::remove_const_t<U>, T>) SCREE_HD constexpr PerBody(const Span<U>& all)
      : values(all) {}
  SCREE_HD T operator[](Index i) const { return i < first ? shared : values[i - first]; }
};

}  // namespace scree
