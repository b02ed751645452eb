#pragma once
// Tuned twin of the body pass of APGD for contacts with lever arms. A body that is no sphere has some ten contacts, half of
// them as B, whose impulses and arms lie apart from each other. What bounds the plain pass is not their bytes but the lines of the
// first-level cache that loads touch: a thread that reads a vector touches its line three times. Here the lanes of a warp are
// dealt out: three of four read one component each of the same vector, eight share a body, and its contacts are numbered
// before any of them is read. Each warp then moves the 32 bodies whose wrenches it has gathered, one a lane. Arms of contacts as
// B are brought into the order of the lists when a solve starts: memory gives 64 bytes for each that lies alone.
//
// Bytes (float): per contact, of each of its two bodies: impulse and arm 24, of B also its number 4; per body: v*, V, V_y 72,
// inertia 64, starts 16 read; 48 written. Sums are those of the plain pass in another, fixed order.

#include <algorithm>
#include <type_traits>

#include "kernels/solve/apgd_passes.h"

namespace scree {
namespace apgd_bodies {

inline constexpr int kThreads = 128;
inline constexpr int kWarp = 32;
inline constexpr int kLanes = 8;               ///< of a body
inline constexpr int kTogether = kLanes / 4;   ///< contacts of a body that are read at a time
inline constexpr int kRound = kWarp / kLanes;  ///< bodies of a warp at a time
inline constexpr unsigned kAll = 0xffffffffu;

/// Brings the arms of contacts as B into the order of the lists of bodies. Bytes per contact: 16 read, 12 written.
template <class Real>
struct OrderArms {
  static constexpr const char* name = "order_arms";
  Span<const Index> contact;  ///< of the lists
  const Index*
      count;  ///< of those, in backend memory: no list has contacts with bodies that are not owned
  Span<const Vec3<Real>> arm;
  Span<Vec3<Real>> ordered;  ///< out
  SCREE_HD void operator()(Index k) const {
    if (k < *count) ordered[k] = arm[contact[k]];
  }
};

/// What a lane reads of a contact: its component of the impulse on the body, and of the arm.
template <class Real>
struct ArmedImpulse {
  Real impulse = 0;
  Real arm = 0;
};

/// The largest number of a warp, in all lanes.
__device__ inline Index most_of_warp(Index x) {
#if defined(__CUDA_ARCH__) && __CUDA_ARCH__ >= 800
  return __reduce_max_sync(kAll, x);
#else
  for (int step = kWarp / 2; step > 0; step /= 2) {
    const Index other = __shfl_xor_sync(kAll, x, step);
    x = other > x ? other : x;
  }
  return x;
#endif
}

/// The contacts of the bodies of a warp.
template <class Real>
class Gathering {
 public:
  /// @param arm_b  in the order of the lists
  __device__ Gathering(const ContactProblem<Real>& p, const Vec3<Real>* gamma,
                       const Vec3<Real>* arm_b, Index first, Index n)
      : gamma_(component(gamma)),
        arm_a_(component(p.arm_a.data)),
        arm_b_(component(arm_b)),
        b_contact_(p.b_contact.data) {
    if (first + lane() >= n) return;
    const Index i = first + lane();
    a_begin_ = p.a_start[i];
    a_count_ = p.a_start[i + 1] - a_begin_;
    b_begin_ = p.b_start[i];
    count_ = a_count_ + p.b_start[i + 1] - b_begin_;
  }

  /// J^T gamma of the bodies of a round; lanes 0 to 2 of each body have a component of force and torque.
  __device__ void gather(int round, Real& force, Real& torque) const {
    const int of = round * kRound + lane() / kLanes, in = lane() % kLanes;
    const Index a_begin = __shfl_sync(kAll, a_begin_, of),
                a_count = __shfl_sync(kAll, a_count_, of);
    const Index b_begin = __shfl_sync(kAll, b_begin_, of), count = __shfl_sync(kAll, count_, of);
    const Index most = most_of_warp(count);
    const int axis = in % 4;
    for (Index from = 0; from < most; from += kLanes) {
      const Index mine = from + in;
      Index contact = a_begin + mine;
      if (mine >= a_count && mine < count) contact = b_contact_[b_begin + mine - a_count];
      ArmedImpulse<Real> x[kLanes / kTogether];
#pragma unroll
      for (int t = 0; t < kLanes / kTogether; ++t) {
        const int place = kTogether * t + in / 4;
        const Index c = __shfl_sync(kAll, contact, place, kLanes), k = from + place;
        if (k >= count || axis == 3) continue;
        const Real impulse = gamma_[3 * static_cast<Offset>(c) + axis];
        x[t] = k < a_count
                   ? ArmedImpulse<Real>{-impulse, arm_a_[3 * static_cast<Offset>(c) + axis]}
                   : ArmedImpulse<Real>{
                         impulse, arm_b_[3 * static_cast<Offset>(b_begin + k - a_count) + axis]};
      }
#pragma unroll
      for (int t = 0; t < kLanes / kTogether; ++t) {
        force += x[t].impulse;
        torque += cross_component(x[t], axis);
      }
    }
#pragma unroll
    for (int step = kLanes / 2; step >= 4; step /= 2) {
      force += __shfl_down_sync(kAll, force, step, kLanes);
      torque += __shfl_down_sync(kAll, torque, step, kLanes);
    }
  }

