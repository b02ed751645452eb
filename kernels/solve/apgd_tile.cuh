#pragma once
// A tile of bodies in shared memory, as a block of the APGD sweep works on it; see apgd_sweep.cuh.

#include <cuda_pipeline.h>

#include "kernels/backend/cuda.cuh"
#include "kernels/contact/packed_contact.h"
#include "kernels/solve/apgd_iteration.h"
#include "kernels/solve/apgd_programs.h"
#include "kernels/solve/one_contact.h"

namespace scree {
namespace apgd_sweep {

inline constexpr int kThreads = Cuda::kBlock;  ///< of a block
inline constexpr int kWarps = kThreads / 32;
inline constexpr int kBodies = 240;  ///< of a tile, at most
static_assert(kBodies < kThreads, "a thread for each start of a list");
static_assert(kBodies <= 256, "a packed contact names a body of its tile by a byte");
inline constexpr int kStaged = 904;     ///< contacts of a tile kept in shared memory
inline constexpr int kAtOnce = 4;       ///< contacts of a body that are fetched together
inline constexpr Index kLongList = 96;  ///< contacts of a body that one thread sums up, at most

template <class Real>
using RadialPasses = ApgdPasses<RadialRows<Real>, Real>;

template <class R, class Real>
inline constexpr bool kIsImpact = std::is_same_v<R, ImpactRows<RadialRows<Real>>> ||
                                  std::is_same_v<R, ImpactRows<MixedRows<Real>>>;

template <class R>
constexpr Law law_of(bool is_exact) {
  if (kIsImpact<R, float>) return Law::impact;
  return is_exact ? Law::coulomb : Law::convex;
}

/// Whether there are general contacts beside the radial ones.
template <class R, class Real>
inline constexpr bool kIsMixed =
    std::is_same_v<R, MixedRows<Real>> || std::is_same_v<R, ImpactRows<MixedRows<Real>>>;

/// What a contact exerts on its bodies: B's force, and the torque on both.
template <class Real>
struct Pull {
  Vec3<Real> impulse;
  Vec3<Real> torque;

  Pull() = default;
  __device__ Pull(const Vec3<Real>& g, const Vec3<Real>& normal)
      : impulse(g), torque(cross(g, normal)) {}
};

/// Sum of a body's contacts: force and torque.
template <class Real>
struct Wrench {
  Vec3<Real> force, torque;

