#pragma once
// Tuned twin of conjugate gradients: one cooperative launch runs a whole solve, a warp a row. Systems of few rows go to
// cluster_gradients.cuh, those of very few to few_rows.cuh.
//
// Bytes of an iteration: 1,152 a diagonal block and its inverse, twice 1,152 a block above the diagonal, 8 x 96 a row; systems of some
// thousand rows stay in the second-level cache. What an iteration takes at least are two meetings of all blocks, some 2 us each.

#include "kernels/affine/cluster_gradients.cuh"
#include "kernels/affine/few_rows.cuh"
#include "kernels/affine/gradient_iteration.h"
#include "kernels/backend/cuda.cuh"
#include "kernels/backend/device_counter.cuh"

namespace scree::affine {
namespace gradients {

inline constexpr int kThreads = Cuda::kBlock;
inline constexpr int kWarps = kThreads / 32;
inline constexpr unsigned kAll = 0xffffffffu;

/// Where blocks meet, in device memory; the counter starts at zero with a solve.
struct Meeting {
  unsigned* arrived;
  double* partial;  ///< [2][blocks]
};

/// Sum over the block in a fixed order, for all of its threads.
__device__ inline double block_total(double mine) {
  __shared__ double of_warp[kWarps];
#pragma unroll
  for (int step = 16; step > 0; step /= 2) mine += __shfl_down_sync(kAll, mine, step);
  __syncthreads();
  if (threadIdx.x % 32 == 0) of_warp[threadIdx.x / 32] = mine;
  __syncthreads();
  double sum = 0;
#pragma unroll
  for (int k = 0; k < kWarps; ++k) sum += of_warp[k];
  return sum;
}

/// Sum over all blocks, the same bits in each. What they wrote before is visible then.
__device__ inline double meet(const Meeting& m, unsigned& round, double mine) {
  const double own = block_total(mine);
  double* partial = m.partial + (round % 2) * gridDim.x;
  if (threadIdx.x == 0) {
    partial[blockIdx.x] = own;
    DeviceCounter(*m.arrived).fetch_add(1, cuda::memory_order_release);
    wait_for(*m.arrived, (round + 1) * gridDim.x);
  }
  __syncthreads();
  ++round;
  double sum = 0;
  for (unsigned k = threadIdx.x; k < gridDim.x; k += kThreads) sum += partial[k];
  return block_total(sum);
}

__device__ inline double* numbers(AffineVec& v) { return &v.node[0].x; }
__device__ inline const double* numbers(const AffineVec& v) { return &v.node[0].x; }

/// A warp's product of a block with a vector, whose entry i is in lane i: lanes 0 to 11 and 12 to 23 take half a line each.
struct Lanes {
  int lane = static_cast<int>(threadIdx.x % 32);
  int line = lane % 12;
  int from = 6 * (lane / 12 % 2);

