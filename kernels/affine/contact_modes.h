#pragma once
// Second derivatives of a pair, made semidefinite, as a sum of outer products m m^T of few vectors m of four points.
//
// Without a mollifier they are, in directions a = w (x) t and c = s (x) gap, for each parameter that is free, with tangents t
// made orthonormal and the slopes s of the weights w combined alike,
//   (4 b'' D + 2 b') (w (x) n)(w (x) n)^T  -  2 b' sum of (a c^T + c a^T + c c^T)
// and what is negative: a and c are orthogonal, so each term of the sum has one positive eigenvalue, in closed form. That of
// each is taken for itself: what is left out is never positive, and no eigenvalues of larger matrices are needed.
// Eigenvalues depend on what lengths are measured with. With the four points they go with 1 / size of the triangle or edge, though
// these move with their body alone; with the mass of both bodies a term is as stiff as turning bodies of that size are.
// The mollifier is a function of r = e x f. Its second derivatives are taken without those of r, which are small against the
// rest where edges are nearly parallel, and along r together with the normal. docs/theory.md, "Barrier contact".

#include "kernels/affine/contact_potential.h"
#include "kernels/affine/friction.h"

namespace scree::affine {

SCREE_HD inline double square_of(const double (&w)[4]) {
  return w[0] * w[0] + w[1] * w[1] + w[2] * w[2] + w[3] * w[3];
}

/// How the bodies of a pair give way to forces on its points.
struct PairMobility {
  Four rest;      ///< the points in coordinates of their bodies [m]
  int split = 1;  ///< points of the first body
  Mobility body[2];

  /// f M^-1 f of forces w_i n, n of length one.
  SCREE_HD double squared(const double (&w)[4]) const {
    double all = 0;
    for (int side = 0; side < 2; ++side) {
      double sum = 0;
      Vec3d moment;
      for (int i = 0; i < 4; ++i) {
        const double own = (i < split) == (side == 0) ? w[i] : 0;
        sum += own;
        moment += own * rest[i];
      }
      all += body[side].squared(sum, moment);
    }
    return all;
  }
};

/// Vectors whose outer products are summed. Each has a place that is known when this is compiled, so that they stay in registers.
struct Modes {
  static constexpr int kMost = 3;
  int count = 0;  ///< places up to the last vector
  Four at[kMost];

