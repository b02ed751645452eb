#pragma once
// Conjugate gradients of systems of few rows: one cluster of blocks runs a whole solve, with the matrix in its shared memory. Needs
// compute capability 9.0; elsewhere, and for more rows, block_gradients.cuh does it.
//
// Each block has some rows, a warp has one at a time. All blocks have the whole z, since rows want that of their neighbors; the
// image of the direction follows from that of z (Chronopoulos and Gear, s-step iterative methods, 1989), so directions stay with
// their rows. Blocks meet twice an iteration.
//
// Bytes of an iteration, all in shared memory: 1,152 an inverse, a diagonal block and twice a block above the diagonal. What does
// not fit is read again from the second-level cache.

#include <cooperative_groups.h>

#include "kernels/affine/block_gradients.h"
#include "kernels/backend/cuda.cuh"

namespace scree::affine {
namespace cluster_gradients {

namespace cg = cooperative_groups;

inline constexpr int kThreads = 512;
inline constexpr int kWarps = kThreads / 32;
inline constexpr int kMostBlocks = 16;  ///< of a cluster; more than eight are not portable
inline constexpr unsigned kAll = 0xffffffffu;
/// Blocks share rows by their entries and this much a row, for the inverse, the diagonal block and what else there is to do.
inline constexpr Index kRowWork = 8;
/// Lines 2 a and 2 a + 1 of a block's product are found by lanes a, a + 6, a + 12 and a + 18, from three columns each.
inline constexpr int kPairs = 6, kColumns = 3, kLanes = 24;

/// A 12x12 block as lanes read it: lane after lane, column after column of the lane.
struct LaneBlock {
  double2 entry[kColumns][kLanes];
};
static_assert(sizeof(LaneBlock) == sizeof(Dense<12>));

/// What a row keeps, two numbers a lane; and the number of its inverse among the blocks of the rows of its block. Its diagonal
/// block and the others follow.
struct RowVectors {
  double2 x[kPairs], r[kPairs], p[kPairs], s[kPairs];
  Index place, end;
  unsigned wanted;  ///< bit b: block b has a row that wants z of this one
  unsigned unused;
};

/// What blocks meet with.
struct alignas(16) Sums {
  double of_warp[kWarps];
  double of_block[2][kMostBlocks];  ///< in turn
  Index first_row[kMostBlocks + 2];
};
static_assert(kWarps == 16 && kMostBlocks == 16);  // halves of a warp

/// Bytes of shared memory besides the blocks of the matrix.
struct Needs {
  std::size_t z, sums, row;
  __host__ __device__ explicit Needs(std::size_t rows)
      : z(rows * sizeof(AffineVec)), sums(sizeof(Sums)), row(sizeof(RowVectors)) {}
};
/// Most rows of a block.
inline std::size_t most_own_rows(std::size_t rows, std::size_t mixed, unsigned blocks) {
  return std::min(rows, (2 * mixed + kRowWork * rows) / (kRowWork * blocks) + 1);
}

/// Where the rows of a block of the cluster begin.
__device__ inline Index first_row(const BlockLists& lists, Index rows, unsigned block,
                                  unsigned blocks) {
  const auto work = [&](Index row) { return Offset{lists.begin[row]} + Offset{kRowWork} * row; };
  const Offset wanted = work(rows) * block / blocks;
  Index low = 0, high = rows;
  while (low < high) {
    const Index middle = (low + high) / 2;
    if (work(middle) < wanted) {
      low = middle + 1;
    } else {
      high = middle;
    }
  }
  return low;
}

struct Lane {
  int lane = static_cast<int>(threadIdx.x % 32);
  int pair = lane % kPairs;
  int column = kColumns * (lane / kPairs % 4);
  bool works = lane < kLanes;
  bool holds = lane < kPairs;  ///< two numbers of the row

