#pragma once
// Two capsules: up to four contacts, each of them that of two spheres centered on the axes.
//
// Where the axes are nearest to each other, an end of one is opposite to the other, or two ends, or the axes cross in
// between. Each end of one axis with what is nearest to it on the other is a candidate, and so is the crossing. All of
// them are true contacts of parts of the bodies, so capsules that lie side by side have two, and none comes or
// goes as they turn without being near the limit of what is listed.

#include "kernels/narrow_phase/pairs/manifold.h"
#include "kernels/narrow_phase/pairs/pair_side.h"
#include "shapes/capsule.h"

namespace scree {

/// The axes of capsules A and B in world axes, from the center of A.
struct CapsulePair {
  Vec3d axis_a, axis_b;  ///< unit
  double end_a, end_b;   ///< center to the center of an end [m]
  double radius_a, radius_b;
  Vec3d d;  ///< center of A to center of B [m]

  SCREE_HD CapsulePair(const PairSide& a, const PairSide& b, const Vec3d& along)
      : axis_a(rotate(a.orientation, Vec3d{0, 0, 1})),
        axis_b(rotate(b.orientation, Vec3d{0, 0, 1})),
        end_a(shapes::Capsule::half_length(a.half_extents)),
        end_b(shapes::Capsule::half_length(b.half_extents)),
        radius_a(shapes::Capsule::radius(a.half_extents)),
        radius_b(shapes::Capsule::radius(b.half_extents)),
        d(along) {}

  /// The contact at coordinates along both axes [m].
  SCREE_HD ContactGeometry contact_at(double s, double t) const {
    const Vec3d from = s * axis_a, to = d + t * axis_b, offset = to - from;
    // Axes that meet are parted across both of them.
    const double distance = norm(offset);
    ContactGeometry g;
    g.normal = distance > 0 ? (1 / distance) * offset
                            : normalized(cross(axis_a, axis_b), any_orthogonal(axis_a));
    g.gap = distance - (radius_a + radius_b);
    g.arm_a = from + radius_a * g.normal;
    g.arm_b = t * axis_b - radius_b * g.normal;
    return g;
  }
};

/// Features of two capsules: an end of A, an end of B, or where the axes cross.
struct CapsuleFeature {
  static constexpr int kBits = 3;
  static constexpr std::uint32_t kEndOfB = 2;
  static constexpr std::uint32_t kCrossing = 4;
  static constexpr int kCount = 5;
  /// Axes with a smaller squared sine of the angle between them do not cross.
  static constexpr double kParallel = 1e-6;
};

/// Where a feature is on the axes.
struct CapsulePlace {
  double s = 0, t = 0;      ///< coordinates along the axes of A and B [m]
  bool is_between = false;  ///< neither is limited by an end that the feature does not name

  SCREE_HD CapsulePlace(const CapsulePair& pair, std::uint32_t feature) {
    const double da = dot(pair.d, pair.axis_a), db = dot(pair.d, pair.axis_b);
    const double c = dot(pair.axis_a, pair.axis_b);
    if (feature == CapsuleFeature::kCrossing) {
      const double sine2 = 1 - c * c;
      if (!(sine2 > CapsuleFeature::kParallel)) return;
      s = (da - c * db) / sine2;
      t = (c * da - db) / sine2;
      is_between = std::abs(s) < pair.end_a && std::abs(t) < pair.end_b;
    } else if (feature < CapsuleFeature::kEndOfB) {
      s = feature == 0 ? -pair.end_a : pair.end_a;
      t = limited(c * s - db, pair.end_b);
    } else {
      t = feature == CapsuleFeature::kEndOfB ? -pair.end_b : pair.end_b;
      s = limited(c * t + da, pair.end_a);
    }
  }

 private:
  SCREE_HD double limited(double x, double end) {
    is_between = std::abs(x) < end;
    return x > end ? end : x < -end ? -end : x;
  }
};

/// Geometry of the contact that a feature names.
SCREE_HD inline ContactGeometry capsule_capsule_contact(const CapsulePair& pair,
                                                        std::uint32_t feature) {
  const CapsulePlace place(pair, feature);
  return pair.contact_at(place.s, place.t);
}

/// The contacts of two capsules that are wanted, four at most: without the one with the largest gap.
/// @param listed  listed(contact): whether it is wanted
template <class Listed>
SCREE_HD Manifold capsule_capsule(const CapsulePair& pair, Listed&& listed) {
  Manifold m;
  for (std::uint32_t feature = 0; feature < CapsuleFeature::kCount; ++feature) {
    const CapsulePlace place(pair, feature);
    // Two ends that face each other are named by that of A.
    if (feature >= CapsuleFeature::kEndOfB && !place.is_between) continue;
    const ContactGeometry g = pair.contact_at(place.s, place.t);
    if (!listed(g)) continue;
    int at = m.count;
    if (at == Manifold::kMaxContacts) {
      int far = 0;
      for (int k = 1; k < at; ++k) far = m.contact[k].gap > m.contact[far].gap ? k : far;
      if (!(m.contact[far].gap > g.gap)) continue;
      for (int k = far; k + 1 < at; ++k) {
        m.feature[k] = m.feature[k + 1];
        m.contact[k] = m.contact[k + 1];
      }
      --at;
    }
    m.feature[at] = feature;
    m.contact[at] = g;
    m.count = at + 1;
  }
  return m;
}

struct CapsuleCapsule {
  using A = shapes::Capsule;
  using B = shapes::Capsule;
  static constexpr int kFeatureBits = CapsuleFeature::kBits;
  SCREE_HD static ContactGeometry contact(const PairSide& a, const PairSide& b, const Vec3d& d,
                                          std::uint32_t feature) {
    return capsule_capsule_contact(CapsulePair(a, b, d), feature);
  }
  template <class Listed>
  SCREE_HD static Manifold manifold(const PairSide& a, const PairSide& b, const Vec3d& d, double,
                                    Listed&& listed) {
    return capsule_capsule(CapsulePair(a, b, d), listed);
  }
};

}  // namespace scree
