#pragma once
// Records moved by wide loads. Neighbors in a warp want records that lie apart, and a load takes a cycle of the
// first-level cache for each line that it touches; in loads of 4 bytes a twist takes six of them.

#include <cstring>

#include "kernels/math/vec3.h"

namespace scree {

/// A record by loads of sizeof(Chunk) bytes, to which it has to be aligned.
template <class Chunk, class T>
__device__ T load_by(const T* from) {
  static_assert(sizeof(T) % sizeof(Chunk) == 0);
  Chunk part[sizeof(T) / sizeof(Chunk)];
#pragma unroll
  for (unsigned k = 0; k < sizeof(T) / sizeof(Chunk); ++k)
    part[k] = reinterpret_cast<const Chunk*>(from)[k];
  T to;
  std::memcpy(&to, part, sizeof(T));
  return to;
}
template <class Chunk, class T>
__device__ void store_by(const T& from, T* to) {
  static_assert(sizeof(T) % sizeof(Chunk) == 0);
  Chunk part[sizeof(T) / sizeof(Chunk)];
  std::memcpy(part, &from, sizeof(T));
#pragma unroll
  for (unsigned k = 0; k < sizeof(T) / sizeof(Chunk); ++k)
    reinterpret_cast<Chunk*>(to)[k] = part[k];
}
__device__ inline float4 widened(const Vec3<float>& v, float w = 0) {
  return make_float4(v.x, v.y, v.z, w);
}
__device__ inline Vec3<float> narrowed(const float4& v) { return {v.x, v.y, v.z}; }

}  // namespace scree
