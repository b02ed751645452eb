#pragma once
// Tuned twin of the passes of accelerated Schwarz for spheres: one cooperative launch runs many.
//
// A warp takes a tile, brings what its contacts need into shared memory, sweeps there, and writes
// back. Tiles come in the order of their colors; a tile waits for its neighbors, not for whole
// colors: for those before it in this pass, and for the others in the pass before, so passes
// overlap as well. All warps are on the device at once and each goes through its tiles in order, so
// the first unfinished tile never waits. The warp that ends a pass as the last one adds up the sums
// in order and decides on the momentum.
//
// Bytes per contact and pass (float): normal and bias 16, link 8, two impulses 24 read, 12 written;
// the impulses again from the caches. Per body: first tile 4, V of two iterates 48 read, V 24
// written; again for each further tile that touches it. Tiles with too many contacts for shared
// memory are swept in place.

#include "kernels/solve/schwarz_iteration.h"
#include "kernels/solve/schwarz_tile.cuh"

namespace scree {
namespace schwarz {

/// Sum over a warp in a fixed order, in lane 0.
__device__ inline Sums<1> warp_sum(Sums<1> mine) {
#pragma unroll
  for (int step = kLanes / 2; step > 0; step /= 2)
    mine.value[0] += __shfl_down_sync(0xffffffffu, mine.value[0], step);
  return mine;
}

/// Ends a warp's part of a pass; the last warp decides.
template <class Real>
__device__ void finish(const Passes<Real>& a, const Shared& shared, unsigned pass,
                       const Sums<1>& sum) {
  const Sums<1> mine = warp_sum(sum);
  Sums<1>* const partial = shared.partial + (pass % 2) * gridDim.x;
  int is_last = 0;
  if (threadIdx.x == 0) {
    partial[blockIdx.x] = mine;
    DeviceCounter arrived(shared.arrived[pass % 2]);
    is_last = arrived.fetch_add(1, cuda::memory_order_acq_rel) == (pass / 2 + 1) * gridDim.x - 1;
  }
  is_last = __shfl_sync(0xffffffffu, is_last, 0);
  if (!is_last) return;
  __syncwarp();  // what lane 0 has seen of other warps is visible to all lanes
  Sums<1> rest;
  for (unsigned k = threadIdx.x; k < gridDim.x; k += kLanes) rest.combine(partial[k]);
  const Sums<1> total = warp_sum(rest);
  if (threadIdx.x == 0) {
    SchwarzFinish{a.state, static_cast<int>(pass)}(total);
    DeviceCounter(*shared.passes).store(pass + 1, cuda::memory_order_release);
  }
}

/// Passes [pass, end): pass k makes iterate k + 1.
template <class Real>
__global__ void __launch_bounds__(kLanes, kLeastWarps<Real>)
    run_passes(const __grid_constant__ Passes<Real> a, const __grid_constant__ Tiles d,
               const Shared shared, Room room, unsigned pass, unsigned end) {
  extern __shared__ __align__(16) unsigned char bytes[];
  const TileProblem<Real> tile(bytes, a.p, room);
  const Index tiles = d.tiles.count();
  for (; pass < end; ++pass) {
    if (threadIdx.x == 0 && pass > 0) wait_for(*shared.passes, pass - 1);  // its momentum
    __syncwarp();
    Sums<1> sum;
    for (Index at = static_cast<Index>(blockIdx.x); at < tiles;
         at += static_cast<Index>(gridDim.x)) {
      const TileSweep<Real> work(a, d, d.sequence[at], static_cast<int>(pass));
      const bool fits = work.fits(room);
      if (fits) {
        work.list_bodies(tile);
        work.load_contacts(tile);
      }
      work.wait(shared, pass);
      if (fits) {
        const auto step = tile.step(a.p, work.shape.free_bodies, a.relaxation);
        work.load_bodies(tile);
        work.sweep(step);
        work.store_bodies(tile);
        work.signal_done(shared, pass);
        work.store_contacts(tile, step, sum);
      } else {
        work.sweep_in_place();
        work.signal_done(shared, pass);
      }
      __syncwarp();
    }
    finish(a, shared, pass, sum);
  }
}

}  // namespace schwarz

template <class Real>
class SchwarzIteration<Cuda, RadialRows<Real>, Real> {
 public:
  explicit SchwarzIteration(Cuda& cuda) : counters_(cuda), partial_(cuda), room_of_all_(cuda, 1) {}

  template <class TileColoring>
  void start(Cuda& cuda, const schwarz::Passes<Real>& a, TileColoring& found) {
    const Index tiles = found.tiles().count();
    reduce<schwarz::Room>(cuda, tiles, schwarz::RoomOfTile<Real>{a.p, found.tiles(), found.shape()},
                          StoreResult<schwarz::Room>{room_of_all_.data()});
    room_ = fetch(cuda, room_of_all_.data());
    bytes_ = schwarz::TileProblem<Real>::bytes(a.p, room_);
    check_cuda(cudaFuncSetAttribute(kernel(), cudaFuncAttributePreferredSharedMemoryCarveout,
                                    cudaSharedmemCarveoutMaxShared),
               "shared memory of schwarz_sweep");
    warps_ = std::min<unsigned>(
        cuda.resident_blocks(kernel(), "occupancy of schwarz_sweep", bytes_, schwarz::kLanes),
        static_cast<unsigned>(tiles));
    counters_.reserve_discard(Offset{tiles} + 3);
    partial_.reserve_discard(2 * Offset{warps_});
    fill(cuda, counters_.view(Offset{tiles} + 3), 0u);
    shared_ = {counters_.data(), counters_.data() + 2, counters_.data() + 3, partial_.data()};
  }

  template <class TileColoring>
  void run(Cuda& cuda, const schwarz::Passes<Real>& a, TileColoring& found, int k, int count) {
    schwarz::Passes<Real> passes = a;
    schwarz::Tiles tiles{found.tiles(),   found.neighbors(), found.sequence(), found.first(),
                         found.outside(), found.link(),      found.shape()};
    auto first = static_cast<unsigned>(k), end = static_cast<unsigned>(k + count);
    void* arguments[] = {&passes, &tiles, &shared_, &room_, &first, &end};
    check_cuda(cudaLaunchCooperativeKernel(kernel(), warps_, schwarz::kLanes, arguments, bytes_,
                                           cuda.stream()),
               "schwarz_sweep");
    cuda.check_launch("schwarz_sweep");
  }

 private:
  static const void* kernel() { return reinterpret_cast<const void*>(&schwarz::run_passes<Real>); }

  Buffer<Cuda, unsigned> counters_;
  Buffer<Cuda, Sums<1>> partial_;
  Buffer<Cuda, schwarz::Room> room_of_all_;
  schwarz::Shared shared_{};
  schwarz::Room room_;
  std::size_t bytes_ = 0;
  unsigned warps_ = 0;
};

}  // namespace scree
