#pragma once
// Which primitive each sample sees, or how deep it sees. A drawing pass has three steps:
// count the 8x8-sample chunks of every primitive's rectangle, scan the counts, and run one
// work item per chunk. Small and large solids thus cost each thread the same, and a sphere of
// one pixel costs one item.

#include <cstring>

#include "kernels/backend/atomic.h"
#include "kernels/render/solids.h"

namespace scree::render {

/// A sample of the visibility buffer: depth in the high half, primitive number in the low half.
/// Depths are positive, and positive floats order like their bits, so the smallest entry is the
/// nearest solid and a tie goes to the lower number.
inline constexpr std::uint64_t kNothing = ~std::uint64_t{0};

/// A sample of a depth buffer, for views of which only the depths matter: the high half alone.
inline constexpr std::uint32_t kNoDepth = ~std::uint32_t{0};

SCREE_HD inline std::uint32_t pack_depth(float depth) {
  std::uint32_t bits;
  memcpy(&bits, &depth, sizeof bits);
  return bits;
}
SCREE_HD inline std::uint64_t pack_sample(float depth, Index primitive) {
  return (static_cast<std::uint64_t>(pack_depth(depth)) << 32) |
         static_cast<std::uint32_t>(primitive);
}
SCREE_HD inline Index primitive_of(std::uint64_t sample) {
  return static_cast<Index>(static_cast<std::uint32_t>(sample));
}
/// Depth of a sample [m]; 1e30 where nothing is seen.
SCREE_HD inline float depth_of(std::uint32_t sample) {
  if (sample == kNoDepth) return 1e30f;
  float depth;
  memcpy(&depth, &sample, sizeof depth);
  return depth;
}
SCREE_HD inline float depth_of(std::uint64_t sample) {
  return depth_of(static_cast<std::uint32_t>(sample >> 32));
}

/// Puts a hit into a buffer unless something nearer is there.
SCREE_HD inline void draw_hit(std::uint64_t* sample, float depth, Index primitive) {
  atomic_min(sample, pack_sample(depth, primitive));
}
SCREE_HD inline void draw_hit(std::uint32_t* sample, float depth, Index) {
  atomic_min(sample, pack_depth(depth));
}

/// Triangles of each shape record; zero for other shapes and for bodies that are not there.
template <class Real>
struct CountTriangles {
  static constexpr const char* name = "render_count_triangles";
  DrawList<Real> list;
  Span<Index> counts;  ///< [shapes] out
  SCREE_HD void operator()(Index s) const {
    const ShapeRecord<Real>& record = list.shapes[s];
    const bool drawn = outline_of(record.kind) == Outline::triangles && record.mesh >= 0 &&
                       list.is_present(record.body) && list.shape[record.body] == s;
    counts[s] = drawn ? list.meshes.ranges[record.mesh].triangle_count : 0;
  }
};

/// Solids of a view, as the drawing pass takes them.
/// @tparam Sample  std::uint64_t for a visibility buffer, std::uint32_t for a depth buffer
template <class Real, class Sample>
struct SolidSource {
  static constexpr const char* count_name = "render_count_solids";
  static constexpr const char* draw_name = "render_draw_solids";
  DrawList<Real> list;
  View view;
  Span<Sample> samples;     ///< [view.sample_count()] in and out
  bool solid_only = false;  ///< see resolve()

  SCREE_HD Index primitive_count() const { return list.primitive_count(); }

  SCREE_HD SampleRect rect(Index primitive) const {
    return resolve(list, view, primitive, solid_only).rect(view);
  }
  SCREE_HD void draw(Index primitive, Index chunk) const {
    const Solid solid = resolve(list, view, primitive, solid_only);
    const SampleRect area = solid.rect(view).chunk(chunk);
    // The kind is told apart once per chunk, not once per sample.
    ShapeList::visit(solid.kind,
                     [&](auto shape) { draw_shape<decltype(shape)>(solid, area, primitive); });
  }

 private:
  template <class S>
  SCREE_HD void draw_shape(const Solid& solid, const SampleRect& area, Index primitive) const {
    for (int j = area.y_begin; j < area.y_end; ++j) {
      const float y = view.plane_y(j);
      Sample* row = samples.data + view.index(0, j);
      for (int i = area.x_begin; i < area.x_end; ++i) {
        const float depth = S::hit(solid, solid.eye.ray(view.plane_x(i), y));
        // The upper limit also rejects what is not finite.
        if (depth > view.near_depth && depth < 1e20f) draw_hit(row + i, depth, primitive);
      }
    }
  }
};

/// Work items of each primitive.
template <class Source>
struct CountChunks {
  static constexpr const char* name = Source::count_name;
  Source source;
  Span<Index> counts;  ///< [primitives] out
  SCREE_HD void operator()(Index p) const { counts[p] = source.rect(p).chunk_count(); }
};

/// One chunk of one primitive into the buffer of its source.
template <class Source>
struct DrawChunk {
  static constexpr const char* name = Source::draw_name;
  Source source;
  Span<const Offset> chunk_begin;  ///< [primitives + 1] scanned counts
  Offset first_item = 0;           ///< item number of i = 0
  SCREE_HD void operator()(Index i) const {
    const Offset item = first_item + i;
    const Index primitive = owner_of(chunk_begin, item);
    source.draw(primitive, static_cast<Index>(item - chunk_begin[primitive]));
  }
};

}  // namespace scree::render
