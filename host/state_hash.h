#pragma once
// Bit patterns of all body states in one number: runs that give the same are the same to the bit.

#include <bit>
#include <cstdint>

#include "host/world.h"

namespace scree {

/// FNV-1a over the bits of all positions, orientations and velocities.
inline std::uint64_t state_hash(const BodyStates& s) {
  std::uint64_t hash = 14695981039346656037ull;
  const auto add = [&](double x) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(x)) * 1099511628211ull;
  };
  const auto add_vec = [&](const Vec3d& v) { add(v.x), add(v.y), add(v.z); };
  for (const Vec3d& x : s.position) add_vec(x);
  for (const Quatd& q : s.orientation) add(q.w), add_vec(q.vec());
  for (const Vec3d& v : s.velocity) add_vec(v);
  for (const Vec3d& w : s.angular_velocity) add_vec(w);
  return hash;
}

}  // namespace scree
