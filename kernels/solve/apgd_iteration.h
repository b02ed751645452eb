#pragma once
// Runs APGD iterations on a backend: tuned twins of the two passes where there are some, else the
// passes in turn.

#include "kernels/bodies/ghosts.h"
#include "kernels/solve/apgd_passes.h"

namespace scree {

/// One trial of the line search: contact pass, body pass, acceptance.
template <class B, class R, class Real>
void apgd_trial(B& b, const ApgdPasses<R, Real>& a) {
  reduce<Sums<2>>(b, a.p.contact_count, a.contact_pass(), ApgdContactFinish{a.state});
  reduce<Sums<1>>(b, a.p.bodies.owned_count, a.body_pass(), ApgdBodyFinish{a.state, a.exact});
}

/// Trials of one solve after the other; each backend has its own class, with
///   ApgdIteration(B&)
///   start(B&, const ApgdPasses<R, Real>&, const Ghosts<B>*)   before the first trial of a solve; ghosts of ranks that may
///       meet in run(), which knows the diagonal metric alone; else null
///   stops(const ApgdPasses<R, Real>&)                 whether run() may end early
///   stores_extrapolated(const ApgdPasses<R, Real>&)   whether V_y is kept in memory; else it is
///       worked out from both iterates, which have to be the same at the start of a solve
///   run(B&, const ApgdPasses<R, Real>&, int count, double enough)
///       queues trials on the passes of start(), as many as asked for or, where it may, until the
///       measure of the state is not above `enough`
///   meets_ranks()        of several ranks: whether run() exchanges what they find; else queue_trial() and take_sums() serve
///   queue_trial(B&, const ApgdPasses<R, Real>&)
///       of several ranks: queues one trial, which leaves the next state to the caller
///   take_sums(B&, const ApgdPasses<R, Real>&)        its sums here; contacts that two ranks list count in one
template <class B>
class ApgdIteration;

}  // namespace scree

#ifdef __CUDACC__
#include "kernels/solve/apgd_sweep.cuh"
#else
#include "kernels/solve/apgd_blocks.h"
#endif
