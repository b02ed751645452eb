#pragma once
// Records of numbers turned into lanes and back, in registers. One number at a time would take a load and a store for each, and
// the vector that is read behind the stores waits until they are done. The contact pass of APGD takes 0.64 of the time (AMD
// EPYC without AVX-512, float).

#include <cstring>

#include "kernels/backend/lanes.h"
#include "kernels/contact/contact_problem.h"

namespace scree {

/// Four records at a time, as many fours as a vector register takes.
template <class Real>
class TurnedRecords {
 public:
  using L = Lanes<Real>;
  static constexpr int kFour = 4;
  /// Whether registers hold whole fours.
  static constexpr bool kWorks = L::kCount % kFour == 0;

  /// Vectors that follow each other.
  static Vec3<L> vectors(const Vec3<Real>* from) {
    static_assert(sizeof(Vec3<Real>) == 3 * sizeof(Real));
    Four x[kFours], y[kFours], z[kFours];
    for (int k = 0; k < kFours; ++k) {
      Four a, b, c;
      const Real* first = &from[k * kFour].x;
      read(first, a);                                             // x0 y0 z0 x1
      read(first + 4, b);                                         // y1 z1 x2 y2
      read(first + 8, c);                                         // z2 x3 y3 z3
      const Four ab = __builtin_shufflevector(a, b, 1, 2, 4, 5);  // y0 z0 y1 z1
      const Four bc = __builtin_shufflevector(b, c, 2, 3, 5, 6);  // x2 y2 x3 y3
      const Four cc = __builtin_shufflevector(c, c, 0, 3, 0, 3);  // z2 z3
      x[k] = __builtin_shufflevector(a, bc, 0, 3, 4, 6);
      y[k] = __builtin_shufflevector(ab, bc, 0, 2, 5, 7);
      z[k] = __builtin_shufflevector(ab, cc, 1, 3, 4, 5);
    }
    return {joined(x), joined(y), joined(z)};
  }
  /// The way back.
  static void store(const Vec3<L>& v, Vec3<Real>* to) {
    Four x[kFours], y[kFours], z[kFours];
    parted(v.x, x), parted(v.y, y), parted(v.z, z);
    for (int k = 0; k < kFours; ++k) {
      const Four xy = __builtin_shufflevector(x[k], y[k], 0, 4, 1, 5);    // x0 y0 x1 y1
      const Four zx = __builtin_shufflevector(z[k], x[k], 0, 5, 2, 7);    // z0 x1 z2 x3
      const Four yz = __builtin_shufflevector(y[k], z[k], 1, 5, 3, 7);    // y1 z1 y3 z3
      const Four high = __builtin_shufflevector(x[k], y[k], 2, 6, 3, 7);  // x2 y2 x3 y3
      Real* first = &to[k * kFour].x;
      write(__builtin_shufflevector(xy, zx, 0, 1, 4, 5), first);
      write(__builtin_shufflevector(yz, high, 0, 1, 4, 5), first + 4);
      write(__builtin_shufflevector(zx, yz, 2, 3, 6, 7), first + 8);
    }
  }
  /// Twists of bodies, from anywhere.
  static Twist<L> twists(const Twist<Real>* all, const Index* body) {
    static_assert(sizeof(Twist<Real>) == 6 * sizeof(Real));
    Four row[6][kFours];
    for (int k = 0; k < kFours; ++k) {
      Four head[kFour];
      Two tail[kFour];
      for (int j = 0; j < kFour; ++j) {
        const Real* first = &all[body[k * kFour + j]].linear.x;
        read(first, head[j]), read(first + 4, tail[j]);
      }
      const Four low0 = __builtin_shufflevector(head[0], head[1], 0, 4, 1, 5);
      const Four low1 = __builtin_shufflevector(head[2], head[3], 0, 4, 1, 5);
      const Four high0 = __builtin_shufflevector(head[0], head[1], 2, 6, 3, 7);
      const Four high1 = __builtin_shufflevector(head[2], head[3], 2, 6, 3, 7);
      const Four tail0 = __builtin_shufflevector(tail[0], tail[1], 0, 2, 1, 3);
      const Four tail1 = __builtin_shufflevector(tail[2], tail[3], 0, 2, 1, 3);
      row[0][k] = __builtin_shufflevector(low0, low1, 0, 1, 4, 5);
      row[1][k] = __builtin_shufflevector(low0, low1, 2, 3, 6, 7);
      row[2][k] = __builtin_shufflevector(high0, high1, 0, 1, 4, 5);
      row[3][k] = __builtin_shufflevector(high0, high1, 2, 3, 6, 7);
      row[4][k] = __builtin_shufflevector(tail0, tail1, 0, 1, 4, 5);
      row[5][k] = __builtin_shufflevector(tail0, tail1, 2, 3, 6, 7);
    }
    return {{joined(row[0]), joined(row[1]), joined(row[2])},
            {joined(row[3]), joined(row[4]), joined(row[5])}};
  }

 private:
  static constexpr int kFours = kWorks ? L::kCount / kFour : 1;
  using Two [[gnu::vector_size(2 * sizeof(Real))]] = Real;
  using Four [[gnu::vector_size(4 * sizeof(Real))]] = Real;
  using Eight [[gnu::vector_size(8 * sizeof(Real))]] = Real;
  using Whole [[gnu::vector_size(L::kCount * sizeof(Real))]] = Real;

  // Vectors go by reference: as values they would be passed in registers that not every processor has.
  template <class V>
  static void read(const Real* from, V& v) {
    std::memcpy(&v, from, sizeof(V));
  }
  template <class V>
  static void write(const V& v, Real* to) {
    std::memcpy(to, &v, sizeof(V));
  }
  static void pair(const Four& a, const Four& b, Eight& v) {
    v = __builtin_shufflevector(a, b, 0, 1, 2, 3, 4, 5, 6, 7);
  }
  static L joined(const Four (&v)[kFours]) {
    using Vector = typename L::Vector;
    if constexpr (kFours == 1) {
      return L(static_cast<Vector>(v[0]));
    } else if constexpr (kFours == 2) {
      Eight all;
      pair(v[0], v[1], all);
      return L(static_cast<Vector>(all));
    } else {
      static_assert(kFours == 4);
      Eight low, high;
      pair(v[0], v[1], low), pair(v[2], v[3], high);
      return L(static_cast<Vector>(__builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9,
                                                           10, 11, 12, 13, 14, 15)));
    }
  }
  static void parted(const L& lanes, Four (&v)[kFours]) {
    const auto whole = static_cast<Whole>(lanes.vector());
    if constexpr (kFours == 1) {
      v[0] = whole;
    } else if constexpr (kFours == 2) {
      v[0] = __builtin_shufflevector(whole, whole, 0, 1, 2, 3);
      v[1] = __builtin_shufflevector(whole, whole, 4, 5, 6, 7);
    } else {
      v[0] = __builtin_shufflevector(whole, whole, 0, 1, 2, 3);
      v[1] = __builtin_shufflevector(whole, whole, 4, 5, 6, 7);
      v[2] = __builtin_shufflevector(whole, whole, 8, 9, 10, 11);
      v[3] = __builtin_shufflevector(whole, whole, 12, 13, 14, 15);
    }
  }
};

}  // namespace scree
