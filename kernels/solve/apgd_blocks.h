#pragma once
// Tuned twin of the APGD contact pass for radial contacts on the CPU: as many contacts at a time
// as a vector register holds. Their numbers are turned from records to lanes, and the step of the
// plain pass runs on lanes. The body pass is the plain one.
//
// The time goes into arithmetic, not memory: with AVX-512 a contact took 8 ns in place of
// 22 (one thread of an AMD EPYC, float), when numbers were still moved one by one. Sums are added up block by block: the
// same bits for any number of threads.

#include <algorithm>

#include "kernels/backend/cpu.h"
#include "kernels/backend/lanes.h"
#include "kernels/solve/apgd_iteration.h"
#include "kernels/solve/one_contact.h"
#include "kernels/solve/turned_records.h"

namespace scree {

template <class Real>
using RadialImpactRows = ImpactRows<RadialRows<Real>>;
template <class Real>
using MixedImpactRows = ImpactRows<MixedRows<Real>>;

/// The contact step of a running solve for general contacts of the mixed layout, from the first of
/// them on.
template <class R, class Real>
struct ApgdGeneralContacts {
  static constexpr const char* name = "apgd_general_contacts";
  ApgdContactPass<R, Real> pass;
  SCREE_HD Sums<2> operator()(Index k) const { return pass(pass.p.radial_count + k); }
};

/// Contact step of a block of contacts; the element is the block.
template <template <class> class Rows, class Real>
struct ApgdContactBlock {
  static constexpr const char* name = "apgd_contact_blocks";
  static constexpr Index kContacts = Lanes<Real>::kCount;
  static constexpr Index kChunk = 1024 / kContacts;  ///< blocks in one piece of a parallel sum

  ApgdPasses<Rows<Real>, Real> a;

  static Index count(Index contacts) { return (contacts + kContacts - 1) / kContacts; }

  Sums<2> operator()(Index block) const {
    using L = Lanes<Real>;
    const Index first = block * kContacts;
    const int present = static_cast<int>(std::min(kContacts, a.p.contact_count - first));
    if (!all_count(first, present)) return one_by_one(first, present);
    const ApgdContactStep<Rows<Real>, Real> step = a.contact_pass().step();
    if constexpr (TurnedRecords<Real>::kWorks) {
      if (present == kContacts) return whole_block(step, first);
    }

    // Lanes past the end stay zero: their impulse remains zero and adds nothing to the sums.
    Records in{};
    for (int j = 0; j < present; ++j) {
      const Index c = first + j;
      in.put(j, kGamma, step.current[c]);
      in.put(j, kBefore, step.previous[c]);
      in.put(j, kNormal, a.p.normal[c]);
      in.put(j, kTwistA, step.extrapolated[a.p.body_a[c]]);
      in.put(j, kTwistB, step.extrapolated[a.p.body_b[c]]);
      in.lane[kBias][j] = a.p.bias[c];
      in.lane[kFriction][j] = a.p.friction[c];
      in.lane[kAdhesion][j] = a.p.adhesion[c];
      const ContactMetric<Real> h = a.metric.load(c);
      in.lane[kMetric][j] = h.normal;
      in.lane[kMetric + 1][j] = h.tangential;
    }
    for (int j = present; j < kContacts; ++j) in.lane[kMetric][j] = in.lane[kMetric + 1][j] = 1;

    OneContact<L> lanes{in.vector(kGamma),
                        in.vector(kBefore),
                        in.vector(kNormal),
                        L::load(in.lane[kBias]),
                        L::load(in.lane[kFriction]),
                        L::load(in.lane[kAdhesion]),
                        {L::load(in.lane[kMetric]), L::load(in.lane[kMetric + 1])}};
    Vec3<L> next;
    const Sums<2> sums = lanes.template step<Rows<L>>(L(step.beta), L(step.step), in.twist(kTwistA),
                                                      in.twist(kTwistB), next, a.exact);

    Records out;
    next.x.store(out.lane[0]), next.y.store(out.lane[1]), next.z.store(out.lane[2]);
    for (int j = 0; j < present; ++j) {
      step.next[first + j] = {out.lane[0][j], out.lane[1][j], out.lane[2][j]};
    }
    return sums;
  }

