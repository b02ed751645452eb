#pragma once
// Tuned twin of the APGD contact pass for radial contacts on the CPU: as many contacts at a time
// as a vector register holds. Their numbers are turned from records to lanes, and the step of the
// plain pass runs on lanes. The body pass is the plain one.
//
// The time goes into arithmetic, not memory: with AVX-512 a contact takes 8 ns in place of
// 22 (one thread of an AMD EPYC, float). Sums are added up block by block: the same bits
// for any number of threads.

#include <algorithm>

#include "kernels/backend/cpu.h"
#include "kernels/backend/lanes.h"
#include "kernels/solve/apgd_iteration.h"
#include "kernels/solve/one_contact.h"

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
    const ApgdContactStep<Rows<Real>, Real> step = a.contact_pass().step();

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
  explicit ApgdIteration(Cpu&) {}
  template <class R, class Real>
  void start(Cpu&, const ApgdPasses<R, Real>&) {}

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

 private:
  template <class R, class Real>
  static void trial(Cpu& cpu, const ApgdPasses<R, Real>& a) {
    apgd_trial(cpu, a);
  }
  template <class Real>
  static void trial(Cpu& cpu, const ApgdPasses<RadialRows<Real>, Real>& a) {
    trial_in_blocks<RadialRows>(cpu, a);
  }
  template <class Real>
  static void trial(Cpu& cpu, const ApgdPasses<RadialImpactRows<Real>, Real>& a) {
    trial_in_blocks<RadialImpactRows>(cpu, a);
  }
  template <class Real>
  static void trial(Cpu& cpu, const ApgdPasses<MixedRows<Real>, Real>& a) {
    trial_in_groups<RadialRows>(cpu, a);
  }
  template <class Real>
  static void trial(Cpu& cpu, const ApgdPasses<MixedImpactRows<Real>, Real>& a) {
    trial_in_groups<RadialImpactRows>(cpu, a);
  }

  template <template <class> class Rows, class Real>
  static void trial_in_blocks(Cpu& cpu, const ApgdPasses<Rows<Real>, Real>& a) {
    step_in_blocks<Rows>(cpu, a);
    reduce<Sums<1>>(cpu, a.p.bodies.owned_count, a.body_pass(), ApgdBodyFinish{a.state, a.exact});
  }
  /// @tparam Rows  of the radial contacts
  template <template <class> class Rows, class R, class Real>
  static void trial_in_groups(Cpu& cpu, const ApgdPasses<R, Real>& a) {
    ApgdPasses<Rows<Real>, Real> radial = passes_on<Rows<Real>>(a);
    radial.p.contact_count = a.p.radial_count;
    step_in_blocks<Rows>(cpu, radial);
    reduce<Sums<2>>(cpu, a.p.contact_count - a.p.radial_count,
                    ApgdGeneralContacts<R, Real>{a.contact_pass()},
                    ApgdContactFinish{a.state, true});
    reduce<Sums<1>>(cpu, a.p.bodies.owned_count, a.body_pass(), ApgdBodyFinish{a.state, a.exact});
  }
  template <template <class> class Rows, class Real>
  static void step_in_blocks(Cpu& cpu, const ApgdPasses<Rows<Real>, Real>& a) {
    using Block = ApgdContactBlock<Rows, Real>;
    reduce<Sums<2>>(cpu, Block::count(a.p.contact_count), Block{a}, ApgdContactFinish{a.state});
  }
};

}  // namespace scree
