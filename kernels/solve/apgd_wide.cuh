#pragma once
// Tuned twin of the two APGD passes for general contacts in float: the same sums in the same order, by wide loads.
//
// The plain passes wait for lines of the first-level cache: a load of a warp takes a cycle for each line that it touches,
// and neighbors in a warp want records that lie apart. In loads of 4 bytes a vector takes three, a twist six and the mass
// of a body sixteen. Here impulses and lever arms have 16 bytes, one load; a twist takes three and a mass four. Bytes
// per contact, beside those of the plain passes: impulse 16 written; 2 x 32 gathered as A and as B in place of 2 x 24. Arms are
// copied once a solve. Memory: 48 bytes a contact. On an H200 a trial takes 343 us instead of 480 with 1e6 boxes and
// 4.9e6 contacts, and 47 instead of 52 with 1.1e5 boxes and 4.1e5 contacts (bench/results/h200).

#include <algorithm>

#include "kernels/backend/wide_records.cuh"
#include "kernels/solve/apgd_decide.cuh"

namespace scree {
namespace wide {

using Rows = GeneralRows<float>;
using Passes = ApgdPasses<Rows, float>;

/// Contacts whose records a thread asks for before it adds the first up: 1, 4 and 6 are slower with few bodies.
inline constexpr int kAtOnce = 2;

/// What the body pass reads of contacts.
struct Records {
  Span<float4> impulse;  ///< of the trial
  Span<float4> arm_a, arm_b;
};

struct CopyArms {
  static constexpr const char* name = "apgd_copy_arms";
  Span<const Vec3<float>> arm_a, arm_b;
  Records to;
  __device__ void operator()(Index c) const {
    to.arm_a[c] = widened(arm_a[c]);
    to.arm_b[c] = widened(arm_b[c]);
  }
};

struct ContactPass {
  static constexpr const char* name = "apgd_contact_pass";
  ApgdContactPass<Rows, float> plain;
  Span<float4> impulse;

  __device__ Sums<2> operator()(Index c) const {
    const ContactProblem<float>& p = plain.p;
    const auto step = plain.step();
    const Twist<float>* v = step.extrapolated.data;
    const Sums<2> sums = step(p, plain.metric, c, load_by<float2>(v + p.body_a[c]),
                              load_by<float2>(v + p.body_b[c]));
    impulse[c] = widened(step.next[c]);
    return sums;
  }
};

struct BodyPass {
  static constexpr const char* name = "apgd_body_pass";
  ApgdBodyPass<Rows, float> plain;
  Records records;

  __device__ Sums<1> operator()(Index i) const {
    const ContactProblem<float>& p = plain.p;
    const ApgdState& s = *plain.state;
    const auto mass = load_by<float4>(p.general_inertia.data + i);
    const Twist<float> next = p.free_velocity[i] + Rows::apply_inverse_mass(mass, gathered(p, i));
    const auto extrapolated = load_by<float2>(plain.velocity.extrapolated(s).data + i);
    const Twist<float> momentum = static_cast<float>(s.next_beta) *
                                  (next - load_by<float2>(plain.velocity.current(s).data + i));
    store_by<float2>(next, plain.velocity.iterate(s.accepted + 1).data + i);
    store_by<float2>(next + momentum, plain.velocity.of_extrapolated.data + i);
    return {{Rows::mass_norm2(mass, next - extrapolated)}};
  }

