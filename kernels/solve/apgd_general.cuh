#pragma once
// General contacts, and bodies that are no spheres, in the APGD sweep of the mixed layout; see
// apgd_sweep.cuh.

#include "kernels/solve/apgd_tile.cuh"

namespace scree {
namespace apgd_sweep {

/// General contacts of a body that one thread sums up, at most: it waits for memory at each.
inline constexpr Index kLongGeneralList = 16;

/// Contact step of the thread's share of the general contacts.
template <Law kLaw, class Real>
__device__ void step_general_contacts(const RadialPasses<Real>& a, const Trial<Real>& trial,
                                      Sums<3>& sums) {
  using Rows = std::conditional_t<kLaw == Law::impact, ImpactRows<GeneralRows<Real, true>>,
                                  GeneralRows<Real, true>>;
  const ApgdContactStep<Rows, Real> step{trial.gamma, trial.previous_gamma, trial.next_gamma,    {},
                                         trial.beta,  trial.length,         kLaw == Law::coulomb};
  const StoredMetric<Rows, Real> metric{a.metric.values, a.metric.one_each,
                                        a.metric.tangential_ratio};
  const auto v_y = [&](Index i) {
    return trial.extrapolated(trial.velocity[i], trial.previous_velocity[i]);
  };
  const bool has_uncounted = a.p.bodies.has_uncounted();
  const auto stride = static_cast<Index>(gridDim.x * blockDim.x);
  for (Index c = a.p.radial_count + static_cast<Index>(blockIdx.x * blockDim.x + threadIdx.x);
       c < a.p.contact_count; c += stride) {
    const Sums<2> mine = step(a.p, metric, c, v_y(a.p.body_a[c]), v_y(a.p.body_b[c]));
    if (has_uncounted && !a.p.bodies.counts(a.p.body_b[c])) continue;
    sums.value[0] += mine.value[0];
    sums.value[1] += mine.value[1];
  }
}

/// What general contact `number` of the group exerts on one of its bodies.
template <class Real>
__device__ Wrench<Real> general_wrench(const ContactProblem<Real>& p, const Vec3<Real>* gamma,
                                       Index number, bool side_b) {
  const Index c = p.radial_count + number;
  const Twist<Real> w = GeneralRows<Real, true>::wrench(p, c, side_b, {gamma[c]});
  return {w.linear, w.angular};
}

/// Adds what general contacts exert on the thread's body. All threads of a warp come here: they sum
/// up long lists together.
/// @param gamma  impulses of all contacts
template <class Real>
__device__ void add_general(const ContactProblem<Real>& p, const Vec3<Real>* gamma, Index i,
                            bool is_there, Wrench<Real>& wrench) {
  const ContactLists& lists = p.later[0];
  const auto add = [&](Wrench<Real>& to, Index number, bool side_b) {
    const Wrench<Real> w = general_wrench(p, gamma, number, side_b);
    to.force += w.force;
    to.torque += w.torque;
  };
  const bool is_long = is_there && lists.count(i) > kLongGeneralList;
  if (is_there && !is_long) {
    for (Index k = lists.a_start[i]; k < lists.a_start[i + 1]; ++k) add(wrench, k, false);
    for (Index k = lists.b_start[i]; k < lists.b_start[i + 1]; ++k)
      add(wrench, lists.b_contact[k], true);
  }
  const auto lane = static_cast<Index>(threadIdx.x % 32);
  for (unsigned left = __ballot_sync(0xffffffffu, is_long); left != 0; left &= left - 1) {
    const Index of = __ffs(static_cast<int>(left)) - 1, body = i - lane + of;
    Wrench<Real> sum;
    for (Index k = lists.a_start[body] + lane; k < lists.a_start[body + 1]; k += 32)
      add(sum, k, false);
    for (Index k = lists.b_start[body] + lane; k < lists.b_start[body + 1]; k += 32)
      add(sum, lists.b_contact[k], true);
    sum.add_over_warp();
    if (lane == of) {
      wrench.force += sum.force;
      wrench.torque += sum.torque;
    }
  }
}

/// New velocity of a body that is no sphere.
template <class Real>
__device__ void step_general_body(const ContactProblem<Real>& p, const Trial<Real>& trial, Index i,
                                  const Wrench<Real>& wrench, const Twist<Real>& extrapolated,
                                  Sums<3>& sums) {
  const Twist<Real> next = p.free_velocity[i] + GeneralRows<Real, true>::apply_inverse_mass(
                                                    p, i, {wrench.force, wrench.torque});
  trial.next_velocity[i] = next;
  sums.value[2] += GeneralRows<Real, true>::mass_norm2(p, i, next - extrapolated);
}

}  // namespace apgd_sweep
}  // namespace scree
