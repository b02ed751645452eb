#pragma once
// Vectors and quaternions as flat rows of doubles, which is how files hold them.

#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "host/scene.h"

namespace scree {

static_assert(sizeof(Vec3d) == 3 * sizeof(double) && std::is_standard_layout_v<Vec3d>);
static_assert(sizeof(Quatd) == 4 * sizeof(double) && std::is_standard_layout_v<Quatd>);

inline std::span<const double> values(const std::vector<Vec3d>& v) {
  return {reinterpret_cast<const double*>(v.data()), 3 * v.size()};
}
inline std::span<double> values(std::vector<Vec3d>& v) {
  return {reinterpret_cast<double*>(v.data()), 3 * v.size()};
}
inline std::span<const double> values(const std::vector<Quatd>& v) {
  return {reinterpret_cast<const double*>(v.data()), 4 * v.size()};
}
inline std::span<double> values(std::vector<Quatd>& v) {
  return {reinterpret_cast<double*>(v.data()), 4 * v.size()};
}
template <class T>
std::span<const T> values(const std::vector<T>& v) {
  return v;
}
template <class T>
std::span<T> values(std::vector<T>& v) {
  return v;
}

}  // namespace scree