  /// @return  entry of line 2 pair or one more, of a block in device memory
  __device__ double entry(const Dense<12>& m, bool is_turned, int more, int k) const {
    const int i = 2 * pair + more, j = column + k;
    return m.entry[is_turned ? 12 * j + i : 12 * i + j];
  }
  __device__ void copy(const Dense<12>& m, bool is_turned, LaneBlock& to) const {
    if (!works) return;
#pragma unroll
    for (int k = 0; k < kColumns; ++k)
      to.entry[k][lane] = {entry(m, is_turned, 0, k), entry(m, is_turned, 1, k)};
  }
  __device__ void add(const LaneBlock& m, const double* vector, double2& sum) const {
    if (!works) return;
#pragma unroll
    for (int k = 0; k < kColumns; ++k) {
      const double2 e = m.entry[k][lane];
      const double v = vector[column + k];
      sum.x += e.x * v, sum.y += e.y * v;
    }
  }
  __device__ void add(const Dense<12>& m, bool is_turned, const double* vector,
                      double2& sum) const {
    if (!works) return;
#pragma unroll
    for (int k = 0; k < kColumns; ++k) {
      const double v = vector[column + k];
      sum.x += entry(m, is_turned, 0, k) * v, sum.y += entry(m, is_turned, 1, k) * v;
    }
  }
  /// The sum over the columns, in the lanes that hold it.
  __device__ double2 whole(double2 sum) const {
#pragma unroll
    for (int step = 2 * kPairs; step >= kPairs; step /= 2) {
      sum.x += __shfl_down_sync(kAll, sum.x, step);
      sum.y += __shfl_down_sync(kAll, sum.y, step);
    }
    return sum;
  }
};

/// Sum over as many lanes, the same bits in all of them.
template <int kCount>
__device__ double lanes_total(double mine) {
#pragma unroll
  for (int step = kCount / 2; step > 0; step /= 2) mine += __shfl_xor_sync(kAll, mine, step);
  return mine;
}

// Older devices have no clusters.
#if !defined(__CUDA_ARCH__) || __CUDA_ARCH__ >= 900

/// A block of the cluster at work.
struct Block {
  cg::cluster_group cluster = cg::this_cluster();
  unsigned blocks = cluster.num_blocks(), own = cluster.block_rank();
  int warp = static_cast<int>(threadIdx.x / 32);
  Lane at;
  GradientVectors v;
  Index first, count;  ///< its rows
  double* z;           ///< of all rows; only those are kept up to date that rows of this block want
  Sums* sums;
  RowVectors* rows;
  LaneBlock* resident;  ///< the first blocks of the rows
  Index* column;        ///< of each, which row of z it takes
  Index resident_count;

  __device__ Block(const GradientVectors& of, Index all, unsigned char* shared, unsigned bytes)
      : v(of) {
    const Needs needs(static_cast<std::size_t>(all));
    z = reinterpret_cast<double*>(shared);
    sums = reinterpret_cast<Sums*>(shared + needs.z);
    if (threadIdx.x <= blocks)
      sums->first_row[threadIdx.x] = first_row(v.lists, all, threadIdx.x, blocks);
    __syncthreads();
    first = sums->first_row[own];
    count = sums->first_row[own + 1] - first;
    rows = reinterpret_cast<RowVectors*>(shared + needs.z + needs.sums);
    resident = reinterpret_cast<LaneBlock*>(rows + count);
    const auto* const end = shared + bytes;
    resident_count = static_cast<Index>((end - reinterpret_cast<unsigned char*>(resident)) /
                                        static_cast<Offset>(sizeof(LaneBlock) + sizeof(Index)));
    column = reinterpret_cast<Index*>(resident + resident_count);
    load();
  }