  static __device__ int lane() { return static_cast<int>(threadIdx.x % kWarp); }

 private:
  static_assert(sizeof(Vec3<Real>) == 3 * sizeof(Real), "components lie beside each other");
  static __device__ const Real* component(const Vec3<Real>* v) {
    return reinterpret_cast<const Real*>(v);
  }
  /// Of arm x impulse; lanes 0 to 2 of four hold the components.
  static __device__ Real cross_component(const ArmedImpulse<Real>& x, int axis) {
    const int next = axis == 2 ? 0 : axis + 1, after = axis == 0 ? 2 : axis - 1;
    return __shfl_sync(kAll, x.arm, next, 4) * __shfl_sync(kAll, x.impulse, after, 4) -
           __shfl_sync(kAll, x.arm, after, 4) * __shfl_sync(kAll, x.impulse, next, 4);
  }

  const Real* gamma_;
  const Real* arm_a_;
  const Real* arm_b_;
  const Index* b_contact_;
  Index a_begin_ = 0, a_count_ = 0, b_begin_ = 0, count_ = 0;  ///< of the lane's own body
};

template <class R, class Real>
__global__ void __launch_bounds__(kThreads, sizeof(Real) == 4 ? 8 : 4)
    move_bodies(Index n, const __grid_constant__ ApgdBodyPass<R, Real> pass,
                const Vec3<Real>* arm_b, ApgdBodyFinish finish, Sums<1>* partials,
                unsigned* ticket) {
  __shared__ Real memory[kThreads / kWarp][kWarp][6];
  Real(&wrench)[kWarp][6] = memory[threadIdx.x / kWarp];
  const int lane = Gathering<Real>::lane();
  const Vec3<Real>* gamma = pass.gamma.next(pass.state->accepted).data;
  const Index warps = static_cast<Index>(gridDim.x) * (kThreads / kWarp);
  Sums<1> sums;
  for (Index first = kWarp * static_cast<Index>((blockIdx.x * kThreads + threadIdx.x) / kWarp);
       first < n; first += kWarp * warps) {
    const Gathering<Real> bodies(pass.p, gamma, arm_b, first, n);
    for (int round = 0; round < kWarp / kRound; ++round) {
      Real force = 0, torque = 0;
      bodies.gather(round, force, torque);
      const int of = round * kRound + lane / kLanes, axis = lane % kLanes;
      if (axis < 3) wrench[of][axis] = force, wrench[of][3 + axis] = torque;
    }
    __syncwarp();
    const Real* w = wrench[lane];
    const Index i = first + lane;
    if (i < n) sums.combine(pass.move(i, {{w[0], w[1], w[2]}, {w[3], w[4], w[5]}}));
    __syncwarp();
  }
  finish_reduction<kThreads>(sums, finish, partials, ticket);
}

/// Rows whose contacts are a force at two arms each, in one group.
template <class R, class Real>
inline constexpr bool kServes = std::is_base_of_v<GeneralRows<Real>, R>;

}  // namespace apgd_bodies

/// The body pass of the trials of a solve.
class ApgdBodies {
 public:
  explicit ApgdBodies(Cuda& cuda) : arm_b_(cuda) {}

  /// Memory: three numbers a contact.
  template <class R, class Real>
  void start(Cuda& cuda, const ApgdPasses<R, Real>& a) {
    const Span<const Index> contact = a.p.b_contact;
    arm_b_.reserve_discard(contact.size * static_cast<Offset>(sizeof(Vec3<Real>)));
    for_each(cuda, static_cast<Index>(contact.size),
             apgd_bodies::OrderArms<Real>{contact,
                                          a.p.b_start.data + a.p.bodies.owned_count,
                                          a.p.arm_b,
                                          {arms<Real>(), contact.size}});
  }

  template <class R, class Real>
  void run(Cuda& cuda, const ApgdPasses<R, Real>& a) {
    const auto kernel = &apgd_bodies::move_bodies<R, Real>;
    constexpr int kThreads = apgd_bodies::kThreads;
    const Index n = a.p.bodies.owned_count;
    const unsigned resident =
        cuda.reduce_blocks(reinterpret_cast<const void*>(kernel), "apgd_move_bodies", kThreads);
    const auto wanted = static_cast<unsigned>((n + kThreads - 1) / kThreads);
    kernel<<<std::clamp(wanted, 1u, resident), kThreads, 0, cuda.stream()>>>(
        n, a.body_pass(), arms<Real>(), ApgdBodyFinish{a.state, a.exact},
        static_cast<Sums<1>*>(cuda.partials()), cuda.ticket());
    cuda.check_launch("apgd_move_bodies");
  }

 private:
  template <class Real>
  Vec3<Real>* arms() {
    return reinterpret_cast<Vec3<Real>*>(arm_b_.data());
  }
  Buffer<Cuda, unsigned char> arm_b_;  ///< of the solve, in the order of the lists
};

}  // namespace scree
