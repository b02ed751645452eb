#pragma once
// Which owned bodies this rank shows to others, and where in storage it keeps copies of theirs.

#include <cstring>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "kernels/backend/device_messages.h"
#include "kernels/backend/over_ranks.h"
#include "kernels/backend/peer_window.h"
#include "kernels/bodies/body_ranges.h"

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

/// Arrays whose rows go together, in this order.
template <class... T>
struct RowArrays;
template <>
struct RowArrays<> {
  static constexpr Index kBytes = 0;
  SCREE_HD void store(Index, unsigned char*) const {}
  SCREE_HD void load(Index, const unsigned char*) const {}
  SCREE_HD std::uint32_t* piece(Index, Index) const { return nullptr; }
};
template <class T, class... Others>
struct RowArrays<T, Others...> {
  static constexpr std::size_t kWord = 4;
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % kWord == 0);
  static constexpr Index kBytes = sizeof(T) + RowArrays<Others...>::kBytes;

  Span<T> rows;
  RowArrays<Others...> others;

  explicit RowArrays(Span<T> first, Span<Others>... next) : rows(first), others(next...) {}

  SCREE_HD void store(Index i, unsigned char* to) const {
    copy_row(rows.data + i, to);
    others.store(i, to + sizeof(T));
  }
  SCREE_HD void load(Index i, const unsigned char* from) const {
    copy_row(from, rows.data + i);
    others.load(i, from + sizeof(T));
  }
  /// Word k of row i.
  SCREE_HD std::uint32_t* piece(Index i, Index k) const {
    constexpr auto kOwn = static_cast<Index>(sizeof(T) / kWord);
    if (k >= kOwn) return others.piece(i, k - kOwn);
    return reinterpret_cast<std::uint32_t*>(rows.data + i) + k;
  }

 private:
  /// In words of 4 bytes, as rows of one kind after those of another are placed.
  static SCREE_HD void copy_row(const void* from, void* to) {
    std::memcpy(__builtin_assume_aligned(to, kWord), __builtin_assume_aligned(from, kWord),
                sizeof(T));
  }
};

/// Rows of bodies, one after the other.
template <class Arrays>
struct PackRows {
  static constexpr const char* name = "pack_rows";
  Span<const Index> body;
  Arrays arrays;
  unsigned char* to;
  SCREE_HD void operator()(Index k) const {
    arrays.store(body[k], to + static_cast<Offset>(k) * Arrays::kBytes);
  }
};

template <class Arrays>
struct UnpackRows {
  static constexpr const char* name = "unpack_rows";
  const unsigned char* from;
  Index first;  ///< ghost
  Arrays arrays;
  SCREE_HD void operator()(Index k) const {
    arrays.load(first + k, from + static_cast<Offset>(k) * Arrays::kBytes);
  }
};

/// How this rank reaches the others in their windows. Programs on the device have it by value.
struct GhostLinks : PeerBoards {
  /// Where bodies go that are sent.
  struct Target {
    Index begin = 0, end = 0;        ///< of them
    Index there = 0;                 ///< place of the first in a room
    unsigned char* rooms = nullptr;  ///< see PeerWindow
  };
  /// Rooms of a rank: two by turns for rows that kernels push, for programs that meet (kernels/solve/rank_meeting.cuh), and
  /// for swaps (ghost_swap.cuh). Words of these two tell by their numbers that they have come.
  static constexpr int kFirstOfPrograms = 2, kFirstOfSwaps = 4;

  int targets = 0;
  Target target[PeerBoard::kMostRanks];
  Span<const Index> sent;          ///< bodies
  unsigned char* rooms = nullptr;  ///< of this rank
  Offset room_bytes = 0;
  Index first = 0, count = 0;  ///< ghosts

  /// Where a row of a body that is sent has its place. @param k  in `sent`
  SCREE_HD unsigned char* place(Index k, int room, Index row_bytes) const {
    int q = 0;
    while (k >= target[q].end) ++q;
    const Offset row = target[q].there + (k - target[q].begin);
    return target[q].rooms + room * room_bytes + row * row_bytes;
  }
};

#ifdef __CUDACC__
class Cuda;
template <class Arrays>
void swap_rows(Cuda& cuda, const GhostLinks& links, const Arrays& arrays);  // ghost_swap.cuh
#endif

/// Writes rows of bodies where other ranks look for them.
template <class Arrays>
struct PushRows {
  static constexpr const char* name = "push_rows";
  GhostLinks links;
  Arrays arrays;
  int room;
  SCREE_HD void operator()(Index k) const {
    arrays.store(links.sent[k], links.place(k, room, Arrays::kBytes));
  }
};

