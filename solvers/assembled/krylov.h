#pragma once
// Linear systems of Newton's method on a backend, without a factorization.

#include <utility>

#include "solvers/assembled/backend_problem.h"
#include "solvers/assembled/contact_function.h"

namespace scree {

/// y = B x for a 3x3 block.
SCREE_HD inline void block_times(const Block3& b, const double* x, double* y) {
  for (int i = 0; i < 3; ++i) y[i] = b[3 * i] * x[0] + b[3 * i + 1] * x[1] + b[3 * i + 2] * x[2];
}

/// Inverse by cofactors; the identity when the block has none that is finite.
SCREE_HD inline Block3 inverse_block(const Block3& b) {
  const double c0 = b[4] * b[8] - b[5] * b[7], c1 = b[5] * b[6] - b[3] * b[8],
               c2 = b[3] * b[7] - b[4] * b[6];
  const double s = 1 / (b[0] * c0 + b[1] * c1 + b[2] * c2);
  if (!(std::abs(s) < 1e300)) return {1, 0, 0, 0, 1, 0, 0, 0, 1};
  return {c0 * s, (b[2] * b[7] - b[1] * b[8]) * s, (b[1] * b[5] - b[2] * b[4]) * s,
          c1 * s, (b[0] * b[8] - b[2] * b[6]) * s, (b[2] * b[3] - b[0] * b[5]) * s,
          c2 * s, (b[1] * b[6] - b[0] * b[7]) * s, (b[0] * b[4] - b[1] * b[3]) * s};
}

/// The Jacobian A + B (W + shift D) of contact functions, with A = dF/dr and B = dF/du in blocks.
struct ContactJacobian {
  Span<const Block3> by_r, by_u;
  Span<const Block3> inverse;  ///< of the diagonal blocks: the preconditioner
  Span<const double> shift;    ///< [contact_count] shift D [1/kg]