  /// Whether there is a vector of such a square; zeros are left where there is none.
  SCREE_HD bool begin(int place, double square) {
    if (!(square > 0)) return false;
    count = place < count ? count : place + 1;
    return true;
  }
  /// Adds scale w (x) direction.
  SCREE_HD void add(int place, double scale, const double (&w)[4], const Vec3d& direction) {
    for (int i = 0; i < 4; ++i) at[place][i] += (scale * w[i]) * direction;
  }
};

/// Eigenvalues and orthonormal eigenvectors of [[a, b], [b, c]].
struct TwoByTwo {
  double value[2];
  double vector[2][2];
};
SCREE_HD inline TwoByTwo eigen(double a, double b, double c) {
  const double half = 0.5 * (a - c), root = std::sqrt(half * half + b * b), mean = 0.5 * (a + c);
  TwoByTwo r{{mean + root, mean - root}, {{1, 0}, {0, 1}}};
  double x = half < 0 ? b : half + root, y = half < 0 ? root - half : b;
  const double length = std::sqrt(x * x + y * y);
  if (!(length > 0)) return r;
  x /= length, y /= length;
  r.vector[0][0] = x, r.vector[0][1] = y;
  r.vector[1][0] = -y, r.vector[1][1] = x;
  return r;
}

/// Parts of the modes of a pair that the barrier acts on: one, or two with a mollifier.
SCREE_HD inline int mode_parts(const Mollifier& m) { return m.first == 0 ? 1 : 2; }

/// The terms of free parameters, in the last two places. @param push  -2 b', > 0
SCREE_HD inline void add_turning_modes(const Nearest& n, double push, const Four& x,
                                       const PairMobility& mobility, Modes& modes) {
  const double weights = mobility.squared(n.weight);
  Vec3d tangent[2];
  double slope[2][4];
  for (int k = 0; k < 2; ++k) {
    if (k >= n.free) return;
    for (int i = 0; i < 4; ++i) slope[k][i] = n.slope[k][i];
    for (int i = 1; i < 4; ++i) tangent[k] += slope[k][i] * (x[i] - x[0]);
    if (k == 1) {
      const double along = dot(tangent[0], tangent[1]);
      tangent[1] -= along * tangent[0];
      for (int i = 0; i < 4; ++i) slope[1][i] -= along * slope[0][i];
    }
    const double length = norm(tangent[k]);
    if (!(length > 0)) return;
    tangent[k] *= 1 / length;
    for (int i = 0; i < 4; ++i) slope[k][i] /= length;
    const double square = mobility.squared(slope[k]) * n.squared, c = std::sqrt(square);  // of |c|
    const double value = 0.5 * square + std::sqrt(0.25 * square * square + weights * square);
    const double size = std::sqrt(weights * square + value * value);
    if (!(c > 0) || !modes.begin(1 + k, push * value)) continue;
    const double scale = std::sqrt(push * value) / size;
    modes.add(1 + k, scale * c, n.weight, tangent[k]);
    modes.add(1 + k, scale * value / c, slope[k], n.gap);
  }
}

/// Modes of a part. @param part  0, or 1 of two
/// @param surplus  part of the force that is not expected to stay (expected_forces.h): its share of f/g is taken off the curvature
SCREE_HD inline Modes contact_modes(const ContactPair& pair, const Barrier& barrier,
                                    const ContactPlace& place, const Four& x,
                                    const PairMobility& mobility, int part, double surplus = 0) {
  Modes modes;
  if (!place.is_active) return modes;
  const Nearest& n = place.nearest;
  const Derivatives& b = place.barrier;
  const Mollifier& m = place.mollifier;
  const double weights = square_of(n.weight);
  const double root = std::sqrt(weights);
  const Vec3d normal = normalized(n.gap);
  const double distance = std::sqrt(n.squared);
  const double less = surplus * -2 * b.first * distance / (distance - barrier.separation);
  const double along =
      pair.weight * m.value * (4 * b.second * n.squared + 2 * b.first - less) * weights;
  if (m.first == 0) {
    if (modes.begin(0, along)) modes.add(0, std::sqrt(along) / root, n.weight, normal);
    add_turning_modes(n, -2 * pair.weight * b.first, x, mobility, modes);
    return modes;
  }
  // The gradient of |r|^2 is 2 |r| times that of r along its direction; in the directions across only r has one.
  const Vec3d e = x[1] - x[0], f = x[3] - x[2], r = cross(e, f);
  const Vec3d about = normalized(r, any_orthogonal(norm2(e) > norm2(f) ? e : f));
  const double both[2][4] = {{-1, 1, 0, 0}, {0, 0, -1, 1}}, length = norm(r);
  const auto add_of_r = [&](int place, double scale, const Vec3d& direction) {
    modes.add(place, scale, both[0], cross(f, direction));
    modes.add(place, scale, both[1], cross(direction, e));
  };
  const auto size_of_r = [&](const Vec3d& direction) {
    return std::sqrt(2 * norm2(cross(f, direction)) + 2 * norm2(cross(direction, e)));
  };
  const double size = size_of_r(about);
  const TwoByTwo two = eigen(
      along, pair.weight * b.first * m.first * 4 * length * std::sqrt(n.squared) * root * size,
      pair.weight * b.value * (2 * m.first + 4 * m.second * length * length) * size * size);
  if (modes.begin(0, two.value[part])) {
    const double scale = std::sqrt(two.value[part]);
    modes.add(0, scale * two.vector[part][0] / root, n.weight, normal);
    add_of_r(0, scale * two.vector[part][1] / size, about);
  }
  if (part == 0) {
    add_turning_modes(n, -2 * pair.weight * m.value * b.first, x, mobility, modes);
    return modes;
  }
  const double across = 2 * pair.weight * b.value * m.first;
  const Vec3d first = any_orthogonal(about);
  if (modes.begin(1, across)) add_of_r(1, std::sqrt(across), first);
  if (modes.begin(2, across)) add_of_r(2, std::sqrt(across), cross(about, first));
  return modes;
}

/// Along the slip the stiffness is f1', or more where that is damped, across it f1 / y, both never below zero.
SCREE_HD inline Modes friction_modes(const FrictionContact& f, const SlipLaw& law,
                                     const Four& moved) {
  Modes modes;
  double u[2];
  slip_of(f, moved, u);
  const double y = std::sqrt(u[0] * u[0] + u[1] * u[1]);
  const double c = y > 0 ? u[0] / y : 1, s = y > 0 ? u[1] / y : 0;
  const double along = f.bound * law.damped_stiffness(y), across = f.bound * law.force_per_slip(y);
  if (modes.begin(0, along))
    modes.add(0, std::sqrt(along), f.weight, c * f.tangent[0] + s * f.tangent[1]);
  if (modes.begin(1, across))
    modes.add(1, std::sqrt(across), f.weight, c * f.tangent[1] - s * f.tangent[0]);
  return modes;
}

}  // namespace scree::affine