/// Places of bodies that are sent, after owned bodies have moved in storage.
struct RenumberSent {
  static constexpr const char* name = "renumber_sent";
  Span<const Index> new_of_old;
  Span<Index> sent;  ///< in and out
  SCREE_HD void operator()(Index k) const { sent[k] = new_of_old[sent[k]]; }
};

/// The plan of what ranks show each other, and the exchange by it.
template <class B>
class Ghosts {
 public:
  explicit Ghosts(B& b) : sent_(b), packed_(b), arrived_(b), window_(b) {}

  Index count() const { return count_; }

  /// A call that all ranks make together.
  /// @param peers  by rank, rising, those without bodies left out  @param sent  places of the bodies to send
  void set(B& b, std::vector<GhostPeer> peers, std::vector<Index> sent) {
    peers_ = std::move(peers);
    sent_count_ = static_cast<Index>(sent.size());
    upload(b, sent, sent_);
    count_ = 0;
    for (const GhostPeer& peer : peers_) count_ += peer.count;
    Ranks& ranks = *b.ranks();
    transport_ = working_transport(ranks);
    ranks.note_transport(transport_);
    if (transport_ == Transport::peer) {
      tell_places(ranks);
      link(ranks);
      return;
    }
    wait_for_messages(b);
    packed_.reserve_discard(Offset{sent_count_} * kMostRow);
    arrived_.reserve_discard(Offset{count_} * kMostRow);
  }

  /// Why the transport that was asked for does not work, the same on all ranks; empty: it does. Data go through hosts then.
  std::string transport_fault(const Ranks& ranks) const {
    const Transport asked = ranks.transport();
    if (!B::kIsDevice || asked == Transport::automatic || asked == transport_) return {};
    if (asked == Transport::peer) return "GPUs of ranks cannot write into each other's memory";
    return messages_ != nullptr ? messages_->fault() : "there is none between these ranks";
  }

  /// Follows a reordering of the owned bodies. @param new_of_old  new storage index of each
  void follow(B& b, Span<const Index> new_of_old) {
    for_each(b, sent_count_, RenumberSent{new_of_old, sent_.view(sent_count_)});
  }

  /// Gives the ghosts the rows that their owners have. A call that all ranks make together.
  /// @param rows  arrays with a row for each body [moving_count at least]; their rows go in one message
  template <class... T>
  void update(B& b, Span<T>... rows) const {
    using Arrays = RowArrays<T...>;
    if constexpr (B::kIsDevice && 2 * Arrays::kBytes <= kMostRow) {
      if (transport_ == Transport::peer && b.peers() != nullptr)
        return swap_rows(b, links_, Arrays(rows...));
    }
    send(b, rows...);
    if (transport_ == Transport::peer) {
      b.synchronize();
      any(*b.ranks(), false);  // all have sent
    }
    receive(b, rows...);
  }

  /// The two halves of update(), for callers that combine or fetch a record over ranks between them. All ranks make both
  /// calls together; the second may be left out.
  template <class... T>
  void send(B& b, Span<T>... rows) const {
    using Arrays = RowArrays<T...>;
    static_assert(Arrays::kBytes <= kMostRow);
    if constexpr (B::kIsDevice) {
      if (transport_ == Transport::peer) {
        turn_ = 1 - turn_;
        for_each(b, sent_count_, PushRows<Arrays>{links_, Arrays(rows...), turn_});
      } else if (transport_ == Transport::nccl) {
        wait_for_messages(b);
        pack(b, Arrays(rows...));
        messages_->exchange(sent_messages<Arrays>(packed_.data()),
                            received_messages<Arrays>(arrived_.data()), b.stream());
        are_sent_ = true;
      }
    }
  }
  template <class... T>
  void receive(B& b, Span<T>... rows) const {
    using Arrays = RowArrays<T...>;
    if constexpr (B::kIsDevice) {
      if (transport_ == Transport::peer) {
        unpack(b, links_.rooms + turn_ * links_.room_bytes, Arrays(rows...));
        return;
      }
      if (transport_ == Transport::nccl) {
        wait_for_messages(b);
        unpack(b, arrived_.data(), Arrays(rows...));
        return;
      }
    }
    exchange_on_hosts(b, Arrays(rows...));
  }

  /// For programs that exchange velocities themselves; null where they cannot.
  const GhostLinks* links() const {
    return transport_ == Transport::peer && window_.can_meet() ? &links_ : nullptr;
  }
  /// Whether ranks are threads of one process.
  bool has_threads() const { return window_.has_threads(); }

