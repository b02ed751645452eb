#pragma once
// Primitives over all ranks. Without ranks they are those of the backend.

#include "kernels/backend/backend.h"
#include "kernels/backend/ranks.h"

#ifdef __CUDACC__
#include "kernels/backend/peer_meeting.cuh"
#endif

namespace scree {

/// Ends a reduction whose records came from the hosts.
template <class R, class G>
struct FinishWith {
  static constexpr const char* name = "finish_over_ranks";
  R own, total;
  G finish;
  SCREE_HD void operator()(Index) const { finish_over_ranks(finish, own, total); }
};

/// Combines the record of each rank in their order, so that the total has the same bits everywhere. It ends what ranks wrote
/// into each other's memory before. Hosts that have to help read it once.
/// @param own  on the backend
template <class R, class B, class G>
void combine_on_ranks(B& b, const R* own, const G& finish) {
  if constexpr (B::kIsDevice) {
    if (auto* const peers = b.peers()) return peers->combine(b, own, finish);
  }
  const R here = fetch(b, own);
  for_each(b, 1, FinishWith<R, G>{here, combined(*b.ranks(), here), finish});
}

/// The record of each rank, in their order. It ends what ranks wrote into each other's memory before.
/// @param own, all  on the backend
template <class R, class B>
void gather_on_ranks(B& b, const R* own, Span<R> all) {
  if constexpr (B::kIsDevice) {
    if (auto* const peers = b.peers()) return peers->gather(b, own, all);
  }
  const std::vector<R> records = gather(*b.ranks(), fetch(b, own));
  upload(b, records.data(), all);
}

/// reduce() over the elements of all ranks, where there are some; see combine_on_ranks().
template <class R, class B, class F, class G>
void reduce_on_ranks(B& b, Index n, F f, G finish) {
  Buffer<B, R> own(b, 1);
  reduce<R>(b, n, f, StoreResult<R>{own.data()});
  combine_on_ranks(b, std::as_const(own).data(), finish);
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

/// A record that each rank has on its backend, combined, on the host. It ends what ranks wrote into each other's memory before.
template <class R, class B>
R fetch_over_ranks(B& b, const R* own) {
  if (b.ranks() == nullptr) return fetch(b, own);
  if constexpr (B::kIsDevice) {
    if (auto* const peers = b.peers()) {
      peers->combine(b, own, StoreResult<R>{result_place<R>(b)});
      return take_result<R>(b);
    }
  }
  return combined(*b.ranks(), fetch(b, own));
}

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

}  // namespace scree
