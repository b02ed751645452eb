#pragma once
// Which owned bodies this rank shows to others, and where in storage it keeps copies of theirs.

#include <vector>

#include "kernels/backend/over_ranks.h"
#include "kernels/backend/peer_window.h"
#include "kernels/bodies/body_ranges.h"
#include "kernels/bodies/permute.h"

namespace scree {

/// What two ranks show each other.
struct GhostPeer {
  int rank = 0;
  Index send_begin = 0;  ///< in the list of bodies that are sent
  Index send_count = 0;
  Index first = 0;  ///< ghosts of that rank are at [first, first + count)
  Index count = 0;
  Index there = 0;  ///< place of the bodies that are sent, among all that the other rank gets
};

/// Rows of bodies that go to one rank.
template <class T>
struct PushRows {
  static constexpr const char* name = "push_rows";
  Span<const Index> body;
  Span<const T> rows;
  T* to;
  SCREE_HD void operator()(Index k) const { to[k] = rows[body[k]]; }
};

/// The plan of what ranks show each other, and the exchange by it.
template <class B>
class Ghosts {
 public:
  explicit Ghosts(B& b) : sent_(b), window_(b) {}

  Index count() const { return count_; }

  /// A call that all ranks make together.
  /// @param peers  by rank, rising, those without bodies left out  @param sent  places of the bodies to send
  void set(B& b, std::vector<GhostPeer> peers, std::vector<Index> sent) {
    peers_ = std::move(peers);
    sent_bodies_ = std::move(sent);
    upload(b, sent_bodies_, sent_);
    count_ = 0;
    for (const GhostPeer& peer : peers_) count_ += peer.count;
    Ranks& ranks = *b.ranks();
    is_direct_ = window_.reserve(ranks, static_cast<std::size_t>(count_) * kMostRow);
    if (is_direct_) tell_places(ranks);
  }

  /// Gives the ghosts the rows that their owners have. A call that all ranks make together.
  /// @param rows  [moving_count at least], a row for each body
  template <class T>
  void update(B& b, Span<T> rows) const {
    send(b, rows);
    if (is_direct_) {
      b.synchronize();
      any(*b.ranks(), false);  // all have sent
    }
    receive(b, rows);
  }

  /// The two halves of update(), for callers that wait for the backend and exchange something else between them.
  template <class T>
  void send(B& b, Span<T> rows) const {
    static_assert(sizeof(T) <= kMostRow);
    if constexpr (B::kIsDevice) {
      if (!is_direct_) return;
      window_.turn();
      for (const GhostPeer& peer : peers_)
        for_each(b, peer.send_count,
                 PushRows<T>{{sent_.data() + peer.send_begin, peer.send_count},
                             rows,
                             reinterpret_cast<T*>(window_.at(peer.rank)) + peer.there});
    }
  }
  template <class T>
  void receive(B& b, Span<T> rows) const {
    if constexpr (B::kIsDevice) {
      if (is_direct_) {
        const auto* came = reinterpret_cast<const T*>(window_.at(b.ranks()->rank()));
        if (count_ > 0) copy(b, Span<const T>{came, count_}, Span<T>{rows.data + first(), count_});
        return;
      }
    }
    exchange_on_hosts(b, rows);
  }

 private:
  static constexpr std::size_t kMostRow = 64;  ///< bytes

  template <class T>
  void exchange_on_hosts(B& b, Span<T> rows) const {
    const auto n = static_cast<Index>(sent_bodies_.size());
    Buffer<B, T> gathered(b, n);
    for_each(b, n, Gather<T>{sent_.view(n), rows, gathered.view(n)});
    std::vector<T> out = download(b, gathered.view(n));
    std::vector<T> in(static_cast<std::size_t>(count_));
    std::vector<Ranks::Message> send, receive;
    Index arrived = 0;
    for (const GhostPeer& peer : peers_) {
      if (peer.send_count > 0)
        send.push_back({peer.rank, out.data() + peer.send_begin, bytes<T>(peer.send_count)});
      if (peer.count > 0) receive.push_back({peer.rank, in.data() + arrived, bytes<T>(peer.count)});
      arrived += peer.count;
    }
    b.ranks()->exchange(send, receive);
    if (count_ > 0) upload(b, in.data(), Span<T>{rows.data + first(), count_});
  }

  /// Each rank tells the others where their rows come among those it gets.
  void tell_places(Ranks& ranks) {
    std::vector<Index> own;
    Index arrived = 0;
    for (const GhostPeer& peer : peers_) {
      own.push_back(arrived);
      arrived += peer.count;
    }
    std::vector<Ranks::Message> send, receive;
    for (std::size_t k = 0; k < peers_.size(); ++k) {
      if (peers_[k].count > 0) send.push_back({peers_[k].rank, &own[k], sizeof(Index)});
      if (peers_[k].send_count > 0)
        receive.push_back({peers_[k].rank, &peers_[k].there, sizeof(Index)});
    }
    ranks.exchange(send, receive);
  }

  template <class T>
  static std::size_t bytes(Index n) {
    return static_cast<std::size_t>(n) * sizeof(T);
  }
  /// Ghosts of all peers are one range.
  Index first() const { return peers_.front().first; }

  std::vector<GhostPeer> peers_;
  std::vector<Index> sent_bodies_;
  Buffer<B, Index> sent_;
  mutable PeerWindow<B> window_;
  Index count_ = 0;
  bool is_direct_ = false;  ///< through the window, not through hosts
};

}  // namespace scree
