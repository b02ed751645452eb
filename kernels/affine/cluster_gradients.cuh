#pragma once
// Conjugate gradients of systems of few rows: one cluster of blocks runs a whole solve, with the matrix in its shared memory. Needs
// compute capability 9.0; elsewhere, and for more rows, block_gradients.cuh does it.
//
// Each block has some rows, a warp has one at a time. All blocks have the whole z, since rows want that of their neighbors; the
// image of the direction follows from that of z (Chronopoulos and Gear, s-step iterative methods, 1989), so directions stay with
// their rows. Blocks meet twice an iteration.
//
// The entries of a long row are cut into parts, of which other warps and maybe other blocks have some: a stiff body that carries
// soft ones has a hundred neighbors, and a warp that went through all of them would be waited for. A part has the direction of
// its row too, so it has its share of the curvature and of the image without one more meeting; who has the row adds up the shares
// of its image in the order of the parts.
//
// Bytes of an iteration, all in shared memory: 1,152 an inverse, a diagonal block and twice a block above the diagonal. What does
// not fit is read again from the second-level cache. 290 rows with 883 blocks are 2.7 MB, or 170 KB a block of 16, which it
// reads in 1 us; what an iteration takes beside that are the meetings.

#include <cooperative_groups.h>

#include "kernels/affine/cluster_shares.cuh"

