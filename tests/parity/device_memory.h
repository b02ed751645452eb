#pragma once
// Reads and writes what an ArrayView points at, as a program outside the library would.

#include <gtest/gtest.h>

#include <cstring>

#include "host/arrays.h"
#ifdef SCREE_HAS_CUDA
#include <cuda_runtime.h>
#endif

namespace scree::parity {

/// @param at  inside the view
inline void read_memory(const ArrayView& v, const void* at, void* to, std::size_t bytes) {
  if (v.backend == BackendKind::cpu) {
    std::memcpy(to, at, bytes);
    return;
  }
#ifdef SCREE_HAS_CUDA
  ASSERT_EQ(cudaMemcpy(to, at, bytes, cudaMemcpyDeviceToHost), cudaSuccess);
#endif
}

inline void write_memory(const ArrayView& v, void* at, const void* from, std::size_t bytes) {
  if (v.backend == BackendKind::cpu) {
    std::memcpy(at, from, bytes);
    return;
  }
#ifdef SCREE_HAS_CUDA
  ASSERT_EQ(cudaMemcpy(at, from, bytes, cudaMemcpyHostToDevice), cudaSuccess);
  ASSERT_EQ(cudaDeviceSynchronize(), cudaSuccess);  // the call may return before the copy is done
#endif
}

}  // namespace scree::parity
