#pragma once
// General contacts, and bodies that are no spheres, in the APGD sweep of the mixed layout; see
// apgd_sweep.cuh.

#include "kernels/backend/wide_records.cuh"
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

/// What a body is without its contacts.
template <class Real>
struct BodyBefore {
  RadialInertia<Real> inertia;
  Twist<Real> free_velocity;
  BodyBefore() = default;
  __device__ BodyBefore(const ContactProblem<Real>& p, Index i)
      : inertia(p.radial_inertia[i]), free_velocity(p.free_velocity[i]) {}
};

/// The same of a body that has a general inertia, as all have in a layout of general contacts alone.
struct GeneralBody {
  GeneralInertia<float> inertia;
  Twist<float> free_velocity;
  GeneralBody() = default;
  __device__ GeneralBody(const ContactProblem<float>& p, Index i)
      : inertia(load_by<float4>(p.general_inertia.data + i)), free_velocity(p.free_velocity[i]) {}
};
template <bool>
__device__ Twist<float> moved_body(const ContactProblem<float>&, Index, const GeneralBody& before,
                                   const Wrench<float>& wrench, const Twist<float>& extrapolated,
                                   Sums<3>& sums) {
  using Rows = GeneralRows<float>;
  const Twist<float> next = before.free_velocity +
                            Rows::apply_inverse_mass(before.inertia, {wrench.force, wrench.torque});
  sums.value[2] += Rows::mass_norm2(before.inertia, next - extrapolated);
  return next;
}

/// New velocity of body i.
/// @tparam kIsMixed  it may be one that is no sphere
/// @param wrench     of all of its contacts
/// @param sums       in, out: the third one
template <bool kIsMixed, class Real>
__device__ Twist<Real> moved_body(const ContactProblem<Real>& p, Index i,
                                  const BodyBefore<Real>& before, const Wrench<Real>& wrench,
                                  const Twist<Real>& extrapolated, Sums<3>& sums) {
  const RadialInertia<Real>& inertia = before.inertia;
  if constexpr (kIsMixed) {
    if (!(inertia.inv_mass > Real(0))) {
      using Rows = GeneralRows<Real, true>;
      const Twist<Real> next =
          before.free_velocity + Rows::apply_inverse_mass(p, i, {wrench.force, wrench.torque});
      sums.value[2] += Rows::mass_norm2(p, i, next - extrapolated);
      return next;
    }
  }
  const Twist<Real> next = before.free_velocity + RadialRows<Real>::apply_inverse_mass(
                                                      inertia, {wrench.force, wrench.torque});
  const Twist<Real> change = next - extrapolated;
  Real energy = 0;
  if (inertia.inv_mass > Real(0)) energy += norm2(change.linear) * inverse(inertia.inv_mass);
  if (inertia.inv_spin > Real(0)) energy += norm2(change.angular) * inverse(inertia.inv_spin);
  sums.value[2] += static_cast<double>(energy);
  return next;
}

}  // namespace apgd_sweep
}  // namespace scree
