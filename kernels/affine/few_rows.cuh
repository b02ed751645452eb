#pragma once
// Systems of a few rows, factorized by one block of threads in its shared memory: L D L^T of the whole matrix, with the right-hand
// side as one more line below it, which comes out as the solution of the lower triangle. Source: Golub and Van Loan, Matrix
// Computations, section 4.1. Conjugate gradients take two meetings an iteration, and bodies that press on each other many of these.

#include "kernels/affine/block_gradients.h"
#include "kernels/backend/cuda.cuh"

namespace scree::affine {
namespace few_rows {

inline constexpr Index kMost = 8;  ///< more are left to gradients
inline constexpr int kSide = 16, kThreads = kSide * kSide;
inline constexpr int kColumns = (12 * kMost + 31) / 32;  ///< of a lane of the first warp

inline constexpr std::size_t bytes(Index rows) {
  const auto n = static_cast<std::size_t>(12 * rows);
  return (n + 1) * (n + 1) * sizeof(double);
}

/// Zero where equations leave nothing of a number: its line and its right-hand side are zeros too.
__device__ inline double inverse_of(double pivot) { return pivot == 0 ? 0 : 1 / pivot; }

/// The lower triangle in lines of n + 1 numbers, which is odd: threads along a column read different banks.
__device__ inline void load(const GradientVectors& v, Span<const AffineVec> right, double* a) {
  const auto n = static_cast<int>(12 * right.size);
  const auto thread = static_cast<int>(threadIdx.x);
  const auto place = [&](int i, int j) -> double& { return a[i * (n + 1) + j]; };
  for (int k = thread; k < (n + 1) * (n + 1); k += kThreads) a[k] = 0;
  __syncthreads();
  for (int k = thread; k < 12 * n; k += kThreads) {
    const int i = k / 12, row = i / 12;
    place(i, 12 * row + k % 12) = v.diagonal[row](i % 12, k % 12);
  }
  for (int k = thread; k < n; k += kThreads) place(n, k) = entry_of(right[k / 12], k % 12);
  for (int row = 0; row < static_cast<int>(right.size); ++row) {
    const Index begin = v.lists.begin[row];
    const int numbers = 144 * (v.lists.begin[row + 1] - begin);
    for (int k = thread; k < numbers; k += kThreads) {
      const Index half = v.lists.entry[begin + k / 144];
      if (half % 2 == 0) continue;  // above the diagonal
      const MixedBlock& m = v.lists.mixed[half / 2];
      const int i = k % 144 / 12, j = k % 12;
      place(12 * row + i, 12 * m.row + j) = m.value(j, i);
    }
  }
}

/// The solution, by the first warp, of the upper triangle that lies below the diagonal as columns.
__device__ inline void solve_upper(const double* a, int n, int lane, const GradientVectors& v) {
  double left[kColumns], inverse[kColumns];  // of columns lane, lane + 32 and so on
#pragma unroll
  for (int c = 0; c < kColumns; ++c) {
    const int j = lane + 32 * c;
    left[c] = j < n ? a[n * (n + 1) + j] : 0;
    inverse[c] = j < n ? inverse_of(a[j * (n + 1) + j]) : 0;
  }
  for (int k = n - 1; k > 0; --k) {
    double mine = 0;
#pragma unroll
    for (int c = 0; c < kColumns; ++c) mine = k / 32 == c ? left[c] * inverse[c] : mine;
    const double x = __shfl_sync(0xffffffffu, mine, k % 32);
#pragma unroll
    for (int c = 0; c < kColumns; ++c) {
      const int j = lane + 32 * c;
      if (j < k) left[c] -= a[k * (n + 1) + j] * x;
    }
  }
#pragma unroll
  for (int c = 0; c < kColumns; ++c) {
    const int j = lane + 32 * c;
    if (j < n) v.x[j / 12].node[j % 12 / 3][j % 3] = left[c] * inverse[c];
  }
}

/// Each thread keeps every kSide-th number of every kSide-th line, kTiles^2 of them. A column is finished in shared memory, where all
/// read it, and never written again: one meeting a column.
template <int kTiles>
__global__ void __launch_bounds__(kThreads)
    factorize_few_rows(GradientVectors v, Span<const AffineVec> right) {
  extern __shared__ __align__(16) unsigned char storage[];
  double* const a = reinterpret_cast<double*>(storage);
  const auto n = static_cast<int>(12 * right.size), line = n + 1;
  const auto thread = static_cast<int>(threadIdx.x);
  const int down = thread / kSide, across = thread % kSide;
  load(v, right, a);
  __syncthreads();
  double own[kTiles][kTiles];
#pragma unroll
  for (int p = 0; p < kTiles; ++p) {
#pragma unroll
    for (int q = 0; q < kTiles; ++q) {
      const int i = down + kSide * p, j = across + kSide * q;
      own[p][q] = i <= n && j < n ? a[i * line + j] : 0;
    }
  }
  bool is_positive = true;  // the same in all threads
#pragma unroll
  for (int tile = 0; tile < kTiles;
       ++tile) {  // of columns, so that it is known which registers hold them
    for (int k = kSide * tile; k < kSide * (tile + 1) && k < n; ++k) {
      if (across == k % kSide) {
#pragma unroll
        for (int p = tile; p < kTiles; ++p) {
          const int i = down + kSide * p;
          if (i >= k && i <= n) a[i * line + k] = own[p][tile];
        }
      }
      __syncthreads();
      const double pivot = a[k * line + k], inverse = inverse_of(pivot);
      is_positive = is_positive && pivot >= 0;
      double column[kTiles];
#pragma unroll
      for (int q = tile; q < kTiles; ++q) {
        const int j = across + kSide * q;
        column[q] = j > k && j < n ? a[j * line + k] : 0;
      }
#pragma unroll
      for (int p = tile; p < kTiles; ++p) {
        const int i = down + kSide * p;
        const double factor = i > k && i <= n ? a[i * line + k] * inverse : 0;
#pragma unroll
        for (int q = tile; q < kTiles; ++q) own[p][q] -= factor * column[q];
      }
    }
  }
  if (thread < 32) solve_upper(a, n, thread, v);
  if (thread != 0) return;
  GradientState s;
  s.iterations = 1;
  s.is_done = is_positive;
  *v.state = s;
}

/// Compiled for as many tiles as a system needs.
template <int kTiles = 1>
void launch(Cuda& cuda, const GradientVectors& v, Span<const AffineVec> right) {
  const auto rows = static_cast<Index>(right.size);
  if constexpr (kSide * kTiles <= 12 * kMost) {
    if (kSide * kTiles <= 12 * rows) return launch<kTiles + 1>(cuda, v, right);
  }
  check_cuda(
      cudaFuncSetAttribute(factorize_few_rows<kTiles>, cudaFuncAttributeMaxDynamicSharedMemorySize,
                           static_cast<int>(bytes(kMost))),
      "shared memory of factorize_few_rows");
  factorize_few_rows<kTiles><<<1, kThreads, bytes(rows), cuda.stream()>>>(v, right);
}

}  // namespace few_rows

/// @param v  its step and state are set
inline void factorize_few_rows(Cuda& cuda, const GradientVectors& v, Span<const AffineVec> right) {
  few_rows::launch(cuda, v, right);
  cuda.check_launch("factorize_few_rows");
}

}  // namespace scree::affine
