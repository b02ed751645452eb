#pragma once
// Two programs in one launch: on a device short ones take as long as it takes to launch them.

#include <algorithm>

#include "kernels/types.h"

namespace scree {

/// Items of the second program follow those of the first, in other blocks of threads, so that none has both. Neither program may
/// read what the other writes.
template <class F, class G>
struct Both {
  static constexpr const char* name = F::name;
  static constexpr int kBlockThreads = std::min(F::kBlockThreads, G::kBlockThreads);
  F first;
  Index count = 0;  ///< items of the first
  G second;

  /// @param of_second  items
  SCREE_HD Index items(Index of_second) const { return begin_of_second() + of_second; }
  SCREE_HD void operator()(Index i) const {
    const Index begin = begin_of_second();
    if (i < count) {
      first(i);
    } else if (i >= begin) {
      second(i - begin);
    }
  }

 private:
  SCREE_HD Index begin_of_second() const {
    return (count + kBlockThreads - 1) / kBlockThreads * kBlockThreads;
  }
};

}  // namespace scree