  /// Calls visit(k) for the rows of this warp.
  template <class F>
  __device__ void for_each_row(F&& visit) const {
    for (Index k = warp; k < count; k += kWarps) visit(k);
  }
  /// The e-th of the other blocks of a row, and the row of z that it takes.
  struct Other {
    const Dense<12>* value;
    bool is_turned;
    Index column;
  };
  __device__ Other other(Index row, Index e) const {
    const Index entry = v.lists.entry[v.lists.begin[row] + e];
    const MixedBlock& m = v.lists.mixed[entry / 2];
    const bool is_turned = entry % 2 != 0;
    return {&m.value, is_turned, is_turned ? m.row : m.column};
  }

  __device__ unsigned block_of(Index row) const {
    unsigned b = 0;
    while (sums->first_row[b + 1] <= row) ++b;
    return b;
  }

  __device__ void load() const {
    for_each_row([&](Index k) {
      const Index row = first + k, begin = v.lists.begin[row];
      const Index others = v.lists.begin[row + 1] - begin;
      const Index to = begin - v.lists.begin[first] + 2 * k;
      if (to < resident_count) at.copy(v.inverse[row], false, resident[to]);
      if (to + 1 < resident_count) {
        at.copy(v.diagonal[row], false, resident[to + 1]);
        column[to + 1] = row;
      }
      for (Index e = 0; e < others && to + 2 + e < resident_count; ++e) {
        const Other o = other(row, e);
        at.copy(*o.value, o.is_turned, resident[to + 2 + e]);
        column[to + 2 + e] = o.column;
      }
      unsigned wanted = 1u << own;
      for (Index e = at.lane; e < others; e += 32) wanted |= 1u << block_of(other(row, e).column);
      wanted = __reduce_or_sync(kAll, wanted);
      if (at.lane == 0) rows[k].place = to, rows[k].end = to + 2 + others, rows[k].wanted = wanted;
    });
    __syncwarp();
  }

  /// M^-1 of the residual of row k.
  __device__ double2 precondition(Index k) const {
    double2 sum{0, 0};
    const double* r = &rows[k].r[0].x;
    const Index from = rows[k].place;
    if (from < resident_count) {
      at.add(resident[from], r, sum);
    } else {
      at.add(v.inverse[first + k], false, r, sum);
    }
    return at.whole(sum);
  }
  /// Row k of the matrix times z.
  __device__ double2 product(Index k) const {
    double2 sum{0, 0};
    const Index row = first + k, from = rows[k].place + 1, end = rows[k].end;
    const Index near = min(end, resident_count);
#pragma unroll 4
    for (Index i = from; i < near; ++i) at.add(resident[i], z + 12 * column[i], sum);
    for (Index i = max(from, near); i < end; ++i) {
      if (i == from) {
        at.add(v.diagonal[row], false, z + 12 * row, sum);
      } else {
        const Other o = other(row, i - from - 1);
        at.add(*o.value, o.is_turned, z + 12 * o.column, sum);
      }
    }
    return at.whole(sum);
  }

