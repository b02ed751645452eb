#pragma once
// Barrier energy of one pair, with gradient and Hessian for its four points.
// docs/theory.md, "Barrier contact".

#include "kernels/affine/affine_state.h"
#include "kernels/affine/barrier.h"
#include "kernels/affine/mollifier.h"

namespace scree::affine {

/// What does not change of a pair.
struct ContactPair {
  PairKind kind = PairKind::point_triangle;
  double weight = 1;          ///< area of the pair [m^2] with the physical barrier, or a number
  double parallel_below = 0;  ///< of edges: mollifier_threshold() [m^4]; zero: no factor
};

SCREE_HD inline Mollifier mollifier(const ContactPair& pair, const Four& x) {
  return pair.kind == PairKind::edge_edge ? mollifier(pair.parallel_below, x) : Mollifier{};
}

/// @param squared  of the distance [m^2]
SCREE_HD inline double contact_energy(const ContactPair& pair, const Barrier& barrier,
                                      double squared, const Mollifier& m) {
  return pair.weight * m.value * barrier(squared).value;
}
SCREE_HD inline double contact_energy(const ContactPair& pair, const Barrier& barrier,
                                      const Four& x) {
  return contact_energy(pair, barrier, squared_distance(pair.kind, x), mollifier(pair, x));
}

/// What rounding of its points makes of the energy of a pair [J], nearly. @param size  of coordinates [m]
SCREE_HD inline double contact_rounding(const ContactPair& pair, const Barrier& barrier,
                                        double squared, const Mollifier& m, double size) {
  const double force = 2 * std::sqrt(squared) * std::abs(barrier(squared).first);
  return kPlaceRounding * size * pair.weight * m.value * force;
}

/// What all derivatives take of the places of the points.
struct ContactPlace {
  Nearest nearest;
  bool is_active = false;  ///< whether the barrier acts; the rest is set where it does
  Derivatives barrier;
  Mollifier mollifier;
};

SCREE_HD inline ContactPlace contact_place(const ContactPair& pair, const Barrier& barrier,
                                           const Four& x) {
  ContactPlace c;
  c.nearest = nearest_points(pair.kind, x);
  c.is_active = barrier.acts(c.nearest.squared);
  if (!c.is_active) return c;
  c.barrier = barrier(c.nearest.squared);
  c.mollifier = mollifier(pair, x);
  return c;
}

SCREE_HD inline Four contact_gradient(const ContactPair& pair, const ContactPlace& place,
                                      const Four& x) {
  Four g;
  if (!place.is_active) return g;
  const Derivatives& b = place.barrier;
  const Mollifier& m = place.mollifier;
  const Four d = distance_gradient(place.nearest);
  for (int i = 0; i < 4; ++i) g[i] = (pair.weight * m.value * b.first) * d[i];
  if (m.first != 0) {
    const Four c = cross_gradient(x);
    for (int i = 0; i < 4; ++i) g[i] += (pair.weight * m.first * b.value) * c[i];
  }
  return g;
}

SCREE_HD inline Four contact_gradient(const ContactPair& pair, const Barrier& barrier,
                                      const Four& x) {
  return contact_gradient(pair, contact_place(pair, barrier, x), x);
}

/// Normal force of a pair [N], which friction takes: the barrier's slope with respect to the
/// distance itself.
SCREE_HD inline double normal_force(const ContactPair& pair, const Barrier& barrier,
                                    const Four& x) {
  const Nearest n = nearest_points(pair.kind, x);
  const double m = mollifier(pair, x).value;
  return -2 * pair.weight * m * barrier(n.squared).first * std::sqrt(n.squared);
}

}  // namespace scree::affine
