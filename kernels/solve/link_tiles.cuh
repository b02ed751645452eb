#pragma once
// Tuned twin of LinkTiles: a warp links the contacts of a tile, 32 at a time. Those whose bodies
// no earlier one of the 32 waits for take their colors together, which gives each the color
// that it would get alone. By one thread a tile, each step waits for memory several times:
// 1.0 ms for 1e6 bodies.

#include "kernels/backend/cuda.cuh"
#include "kernels/solve/tile_linking.h"

namespace scree {
namespace link {

inline constexpr int kLanes = 32;        ///< threads of a block
inline constexpr Index kContacts = 384;  ///< of a tile; larger ones are linked by one thread
inline constexpr Index kBodies = 64;     ///< likewise
inline constexpr unsigned kAll = 0xffffffffu;
static_assert(kTileColors == kLanes);

/// A body in the coloring.
struct BodySlot {
  std::uint32_t used;  ///< colors
  int owner;           ///< lowest lane that waits for it, kLanes: none
};

struct Tile {
  Index previous[kContacts];
  BodySlot slot[kBodies + kContacts];  ///< own bodies, then those of other tiles
  std::uint16_t number[kContacts];     ///< of body B
  std::uint16_t rank[kContacts];       ///< among the contacts of its color
  std::uint8_t color[kContacts];
  int count[kTileColors];  ///< contacts of each color; in the end where it begins
};

/// Sum of `mine` over the lanes up to and with this one.
__device__ inline int sum_up_to(int mine) {
  for (int step = 1; step < kLanes; step *= 2) {
    const int below = __shfl_up_sync(kAll, mine, step);
    if (static_cast<int>(threadIdx.x) >= step) mine += below;
  }
  return mine;
}

/// Takes the smallest color that is free on the bodies of slots a and b (b < 0: none), after all
/// lower lanes with one of these bodies.
/// @return kTileColors when none is free
__device__ inline int take_color(Tile& tile, bool waits, Index a, Index b) {
  const auto lane = static_cast<int>(threadIdx.x);
  int color = kTileColors;
  while (__any_sync(kAll, waits)) {
    if (waits) {
      atomicMin(&tile.slot[a].owner, lane);
      if (b >= 0) atomicMin(&tile.slot[b].owner, lane);
    }
    __syncwarp();
    const bool is_next =
        waits && tile.slot[a].owner == lane && (b < 0 || tile.slot[b].owner == lane);
    __syncwarp();
    if (waits) {
      tile.slot[a].owner = kLanes;
      if (b >= 0) tile.slot[b].owner = kLanes;
    }
    if (is_next) {
      const std::uint32_t used = tile.slot[a].used | (b >= 0 ? tile.slot[b].used : 0);
      color = lowest_bit(~std::uint64_t{used});
      if (color < kTileColors) {
        tile.slot[a].used |= std::uint32_t{1} << color;
        if (b >= 0) tile.slot[b].used |= std::uint32_t{1} << color;
      }
      waits = false;
    }
    __syncwarp();
  }
  return color;
}

template <class Links>
__global__ void __launch_bounds__(kLanes) link_tiles_kernel(const __grid_constant__ Links g) {
  __shared__ Tile tile;
  const auto lane = static_cast<Index>(threadIdx.x);
  const unsigned below = (1u << lane) - 1;
  const auto t = static_cast<Index>(blockIdx.x);
  const Index begin = g.tiles.begin(t), own = g.tiles.end(t) - begin;
  const Index first = g.tiles.first_contact(t);
  const Index n = g.tiles.first_contact(t + 1) - first;
  if (n > kContacts || own > kBodies) {
    if (lane == 0) g(t);
    return;
  }
  for (Index c = lane; c < n; c += kLanes) tile.previous[c] = g.previous[first + c];
  for (Index i = lane; i < own + n; i += kLanes) tile.slot[i] = {0, kLanes};
  tile.count[lane] = 0;
  __syncwarp();

  Index free_bodies = own, fixed = 0;
  bool has_links = true;
  for (Index at = 0; at < n; at += kLanes) {
    const Index c = at + lane;
    const bool is_there = c < n;
    const Index a = is_there ? g.tiles.body_a[first + c] - begin : 0;
    const Index body_b = is_there ? g.tiles.body_b[first + c] : 0;
    const bool is_fixed = is_there && body_b >= g.tiles.owned_count;
    const bool is_outside = is_there && !is_fixed && body_b - begin >= own;
    const bool is_new = is_outside && tile.previous[c] < 0;
    const unsigned news = __ballot_sync(kAll, is_new), fixes = __ballot_sync(kAll, is_fixed);
    Index number = body_b - begin;
    if (is_new) {
      number = free_bodies + __popc(news & below);
      g.outside[first + number - own] = body_b;
    } else if (is_fixed) {
      number = fixed + __popc(fixes & below);
      g.outside[first + n - 1 - number] = body_b;
    }
    if (is_there) tile.number[c] = static_cast<std::uint16_t>(number);
    __syncwarp();
    if (is_outside && !is_new) {
      Index same = tile.previous[c];
      while (tile.previous[same] >= 0) same = tile.previous[same];
      number = tile.number[same];
    }
    __syncwarp();
    if (is_there) tile.number[c] = static_cast<std::uint16_t>(number);
    free_bodies += __popc(news);
    fixed += __popc(fixes);

    const int color = take_color(tile, is_there, a, is_fixed ? -1 : number);
    has_links = has_links && __all_sync(kAll, !is_there || color < kTileColors);
    const unsigned alike = __match_any_sync(kAll, color);
    if (is_there && color < kTileColors) {
      const int before = tile.count[color];
      tile.color[c] = static_cast<std::uint8_t>(color);
      tile.rank[c] = static_cast<std::uint16_t>(before + __popc(alike & below));
    }
    __syncwarp();
    if (is_there && color < kTileColors && (alike & below) == 0) tile.count[color] += __popc(alike);
    __syncwarp();
  }

  const int mine = has_links ? tile.count[lane] : 0;
  const unsigned used = __ballot_sync(kAll, mine > 0);
  const int colors = used == 0 ? 0 : kLanes - __clz(static_cast<int>(used));
  const int end = sum_up_to(mine);
  __syncwarp();
  tile.count[lane] = end - mine;
  TileShape& shape = g.shape[t];
  shape.color_end[lane] = static_cast<std::uint16_t>(lane < colors ? end : 0);
  if (lane == 0) {
    shape.free_bodies = free_bodies;
    shape.bodies = free_bodies + fixed;
    shape.colors = colors;
  }
  __syncwarp();
  for (Index c = lane; has_links && c < n; c += kLanes) {
    const bool is_fixed = g.tiles.body_b[first + c] >= g.tiles.owned_count;
    const Index color = tile.color[c];
    g.link[first + c] = {static_cast<std::uint16_t>(g.tiles.body_a[first + c] - begin),
                         static_cast<std::uint16_t>(tile.number[c] + (is_fixed ? free_bodies : 0)),
                         static_cast<std::uint16_t>(tile.count[color] + tile.rank[c]),
                         static_cast<std::uint16_t>(color)};
  }
}

}  // namespace link

inline void link_tiles(Cuda& cuda, const LinkTiles& program) {
  link::link_tiles_kernel<<<static_cast<unsigned>(program.tiles.count()), link::kLanes, 0,
                            cuda.stream()>>>(program);
  cuda.check_launch(LinkTiles::name);
}

}  // namespace scree