  /// Gives z of row k to the blocks that want it: traffic between them is what an iteration waits for.
  __device__ void show(Index k, double2 mine) const {
    mine = {__shfl_sync(kAll, mine.x, at.pair), __shfl_sync(kAll, mine.y, at.pair)};
    if (at.lane >= 30) return;
    auto* const to = reinterpret_cast<double2*>(z + 12 * (first + k)) + at.pair;
    const unsigned wanted = rows[k].wanted;
    for (auto b = static_cast<unsigned>(at.lane / kPairs); b < blocks; b += 5)
      if ((wanted >> b & 1) != 0) *cluster.map_shared_rank(to, b) = mine;
  }
  /// Sum over the cluster, the same bits in all threads. What was shown before is there then.
  /// @param round  0 or 1, in turn  @param mine  zero but in the first eight lanes
  __device__ double meet(int round, double mine) const {
    mine = lanes_total<8>(mine);
    if (at.lane == 0) sums->of_warp[warp] = mine;
    __syncthreads();
    if (warp == 0) {
      const double sum = lanes_total<kWarps>(sums->of_warp[at.lane % kWarps]);
      if (at.lane < static_cast<int>(blocks))
        *cluster.map_shared_rank(&sums->of_block[round][own], static_cast<unsigned>(at.lane)) = sum;
    }
    cluster.sync();  // not the aligned one: lanes of a warp need not be together here
    const auto b = static_cast<unsigned>(at.lane) % kMostBlocks;
    return lanes_total<kMostBlocks>(b < blocks ? sums->of_block[round][b] : 0);
  }
};

#endif

inline __global__ void __launch_bounds__(kThreads)
    run_cluster_gradients(GradientVectors vectors, Span<const AffineVec> right, double tolerance,
                          int most, unsigned bytes) {
#if __CUDA_ARCH__ >= 900
  extern __shared__ __align__(16) unsigned char shared[];
  const Block b(vectors, static_cast<Index>(right.size), shared, bytes);
  b.cluster.sync();  // all have begun
  const Lane& at = b.at;
  GradientState s;
  double sum = 0;
  b.for_each_row([&](Index k) {
    RowVectors& row = b.rows[k];
    double2 r{0, 0};
    if (at.holds) {
      const double* from = &right[b.first + k].node[0].x + 2 * at.pair;
      r = {from[0], from[1]};
      row.r[at.pair] = r;
      row.x[at.pair] = row.p[at.pair] = row.s[at.pair] = {0, 0};
    }
    __syncwarp();
    const double2 z = b.precondition(k);
    b.show(k, z);
    if (at.holds) sum += r.x * z.x + r.y * z.y;
  });
  s.along = s.first = b.meet(1, sum);
  s.is_done = !(s.along > 0);
  while (!s.is_done && s.iterations < most) {
    sum = 0;
    b.for_each_row([&](Index k) {
      RowVectors& row = b.rows[k];
      const double2 image = b.product(k);
      if (!at.holds) return;
      const double2 z = reinterpret_cast<const double2*>(b.z + 12 * (b.first + k))[at.pair];
      double2 p = row.p[at.pair], q = row.s[at.pair];
      p = {z.x + s.beta * p.x, z.y + s.beta * p.y};
      q = {image.x + s.beta * q.x, image.y + s.beta * q.y};
      row.p[at.pair] = p, row.s[at.pair] = q;
      sum += p.x * q.x + p.y * q.y;
    });
    const double curvature = b.meet(0, sum);
    if (!(curvature > 0)) {
      s.is_done = true;
      break;
    }
    s.alpha = s.along / curvature;
    sum = 0;
    b.for_each_row([&](Index k) {
      RowVectors& row = b.rows[k];
      double2 r{0, 0};
      if (at.holds) {
        const double2 p = row.p[at.pair], q = row.s[at.pair], x = row.x[at.pair];
        r = row.r[at.pair];
        row.x[at.pair] = {x.x + s.alpha * p.x, x.y + s.alpha * p.y};
        r = {r.x - s.alpha * q.x, r.y - s.alpha * q.y};
        row.r[at.pair] = r;
      }
      __syncwarp();
      const double2 z = b.precondition(k);
      b.show(k, z);
      if (at.holds) sum += r.x * z.x + r.y * z.y;
    });
    const double along = b.meet(1, sum);
    s.beta = along / s.along;
    s.along = along;
    ++s.iterations;
    s.is_done = !(along > tolerance * tolerance * s.first);
  }
  b.for_each_row([&](Index k) {
    if (!at.holds) return;
    double* const to = &vectors.x[b.first + k].node[0].x + 2 * at.pair;
    const double2 x = b.rows[k].x[at.pair];
    to[0] = x.x, to[1] = x.y;
  });
  if (b.own == 0 && threadIdx.x == 0) *vectors.state = s;
#endif
}

}  // namespace cluster_gradients

/// Where and how the device runs a cluster of the largest size.
class ClusterGradients {
 public:
  explicit ClusterGradients(Cuda& cuda) {
    int major = 0, bytes = 0;
    check_cuda(cudaDeviceGetAttribute(&major, cudaDevAttrComputeCapabilityMajor, cuda.device()),
               "compute capability");
    if (major < 9) return;
    check_cuda(
        cudaDeviceGetAttribute(&bytes, cudaDevAttrMaxSharedMemoryPerBlockOptin, cuda.device()),
        "shared memory of a block");
    bytes_ = static_cast<std::size_t>(bytes);
    check_cuda(cudaFuncSetAttribute(kernel(), cudaFuncAttributeMaxDynamicSharedMemorySize, bytes),
               "shared memory of cluster_gradients");
    check_cuda(cudaFuncSetAttribute(kernel(), cudaFuncAttributeNonPortableClusterSizeAllowed, 1),
               "cluster of cluster_gradients");
    for (unsigned blocks = cluster_gradients::kMostBlocks; blocks >= kLeastBlocks; blocks /= 2) {
      int clusters = 0;
      cudaLaunchAttribute attribute;
      const cudaLaunchConfig_t config = launch(cuda, blocks, attribute);
      check_cuda(cudaOccupancyMaxActiveClusters(&clusters, kernel(), &config),
                 "occupancy of cluster_gradients");
      if (clusters > 0) {
        blocks_ = blocks;
        return;
      }
    }
  }

