#include <cub/block/block_radix_sort.cuh>
#include <cub/block/block_scan.cuh>

#include "kernels/affine/few_entries.h"
#include "kernels/backend/cuda.cuh"

namespace scree::affine {
namespace {

/// Thread t has the entries t kItems to t kItems + kItems - 1.
constexpr int kItems = 4;

template <int kThreads>
struct Shared {
  using Key = std::uint32_t;  // rows are few
  using Sort = cub::BlockRadixSort<Key, kThreads, kItems, Index>;
  using Scan = cub::BlockScan<std::uint32_t, kThreads>;
  static constexpr Index kRoom = kThreads * kItems;
  struct Lists {
    Key key[kRoom];
    std::uint16_t halves_before[kRoom], blocks_before[kRoom];
  };
  union {
    typename Sort::TempStorage sort;
    Lists lists;  // once that is done
  };
  typename Scan::TempStorage scan;
};

/// @param bits  of a key
template <int kThreads>
__global__ void __launch_bounds__(kThreads)
    list_kernel(const __grid_constant__ FewEntries few, int bits) {
  using Of = Shared<kThreads>;
  using Key = typename Of::Key;
  __shared__ Of s;
  const auto thread = static_cast<Index>(threadIdx.x), begin = kItems * thread;
  const auto count = static_cast<Index>(2 * few.elements.size);
  const auto rows = static_cast<Index>(few.keys.rows);
  const auto none = static_cast<Key>(few.keys.none());
  const auto place_of = [&](Key wanted, Index from = 0) {
    return first_not_below(Span<const Key>{s.lists.key, count}, from, count, wanted);
  };
  Key key[kItems];
  Index value[kItems];
  for (int i = 0; i < kItems; ++i) {
    const Index k = begin + i;
    value[i] = k;
    key[i] = ~Key{0};  // behind all others
    if (k >= count) continue;
    const Element& e = few.elements[k / 2];
    const int side = k % 2;
    key[i] = static_cast<Key>(
        few.keys.key(few.bodies[e.body[side]].row, few.bodies[e.body[1 - side]].row));
  }
  typename Of::Sort(s.sort).Sort(key, value, 0, bits);
  __syncthreads();
  for (int i = 0; i < kItems; ++i) {
    const Index k = begin + i;
    s.lists.key[k] = key[i];
    if (k >= count) continue;
    few.key[k] = key[i];
    few.entry[k] = value[i];
  }
  __syncthreads();

  // A half is where entries of another row begin, a block one of these above the diagonal: counted in the two halves of a word.
  std::uint32_t mark[kItems], before[kItems], all;
  for (int i = 0; i < kItems; ++i) {
    const Index k = begin + i;
    const Index row = few.keys.row(key[i]), other = few.keys.other(key[i]);
    const bool is_half = k < count && key[i] < none && other < rows && row != other &&
                         (k == 0 || s.lists.key[k - 1] != key[i]);
    mark[i] = is_half ? (row < other ? 0x10001u : 1u) : 0u;
  }
  typename Of::Scan(s.scan).ExclusiveSum(mark, before, all);
  const auto halves = static_cast<Index>(all & 0xffffu), blocks = static_cast<Index>(all >> 16);
  for (int i = 0; i < kItems; ++i) {
    const Index k = begin + i;
    s.lists.halves_before[k] = static_cast<std::uint16_t>(before[i] & 0xffffu);
    s.lists.blocks_before[k] = static_cast<std::uint16_t>(before[i] >> 16);
  }
  __syncthreads();

  for (int i = 0; i < kItems; ++i) {
    if (mark[i] == 0) continue;
    const Index k = begin + i, place = static_cast<Index>(before[i] & 0xffffu);
    const auto block = static_cast<Index>(before[i] >> 16);
    if (mark[i] > 1) {
      few.block_begin[block] = k;
      few.block_end[block] = place_of(key[i] + 1, k);
      few.half[place] = 2 * block;
    } else {
      const auto turned =
          static_cast<Key>(few.keys.key(few.keys.other(key[i]), few.keys.row(key[i])));
      few.half[place] = 2 * s.lists.blocks_before[place_of(turned)] + 1;
    }
  }
  for (Index block = blocks + thread; block < few.elements.size; block += kThreads)
    few.block_begin[block] = few.block_end[block] = count;
  for (Index row = thread; row <= rows; row += kThreads) {
    const Index first = place_of(static_cast<Key>(row) * static_cast<Key>(rows + 1));
    few.row_begin[row] = first;
    few.half_begin[row] = first < count ? s.lists.halves_before[first] : halves;
  }
}

}  // namespace

void list_few_entries(Cuda& cuda, const FewEntries& few) {
  const int bits = bits_for(few.keys.none() + 1);
  constexpr int kMany = FewEntries::kMost / kItems, kFew = kMany / 4;
  if (few.count() <= kFew * kItems) {
    list_kernel<kFew><<<1, kFew, 0, cuda.stream()>>>(few, bits);
  } else {
    list_kernel<kMany><<<1, kMany, 0, cuda.stream()>>>(few, bits);
  }
  cuda.check_launch("list_few_entries");
}

}  // namespace scree::affine
