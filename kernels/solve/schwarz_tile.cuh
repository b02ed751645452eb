#pragma once
// A tile of accelerated Schwarz in the shared memory of a warp: loading, sweeping, storing.

#include "kernels/backend/cuda.cuh"
#include "kernels/backend/device_counter.cuh"
#include "kernels/solve/schwarz_pass.h"
#include "kernels/solve/tile_conflicts.h"
#include "kernels/solve/tile_linking.h"

namespace scree {
namespace schwarz {

inline constexpr int kLanes = 32;  ///< threads of a block: one warp
inline constexpr int kAtOnce = 4;  ///< contacts or bodies that a thread fetches together
template <class Real>
inline constexpr int kLeastWarps = sizeof(Real) == 4 ? 20 : 12;  ///< wanted on a multiprocessor
inline constexpr std::size_t kMaxTileBytes = 24'000;  ///< bytes of shared memory of a tile

template <class Real>
using Passes = SchwarzPasses<RadialRows<Real>, Real>;
template <class Real>
using Step = GaussSeidelPass<RadialRows<Real>, Real>;

/// What TileColoring found.
struct Tiles {
  BodyTiles tiles;
  TileLists neighbors;
  Span<const Index> sequence, first, outside;
  Span<const TileLink> link;
  Span<const TileShape> shape;
};

/// What the warps share, in device memory. All of it starts at zero with a solve.
struct Shared {
  /// [2] warps at the end of a pass, over all passes k in k % 2: a warp may end a pass while others
  /// are still in the one before, but none is two ahead.
  unsigned* arrived;
  unsigned* passes;  ///< passes that have ended
  unsigned* done;    ///< [tiles] passes over a tile
  Sums<1>* partial;  ///< [2 * warps] those of pass k in the half k % 2
};

/// Shared memory of a warp.
struct Room {
  Index contacts = 0;
  Index bodies = 0;
  SCREE_HD void combine(const Room& o) {
    if (o.contacts > contacts) contacts = o.contacts;
    if (o.bodies > bodies) bodies = o.bodies;
  }
};

/// The contact problem of a tile, in shared memory: contacts at their places.
template <class Real>
struct TileProblem {
  Twist<Real>* velocity;
  RadialInertia<Real>* inertia;
  Vec3<Real>* gamma;
  Vec3<Real>* normal;
  Real* bias;
  Real* friction;  ///< null where it is the same for all contacts of the problem
  Real* adhesion;  ///< likewise
  Index* body_a;
  Index* body_b;
  Index* body;  ///< in the whole problem; ~i when this tile is the first one that touches body i
  Room room;

  static constexpr std::size_t kBodyBytes =
      sizeof(Twist<Real>) + sizeof(RadialInertia<Real>) + sizeof(Index);
  static SCREE_HD std::size_t bytes(const ContactProblem<Real>& p, const Room& room) {
    const std::size_t reals =
        7 + (p.friction.values.empty() ? 0 : 1) + (p.adhesion.values.empty() ? 0 : 1);
    return (reals * sizeof(Real) + 2 * sizeof(Index)) * static_cast<std::size_t>(room.contacts) +
           kBodyBytes * static_cast<std::size_t>(room.bodies);
  }

  __device__ TileProblem(unsigned char* bytes, const ContactProblem<Real>& p, Room room_)
      : room(room_) {
    velocity = reinterpret_cast<Twist<Real>*>(bytes);
    inertia = reinterpret_cast<RadialInertia<Real>*>(velocity + room.bodies);
    gamma = reinterpret_cast<Vec3<Real>*>(inertia + room.bodies);
    normal = gamma + room.contacts;
    bias = reinterpret_cast<Real*>(normal + room.contacts);
    Real* end = bias + room.contacts;
    friction = p.friction.values.empty() ? nullptr : end;
    if (friction != nullptr) end += room.contacts;
    adhesion = p.adhesion.values.empty() ? nullptr : end;
    if (adhesion != nullptr) end += room.contacts;
    body_a = reinterpret_cast<Index*>(end);
    body_b = body_a + room.contacts;
    body = body_b + room.contacts;
  }

