#pragma once
// When a moving pair first touches, without rounding: the interval [0, 1] is halved as long as the
// four points may be in a plane there, and the features may overlap in it.

#include "kernels/affine/nearest.h"
#include "tests/exact_number.h"

namespace scree::exact {

enum class Touch : std::uint8_t {
  never,
  within,  ///< for certain, between `from` and `to`, and not before `from`
  unclear  ///< not before `from`; touches with a corner or an edge end here
};

struct FirstTouch {
  Touch touch = Touch::never;
  Number from, to;
};

namespace detail {

constexpr int kHalvings = 50;

inline int sign_of_all(const Polynomial& p) {
  int sign = 2;
  for (const Number& b : p.bernstein()) {
    if (sign != 2 && b.sign() != sign) return 0;
    sign = b.sign();
  }
  return sign == 2 ? 0 : sign;
}

/// @param volume  zero where the points are in a plane. @param inside  none negative where features
/// overlap then
inline FirstTouch search(const Polynomial& volume, const std::vector<Polynomial>& inside,
                         const Number& from, int halvings) {
  if (sign_of_all(volume) != 0) return {};
  bool certain = volume.c.front().sign() * volume.bernstein().back().sign() <= 0;
  for (const Polynomial& p : inside) {
    const int sign = sign_of_all(p);
    if (sign < 0) return {};
    certain = certain && sign > 0;
  }
  const Number width = Number(1).scaled(-halvings);
  if (halvings == kHalvings) return {certain ? Touch::within : Touch::unclear, from, from + width};
  const auto halves = [](const std::vector<Polynomial>& all, bool upper) {
    std::vector<Polynomial> r;
    for (const Polynomial& p : all)
      r.push_back(upper ? p.lower_half().moved_by_one() : p.lower_half());
    return r;
  };
  const FirstTouch lower = search(volume.lower_half(), halves(inside, false), from, halvings + 1);
  if (lower.touch != Touch::never) return lower;
  return search(volume.lower_half().moved_by_one(), halves(inside, true), from + width.scaled(-1),
                halvings + 1);
}

}  // namespace detail

inline FirstTouch first_touch(affine::PairKind kind, const affine::Four& from,
                              const affine::Four& to) {
  std::array<Vector<Polynomial>, 4> x;
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k)
      x[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)].c = {
          from[i][k], Number(to[i][k]) - Number(from[i][k])};
  std::vector<Polynomial> inside;
  Polynomial volume;
  if (kind == affine::PairKind::point_triangle) {
    const Vector<Polynomial> normal = cross(x[2] - x[1], x[3] - x[1]);
    volume = dot(normal, x[0] - x[1]);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto &a = x[1 + k], &b = x[1 + (k + 1) % 3];
      inside.push_back(dot(cross(b - a, x[0] - a), normal));
    }
  } else {
    const Vector<Polynomial> e = x[1] - x[0], f = x[3] - x[2], d = x[2] - x[0],
                             normal = cross(e, f);
    volume = dot(normal, d);
    const Polynomial all = dot(normal, normal);
    for (const Polynomial& along : {dot(cross(d, f), normal), dot(cross(d, e), normal)}) {
      inside.push_back(along);
      inside.push_back(all - along);
    }
  }
  return detail::search(volume, inside, Number(), 0);
}

}  // namespace scree::exact