  __device__ double part(const Dense<12>& m, bool is_turned, double vector) const {
    double sum = 0;
#pragma unroll
    for (int k = 0; k < 6; ++k) {
      const int j = from + k;
      const double x = __shfl_sync(kAll, vector, j);
      sum += m.entry[is_turned ? 12 * j + line : 12 * line + j] * x;
    }
    return sum;
  }
  /// Entry i of a product in lane i, of the parts of both halves.
  __device__ double whole(double part) const { return part + __shfl_down_sync(kAll, part, 12); }
};

inline __global__ void __launch_bounds__(kThreads)
    run_gradients(GradientVectors v, Span<const AffineVec> right, Meeting meeting, double tolerance,
                  int most) {
  const auto rows = static_cast<Index>(right.size);
  const auto first = static_cast<Index>(blockIdx.x * kWarps + threadIdx.x / 32);
  const auto stride = static_cast<Index>(gridDim.x * kWarps);
  const Lanes at;
  const bool holds = at.lane < 12;
  unsigned round = 0;
  GradientState s;
  double sum = 0;
  for (Index row = first; row < rows; row += stride) {
    const double r = holds ? numbers(right[row])[at.lane] : 0;
    const double z = at.whole(at.part(v.inverse[row], false, r));
    if (!holds) continue;
    numbers(v.x[row])[at.lane] = 0;
    numbers(v.p[row])[at.lane] = 0;
    numbers(v.r[row])[at.lane] = r;
    numbers(v.z[row])[at.lane] = z;
    sum += r * z;
  }
  s.along = s.first = meet(meeting, round, sum);
  AffineVec *p = v.p.data, *next_p = v.next_p.data;
  s.is_done = !(s.along > 0);
  while (!s.is_done && s.iterations < most) {
    sum = 0;
    for (Index row = first; row < rows; row += stride) {
      const auto direction = [&](Index of) {
        return holds ? numbers(v.z[of])[at.lane] + s.beta * numbers(p[of])[at.lane] : 0;
      };
      const double own = direction(row);
      double part = at.part(v.diagonal[row], false, own);
      for (Index k = v.lists.begin[row]; k < v.lists.begin[row + 1]; ++k) {
        const Index entry = v.lists.entry[k];
        const MixedBlock& m = v.lists.mixed[entry / 2];
        const bool is_turned = entry % 2 != 0;
        part += at.part(m.value, is_turned, direction(is_turned ? m.row : m.column));
      }
      const double image = at.whole(part);
      if (!holds) continue;
      numbers(next_p[row])[at.lane] = own;
      numbers(v.image[row])[at.lane] = image;
      sum += own * image;
    }
    const double curvature = meet(meeting, round, sum);
    if (!(curvature > 0)) {
      s.is_done = true;
      break;
    }
    s.alpha = s.along / curvature;
    sum = 0;
    for (Index row = first; row < rows; row += stride) {
      double r = 0;
      if (holds) {
        numbers(v.x[row])[at.lane] += s.alpha * numbers(next_p[row])[at.lane];
        r = numbers(v.r[row])[at.lane] - s.alpha * numbers(v.image[row])[at.lane];
        numbers(v.r[row])[at.lane] = r;
      }
      const double z = at.whole(at.part(v.inverse[row], false, r));
      if (!holds) continue;
      numbers(v.z[row])[at.lane] = z;
      sum += r * z;
    }
    const double along = meet(meeting, round, sum);
    s.beta = along / s.along;
    s.along = along;
    ++s.iterations;
    s.is_done = !(along > tolerance * tolerance * s.first);
    AffineVec* old = p;
    p = next_p, next_p = old;
  }
  if (blockIdx.x == 0 && threadIdx.x == 0) *v.state = s;
}

}  // namespace gradients

template <>
class GradientIteration<Cuda> {
 public:
  explicit GradientIteration(Cuda& cuda) : cluster_(cuda), arrived_(cuda, 1), partial_(cuda) {}

  static bool wants_inverse(Index rows) { return rows > few_rows::kMost; }

  void run(Cuda& cuda, GradientVectors v, Span<const AffineVec> right, double tolerance, int most,
           GradientState* end) {
    v.state = end;
    if (!wants_inverse(static_cast<Index>(right.size))) {
      factorize_few_rows(cuda, v, right);
      return;
    }
    const auto rows = static_cast<unsigned>(right.size);
    if (cluster_.can_run(rows, static_cast<std::size_t>(v.lists.mixed.size))) {
      cluster_.run(cuda, v, right, tolerance, most);
      return;
    }
    const unsigned blocks = std::min(cuda.resident_blocks(kernel(), "occupancy of block_gradients"),
                                     (rows + gradients::kWarps - 1) / gradients::kWarps);
    partial_.reserve_discard(2 * Offset{blocks});
    fill(cuda, arrived_.view(), 0u);
    gradients::Meeting meeting{arrived_.data(), partial_.data()};
    void* arguments[] = {&v, &right, &meeting, &tolerance, &most};
    check_cuda(cudaLaunchCooperativeKernel(kernel(), blocks, gradients::kThreads, arguments, 0,
                                           cuda.stream()),
               "block_gradients");
    cuda.check_launch("block_gradients");
  }

 private:
  static const void* kernel() { return reinterpret_cast<const void*>(&gradients::run_gradients); }

  ClusterGradients cluster_;
  Buffer<Cuda, unsigned> arrived_;
  Buffer<Cuda, double> partial_;
};

}  // namespace scree::affine