 private:
  /// The same of kContacts contacts, whose numbers are turned in registers.
  Sums<2> whole_block(const ApgdContactStep<Rows<Real>, Real>& step, Index c) const {
    using L = Lanes<Real>;
    using Turned = TurnedRecords<Real>;
    const auto each = [&](const PerContact<Real>& field) {
      return field.values.empty() ? L(field.uniform) : L::load_unaligned(field.values.data + c);
    };
    const Span<const Real> stored = a.p.bias.values.empty() ? a.p.bias.gap : a.p.bias.values;
    L bias = L::load_unaligned(stored.data + c);
    if (a.p.bias.values.empty()) {
      ContactBias<L> of_gap;
      of_gap.inv_time_step = L(a.p.bias.inv_time_step), of_gap.least = L(a.p.bias.least);
      bias = of_gap.value(bias);
    }
    OneContact<L> lanes{Turned::vectors(&step.current[c]),
                        Turned::vectors(&step.previous[c]),
                        Turned::vectors(&a.p.normal[c]),
                        bias,
                        each(a.p.friction),
                        each(a.p.adhesion),
                        {L(Real(1)), L(Real(1))}};
    if (a.metric.one_each && !a.metric.values.empty()) {
      lanes.weights[0] = L::load_unaligned(a.metric.values.data + c);
      lanes.weights[1] = L(a.metric.tangential_ratio) * lanes.weights[0];
    } else if (!a.metric.values.empty()) {
      alignas(64) Real weight[2][kContacts];
      for (Index j = 0; j < kContacts; ++j) {
        const ContactMetric<Real> h = a.metric.load(c + j);
        weight[0][j] = h.normal, weight[1][j] = h.tangential;
      }
      lanes.weights[0] = L::load(weight[0]), lanes.weights[1] = L::load(weight[1]);
    }
    const Twist<Real>* velocity = step.extrapolated.data;
    Vec3<L> next;
    const Sums<2> sums = lanes.template step<Rows<L>>(
        L(step.beta), L(step.step), Turned::twists(velocity, &a.p.body_a[c]),
        Turned::twists(velocity, &a.p.body_b[c]), next, a.exact);
    Turned::store(next, &step.next[c]);
    return sums;
  }

  /// Blocks with contacts that another rank counts are few.
  bool all_count(Index first, int present) const {
    if (a.p.bodies.owned_count == a.p.bodies.moving_count) return true;
    for (int j = 0; j < present; ++j)
      if (!a.p.bodies.counts(a.p.body_b[first + j])) return false;
    return true;
  }
  Sums<2> one_by_one(Index first, int present) const {
    const CountedOnce<ApgdContactPass<Rows<Real>, Real>> contact{a.contact_pass(), a.p.body_a,
                                                                 a.p.body_b, a.p.bodies};
    Sums<2> sums;
    for (int j = 0; j < present; ++j) sums.combine(contact(first + j));
    return sums;
  }

  enum Row {
    kGamma = 0,
    kBefore = 3,
    kNormal = 6,
    kTwistA = 9,
    kTwistB = 15,
    kBias = 21,
    kFriction,
    kAdhesion,
    kMetric,
    kRows = kMetric + 2
  };

  struct Records {
    alignas(64) Real lane[kRows][kContacts];

    void put(int j, int row, const Vec3<Real>& v) {
      lane[row][j] = v.x, lane[row + 1][j] = v.y, lane[row + 2][j] = v.z;
    }
    void put(int j, int row, const Twist<Real>& t) {
      put(j, row, t.linear);
      put(j, row + 3, t.angular);
    }
    Vec3<Lanes<Real>> vector(int row) const {
      using L = Lanes<Real>;
      return {L::load(lane[row]), L::load(lane[row + 1]), L::load(lane[row + 2])};
    }
    Twist<Lanes<Real>> twist(int row) const { return {vector(row), vector(row + 3)}; }
  };
};

template <>
class ApgdIteration<Cpu> {
 public:
  explicit ApgdIteration(Cpu& cpu) : sums_(cpu) {}
  template <class R, class Real>
  void start(Cpu&, const ApgdPasses<R, Real>&, const Ghosts<Cpu>* = nullptr) {}
  bool meets_ranks() const { return false; }

  /// Those that a GPU can end early, so that solves on both backends end at the same iterate.
  template <class R, class Real>
  bool stops(const ApgdPasses<R, Real>&) const {
    return false;
  }
  bool stops(const ApgdPasses<RadialRows<float>, float>&) const { return true; }
  bool stops(const ApgdPasses<RadialImpactRows<float>, float>&) const { return true; }
  bool stops(const ApgdPasses<MixedRows<float>, float>&) const { return true; }
  bool stops(const ApgdPasses<MixedImpactRows<float>, float>&) const { return true; }

