#pragma once
// Element programs that list contacts: count, write keys, fill in the geometry.

#include "kernels/contact_search.h"
#include "kernels/contact_view.h"

namespace scree {

/// What a body found is noted in this many slots; a body with more contacts is searched again when
/// keys are written.
inline constexpr Index kFoundSlots = 8;

/// Counts the contacts that each position finds and notes the first few.
/// Bytes per body, besides neighbors from the caches: 64 read, 4 and 4 per contact written.
template <ShapeMix kMix, class Real>
struct CountContacts {
  static constexpr const char* name = "count_contacts";
  static constexpr int kLeastBlocks = 4;
  ContactSearch<kMix, Real> search;
  Index stride = 0;           ///< number of positions
  Span<Index> count;          ///< [stride] out
  Span<std::uint32_t> found;  ///< [kFoundSlots * stride] out, slot by slot

  SCREE_HD void operator()(Index p) const {
    Index n = 0;
    search(p, [&](std::uint32_t element) {
      if (n < kFoundSlots) found[static_cast<Offset>(n) * stride + p] = element;
      ++n;
    });
    count[p] = n;
  }
};

/// Writes the sort keys of the contacts.
/// Bytes per body: 16 read; per contact: 4 read, 8 written.
template <ShapeMix kMix, class Real>
struct WriteContactKeys {
  static constexpr const char* name = "write_contact_keys";
  ContactSearch<kMix, Real> search;
  Index stride = 0;
  Span<const Index> count;
  Span<const std::uint32_t> found;
  Span<const Offset> begin;    ///< [stride + 1] scan of count
  Span<std::uint64_t> packed;  ///< [contact_count] out, see packed_key()

  SCREE_HD void operator()(Index p) const {
    const Index n = count[p];
    if (n == 0) return;
    const Index i = search.bins.body[p];
    Offset next = begin[p];
    if (n <= kFoundSlots) {
      for (Index k = 0; k < n; ++k) {
        packed[next++] = found_key(search.keys, i, found[static_cast<Offset>(k) * stride + p]);
      }
      return;
    }
    search(p, [&](std::uint32_t element) { packed[next++] = found_key(search.keys, i, element); });
  }
};

/// Turns sorted keys into contacts: bodies, normal, gap, lever arms.
/// Bytes per contact (float, radial), besides bodies from the caches: 8 read, 32 written.
template <ShapeMix kMix, class Real>
struct FillContacts {
  static constexpr const char* name = "fill_contacts";
  BodyView<Real> bodies;
  Span<const ShapeRecord<Real>> shapes;
  WallView<Real> walls;
  ContactRange range;
  ContactKeys keys;
  Span<std::uint64_t> key;  ///< packed in, 64-bit contact keys out
  Span<Index> body_a;       ///< out
  Span<Index> body_b;       ///< out
  Span<Vec3<Real>> normal;  ///< out
  Span<Real> gap;           ///< out [m]
  Span<Vec3<Real>> arm_a;   ///< out, empty when radial [m]
  Span<Vec3<Real>> arm_b;   ///< out, empty when radial [m]

  SCREE_HD void operator()(Index c) const {
    const std::uint64_t packed = key[c];
    const auto a = static_cast<Index>(packed >> keys.element_bits);
    const auto element =
        static_cast<std::uint32_t>(packed & ((std::uint64_t{1} << keys.element_bits) - 1));
    const BodySample body = load_body<kMix>(bodies, shapes, a);
    ContactGeometry g;
    Index b;
    if (keys.is_body(element)) {
      b = keys.body(element);
      const BodySample other = load_body<kMix>(bodies, shapes, b);
      const Vec3d d = minimum_image(other.position - body.position, range.period);
      g = body_pair<kMix>(body, other, d, keys.feature(element));
    } else {
      g = wall_contact<kMix>(walls, range, keys, body, element, b);
    }
    key[c] = make_key(a, element);
    body_a[c] = a;
    body_b[c] = b;
    normal[c] = Vec3<Real>(g.normal);
    gap[c] = static_cast<Real>(g.gap);
    if (!arm_a.empty()) {
      arm_a[c] = Vec3<Real>(g.arm_a);
      arm_b[c] = Vec3<Real>(g.arm_b);
    }
  }
};

}  // namespace scree
