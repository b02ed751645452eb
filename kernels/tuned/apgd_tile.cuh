#pragma once
// A tile of bodies in shared memory, as a block of the APGD sweep works on it; see apgd_sweep.cuh.

#include <cuda_pipeline.h>

#include "kernels/apgd_iteration.h"
#include "kernels/backend/cuda.cuh"

namespace scree {
namespace sweep {

inline constexpr int kThreads = Cuda::kBlock;  ///< of a block
inline constexpr int kBodies = 240;            ///< of a tile
static_assert(kBodies < kThreads, "a thread for each start of a list");
inline constexpr int kStaged = 800;     ///< contacts of a tile kept in shared memory
inline constexpr int kAtOnce = 4;       ///< contacts of a body that are fetched together
inline constexpr Index kLongList = 96;  ///< contacts of a body that one thread sums up, at most

template <class Real>
using RadialPasses = ApgdPasses<RadialRows<Real>, Real>;

/// What a contact exerts on its bodies.
template <class Real>
struct Pull {
  Vec3<Real> impulse;
  Vec3<Real> normal;
};

/// Sum of a body's contacts: force and torque.
template <class Real>
struct Wrench {
  Vec3<Real> force, torque;

  __device__ void add_as_a(const Pull<Real>& pull) {
    force -= pull.impulse;
    torque += cross(pull.impulse, pull.normal);
  }
  __device__ void add_as_b(const Pull<Real>& pull) {
    force += pull.impulse;
    torque += cross(pull.impulse, pull.normal);
  }
  /// Sum over the warp, the same bits in every lane.
  __device__ void add_over_warp() {
#pragma unroll
    for (int step = 16; step > 0; step /= 2) {
#pragma unroll
      for (int k = 0; k < 3; ++k) {
        force[k] += __shfl_xor_sync(0xffffffffu, force[k], step);
        torque[k] += __shfl_xor_sync(0xffffffffu, torque[k], step);
      }
    }
  }
};

/// What comes from memory for the bodies of a tile before its contact step.
template <class Real>
struct TileBodies {
  Twist<Real> extrapolated[kBodies];
  Index a_start[kBodies + 1];
  Index b_start[kBodies + 1];
};

/// A body between the contact step of its tile and its body pass: the sum of its contacts within
/// the tile, and those with bodies of tiles before. Of a body with a long list nothing is summed.
template <class Real>
struct HalfDone {
  Wrench<Real> wrench;
  Index far[kAtOnce];  ///< the first of the latter, or -1
  Index more, end;     ///< the others, as places in the list; more > end: the list is long
  __device__ bool is_long() const { return more > end; }
};

/// Shared memory of a block, 46 KB in float.
template <class Real>
struct TileMemory {
  TileBodies<Real> bodies[2];  ///< of this round, and of the one before or after it
  HalfDone<Real> half_done[kBodies];
  Pull<Real> pull[kStaged];
};

/// Bodies [begin, begin + count) and their contacts as A [first, last).
struct TileRange {
  Index begin, count;
  Index first, last;
};

/// Values of a trial that all threads need, in registers.
template <class Real>
struct Trial {
  ApgdContactStep<RadialRows<Real>, Real> step;
  Span<const Twist<Real>> velocity;  ///< V of the accepted iterate
  Span<Twist<Real>> next_velocity, next_extrapolated;
  Real next_beta;

  __device__ explicit Trial(const RadialPasses<Real>& a)
      : step(a.contact_pass().step()),
        velocity(a.velocity.current(*a.state)),
        next_velocity(a.velocity.iterate(a.state->accepted + 1)),
        next_extrapolated(a.velocity.of_extrapolated),
        next_beta(static_cast<Real>(a.state->next_beta)) {
    // A pointer picked from two is no longer known to be one into device memory.
    __builtin_assume(__isGlobal(step.current.data));
    __builtin_assume(__isGlobal(step.previous.data));
    __builtin_assume(__isGlobal(step.next.data));
    __builtin_assume(__isGlobal(step.extrapolated.data));
    __builtin_assume(__isGlobal(velocity.data));
    __builtin_assume(__isGlobal(next_velocity.data));
    __builtin_assume(__isGlobal(next_extrapolated.data));
    // Else the compiler keeps the doubles and converts them at every contact.
    asm volatile("" : "+f"(step.beta), "+f"(step.step), "+f"(next_beta));
  }
};

/// Begins to fetch the bodies of a tile, each thread one. Wait with __pipeline_wait_prior.
template <class Real>
__device__ void fetch_bodies(const RadialPasses<Real>& a, const Trial<Real>& trial, Index begin,
                             TileBodies<Real>& to) {
  const auto local = static_cast<Index>(threadIdx.x);
  const Index i = begin + local;
  const Index count = min(kBodies, a.p.free_count - begin);
  if (local < count) {
    static_assert(sizeof(Twist<Real>) == 3 * sizeof(float2));
    const auto* from = reinterpret_cast<const float2*>(trial.step.extrapolated.data + i);
    auto* into = reinterpret_cast<float2*>(to.extrapolated + local);
#pragma unroll
    for (int k = 0; k < 3; ++k) __pipeline_memcpy_async(into + k, from + k, sizeof(float2));
  }
  if (local <= count) {
    __pipeline_memcpy_async(to.a_start + local, a.p.a_start.data + i, sizeof(Index));
    __pipeline_memcpy_async(to.b_start + local, a.p.b_start.data + i, sizeof(Index));
  }
  __pipeline_commit();
}

/// Contact step of a tile: new impulses to memory, and what they exert to shared memory.
template <class Real>
__device__ void step_contacts(const RadialPasses<Real>& a, const Trial<Real>& trial,
                              const TileRange& range, const TileBodies<Real>& bodies,
                              Pull<Real>* pull, Sums<3>& sums) {
  for (Index c = range.first + static_cast<Index>(threadIdx.x); c < range.last; c += kThreads) {
    const Index b = a.p.body_b[c] - range.begin;
    const Twist<Real> v_b =
        b < range.count ? bodies.extrapolated[b] : trial.step.extrapolated[b + range.begin];
    // Read before the step writes: the compiler does not know that a normal stays as it is.
    const Vec3<Real> normal = a.p.normal[c];
    const Sums<2> mine =
        trial.step(a.p, a.metric, c, bodies.extrapolated[a.p.body_a[c] - range.begin], v_b);
    if (c - range.first < kStaged) pull[c - range.first] = {trial.step.next[c], normal};
    sums.value[0] += mine.value[0];
    sums.value[1] += mine.value[1];
  }
}

/// Gathers what contacts exert on bodies of one tile.
template <class Real>
class Gather {
 public:
  __device__ Gather(const RadialPasses<Real>& a, const Trial<Real>& trial)
      : p_(a.p), gamma_(trial.step.next.data) {}