  template <class R, class Real>
  bool stores_extrapolated(const ApgdPasses<R, Real>&) const {
    return true;
  }

  template <class R, class Real>
  void run(Cpu& cpu, const ApgdPasses<R, Real>& a, int count, double enough) {
    for (int k = 0; k < count; ++k) {
      trial(cpu, a);
      if (stops(a) && !(a.state->measure > enough)) break;
    }
  }

  template <class R, class Real>
  void queue_trial(Cpu& cpu, const ApgdPasses<R, Real>& a) {
    ApgdSums* sums = sums_.resize_discard(1).data;
    step(cpu, a, [&](bool adds) { return KeepContactSums{&sums->contacts, adds}; });
    reduce<Sums<1>>(cpu, a.p.bodies.owned_count, a.body_pass(),
                    StoreResult<Sums<1>>{&sums->bodies});
  }
  template <class R, class Real>
  ApgdSums take_sums(Cpu&, const ApgdPasses<R, Real>&) const {
    return *sums_.data();
  }

 private:
  /// ApgdContactFinish for sums that are not the last.
  struct KeepContactSums {
    Sums<2>* kept;
    bool adds;
    void operator()(const Sums<2>& sums) const {
      if (!adds) *kept = {};
      kept->combine(sums);
    }
  };

  template <class R, class Real>
  static void trial(Cpu& cpu, const ApgdPasses<R, Real>& a) {
    step(cpu, a, [&](bool adds) { return ApgdContactFinish{a.state, adds}; });
    reduce<Sums<1>>(cpu, a.p.bodies.owned_count, a.body_pass(), ApgdBodyFinish{a.state, a.exact});
  }

  /// The contact step. @param finish  finish(adds): what ends a sum, which may add to the one before
  template <class R, class Real, class F>
  static void step(Cpu& cpu, const ApgdPasses<R, Real>& a, const F& finish) {
    reduce<Sums<2>>(
        cpu, a.p.contact_count,
        CountedOnce<ApgdContactPass<R, Real>>{a.contact_pass(), a.p.body_a, a.p.body_b, a.p.bodies},
        finish(false));
  }
  template <class Real, class F>
  static void step(Cpu& cpu, const ApgdPasses<RadialRows<Real>, Real>& a, const F& finish) {
    step_in_blocks<RadialRows>(cpu, a, finish);
  }
  template <class Real, class F>
  static void step(Cpu& cpu, const ApgdPasses<RadialImpactRows<Real>, Real>& a, const F& finish) {
    step_in_blocks<RadialImpactRows>(cpu, a, finish);
  }
  template <class Real, class F>
  static void step(Cpu& cpu, const ApgdPasses<MixedRows<Real>, Real>& a, const F& finish) {
    step_in_groups<RadialRows>(cpu, a, finish);
  }
  template <class Real, class F>
  static void step(Cpu& cpu, const ApgdPasses<MixedImpactRows<Real>, Real>& a, const F& finish) {
    step_in_groups<RadialImpactRows>(cpu, a, finish);
  }

  /// @tparam Rows  of the radial contacts
  template <template <class> class Rows, class R, class Real, class F>
  static void step_in_groups(Cpu& cpu, const ApgdPasses<R, Real>& a, const F& finish) {
    ApgdPasses<Rows<Real>, Real> radial = passes_on<Rows<Real>>(a);
    radial.p.contact_count = a.p.radial_count;
    step_in_blocks<Rows>(cpu, radial, finish);
    const ApgdGeneralContacts<R, Real> general{a.contact_pass()};
    const Index count = a.p.contact_count - a.p.radial_count;
    const Span<const Index> body_a{a.p.body_a.data + a.p.radial_count, count};
    const Span<const Index> body_b{a.p.body_b.data + a.p.radial_count, count};
    reduce<Sums<2>>(cpu, count,
                    CountedOnce<ApgdGeneralContacts<R, Real>>{general, body_a, body_b, a.p.bodies},
                    finish(true));
  }
  template <template <class> class Rows, class Real, class F>
  static void step_in_blocks(Cpu& cpu, const ApgdPasses<Rows<Real>, Real>& a, const F& finish) {
    using Block = ApgdContactBlock<Rows, Real>;
    reduce<Sums<2>>(cpu, Block::count(a.p.contact_count), Block{a}, finish(false));
  }

  Buffer<Cpu, ApgdSums> sums_;  ///< of one of several ranks
};

}  // namespace scree
