#pragma once
// Element programs that make the parts of bodies, and move them along.

#include "kernels/bodies/parts.h"
#include "kernels/step/integrate.h"

namespace scree {

/// How many parts each body has that there is.
template <class Real>
struct CountParts {
  static constexpr const char* name = "count_parts";
  BodyView<Real> bodies;
  Span<const ShapeRecord<Real>> shapes;
  PartSet<Real> parts;
  Span<Index> count;  ///< [present bodies] out

  SCREE_HD void operator()(Index m) const {
    const Index k = compound_of(bodies, shapes, bodies.present(m));
    count[m] = k < 0 ? 1 : parts.first[k + 1] - parts.first[k];
  }
};

/// What of a part stays the same as long as its body has its place in storage.
template <class Real>
struct PartConstants {
  Span<Index> owner;
  Span<Index> record;  ///< in PartSet::records; -1: the part is the body
  Span<Index> shape, id, group;
  Span<Real> radius, inv_mass;
  Span<std::uint8_t> locks, material;
};

template <class Real>
struct ListParts {
  static constexpr const char* name = "list_parts";
  BodyView<Real> bodies;
  Span<const ShapeRecord<Real>> shapes;
  PartSet<Real> parts;
  Span<const Offset> begin;  ///< [present bodies + 1] scan of the counts
  Index fixed_begin;         ///< place of the first part of a fixed body
  PartConstants<Real> out;

  SCREE_HD void operator()(Index m) const {
    const Index i = bodies.present(m), k = compound_of(bodies, shapes, i);
    const Index shift = bodies.is_fixed(i) ? fixed_begin - part_begin(bodies.moving_count) : 0;
    const Index first = part_begin(m) + shift, end = part_begin(m + 1) + shift;
    for (Index p = first; p < end; ++p) {
      const Index record = k < 0 ? -1 : parts.first[k] + (p - first);
      out.owner[p] = i;
      out.record[p] = record;
      out.shape[p] = record < 0 ? bodies.shape[i] : parts.records[record].shape;
      out.radius[p] = record < 0 ? bodies.radius[i] : parts.records[record].radius;
      out.id[p] = bodies.id[i];
      out.group[p] = bodies.group[i];
      out.inv_mass[p] = bodies.inv_mass[i];
      out.locks[p] = bodies.locks[i];
      out.material[p] = bodies.material[i];
    }
  }

 private:
  SCREE_HD Index part_begin(Index m) const { return static_cast<Index>(begin[m]); }
};

/// Takes the parts along with their bodies.
template <class Real>
struct PlaceParts {
  static constexpr const char* name = "place_parts";
  BodyView<Real> bodies;
  PartSet<Real> set;
  Span<const Index> record;
  PeriodicBox box;
  BodyView<Real> parts;  ///< out: poses and rates
  Span<const Index> owner;
  Span<Vec3<Real>> from_body;

  SCREE_HD void operator()(Index m) const {
    const Index p = parts.present(m), i = owner[p];
    const Quat<Real> q = bodies.orientation[i];
    const Vec3<Real> v = bodies.velocity[i], w = bodies.angular_velocity[i];
    parts.angular_velocity[p] = w;
    if (record[p] < 0) {
      parts.position[p] = bodies.position[i];
      parts.orientation[p] = q;
      parts.velocity[p] = v;
      from_body[p] = {};
      return;
    }
    const PartRecord<Real> part = set.records[record[p]];
    const Quat<double> turn = normalized(Quat<double>(q));
    const Vec3<double> arm = rotate(turn, part.position);
    Vec3<double> x = bodies.position[i] + arm;
    for (int k = 0; k < 3; ++k) x[k] = wrap_coordinate(x[k], box.lower[k], box.length[k]);
    parts.position[p] = x;
    parts.orientation[p] = Quat<Real>(turn * part.orientation);
    from_body[p] = Vec3<Real>(arm);
    parts.velocity[p] = v + cross(w, from_body[p]);
  }
};

/// New places of parts when their bodies changed places. Body m of those that are owned, by its old place.
struct FollowBodies {
  static constexpr const char* name = "follow_bodies";
  Span<const Offset> old_begin;
  Span<const Offset> new_begin;
  Span<const Index> new_of_old;  ///< of bodies
  Span<Index> place;             ///< out: of parts

  SCREE_HD void operator()(Index m) const {
    for (Offset p = old_begin[m]; p < old_begin[m + 1]; ++p)
      place[p] = static_cast<Index>(new_begin[new_of_old[m]] + (p - old_begin[m]));
  }
};

}  // namespace scree