  /// Contacts within the tile of the thread's body, when the tile's contact step is done.
  __device__ HalfDone<Real> within(const TileRange& range, const TileBodies<Real>& bodies,
                                   const Pull<Real>* pull) const {
    const auto pull_of = [&](Index c) { return pull[c - range.first]; };
    const auto pull_of_any = [&](Index c) {
      return c - range.first < kStaged ? pull[c - range.first] : of(c);
    };
    return range.last - range.first <= kStaged ? sum_within(range, bodies, pull_of)
                                               : sum_within(range, bodies, pull_of_any);
  }

  /// Adds contacts with bodies of tiles before, when their contact steps are done.
  __device__ void add_far(HalfDone<Real>& body) const {
    add(body.far, body.wrench);
    for (Index at = body.more; at < body.end; at += kAtOnce) {
      Index c[kAtOnce];
#pragma unroll
      for (int j = 0; j < kAtOnce; ++j) c[j] = at + j < body.end ? p_.b_contact[at + j] : -1;
      add(c, body.wrench);
    }
  }

  /// All contacts of body i, by a warp; every lane gets the sum.
  __device__ Wrench<Real> by_warp(Index i) const {
    const auto lane = static_cast<Index>(threadIdx.x % 32);
    Wrench<Real> sum;
    for (Index c = p_.a_start[i] + lane; c < p_.a_start[i + 1]; c += 32) sum.add_as_a(of(c));
    for (Index at = p_.b_start[i] + lane; at < p_.b_start[i + 1]; at += 32)
      sum.add_as_b(of(p_.b_contact[at]));
    sum.add_over_warp();
    return sum;
  }

 private:
  __device__ Pull<Real> of(Index c) const { return {gamma_[c], p_.normal[c]}; }

  template <class PullOf>
  __device__ HalfDone<Real> sum_within(const TileRange& range, const TileBodies<Real>& bodies,
                                       const PullOf& pull_of) const {
    const auto local = static_cast<int>(threadIdx.x);
    const Index a_begin = bodies.a_start[local], a_end = bodies.a_start[local + 1];
    const Index b_begin = bodies.b_start[local], b_end = bodies.b_start[local + 1];
    HalfDone<Real> body;
#pragma unroll
    for (int j = 0; j < kAtOnce; ++j) body.far[j] = -1;
    body.more = body.end = b_begin + kAtOnce;
    if (a_end - a_begin + b_end - b_begin > kLongList) {
      ++body.more;
      return body;
    }
#pragma unroll 1
    for (Index c = a_begin; c < a_end; ++c) body.wrench.add_as_a(pull_of(c));
    // Several at a time: a list of three or four would wait for memory at each. Contacts with
    // bodies of tiles before come first.
    for (Index at = b_begin; at < b_end; at += kAtOnce) {
      Index c[kAtOnce];
#pragma unroll
      for (int j = 0; j < kAtOnce; ++j) c[j] = at + j < b_end ? p_.b_contact[at + j] : -1;
#pragma unroll
      for (int j = 0; j < kAtOnce; ++j) {
        if (c[j] >= range.first) {
          body.wrench.add_as_b(pull_of(c[j]));
        } else if (at == b_begin) {
          body.far[j] = c[j];
        } else if (c[j] >= 0) {
          body.end = at + j + 1;
        }
      }
    }
    return body;
  }

  /// Contacts whose B is the body; those below zero are none.
  __device__ void add(const Index (&c)[kAtOnce], Wrench<Real>& sum) const {
    Pull<Real> pull[kAtOnce];
#pragma unroll
    for (int j = 0; j < kAtOnce; ++j) {
      if (c[j] >= 0) pull[j] = of(c[j]);
    }
#pragma unroll
    for (int j = 0; j < kAtOnce; ++j) sum.add_as_b(pull[j]);
  }

  const ContactProblem<Real>& p_;
  const Vec3<Real>* const gamma_;
};

}  // namespace sweep
}  // namespace scree
