#pragma once
// A list of pair functions that element programs choose from by the kinds of two shapes.

#include "kernels/narrow_phase/pairs/manifold.h"
#include "kernels/narrow_phase/pairs/pair_side.h"
#include "shapes/shape_kind.h"

namespace scree {

/// Of two bodies, or of a body and a solid wall.
template <class P>
concept IsBodyPair = requires {
  P::kFeatureBits;
};
/// Of a body and a plane.
template <class P>
concept IsPlanePair = requires {
  P::kCorners;
};

/// Of a convex body and a mesh wall.
template <class P>
concept IsMeshPair = requires {
  P::kTriangleBits;
};

template <class P>
constexpr int feature_bits_of() {
  if constexpr (IsBodyPair<P>) return P::kFeatureBits;
  if constexpr (IsMeshPair<P>) return P::kTriangleBits;
  return 0;
}

struct ConvexProgram;
/// Runs many pair functions: those of shapes that have cores.
using SharedProgram = ConvexProgram;

template <class P>
inline constexpr bool kIsShared = requires {
  typename P::Program;
};
/// What runs a pair function: itself, or the shared program.
template <class P>
using ProgramOf = std::conditional_t<kIsShared<P>, SharedProgram, P>;

template <class... P>
struct PairTypes {
  /// Pair functions of two bodies, and those of them that run by themselves.
  static constexpr int kBodyPairs = (0 + ... + (IsBodyPair<P> ? 1 : 0));
  static constexpr int kOwnPrograms = (0 + ... + (IsBodyPair<P> && !kIsShared<P> ? 1 : 0));
  /// Programs that run them.
  static constexpr int kPrograms = kOwnPrograms + (kOwnPrograms < kBodyPairs ? 1 : 0);
  /// Number of the pair function of two bodies, from 0, those that run by themselves first; kBodyPairs: there is none.
  SCREE_HD static int number_of(ShapeKind a, ShapeKind b) {
    int number = 0;
    (void)((is_found<P, false>(a, b, number) || ...) || (is_found<P, true>(a, b, number) || ...));
    return number;
  }
  /// Whether the pair function of two bodies takes them in the other order.
  SCREE_HD static bool is_reversed(ShapeKind a, ShapeKind b) {
    bool is_reversed = false;
    (void)(is_any_of<P>(a, b, is_reversed) || ...);
    return is_reversed;
  }
  /// Calls f(P{}, k) for each pair function of two bodies, the k-th of the list, on the host.
  template <class F>
  static void for_each_body_pair(F&& f) {
    int k = 0;
    const auto visit = [&]<class One>(One pair) {
      if constexpr (IsBodyPair<One>) f(pair, k++);
    };
    (visit(P{}), ...);
  }
  /// Calls f(program, k) for each program, from 0, on the host: the k-th runs the pair functions numbered from
  /// first_number(k) to first_number(k + 1).
  template <class F, class Shared = SharedProgram>
  static void for_each_program(F&& f) {
    int k = 0;
    const auto visit = [&]<class One>(One pair) {
      if constexpr (IsBodyPair<One> && !kIsShared<One>) f(pair, k++);
    };
    (visit(P{}), ...);
    if constexpr (kOwnPrograms < kBodyPairs) f(Shared{}, k);
  }
  static constexpr int first_number(int k) { return k <= kOwnPrograms ? k : kBodyPairs; }
  /// Calls f(program, is_reversed) for the pair function of two bodies, if there is one: in one place for all that the
  /// shared program runs, so that f is compiled there once.
  template <class F, class Shared = SharedProgram>
  SCREE_HD static void visit_bodies(ShapeKind a, ShapeKind b, F&& f) {
    if ((visit_one<P>(a, b, f) || ...)) return;
    bool is_reversed = false;
    if ((is_shared<P>(a, b, is_reversed) || ...)) f(Shared{}, is_reversed);
  }
  /// Calls f(P{}) for the pair function of a body and a plane, if there is one.
  template <class F>
  SCREE_HD static void visit_plane(ShapeKind a, F&& f) {
    (void)(visit_one_plane<P>(a, f) || ...);
  }
  /// Whether a shape has a core: the shared program serves it, or it meets meshes.
  template <class S>
  static constexpr bool has_core() {
    return (needs_core<P, S>() || ...);
  }
  /// Calls f(P{}) for each.
  template <class F>
  static constexpr void for_each(F&& f) {
    (f(P{}), ...);
  }

 private:
  template <class One, bool kShared>
  SCREE_HD static bool is_found(ShapeKind a, ShapeKind b, int& number) {
    if constexpr (IsBodyPair<One> && kIsShared<One> == kShared) {
      bool is_reversed = false;
      if (is_of<One>(a, b, is_reversed)) return true;
      ++number;
    }
    return false;
  }
  template <class One>
  SCREE_HD static bool is_any_of(ShapeKind a, ShapeKind b, bool& is_reversed) {
    if constexpr (IsBodyPair<One>) return is_of<One>(a, b, is_reversed);
    return false;
  }
  template <class One, class F>
  SCREE_HD static bool visit_one(ShapeKind a, ShapeKind b, F&& f) {
    if constexpr (IsBodyPair<One> && !kIsShared<One>) {
      bool is_reversed = false;
      if (!is_of<One>(a, b, is_reversed)) return false;
      f(One{}, is_reversed);
      return true;
    }
    return false;
  }
  template <class One>
  SCREE_HD static bool is_shared(ShapeKind a, ShapeKind b, bool& is_reversed) {
    if constexpr (kIsShared<One>) return is_of<One>(a, b, is_reversed);
    return false;
  }
  /// Whether it is the pair function of these two, and whether in the other order.
  template <class One>
  SCREE_HD static bool is_of(ShapeKind a, ShapeKind b, bool& is_reversed) {
    constexpr ShapeKind own_a = One::A::kind, own_b = One::B::kind;
    is_reversed = own_a != own_b && a == own_b && b == own_a;
    return is_reversed || (a == own_a && b == own_b);
  }
  template <class One, class S>
  static constexpr bool needs_core() {
    if constexpr (kIsShared<One>)
      return std::is_same_v<S, typename One::A> || std::is_same_v<S, typename One::B>;
    if constexpr (IsMeshPair<One>) return std::is_same_v<S, typename One::A>;
    return false;
  }
  template <class One, class F>
  SCREE_HD static bool visit_one_plane(ShapeKind a, F&& f) {
    if constexpr (IsPlanePair<One>) {
      if (a != One::A::kind) return false;
      f(One{});
      return true;
    }
    return false;
  }
};

}  // namespace scree