  /// @param whole  the problem that it is a part of
  __device__ Step<Real> step(const ContactProblem<Real>& whole, Index free_bodies,
                             Real relaxation) const {
    ContactProblem<Real> p = whole;
    p.bodies.owned_count = free_bodies;
    p.body_a = {body_a, room.contacts};
    p.body_b = {body_b, room.contacts};
    p.normal = {normal, room.contacts};
    p.bias = ContactBias<Real>(Span<Real>{bias, room.contacts});
    if (friction != nullptr) p.friction.values = {friction, room.contacts};
    if (adhesion != nullptr) p.adhesion.values = {adhesion, room.contacts};
    p.radial_inertia = RadialInertias<Real>(Span<RadialInertia<Real>>{inertia, room.bodies});
    return {p, {}, {velocity, room.bodies}, {gamma, room.contacts}, relaxation};
  }
};

/// Room a tile needs; none when it is too large.
template <class Real>
struct RoomOfTile {
  static constexpr const char* name = "schwarz_room";
  ContactProblem<Real> p;
  BodyTiles tiles;
  Span<const TileShape> shape;
  SCREE_HD Room operator()(Index t) const {
    const Room room{tiles.first_contact(t + 1) - tiles.first_contact(t), shape[t].bodies};
    return shape[t].colors > 0 && TileProblem<Real>::bytes(p, room) <= kMaxTileBytes ? room
                                                                                     : Room{};
  }
};

/// One pass over one tile.
template <class Real>
struct TileSweep {
  const Passes<Real>& a;
  const Tiles& d;
  Index t;
  Iterates<Vec3<Real>> gamma;
  Iterates<Twist<Real>> velocity;
  Real beta;
  int lane;
  Index begin, own, first, last;
  TileShape shape;

  __device__ TileSweep(const Passes<Real>& a_, const Tiles& d_, Index tile, int k)
      : a(a_),
        d(d_),
        t(tile),
        gamma(a_.impulses(k)),
        velocity(a_.velocities(k)),
        beta(static_cast<Real>(a_.state->beta_of(k))),
        lane(static_cast<int>(threadIdx.x)),
        begin(d_.tiles.begin(tile)),
        own(d_.tiles.end(tile) - begin),
        first(d_.tiles.first_contact(tile)),
        last(d_.tiles.first_contact(tile + 1)) {
    shape.free_bodies = d.shape[t].free_bodies;
    shape.bodies = d.shape[t].bodies;
    shape.colors = d.shape[t].colors;
  }

  __device__ bool fits(const Room& room) const {
    return shape.colors > 0 && last - first <= room.contacts && shape.bodies <= room.bodies;
  }

  /// Contacts are the tile's own: they need not wait for its neighbors.
  __device__ void load_contacts(const TileProblem<Real>& tile) const {
    for (Index at = first + lane; at < last; at += kLanes * kAtOnce) {
      Vec3<Real> y[kAtOnce], normal[kAtOnce];
      Real bias[kAtOnce];
      TileLink link[kAtOnce];
#pragma unroll
      for (int j = 0; j < kAtOnce; ++j) {
        const Index c = at + j * kLanes;
        if (c >= last) continue;
        y[j] = gamma.extrapolated(c, beta);
        normal[j] = a.p.normal[c];
        bias[j] = a.p.bias[c];
        link[j] = d.link[c];
      }
#pragma unroll
      for (int j = 0; j < kAtOnce; ++j) {
        if (at + j * kLanes >= last) continue;
        const Index place = link[j].place;
        tile.gamma[place] = y[j];
        tile.normal[place] = normal[j];
        tile.bias[place] = bias[j];
        const Index c = at + j * kLanes;
        if (tile.friction != nullptr) tile.friction[place] = a.p.friction.values[c];
        if (tile.adhesion != nullptr) tile.adhesion[place] = a.p.adhesion.values[c];
        tile.body_a[place] = link[j].a;
        tile.body_b[place] = link[j].b;
      }
    }
  }

  /// Body of number `local` in the tile; fixed ones are listed from the tile's last contact down.
  __device__ Index body(Index local) const {
    if (local < own) return begin + local;
    return local < shape.free_bodies ? d.outside[first + local - own]
                                     : d.outside[last - 1 - (local - shape.free_bodies)];
  }
  __device__ void list_bodies(const TileProblem<Real>& tile) const {
    for (Index local = lane; local < shape.bodies; local += kLanes) {
      const Index i = body(local);
      tile.inertia[local] = a.p.radial_inertia[i];
      tile.body[local] = local < shape.free_bodies && d.first[i] == t ? ~i : i;
    }
  }