 private:
  /// gather_wrench() on wide records.
  __device__ Twist<float> gathered(const ContactProblem<float>& p, Index i) const {
    Twist<float> sum;
    add(
        p.a_start[i], p.a_start[i + 1], [](Index k) { return k; }, false, sum);
    add(
        p.b_start[i], p.b_start[i + 1], [&](Index k) { return p.b_contact[k]; }, true, sum);
    return sum;
  }
  template <class Contact>
  __device__ void add(Index begin, Index end, const Contact& contact, bool side_b,
                      Twist<float>& sum) const {
    const Span<float4> arm = side_b ? records.arm_b : records.arm_a;
    for (Index k = begin; k < end; k += kAtOnce) {
      Index c[kAtOnce];
#pragma unroll
      for (int j = 0; j < kAtOnce; ++j) c[j] = k + j < end ? contact(k + j) : Index{-1};
      float4 impulse[kAtOnce], at[kAtOnce];
#pragma unroll
      for (int j = 0; j < kAtOnce; ++j) {
        if (c[j] < 0) continue;
        impulse[j] = records.impulse[c[j]];
        at[j] = arm[c[j]];
      }
#pragma unroll
      for (int j = 0; j < kAtOnce; ++j)
        if (c[j] >= 0) sum = sum + Rows::wrench_at(narrowed(at[j]), side_b, narrowed(impulse[j]));
    }
  }
};

/// What the blocks share.
struct Shared {
  ApgdMeeting meeting;
  unsigned*
      stepped;  ///< blocks that are done with the contacts of a trial, over all trials; zero with a solve
};

/// Trials one after the other in one launch. Between contacts and bodies, and at the end of a trial, the blocks meet.
inline __global__ void __launch_bounds__(kApgdThreads, 4)
    run_trials(const __grid_constant__ Passes a, const __grid_constant__ Records records,
               const Shared shared, int count, double enough) {
  __shared__ ApgdState state;  // the same in all blocks
  __shared__ unsigned trials;  // before this launch: no block arrives before all know
  if (threadIdx.x == 0) {
    state = *a.state;
    trials = *shared.meeting.arrived / gridDim.x;
  }
  __syncthreads();
  const auto first = static_cast<Index>(blockIdx.x * blockDim.x + threadIdx.x);
  const auto stride = static_cast<Index>(gridDim.x * blockDim.x);
  ContactPass contact{a.contact_pass(), records.impulse};
  BodyPass body{a.body_pass(), records};
  contact.plain.state = &state;
  body.plain.state = &state;
  for (unsigned k = 0; k < static_cast<unsigned>(count); ++k) {
    if (k > 0 && !(state.measure > enough)) break;
    Sums<3> sums;
    for (Index c = first; c < a.p.contact_count; c += stride) {
      const Sums<2> mine = contact(c);
      sums.value[0] += mine.value[0];
      sums.value[1] += mine.value[1];
    }
    __syncthreads();
    if (threadIdx.x == 0) {
      DeviceCounter(*shared.stepped).fetch_add(1, cuda::memory_order_release);
      wait_for(*shared.stepped, (trials + k + 1) * gridDim.x);
    }
    __syncthreads();
    for (Index i = first; i < a.p.bodies.owned_count; i += stride)
      sums.value[2] += body(i).value[0];
    decide(meet_blocks(shared.meeting, trials + k, sums, [] {}), state, a.exact);
  }
  if (blockIdx.x == 0 && threadIdx.x == 0) *a.state = state;
}

/// The copies of a solve, and its trials.
class Iteration {
 public:
  explicit Iteration(Cuda& cuda)
      : impulse_(cuda), arm_a_(cuda), arm_b_(cuda), counters_(cuda), partial_(cuda) {}

  void start(Cuda& cuda, const Passes& a) {
    const Index n = a.p.contact_count;
    for (Buffer<Cuda, float4>* buffer : {&impulse_, &arm_a_, &arm_b_}) buffer->reserve_discard(n);
    records_ = {impulse_.view(n), arm_a_.view(n), arm_b_.view(n)};
    for_each(cuda, n, CopyArms{a.p.arm_a, a.p.arm_b, records_});
    const Index elements = std::max(n, a.p.bodies.owned_count);
    const Index wanted = (elements + kApgdThreads - 1) / kApgdThreads;
    blocks_ = std::min(cuda.resident_blocks(kernel(), "occupancy of apgd_wide"),
                       static_cast<unsigned>(wanted));
    partial_.reserve_discard(blocks_);
    counters_.reserve_discard(2);
    fill(cuda, counters_.view(2), 0u);
  }
  void run(Cuda& cuda, const Passes& a, int count, double enough) {
    Shared shared{{counters_.data(), partial_.data()}, counters_.data() + 1};
    Passes passes = a;
    void* arguments[] = {&passes, &records_, &shared, &count, &enough};
    check_cuda(
        cudaLaunchCooperativeKernel(kernel(), blocks_, kApgdThreads, arguments, 0, cuda.stream()),
        "apgd_wide");
    cuda.check_launch("apgd_wide");
  }

 private:
  static const void* kernel() { return reinterpret_cast<const void*>(&run_trials); }

  Buffer<Cuda, float4> impulse_, arm_a_, arm_b_;
  Buffer<Cuda, unsigned> counters_;
  Buffer<Cuda, Sums<3>> partial_;
  Records records_;
  unsigned blocks_ = 1;
};

}  // namespace wide
}  // namespace scree
