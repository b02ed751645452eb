#pragma once
// Points of contact of two faces, and the four of them that stay.

#include <cmath>

#include "kernels/narrow_phase/pairs/manifold.h"

namespace scree {

/// Points of a face contact, in the plane of the reference face.
struct FacePoints {
  static constexpr int kMaxPoints = 16;
  /// Points that have not been tested yet: corners of both faces, and where their sides cross.
  static constexpr int kMaxOffers = 24;
  int count = 0;
  int point[kMaxOffers];
  double u[kMaxOffers], v[kMaxOffers], gap[kMaxPoints];

  SCREE_HD bool has(double u_, double v_, double tie) const {
    for (int k = 0; k < count; ++k) {
      if (std::abs(u[k] - u_) <= 2 * tie && std::abs(v[k] - v_) <= 2 * tie) return true;
    }
    return false;
  }
  SCREE_HD void add(int p, double u_, double v_, double gap_) {
    if (count == kMaxPoints) return;
    gap[count] = gap_;
    offer(p, u_, v_);
  }
  SCREE_HD void offer(int p, double u_, double v_) {
    point[count] = p, u[count] = u_, v[count] = v_;
    ++count;
  }
  /// Twice the area of a triangle, positive when it is counterclockwise.
  SCREE_HD double area(int i, int j, int k) const {
    return (u[j] - u[i]) * (v[k] - v[i]) - (v[j] - v[i]) * (u[k] - u[i]);
  }
};

/// The four points that stay of many: the deepest one, that farthest from it, and those that make
/// the area largest. A later point must be better by more than rounding.
/// @return  how many; `kept` are their places
SCREE_HD inline int reduced(const FacePoints& p, double tie, int kept[Manifold::kMaxContacts]) {
  constexpr double kBetter = 1 + 1e-3;
  if (p.count <= Manifold::kMaxContacts) {
    for (int k = 0; k < p.count; ++k) kept[k] = k;
    return p.count;
  }
  int first = 0, far = 0;
  for (int k = 1; k < p.count; ++k) first = p.gap[k] < p.gap[first] - tie ? k : first;
  double best = 0;
  for (int k = 0; k < p.count; ++k) {
    const double du = p.u[k] - p.u[first], dv = p.v[k] - p.v[first];
    const double found = du * du + dv * dv;
    if (found > best * kBetter) best = found, far = k;
  }
  int third = first;
  best = 0;
  for (int k = 0; k < p.count; ++k) {
    const double found = std::abs(p.area(first, far, k));
    if (found > best * kBetter) best = found, third = k;
  }
  if (third == first) {  // all on a line
    kept[0] = first, kept[1] = far;
    return 2;
  }
  const double turn = p.area(first, far, third) < 0 ? -1 : 1;
  int fourth = first;
  best = 0;
  for (int k = 0; k < p.count; ++k) {
    const double sides[] = {p.area(first, far, k), p.area(far, third, k), p.area(third, first, k)};
    for (const double side : sides) {
      if (-turn * side > best * kBetter) best = -turn * side, fourth = k;
    }
  }
  kept[0] = first, kept[1] = far, kept[2] = third, kept[3] = fourth;
  return fourth == first ? 3 : 4;
}

/// The same. @param kept  out: the numbers of the points, ascending
/// @param least  out: the least gap of them [m]
SCREE_HD inline int reduced(const FacePoints& p, double tie, int kept[Manifold::kMaxContacts],
                            double& least) {
  const int count = reduced(p, tie, kept);
  for (int k = 0; k < count; ++k) {
    const double gap = p.gap[kept[k]];
    least = gap < least ? gap : least;
    const int number = p.point[kept[k]];
    int at = k;
    for (; at > 0 && kept[at - 1] > number; --at) kept[at] = kept[at - 1];
    kept[at] = number;
  }
  return count;
}

}  // namespace scree
