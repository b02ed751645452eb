#pragma once
// Runs passes of accelerated Schwarz on a backend: a tuned twin where there is one, else element
// programs color by color.

#include "kernels/solve/schwarz_pass.h"
#include "kernels/solve/tile_linking.h"

namespace scree {

/// Passes of one solve by element programs, one launch for each color of tiles.
template <class B, class R, class Real>
class PlainSchwarz {
 public:
  explicit PlainSchwarz(B& b) : order_(b), start_(b), metric_(b) {}

  /// @tparam Tiles  TileColoring<B>
  template <class Tiles>
  void start(B& b, const SchwarzPasses<R, Real>& a, Tiles& tiles) {
    const Index n = a.p.contact_count;
    order_.reserve_discard(n);
    start_.reserve_discard(static_cast<Offset>(n) * R::kVectors);
    metric_.reserve_discard(n);
    for_each(b, n, TileOrder{tiles.tiles(), tiles.link(), tiles.shape(), order_.view(n)});
    for_each(b, n, StoreBlockMetric<R, Real>{a.p, metric_.view(n)});
  }

  /// Makes iterate k + 1 from iterate k.
  template <class Tiles>
  void run(B& b, const SchwarzPasses<R, Real>& a, Tiles& tiles, int k) {
    const Index n = a.p.contact_count;
    const Offset vectors = static_cast<Offset>(n) * R::kVectors;
    const Iterates<Vec3<Real>> gamma = a.impulses(k);
    const Iterates<Twist<Real>> velocity = a.velocities(k);
    const Span<Vec3<Real>> start = start_.view(vectors);
    const Span<const ContactMetric<Real>> metric = metric_.view(n);
    for_each(b, static_cast<Index>(vectors),
             Extrapolate<Vec3<Real>, Real>{gamma, a.state, k, start});
    for_each(b, a.p.bodies.owned_count, Extrapolate<Twist<Real>, Real>{velocity, a.state, k, {}});
    const GaussSeidelPass<R, Real> step{a.p, metric, velocity.next, gamma.next, a.relaxation};
    SweepTile<R, Real> sweep{tiles.tiles(), tiles.sequence(), order_.view(n), step, a.sweeps};
    for (Index color = 0; color < tiles.color_count(); ++color) {
      sweep.first = tiles.starts()[color];
      for_each(b, tiles.starts()[color + 1] - sweep.first, sweep);
    }
    reduce<Sums<1>>(b, n, AgainstMomentum<R, Real>{a.p, metric, gamma, start},
                    SchwarzFinish{a.state, k});
  }

 private:
  Buffer<B, Index> order_;
  Buffer<B, Vec3<Real>> start_;  ///< the extrapolated point
  Buffer<B, ContactMetric<Real>> metric_;
};

/// Passes of one solve; backends with a tuned twin specialize it.
template <class B, class R, class Real>
class SchwarzIteration {
 public:
  explicit SchwarzIteration(B& b) : plain_(b) {}

  template <class Tiles>
  void start(B& b, const SchwarzPasses<R, Real>& a, Tiles& tiles) {
    plain_.start(b, a, tiles);
  }
  /// Makes the iterates after number k.
  template <class Tiles>
  void run(B& b, const SchwarzPasses<R, Real>& a, Tiles& tiles, int k, int count) {
    for (int j = 0; j < count; ++j) plain_.run(b, a, tiles, k + j);
  }

 private:
  PlainSchwarz<B, R, Real> plain_;
};

}  // namespace scree

#ifdef __CUDACC__
#include "kernels/solve/schwarz_sweep.cuh"
#endif