  /// Waits for the tiles that share bodies with this one.
  __device__ void wait(const Shared& shared, unsigned pass) const {
    const Offset list = static_cast<Offset>(t) * d.neighbors.room;
    for (Index k = lane; k < d.neighbors.count[t]; k += kLanes) {
      const Index neighbor = d.neighbors.tile[list + k];
      spin_until(shared.done[neighbor / 2], neighbor % 2 == 0 ? pass + 1 : pass);
    }
    acquire();
    __syncwarp();
  }

  /// V at the extrapolated point for the first tile of a body, with what others did for the next.
  __device__ void load_bodies(const TileProblem<Real>& tile) const {
    for (Index at = lane; at < shape.bodies; at += kLanes * kAtOnce) {
      Twist<Real> next[kAtOnce], now[kAtOnce];
#pragma unroll
      for (int j = 0; j < kAtOnce; ++j) {
        const Index local = at + j * kLanes;
        if (local >= shape.bodies) continue;
        const Index i = tile.body[local];
        next[j] = velocity.next[i < 0 ? ~i : i];
        if (i < 0) now[j] = velocity.current[~i];
      }
#pragma unroll
      for (int j = 0; j < kAtOnce; ++j) {
        const Index local = at + j * kLanes;
        if (local >= shape.bodies) continue;
        const bool is_first = tile.body[local] < 0;
        tile.velocity[local] = is_first ? now[j] + beta * (now[j] - next[j]) : next[j];
      }
    }
    __syncwarp();
  }
  __device__ void store_bodies(const TileProblem<Real>& tile) const {
    for (Index local = lane; local < shape.free_bodies; local += kLanes) {
      const Index i = tile.body[local];
      velocity.next[i < 0 ? ~i : i] = tile.velocity[local];
    }
    __syncwarp();
  }

  /// Lets the neighbors go on.
  __device__ void signal_done(const Shared& shared, unsigned pass) const {
    if (lane == 0) DeviceCounter(shared.done[t]).store(pass + 1, cuda::memory_order_release);
  }

  __device__ void sweep(const Step<Real>& step) const {
    const int end_of_lane = d.shape[t].color_end[lane];
    for (int s = 0; s < a.sweeps; ++s) {
      int from = 0;
      for (int color = 0; color < shape.colors; ++color) {
        const int to = __shfl_sync(0xffffffffu, end_of_lane, color);
        for (int k = from + lane; k < to; k += kLanes) step(k);
        __syncwarp();
        from = to;
      }
    }
  }

  __device__ void store_contacts(const TileProblem<Real>& tile, const Step<Real>& step,
                                 Sums<1>& sum) const {
    for (Index at = first + lane; at < last; at += kLanes * kAtOnce) {
      Vec3<Real> x[kAtOnce], y[kAtOnce];
      Index place[kAtOnce];
#pragma unroll
      for (int j = 0; j < kAtOnce; ++j) {
        const Index c = at + j * kLanes;
        if (c >= last) continue;
        x[j] = gamma.current[c];
        y[j] = gamma.extrapolated(c, beta);
        place[j] = d.link[c].place;
      }
#pragma unroll
      for (int j = 0; j < kAtOnce; ++j) {
        const Index c = at + j * kLanes;
        if (c >= last) continue;
        const ForceRows<Real> moved{tile.gamma[place[j]]};
        gamma.next[c] = moved.force;
        sum.combine(against_momentum<RadialRows<Real>>(
            step.p, place[j], own_metric<RadialRows<Real>>(step.p, place[j]), ForceRows<Real>{x[j]},
            ForceRows<Real>{y[j]}, moved));
      }
    }
  }

  /// In place, for a tile that does not fit: color by color, or without links by one thread, in the
  /// order of the plain program. Leaves the sum alone, which only steers the momentum.
  __device__ void sweep_in_place() const {
    for (Index c = first + lane; c < last; c += kLanes) gamma.next[c] = gamma.extrapolated(c, beta);
    for (Index local = lane; local < shape.free_bodies; local += kLanes) {
      const Index i = body(local);
      if (d.first[i] == t) velocity.next[i] = velocity.extrapolated(i, beta);
    }
    __syncwarp();
    const Step<Real> step{a.p, {}, velocity.next, gamma.next, a.relaxation};
    for (int s = 0; s < a.sweeps; ++s) {
      for (Index color = 0; color < shape.colors; ++color) {
        for (Index c = first + lane; c < last; c += kLanes) {
          if (d.link[c].color == color) step(c);
        }
        __syncwarp();
      }
      for (Index c = first; shape.colors == 0 && lane == 0 && c < last; ++c) step(c);
    }
    __syncwarp();
  }
};

}  // namespace schwarz
}  // namespace scree
