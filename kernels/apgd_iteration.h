#pragma once
// Runs APGD iterations on a backend: the two passes in turn, or a tuned twin of them.

#include "kernels/apgd_passes.h"

namespace scree {

/// One trial of the line search: contact pass, body pass, acceptance.
template <class B, class R, class Real>
void apgd_trial(B& b, const ApgdPasses<R, Real>& a) {
  reduce<Sums<2>>(b, a.p.contact_count, a.contact_pass(), ApgdContactFinish{a.state});
  reduce<Sums<1>>(b, a.p.free_count, a.body_pass(), ApgdBodyFinish{a.state});
}

/// Trials of one solve after the other.
template <class B>
class ApgdIteration {
 public:
  explicit ApgdIteration(B&) {}
  /// Before the first trial of a solve.
  template <class R, class Real>
  void start(B&, const ApgdPasses<R, Real>&) {}
  /// Queues `count` trials. @param a  the same as at start()
  template <class R, class Real>
  void run(B& b, const ApgdPasses<R, Real>& a, int count) {
    for (int k = 0; k < count; ++k) apgd_trial(b, a);
  }
};

}  // namespace scree

#ifdef __CUDACC__
#include "kernels/tuned/apgd_sweep.cuh"
#else
#include "kernels/tuned/apgd_blocks.h"
#endif