  __device__ void add_as_a(const Pull<Real>& pull) {
    force -= pull.impulse;
    torque += pull.torque;
  }
  __device__ void add_as_b(const Pull<Real>& pull) {
    force += pull.impulse;
    torque += pull.torque;
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

/// The bodies of a tile as its contact step needs them.
template <class Real>
struct TileBodies {
  Twist<Real> extrapolated[kBodies];  ///< V from memory, then V_y in its place
  Index a_start[kBodies + 1];
  Index b_start[kBodies + 1];
};

/// A body between the contact step of its tile and its body pass: the sum of its contacts within
/// the tile, and those with bodies of tiles before. Of a body with a long list nothing is summed.
template <class Real>
struct PartialWrench {
  Wrench<Real> wrench;
  Index far[kAtOnce];  ///< the first of the latter, or -1
  Index more, end;     ///< the others, as places in the list; more > end: the list is long
  __device__ bool is_long() const { return more > end; }
};

/// Shared memory of a block, 47 KB in float: four of them leave 60 KB to the first-level cache.
template <class Real>
struct TileMemory {
  TileBodies<Real> bodies[2];  ///< of this round, and of the one before or after it
  PartialWrench<Real> half_done[kBodies];
  Pull<Real> pull[kStaged];
};

inline constexpr int kBlocks = 4;  ///< wanted on a multiprocessor
/// Shared memory that a program declares itself, at most; ptxas tells. With more the next larger share of the 256 KB would be
/// taken, which leaves 28 KB. A program with 752 bytes took a quarter longer for a trial.
inline constexpr int kStaticBytes = 480;
static_assert(kBlocks * (sizeof(TileMemory<float>) + kStaticBytes + 1024) <= 196 * 1024);

/// Bodies [begin, begin + count) and their contacts as A [first, last).
struct TileRange {
  Index begin, count;
  Index first, last;
};

/// Packs what contacts keep through a solve.
template <class R, class Real>
struct PackContacts {
  static constexpr const char* name = "apgd_pack_contacts";
  ContactProblem<Real> p;
  StoredMetric<R, Real> metric;
  Span<PackedContact> packed;
  __device__ void operator()(Index c) const {
    const auto local = static_cast<std::uint32_t>(p.body_a[c] % kBodies);
    packed[c] = {p.normal[c], metric.load(c).normal, local};
  }
};

/// A number that is the same in all lanes, in a register that they share where there are such.
__device__ inline unsigned shared_by_warp(unsigned x) {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 800
  return __reduce_max_sync(0xffffffffu, x);
#else
  return x;
#endif
}
__device__ inline float shared_by_warp(double x) {
  return __uint_as_float(shared_by_warp(__float_as_uint(static_cast<float>(x))));
}

/// Values of a trial that all threads need, in registers. V_y is never stored: it is worked out
/// from two iterates where it is needed, and the next iterate takes the place of the older one.
template <class Real>
struct Trial {
  const PackedContact* packed;
  Span<const Vec3<Real>> gamma, previous_gamma;
  Span<Vec3<Real>> next_gamma;
  Span<const Twist<Real>> velocity, previous_velocity;
  Span<Twist<Real>> next_velocity;
  Real beta, length;

  /// @param state  the same in all threads
  __device__ Trial(const RadialPasses<Real>& a, const ApgdState& state,
                   const PackedContact* contacts)
      : packed(contacts), beta(shared_by_warp(state.beta)), length(shared_by_warp(state.step)) {
    const auto k = static_cast<Index>(shared_by_warp(static_cast<unsigned>(state.accepted)));
    gamma = a.gamma.current(k);
    previous_gamma = a.gamma.previous(k);
    next_gamma = a.gamma.next(k);
    velocity = a.velocity.iterate(k);
    previous_velocity = a.velocity.iterate(k + 1);
    next_velocity = a.velocity.iterate(k + 1);
    // A pointer picked from two is no longer known to be one into device memory.
    __builtin_assume(__isGlobal(gamma.data));
    __builtin_assume(__isGlobal(previous_gamma.data));
    __builtin_assume(__isGlobal(next_gamma.data));
    __builtin_assume(__isGlobal(velocity.data));
    __builtin_assume(__isGlobal(previous_velocity.data));
    __builtin_assume(__isGlobal(next_velocity.data));
  }
  __device__ Twist<Real> extrapolated(const Twist<Real>& v, const Twist<Real>& previous) const {
    return v + beta * (v - previous);
  }
};

/// Begins to copy the twist of a body to shared memory.
template <class Real>
__device__ void fetch_twist(const Twist<Real>* from, Twist<Real>* to) {
  static_assert(sizeof(Twist<Real>) == 3 * sizeof(float2));
#pragma unroll
  for (int k = 0; k < 3; ++k) {
    __pipeline_memcpy_async(reinterpret_cast<float2*>(to) + k,
                            reinterpret_cast<const float2*>(from) + k, sizeof(float2));
  }
}

/// Begins to copy where the lists of the thread's body start.
template <class Real>
__device__ void fetch_starts(const ContactProblem<Real>& p, Index body, TileBodies<Real>& to) {
  __pipeline_memcpy_async(to.a_start + threadIdx.x, p.a_start.data + body, sizeof(Index));
  __pipeline_memcpy_async(to.b_start + threadIdx.x, p.b_start.data + body, sizeof(Index));
}

/// V_y of a tile on its way to shared memory, a body to a thread: V comes by itself, its older
/// value waits in registers.
template <class Real>
class BodyFetch {
 public:
  __device__ BodyFetch(const RadialPasses<Real>& a, const Trial<Real>& trial, Index tile)
      : trial_(trial), i_(tile * kBodies + static_cast<Index>(threadIdx.x)) {
    const auto local = static_cast<Index>(threadIdx.x);
    const Index count = min(Index{kBodies}, a.p.bodies.owned_count - tile * kBodies);
    is_body_ = local < count;
    is_start_ = local <= count;
  }
  /// Begins to copy V and the starts of lists.
  __device__ void start(const RadialPasses<Real>& a, TileBodies<Real>& to) const {
    if (is_body_) fetch_twist(trial_.velocity.data + i_, to.extrapolated + threadIdx.x);
    if (is_start_) fetch_starts(a.p, i_, to);
    __pipeline_commit();
  }
  /// Reads the older velocity; some work should come before finish().
  __device__ void read_previous() {
    if (is_body_) previous_ = trial_.previous_velocity[i_];
  }
  /// Puts V_y in the place of V. Other threads may read it after a barrier.
  __device__ void finish(TileBodies<Real>& to) const {
    __pipeline_wait_prior(0);
    if (is_body_) {
      Twist<Real>& v = to.extrapolated[threadIdx.x];
      v = trial_.extrapolated(v, previous_);
    }
  }

 private:
  const Trial<Real>& trial_;
  Index i_;
  bool is_body_, is_start_;
  Twist<Real> previous_;
};

/// V_y of the first tile of a trial, the room of both tiles at hand: it is on its way while the
/// trial before is decided, so which velocities are needed is only predicted.
template <class Real>
class FirstFetch {
 public:
  __device__ FirstFetch(const RadialPasses<Real>& a, Index tile)
      : p_(a.p),
        i_(tile * kBodies + static_cast<Index>(threadIdx.x)),
        count_(min(Index{kBodies}, a.p.bodies.owned_count - tile * kBodies)) {}

  __device__ void start(const Span<const Twist<Real>>& velocity,
                        const Span<const Twist<Real>>& previous, TileBodies<Real>* tiles) const {
    const auto local = static_cast<Index>(threadIdx.x);
    if (local < count_) {
      fetch_twist(velocity.data + i_, tiles[0].extrapolated + local);
      fetch_twist(previous.data + i_, tiles[1].extrapolated + local);
    }
    if (local <= count_) fetch_starts(p_, i_, tiles[0]);
    __pipeline_commit();
  }
  /// Starts again, from other velocities.
  __device__ void restart(const Span<const Twist<Real>>& velocity,
                          const Span<const Twist<Real>>& previous, TileBodies<Real>* tiles) const {
    __pipeline_wait_prior(0);
    start(velocity, previous, tiles);
  }
  /// Other threads may read V_y after a barrier.
  __device__ void finish(const Trial<Real>& trial, TileBodies<Real>* tiles) const {
    __pipeline_wait_prior(0);
    const auto local = static_cast<Index>(threadIdx.x);
    if (local >= count_) return;
    Twist<Real>& v = tiles[0].extrapolated[local];
    v = trial.extrapolated(v, tiles[1].extrapolated[local]);
  }

 private:
  const ContactProblem<Real>& p_;
  Index i_, count_;
};

/// Contact step of a tile: new impulses to memory, and what they exert to shared memory. Each warp
/// takes whole turns of contacts that follow each other, the last one what is left.
/// @tparam kWeights  stored weights of the metric: none (Euclidean), one or two
template <int kWeights, Law kLaw, class Real>
__device__ void step_contacts(const RadialPasses<Real>& a, const Trial<Real>& trial,
                              const TileRange& range, const TileBodies<Real>& bodies,
                              Pull<Real>* pull, Sums<3>& sums) {
  using Rows =
      std::conditional_t<kLaw == Law::impact, ImpactRows<RadialRows<Real>>, RadialRows<Real>>;
  const bool has_uncounted = a.p.bodies.has_uncounted();
  const Index share = (range.last - range.first + kThreads - 1) / kThreads * 32;
  const Index begin = range.first + static_cast<Index>(threadIdx.x / 32) * share;
  const Index end = min(begin + share, range.last);
  for (Index c = begin + static_cast<Index>(threadIdx.x % 32); c < end; c += 32) {
    const Index id_b = a.p.body_b[c];
    const PackedContact packed = trial.packed[c];
    OneContact<Real> contact{trial.gamma[c],    trial.previous_gamma[c], {},
                             a.p.bias.read(c),  a.p.friction[c],         a.p.adhesion[c],
                             {Real(1), Real(1)}};
    if (kWeights == 2) {
#pragma unroll
      for (int j = 0; j < 2; ++j)
        contact.weights[j] = a.metric.values[static_cast<Offset>(c) * 2 + j];
    }
    // All of that is asked for before the first of it is used.
    asm volatile("" ::: "memory");
    const Index b = id_b - range.begin;
    Twist<Real> v_b;
    if (b < range.count) {
      v_b = bodies.extrapolated[b];
    } else {
      const Twist<Real> v = trial.velocity[id_b], previous = trial.previous_velocity[id_b];
      v_b = trial.extrapolated(v, previous);
    }
    contact.bias = a.p.bias.value(contact.bias);
    contact.normal = packed.normal();
    if (kWeights == 1) {
      contact.weights[0] = packed.weight();
      contact.weights[1] = a.metric.tangential_ratio * contact.weights[0];
    }
    Vec3<Real> next;
    const Sums<2> mine =
        contact.template step<Rows>(trial.beta, trial.length, bodies.extrapolated[packed.local()],
                                    v_b, next, kLaw == Law::coulomb);
    trial.next_gamma[c] = next;
    if (c - range.first < kStaged) pull[c - range.first] = {next, contact.normal};
    if (has_uncounted && !a.p.bodies.counts(id_b)) continue;
    sums.value[0] += mine.value[0];
    sums.value[1] += mine.value[1];
  }
}

/// Gathers what contacts exert on bodies of one tile.
template <class Real>
class Gather {
 public:
  __device__ Gather(const RadialPasses<Real>& a, const Trial<Real>& trial)
      : p_(a.p), gamma_(trial.next_gamma.data), packed_(trial.packed) {}

  /// Contacts within the tile of the thread's body, when the tile's contact step is done.
  __device__ PartialWrench<Real> within(const TileRange& range, const TileBodies<Real>& bodies,
                                        const Pull<Real>* pull) const {
    const auto pull_of = [&](Index c) { return pull[c - range.first]; };
    const auto pull_of_any = [&](Index c) {
      return c - range.first < kStaged ? pull[c - range.first] : of(c);
    };
    return range.last - range.first <= kStaged ? sum_within(range, bodies, pull_of)
                                               : sum_within(range, bodies, pull_of_any);
  }

  /// Adds contacts with bodies of tiles before, when their contact steps are done.
  __device__ void add_far(PartialWrench<Real>& body) const {
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
  __device__ Pull<Real> of(Index c) const { return {gamma_[c], packed_[c].normal()}; }

  template <class PullOf>
  __device__ PartialWrench<Real> sum_within(const TileRange& range, const TileBodies<Real>& bodies,
                                            const PullOf& pull_of) const {
    const auto local = static_cast<int>(threadIdx.x);
    const Index a_begin = bodies.a_start[local], a_end = bodies.a_start[local + 1];
    const Index b_begin = bodies.b_start[local], b_end = bodies.b_start[local + 1];
    PartialWrench<Real> body;
#pragma unroll
    for (int j = 0; j < kAtOnce; ++j) body.far[j] = -1;
    body.more = body.end = b_begin + kAtOnce;
    if (a_end - a_begin + b_end - b_begin > kLongList) {
      ++body.more;
      return body;
    }
    // Several at a time: a list of three or four would wait for memory at each.
    Index c[kAtOnce];
    const auto read_list = [&](Index at) {
#pragma unroll
      for (int j = 0; j < kAtOnce; ++j) c[j] = at + j < b_end ? p_.b_contact[at + j] : -1;
    };
    read_list(b_begin);
#pragma unroll 1
    for (Index k = a_begin; k < a_end; ++k) body.wrench.add_as_a(pull_of(k));
    // Contacts with bodies of tiles before come first.
    for (Index at = b_begin; at < b_end; at += kAtOnce) {
      if (at > b_begin) read_list(at);
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
    Vec3<Real> gamma[kAtOnce];
    PackedContact packed[kAtOnce];
#pragma unroll
    for (int j = 0; j < kAtOnce; ++j) {
      const bool is_there = c[j] >= 0;
      if (is_there) gamma[j] = gamma_[c[j]];
      packed[j] = is_there ? packed_[c[j]] : PackedContact({1, 0, 0}, 0, 0);
    }
    asm volatile("" ::: "memory");  // as above: no contact waits for the one before
#pragma unroll
    for (int j = 0; j < kAtOnce; ++j) sum.add_as_b({gamma[j], packed[j].normal()});
  }

  const ContactProblem<Real>& p_;
  const Vec3<Real>* const gamma_;
  const PackedContact* const packed_;
};

}  // namespace apgd_sweep
}  // namespace scree