  /// Whether it can solve systems with so many rows and blocks above the diagonal, and is faster than others.
  bool can_run(std::size_t rows, std::size_t mixed) const {
    if (blocks_ == 0) return false;
    const cluster_gradients::Needs needs(rows);
    const std::size_t own = cluster_gradients::most_own_rows(rows, mixed, blocks_);
    // At most half of the blocks stay in memory beyond that of the cluster.
    const std::size_t matrix = 2 * (rows + mixed) * sizeof(Dense<12>) / blocks_;
    return needs.z + needs.sums + own * needs.row + matrix / 2 <= bytes_;
  }

  /// @param v  its state is set
  void run(Cuda& cuda, const GradientVectors& v, Span<const AffineVec> right, double tolerance,
           int most) const {
    cudaLaunchAttribute attribute;
    const cudaLaunchConfig_t config = launch(cuda, blocks_for(right.size), attribute);
    check_cuda(cudaLaunchKernelEx(&config, &cluster_gradients::run_cluster_gradients, v, right,
                                  tolerance, most, static_cast<unsigned>(bytes_)),
               "cluster_gradients");
    cuda.check_launch("cluster_gradients");
  }

 private:
  static constexpr unsigned kLeastBlocks = 8;

  static const void* kernel() {
    return reinterpret_cast<const void*>(&cluster_gradients::run_cluster_gradients);
  }
  /// Few rows need few blocks, which meet sooner.
  unsigned blocks_for(Offset rows) const {
    unsigned blocks = 1;
    while (blocks < blocks_ && Offset{blocks} * kRowsOfFew < rows) blocks *= 2;
    return blocks;
  }
  static constexpr Offset kRowsOfFew = 4;

  cudaLaunchConfig_t launch(Cuda& cuda, unsigned blocks, cudaLaunchAttribute& attribute) const {
    attribute.id = cudaLaunchAttributeClusterDimension;
    attribute.val.clusterDim = {blocks, 1, 1};
    cudaLaunchConfig_t config = {};
    config.gridDim = dim3(blocks);
    config.blockDim = dim3(cluster_gradients::kThreads);
    config.dynamicSmemBytes = bytes_;
    config.stream = cuda.stream();
    config.attrs = &attribute;
    config.numAttrs = 1;
    return config;
  }

  unsigned blocks_ = 0;    ///< of a cluster; 0: there are none
  std::size_t bytes_ = 0;  ///< of shared memory a block
};

}  // namespace scree::affine
