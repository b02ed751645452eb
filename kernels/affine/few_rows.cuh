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

inline __global__ void __launch_bounds__(kThreads)
    factorize_few_rows(GradientVectors v, Span<const AffineVec> right) {
  extern __shared__ __align__(16) unsigned char storage[];
  double* const a = reinterpret_cast<double*>(storage);
  const auto n = static_cast<int>(12 * right.size), line = n + 1;
  const auto thread = static_cast<int>(threadIdx.x);
  load(v, right, a);
  __syncthreads();
  bool is_positive = true;  // the same in all threads
  for (int k = 0; k < n; ++k) {
    const double pivot = a[k * line + k];
    is_positive = is_positive && pivot >= 0;
    const double inverse = inverse_of(pivot);
    for (int i = k + 1 + thread / kSide; i <= n; i += kSide) {
      const double factor = a[i * line + k] * inverse;
      const int last = i < n ? i : n - 1;
      for (int j = k + 1 + thread % kSide; j <= last; j += kSide)
        a[i * line + j] -= factor * a[j * line + k];
    }
    __syncthreads();
  }
  if (thread >= 32) return;
  double left[kColumns], inverse[kColumns];  // of columns lane, lane + 32 and so on
#pragma unroll
  for (int c = 0; c < kColumns; ++c) {
    const int j = thread + 32 * c;
    left[c] = j < n ? a[n * line + j] : 0;
    inverse[c] = j < n ? inverse_of(a[j * line + j]) : 0;
  }
  for (int k = n - 1; k >= 0; --k) {
    double mine = 0;
#pragma unroll
    for (int c = 0; c < kColumns; ++c) mine = k / 32 == c ? left[c] * inverse[c] : mine;
    const double x = __shfl_sync(0xffffffffu, mine, k % 32);
    if (thread == 0) v.x[k / 12].node[k % 12 / 3][k % 3] = x;
#pragma unroll
    for (int c = 0; c < kColumns; ++c) {
      const int j = thread + 32 * c;
      if (j < k) left[c] -= a[k * line + j] * x;
    }
  }
  if (thread != 0) return;
  GradientState s;
  s.iterations = 1;
  s.is_done = is_positive;
  *v.state = s;
}

}  // namespace few_rows

/// @param v  its step and state are set
inline void factorize_few_rows(Cuda& cuda, const GradientVectors& v, Span<const AffineVec> right) {
  const auto rows = static_cast<Index>(right.size);
  check_cuda(cudaFuncSetAttribute(few_rows::factorize_few_rows,
                                  cudaFuncAttributeMaxDynamicSharedMemorySize,
                                  static_cast<int>(few_rows::bytes(few_rows::kMost))),
             "shared memory of factorize_few_rows");
  few_rows::factorize_few_rows<<<1, few_rows::kThreads, few_rows::bytes(rows), cuda.stream()>>>(
      v, right);
  cuda.check_launch("factorize_few_rows");
}

}  // namespace scree::affine