  /// One block row times x. @param moved  W x
  SCREE_HD void times(Index c, const double* x, const double* moved, double* y) const {
    double a[3], b[3], v[3];
    for (int i = 0; i < 3; ++i) v[i] = moved[i] + shift[c] * x[i];
    block_times(by_r[c], x, a);
    block_times(by_u[c], v, b);
    for (int i = 0; i < 3; ++i) y[i] = a[i] + b[i];
  }
};

/// Scalars of BiCGSTAB, in backend memory. A quotient by zero counts as zero: then nothing moves.
struct KrylovState {
  double rho = 0, alpha = 0, omega = 0, beta = 0;
  double square = 0;  ///< of the residual
  SCREE_HD static double ratio(double a, double b) { return b < 0 || b > 0 ? a / b : 0; }
};

struct KrylovVectors {
  Span<double> x, r, shadow, p, p_hat, s_hat, v, t, moved;
};

/// p = r + beta (p - omega v), and M p.
struct KrylovDirection {
  static constexpr const char* name = "krylov_direction";
  ContactJacobian J;
  KrylovVectors k;
  const KrylovState* state;
  SCREE_HD void operator()(Index c) const {
    const Offset at = 3 * static_cast<Offset>(c);
    for (int i = 0; i < 3; ++i)
      k.p[at + i] = k.r[at + i] + state->beta * (k.p[at + i] - state->omega * k.v[at + i]);
    block_times(J.inverse[c], &k.p[at], &k.p_hat[at]);
  }
};

/// v = J M p, and shadow.v.
struct KrylovAlong {
  static constexpr const char* name = "krylov_along";
  ContactJacobian J;
  KrylovVectors k;
  SCREE_HD Sums<1> operator()(Index c) const {
    const Offset at = 3 * static_cast<Offset>(c);
    J.times(c, &k.p_hat[at], &k.moved[at], &k.v[at]);
    Sums<1> sum;
    for (int i = 0; i < 3; ++i) sum.value[0] += k.shadow[at + i] * k.v[at + i];
    return sum;
  }
};
struct KrylovAlpha {
  KrylovState* state;
  SCREE_HD void operator()(const Sums<1>& sum) const {
    state->alpha = KrylovState::ratio(state->rho, sum.value[0]);
  }
};

/// r = r - alpha v, and M r.
struct KrylovHalf {
  static constexpr const char* name = "krylov_half";
  ContactJacobian J;
  KrylovVectors k;
  const KrylovState* state;
  SCREE_HD void operator()(Index c) const {
    const Offset at = 3 * static_cast<Offset>(c);
    for (int i = 0; i < 3; ++i) k.r[at + i] -= state->alpha * k.v[at + i];
    block_times(J.inverse[c], &k.r[at], &k.s_hat[at]);
  }
};

/// t = J M r, t.r and t.t.
struct KrylovAcross {
  static constexpr const char* name = "krylov_across";
  ContactJacobian J;
  KrylovVectors k;
  SCREE_HD Sums<2> operator()(Index c) const {
    const Offset at = 3 * static_cast<Offset>(c);
    J.times(c, &k.s_hat[at], &k.moved[at], &k.t[at]);
    Sums<2> sums;
    for (int i = 0; i < 3; ++i) {
      sums.value[0] += k.t[at + i] * k.r[at + i];
      sums.value[1] += k.t[at + i] * k.t[at + i];
    }
    return sums;
  }
};
struct KrylovOmega {
  KrylovState* state;
  SCREE_HD void operator()(const Sums<2>& sums) const {
    state->omega = KrylovState::ratio(sums.value[0], sums.value[1]);
  }
};

/// x and r at the end of an iteration, shadow.r and r.r.
struct KrylovStep {
  static constexpr const char* name = "krylov_step";
  KrylovVectors k;
  const KrylovState* state;
  SCREE_HD Sums<2> operator()(Index c) const {
    Sums<2> sums;
    for (int i = 0; i < 3; ++i) {
      const Offset at = 3 * static_cast<Offset>(c) + i;
      k.x[at] += state->alpha * k.p_hat[at] + state->omega * k.s_hat[at];
      k.r[at] -= state->omega * k.t[at];
      sums.value[0] += k.shadow[at] * k.r[at];
      sums.value[1] += k.r[at] * k.r[at];
    }
    return sums;
  }
};
struct KrylovBeta {
  KrylovState* state;
  SCREE_HD void operator()(const Sums<2>& sums) const {
    KrylovState& s = *state;
    s.beta = KrylovState::ratio(sums.value[0], s.rho) * KrylovState::ratio(s.alpha, s.omega);
    s.rho = sums.value[0];
    s.square = sums.value[1];
  }
};

/// x = 0, and all else as before the first iteration for the right side in `shadow`.
struct KrylovStart {
  static constexpr const char* name = "krylov_start";
  KrylovVectors k;
  SCREE_HD Sums<2> operator()(Index c) const {
    Sums<2> sums;
    for (int i = 0; i < 3; ++i) {
      const Offset at = 3 * static_cast<Offset>(c) + i;
      k.r[at] = k.shadow[at];
      k.x[at] = k.p[at] = k.v[at] = 0;
      sums.value[0] += k.r[at] * k.r[at];
    }
    sums.value[1] = sums.value[0];
    return sums;
  }
};
struct KrylovFirst {
  KrylovState* state;
  SCREE_HD void operator()(const Sums<2>& sums) const {
    *state = KrylovState{};
    state->rho = sums.value[0];
    state->square = sums.value[1];
  }
};

/// BiCGSTAB with the inverse diagonal blocks as preconditioner from the right. An iteration is two
/// products with W, and 9 blocks of three rows and 40 vectors read or written beside them; the host
/// reads the residual every few iterations.
/// Source: van der Vorst, SIAM J. Sci. Stat. Comput. 13, 1992.
template <class B>
class BlockKrylov {
 public:
  explicit BlockKrylov(const BackendProblem<B>& p) : p_(p), state_(p.backend(), 1) {
    for (int i = 0; i < kVectors; ++i) memory_.push_back(p.vector());
  }
  /// Where the right side goes before solve(), which keeps it.
  Span<double> right_side() { return memory_[2].view(p_.row_count()); }
  /// The solution after solve().
  Span<const double> solution() const { return memory_[0].view(p_.row_count()); }

  /// Solves J x = right side to a reduction of the residual.
  /// @return the reduction that was reached; NaN when the method broke down
  double solve(const ContactJacobian& J, double reduction, int most, AssembledMonitor& monitor) {
    constexpr int kBetweenReads = 5;
    B& b = p_.backend();
    const Index n = p_.contact_count();
    KrylovState* state = state_.data();
    Span<double> m[kVectors];
    for (int i = 0; i < kVectors; ++i) m[i] = memory_[i].view(p_.row_count());
    const KrylovVectors k{m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8]};
    reduce<Sums<2>>(b, n, KrylovStart{k}, KrylovFirst{state});
    const double first = fetch(b, state).square;
    double square = first;
    for (int done = 0; done < most && square > reduction * reduction * first;) {
      for (int i = 0; i < kBetweenReads; ++i, ++done) {
        for_each(b, n, KrylovDirection{J, k, state});
        p_.multiply(memory_[4], memory_[8]);
        reduce<Sums<1>>(b, n, KrylovAlong{J, k}, KrylovAlpha{state});
        for_each(b, n, KrylovHalf{J, k, state});
        p_.multiply(memory_[5], memory_[8]);
        reduce<Sums<2>>(b, n, KrylovAcross{J, k}, KrylovOmega{state});
        reduce<Sums<2>>(b, n, KrylovStep{k, state}, KrylovBeta{state});
        monitor.count_applications(2);
      }
      square = fetch(b, state).square;
    }
    return first > 0 ? std::sqrt(square / first) : 0;
  }

 private:
  static constexpr int kVectors = 9;  // in the order of KrylovVectors
  const BackendProblem<B>& p_;
  Buffer<B, KrylovState> state_;
  std::vector<Buffer<B, double>> memory_;
};

}  // namespace scree
