#pragma once
// Primitives over all ranks. Without ranks they are those of the backend.

#include "kernels/backend/backend.h"
#include "kernels/backend/ranks.h"

namespace scree {

/// Ends a reduction whose record came from the host.
template <class R, class G>
struct FinishWith {
  static constexpr const char* name = "finish_over_ranks";
  R total;
  G finish;
  SCREE_HD void operator()(Index) const { finish(total); }
};

/// reduce() over the elements of all ranks, where there are some: records are combined in their order, so that each has the
/// same bits. One host read, one exchange.
template <class R, class B, class F, class G>
void reduce_on_ranks(B& b, Index n, F f, G finish) {
  Buffer<B, R> own(b, 1);
  reduce<R>(b, n, f, StoreResult<R>{own.data()});
  const R total = combined(*b.ranks(), fetch(b, std::as_const(own).data()));
  for_each(b, 1, FinishWith<R, G>{total, finish});
}

/// reduce() over the elements of this rank or, with others, of all.
template <class R, class B, class F, class G>
void reduce_over_ranks(B& b, Index n, F f, G finish) {
  if (b.ranks() == nullptr) {
    reduce<R>(b, n, f, finish);
  } else {
    reduce_on_ranks<R>(b, n, f, finish);
  }
}

/// While it lives, this rank works for itself.
template <class B>
class Alone {
 public:
  explicit Alone(B& b) : b_(&b), ranks_(b.ranks()) { b.set_ranks(nullptr); }
  ~Alone() { b_->set_ranks(ranks_); }
  Alone(const Alone&) = delete;
  Alone& operator=(const Alone&) = delete;

 private:
  B* b_;
  Ranks* ranks_;
};

/// A record that each rank has on its host, combined.
template <class R, class B>
R over_ranks(B& b, const R& own) {
  return b.ranks() == nullptr ? own : combined(*b.ranks(), own);
}

/// Whether it holds on any rank.
template <class B>
bool on_any_rank(B& b, bool own) {
  return b.ranks() == nullptr ? own : any(*b.ranks(), own);
}

/// The largest of the values of all ranks.
template <class B>
double largest_over_ranks(B& b, double own) {
  return b.ranks() == nullptr ? own : combined(*b.ranks(), Largest<double>{own}).value;
}

}  // namespace scree