 private:
  static constexpr Index kMostRow = 104;  ///< bytes: the state of a body in double

  /// The first way that works, of those that are allowed; the same on all ranks.
  Transport working_transport(Ranks& ranks) {
    if constexpr (B::kIsDevice) {
      const Transport asked = ranks.transport();
      const bool is_free = asked == Transport::automatic;
      if ((is_free || asked == Transport::peer) && ranks.count() <= PeerBoard::kMostRanks &&
          window_.reserve(ranks, static_cast<std::size_t>(count_) * kMostRow))
        return Transport::peer;
      messages_ = ranks.device_messages();
      if ((is_free || asked == Transport::nccl) && messages_ != nullptr && messages_->open(ranks))
        return Transport::nccl;
    }
    return Transport::hosts;
  }

  /// What was sent before is done, for what is put in line now.
  void wait_for_messages(B& b) const {
    if constexpr (B::kIsDevice)
      if (std::exchange(are_sent_, false)) messages_->wait(b.stream());
  }

  /// Rows of the bodies to send, into `packed_`.
  template <class Arrays>
  void pack(B& b, const Arrays& arrays) const {
    for_each(b, sent_count_,
             PackRows<Arrays>{std::as_const(sent_).view(sent_count_), arrays, packed_.data()});
  }
  template <class Arrays>
  void unpack(B& b, const unsigned char* from, const Arrays& arrays) const {
    if (count_ > 0) for_each(b, count_, UnpackRows<Arrays>{from, first(), arrays});
  }

  /// One for each peer that gets something, of rows as pack() lays them out.
  template <class Arrays>
  std::vector<Ranks::Message> sent_messages(unsigned char* from) const {
    std::vector<Ranks::Message> messages;
    for (const GhostPeer& peer : peers_)
      if (peer.send_count > 0)
        messages.push_back({peer.rank, from + bytes_of<Arrays>(peer.send_begin),
                            bytes_of<Arrays>(peer.send_count)});
    return messages;
  }
  template <class Arrays>
  std::vector<Ranks::Message> received_messages(unsigned char* to) const {
    std::vector<Ranks::Message> messages;
    Index arrived = 0;
    for (const GhostPeer& peer : peers_) {
      if (peer.count > 0)
        messages.push_back(
            {peer.rank, to + bytes_of<Arrays>(arrived), bytes_of<Arrays>(peer.count)});
      arrived += peer.count;
    }
    return messages;
  }

  template <class Arrays>
  void exchange_on_hosts(B& b, const Arrays& arrays) const {
    pack(b, arrays);
    std::vector<unsigned char> out = download(
        b, std::as_const(packed_).view(static_cast<Offset>(bytes_of<Arrays>(sent_count_))));
    std::vector<unsigned char> in(bytes_of<Arrays>(count_));
    b.ranks()->exchange(sent_messages<Arrays>(out.data()), received_messages<Arrays>(in.data()));
    upload(b, in, arrived_);
    unpack(b, arrived_.data(), arrays);
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

  void link(const Ranks& ranks) {
    links_ = {};
    static_cast<PeerBoards&>(links_) = window_.boards();
    for (const GhostPeer& peer : peers_) {
      if (peer.send_count == 0) continue;
      links_.target[links_.targets++] = {peer.send_begin, peer.send_begin + peer.send_count,
                                         peer.there, window_.rooms(peer.rank)};
    }
    links_.sent = std::as_const(sent_).view(sent_count_);
    links_.rooms = window_.rooms(ranks.rank());
    links_.room_bytes = static_cast<Offset>(window_.room_bytes());
    links_.first = count_ > 0 ? first() : 0;
    links_.count = count_;
  }

  template <class Arrays>
  static std::size_t bytes_of(Index n) {
    return static_cast<std::size_t>(n) * Arrays::kBytes;
  }
  /// Ghosts of all peers are one range.
  Index first() const { return peers_.front().first; }

  std::vector<GhostPeer> peers_;
  Buffer<B, Index> sent_;
  mutable Buffer<B, unsigned char> packed_, arrived_;  ///< rows, unless they go to peers themselves
  PeerWindow<B> window_;
  DeviceMessages* messages_ = nullptr;  ///< of the transport "nccl"
  GhostLinks links_;                    ///< of the transport "peer"
  Index sent_count_ = 0;
  Index count_ = 0;
  Transport transport_ = Transport::hosts;
  mutable bool are_sent_ = false;  ///< messages that nobody has waited for
  mutable int turn_ = 0;           ///< room of the last exchange
};

}  // namespace scree

#ifdef __CUDACC__
#include "kernels/bodies/ghost_swap.cuh"
#endif