namespace scree::affine {
namespace cluster_gradients {

namespace cg = cooperative_groups;

inline constexpr unsigned kAll = 0xffffffffu;

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
  __device__ void read(const Dense<12>& m, bool is_turned, double2 (&to)[kColumns]) const {
    if (!works) return;
#pragma unroll
    for (int k = 0; k < kColumns; ++k)
      to[k] = {entry(m, is_turned, 0, k), entry(m, is_turned, 1, k)};
  }
  __device__ void write(const double2 (&from)[kColumns], LaneBlock& to) const {
    if (!works) return;
#pragma unroll
    for (int k = 0; k < kColumns; ++k) to.entry[k][lane] = from[k];
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
  Cut start, stop;     ///< its parts
  Index first, count;  ///< its rows
  Index tails;         ///< parts of rows that are not their first
  Index slot_count;    ///< parts of its last row that other blocks have
  double* z;  ///< of all rows; only those are kept up to date that parts of this block want
  Sums* sums;
  double2* slots;  ///< shares in the image of the last row
  RowVectors* rows;
  Part* parts;    ///< the first ones of rows, row by row, then the others
  Offset origin;  ///< the entry that the first place belongs to
  Index* column;  ///< by place: which row of z the block takes
  Index* source;  ///< and where it is in device memory: an entry of the lists, or one of the next
  static constexpr Index kDiagonal = -1, kInverse = -2;
  LaneBlock* resident;  ///< the first blocks
  Index resident_count;

  __device__ Block(const GradientVectors& of, Index all, unsigned char* shared, unsigned bytes)
      : v(of) {
    const Needs needs(static_cast<std::size_t>(all));
    z = reinterpret_cast<double*>(shared);
    sums = reinterpret_cast<Sums*>(shared + needs.z);
    const Shares shares(v.lists, all, blocks, bytes);
    if (threadIdx.x <= blocks) sums->cut[threadIdx.x] = shares.cut(threadIdx.x);
    __syncthreads();
    start = sums->cut[own], stop = sums->cut[own + 1];
    first = start.next_row(), count = stop.next_row() - first;
    slot_count = stop.part > 0 && stop.row >= first ? shares.parts(stop.row) - stop.part : 0;
    slots = reinterpret_cast<double2*>(shared + needs.z + needs.sums);
    rows = reinterpret_cast<RowVectors*>(slots + kPairs * slot_count);
    parts = reinterpret_cast<Part*>(rows + count);
    tails = list_tails(shares);
    origin = shares.begin[start.row] + Offset{kPart} * start.part;
    const auto places =
        static_cast<Index>(shares.begin[stop.row] + Offset{kPart} * stop.part - origin + 2 * count);
    column = reinterpret_cast<Index*>(parts + count + tails);
    source = column + places;
    resident = reinterpret_cast<LaneBlock*>(column + (2 * places + 3) / 4 * 4);
    const auto left = shared + bytes - reinterpret_cast<unsigned char*>(resident);
    const auto room = left / static_cast<Offset>(sizeof(LaneBlock));
    resident_count = static_cast<Index>(room < places ? max(room, Offset{0}) : places);
    load();
  }

  /// Calls visit(k) for the rows of this warp, whose first parts have the same numbers.
  template <class F>
  __device__ void for_each_row(F&& visit) const {
    for (Index k = warp; k < count; k += kWarps) visit(k);
  }
  template <class F>
  __device__ void for_each_part(F&& visit) const {
    for (Index k = warp; k < count + tails; k += kWarps) visit(k);
  }

  /// Blocks that have parts of a row, as bits.
  __device__ unsigned holders(Index row) const {
    unsigned b = owner_of(row), bits = 1u << b;
    while (sums->cut[b + 1].row == row && sums->cut[b + 1].part > 0) bits |= 1u << ++b;
    return bits;
  }
  /// The block that has the first part.
  __device__ unsigned owner_of(Index row) const {
    unsigned b = 0;
    while (sums->cut[b + 1].next_row() <= row) ++b;
    return b;
  }

  /// Lists parts that are not the first of their row. @return how many
  __device__ Index list_tails(const Shares& shares) const {
    const Index end = stop.next_row();
    const auto begin_of = [&](Index row) {
      return row == start.row && start.part > 0 ? start.part : 1;
    };
    const auto count_of = [&](Index row) {
      const Index last = row == stop.row ? stop.part : shares.parts(row);
      return max(last - begin_of(row), 0);
    };
    bool is_any = false;
    for (Index row = start.row + static_cast<Index>(threadIdx.x); row < end; row += kThreads)
      is_any = is_any || count_of(row) > 0;
    if (__syncthreads_or(is_any ? 1 : 0) == 0) return 0;
    if (warp == 0) {
      Index before = count;
      for (Index base = start.row; base < end; base += 32) {
        const Index row = base + at.lane;
        const Index own_count = row < end ? count_of(row) : 0;
        Index after = own_count;
#pragma unroll
        for (int step = 1; step < 32; step *= 2) {
          const Index other = __shfl_up_sync(kAll, after, step);
          if (at.lane >= step) after += other;
        }
        const Index begin = before + after - own_count;
        for (Index k = 0; k < own_count; ++k)
          parts[begin + k].row = row, parts[begin + k].from = kPart * (begin_of(row) + k);
        if (row >= first && row < end)
          rows[row - first].tail = begin, rows[row - first].tail_end = begin + own_count;
        before += __shfl_sync(kAll, after, 31);
      }
      if (at.lane == 0) sums->tails = before - count;
    }
    __syncthreads();
    return sums->tails;
  }

  /// Blocks that follow the diagonal block of a row have a row of z each.
  __device__ Index column_of(Index entry) const {
    const MixedBlock& m = v.lists.mixed[entry / 2];
    return entry % 2 != 0 ? m.row : m.column;
  }
  __device__ const Dense<12>& block_of(Index row, Index entry) const {
    if (entry == kInverse) return v.inverse[row];
    return entry == kDiagonal ? v.diagonal[row] : v.lists.mixed[entry / 2].value;
  }
  static __device__ bool is_turned(Index entry) { return entry >= 0 && entry % 2 != 0; }

  __device__ void load() const {
    for_each_part([&](Index k) {
      Part& part = parts[k];
      const bool is_first = k < count;
      const Index row = is_first ? first + k : part.row, begin_of_part = is_first ? 0 : part.from;
      const Index begin = v.lists.begin[row], entries = v.lists.begin[row + 1] - begin;
      const Index end_of_part = min(begin_of_part + kPart, entries);
      // Of entry 0, were it here.
      const auto zero = static_cast<Index>(begin - origin) + 2 * (row - first + 1);
      unsigned wanted = holders(row);
      for (Index e = begin_of_part + at.lane; e < (is_first ? entries : end_of_part); e += 32) {
        const Index entry = v.lists.entry[begin + e], other = column_of(entry);
        wanted |= holders(other);
        if (e < end_of_part) column[zero + e] = other, source[zero + e] = entry;
      }
      if (at.holds) part.p[at.lane] = part.s[at.lane] = {0, 0};
      wanted = __reduce_or_sync(kAll, wanted);
      if (at.lane == 0) {
        const unsigned owner = owner_of(row);
        part.row = row, part.from = begin_of_part;
        part.place = zero + (is_first ? -1 : begin_of_part), part.end = zero + end_of_part;
        part.owner = owner;
        part.slot = owner == own ? -1 : begin_of_part / kPart - sums->cut[owner + 1].part;
        if (is_first) {
          column[zero - 2] = column[zero - 1] = row;
          source[zero - 2] = kInverse, source[zero - 1] = kDiagonal;
          rows[k].wanted = wanted;
          if (tails == 0) rows[k].tail = rows[k].tail_end = 0;
        }
      }
      __syncwarp();
      fetch(row, part.place - (is_first ? 1 : 0), part.end);
    });
    __syncwarp();
  }
  /// Brings the blocks of a row from a place on to shared memory, as far as there is room.
  __device__ void fetch(Index row, Index place, Index end) const {
    constexpr int kTogether = 4;  // that wait for the cache
    const Index last = min(end, resident_count);
    for (Index i = place; i < last; i += kTogether) {
      double2 value[kTogether][kColumns];
#pragma unroll
      for (int k = 0; k < kTogether; ++k)
        if (i + k < last) at.read(block_of(row, source[i + k]), is_turned(source[i + k]), value[k]);
#pragma unroll
      for (int k = 0; k < kTogether; ++k)
        if (i + k < last) at.write(value[k], resident[i + k]);
    }
  }

  /// M^-1 of the residual of row k.
  __device__ double2 precondition(Index k) const {
    double2 sum{0, 0};
    const double* r = &rows[k].r[0].x;
    const Index place = parts[k].place - 1;
    if (place < resident_count) {
      at.add(resident[place], r, sum);
    } else {
      at.add(v.inverse[first + k], false, r, sum);
    }
    return at.whole(sum);
  }
  /// Those blocks of the matrix times z that a part has.
  __device__ double2 product(const Part& part) const {
    double2 sum{0, 0};
    const Index row = part.row, place = part.place, end = part.end;
    const Index near = min(end, resident_count);
#pragma unroll 4
    for (Index i = place; i < near; ++i) at.add(resident[i], z + 12 * column[i], sum);
#pragma unroll 2
    for (Index i = max(place, near); i < end; ++i)
      at.add(block_of(row, source[i]), is_turned(source[i]), z + 12 * column[i], sum);
    return at.whole(sum);
  }
  /// Two numbers of the image of the direction of row k, once blocks have met.
  __device__ double2 image(Index k) const {
    double2 sum = parts[k].s[at.pair];
    const auto add = [&](double2 share) { sum.x += share.x, sum.y += share.y; };
    for (Index i = rows[k].tail; i < rows[k].tail_end; ++i) add(parts[i].s[at.pair]);
    if (k == count - 1)
      for (Index i = 0; i < slot_count; ++i) add(slots[kPairs * i + at.pair]);
    return sum;
  }
  /// Gives the share of a part to the block that has its row.
  __device__ void give(const Part& part, double2 share) const {
    if (part.slot >= 0)
      *cluster.map_shared_rank(slots + kPairs * part.slot + at.pair, part.owner) = share;
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
      row.x[at.pair] = {0, 0};
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
    b.for_each_part([&](Index k) {
      Part& part = b.parts[k];
      const double2 image = b.product(part);
      if (!at.holds) return;
      const double2 z = reinterpret_cast<const double2*>(b.z + 12 * part.row)[at.pair];
      double2 p = part.p[at.pair], q = part.s[at.pair];
      p = {z.x + s.beta * p.x, z.y + s.beta * p.y};
      q = {image.x + s.beta * q.x, image.y + s.beta * q.y};
      part.p[at.pair] = p, part.s[at.pair] = q;
      b.give(part, q);
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
        const double2 p = b.parts[k].p[at.pair], q = b.image(k), x = row.x[at.pair];
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
    const unsigned blocks = blocks_for(static_cast<Offset>(rows));
    if (cluster_gradients::most_needed(rows, mixed, blocks) > bytes_) return false;
    const cluster_gradients::Needs needs(rows);
    const std::size_t own =
        cluster_gradients::most_own_rows(rows, mixed, blocks, cluster_gradients::kRowWork);
    // At most half of the blocks stay in memory beyond that of the cluster.
    const std::size_t matrix = 2 * (rows + mixed) * sizeof(Dense<12>) / blocks;
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
