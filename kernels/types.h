#pragma once
// Basic types every other header builds on: indices, borrowed views, and the one portability macro.

#include <cassert>
#include <cstdint>
#include <type_traits>

#ifdef __CUDACC__
#define SCREE_HD __host__ __device__
#else
/// Marks a function that runs on the host and on the device; nothing when no CUDA
/// compiler reads the file.
#define SCREE_HD
#endif

namespace scree {

using Index = std::int32_t;   ///< bodies, contacts, cells
using Offset = std::int64_t;  ///< results of scans: positions in lists that may pass 2^31

/// A borrowed, trivially copyable view of contiguous elements; functors carry it by value.
template <class T>
struct Span {
  T* data = nullptr;
  Offset size = 0;

  Span() = default;
  SCREE_HD constexpr Span(T* data_, Offset size_) : data(data_), size(size_) {}
  /// A view that may write turns into one that may only read.
  template <class U>
  requires(std::is_same_v<const U, T>) SCREE_HD constexpr Span(const Span<U>& o)
      : data(o.data), size(o.size) {}

  SCREE_HD T& operator[](Offset i) const {
    assert(i >= 0 && i < size);
    return data[i];
  }
  SCREE_HD bool empty() const { return size == 0; }
  /// The first `count` elements.
  SCREE_HD Span first(Offset count) const {
    assert(count <= size);
    return {data, count};
  }
};

}  // namespace scree
