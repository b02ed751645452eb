#pragma once
// Runs conjugate gradients on a backend: by element programs, or by a tuned twin where there is one.

#include "kernels/affine/block_gradients.h"

namespace scree::affine {

template <class B>
class PlainGradients {
 public:
  explicit PlainGradients(B& b) : state_(b, 1) {}

  /// Whether v has to have the inverse of diagonal blocks.
  static bool wants_inverse(Index /*rows*/) { return true; }
  /// @param v          its state is set here
  /// @param tolerance  of the residual in the norm of the preconditioner, over that of the right-hand side
  /// @param most       iterations
  /// @param end        out: how they ended, once the backend has been waited for
  void run(B& b, GradientVectors v, Span<const AffineVec> right, double tolerance, int most,
           GradientState* end) {
    const auto rows = static_cast<Index>(right.size);
    v.state = state_.data();
    reduce<Sums<1>>(b, rows, BeginGradients{v, right}, StartGradients{v.state});
    for (int k = 0; k < most; ++k) {
      reduce<Sums<1>>(b, rows, MultiplyRow{v}, FindAlpha{v.state});
      reduce<Sums<1>>(b, rows, AdvanceRow{v}, FindBeta{v.state, tolerance * tolerance});
      if (k % kCheckEvery != kCheckEvery - 1) continue;
      if (fetch(b, v.state).is_done) break;
    }
    copy(b, Span<const GradientState>{v.state, 1}, Span<GradientState>{end, 1});
  }

 private:
  /// Iterations between two looks at whether it is done.
  static constexpr int kCheckEvery = 8;

  Buffer<B, GradientState> state_;
};

/// Backends with a tuned twin specialize it.
template <class B>
class GradientIteration : public PlainGradients<B> {
 public:
  using PlainGradients<B>::PlainGradients;
};

}  // namespace scree::affine

#ifdef __CUDACC__
#include "kernels/affine/block_gradients.cuh"
#endif
