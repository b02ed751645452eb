#pragma once
// This rank's share of a scene that several ranks simulate together: which bodies it owns, which it shows to others, and
// how bodies and contacts go from one to another.

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "collision/body_order.h"
#include "dynamics/part_names.h"
#include "dynamics/ranks/common_error.h"
#include "dynamics/ranks/decomposition.h"
#include "dynamics/ranks/gather.h"
#include "dynamics/ranks/partners.h"
#include "dynamics/ranks/state_parts.h"
#include "dynamics/rigid/body_store.h"
#include "kernels/bodies/ghosts.h"
#include "kernels/broad_phase/ghost_search.h"

namespace scree {

/// Calls that get a store are made by all ranks together.
template <class B, class Real>
class RankShare {
 public:
  /// @param slack   ghosts are chosen so much farther than a step needs, and serve until that is used up [m]
  /// @param joined  ids of bodies that joints hold together: their owners know both, wherever they are
  RankShare(B& b, Ranks& ranks, Decomposition decomposition, double slack,
            std::vector<std::array<Index, 2>> joined)
      : b_(&b),
        ranks_(&ranks),
        decomposition_(std::move(decomposition)),
        slack_(slack),
        joined_(std::move(joined)),
        ghosts_(b),
        shown_(b),
        extent_(b, ranks.count()),
        peer_(b),
        own_extent_(b, 1),
        unseen_(b, 1),
        strays_(b, 1),
        cuts_(b) {}

  const Ghosts<B>& ghosts() const { return ghosts_; }
  void set_decomposition(Decomposition decomposition) { decomposition_ = std::move(decomposition); }
  bool owns(const Vec3d& x) const { return decomposition_.owner(x) == ranks_->rank(); }

  /// Bodies changed places: who is a ghost where is void. They stay in storage until renew().
  void forget() { is_current_ = false; }

  /// Follows a reordering of the owned bodies; ghosts stay where they are.
  void follow(BodyOrder<B>& order) {
    if (!is_current_) return;
    order.apply(*b_, shown_.view(order.new_of_old().size));
    ghosts_.follow(*b_, order.new_of_old());
  }

  struct Renewal {
    bool has_others;  ///< there are other ghosts, or in other places: see new_places()
    bool is_spent;    ///< on any rank; not told where there are other ghosts
  };
  /// Brings ghosts up to date with their owners; chooses new ones where some are missing.
  /// @param range     of the step
  /// @param parts     how far bodies reach that have parts
  /// @param is_spent  something that all ranks are to know if it is so on one
  Renewal renew(BodyStore<B, Real>& store, const ContactRange& range, const PartReach<Real>& parts,
                bool is_spent) {
    const BodyView<Real> bodies = store.view();
    const ReachOfBody<Real> reach{{bodies, range, {}}, parts};
    if (is_current_) {
      // On their way while it is found out whether they serve: when all have said so, all have sent.
      store.with_states([&](auto&... arrays) { ghosts_.send(*b_, arrays.view()...); });
      Found found = find_unseen(bodies, reach, is_spent);
      if (found.has_unseen) {
        promise(bodies, reach);
        found = find_unseen(bodies, reach, is_spent);
      }
      if (!found.has_unseen) {
        store.with_states([&](auto&... arrays) { ghosts_.receive(*b_, arrays.view()...); });
        return {false, found.is_spent};
      }
    } else {
      promise(bodies, reach);
    }
    choose(store, reach, download(*b_, std::as_const(extent_).view(extent_.capacity())));
    return {true, false};
  }
  /// New place of each old ghost, -1: it is none any more. @param first  place of the first ghost
  std::vector<Index> new_places(Index first) const {
    std::vector<std::pair<Index, Index>> now;
    for (std::size_t k = 0; k < ids_.size(); ++k)
      now.emplace_back(ids_[k], first + static_cast<Index>(k));
    std::sort(now.begin(), now.end());
    std::vector<Index> places;
    for (const Index id : old_ids_) {
      const auto found = std::lower_bound(now.begin(), now.end(), std::pair<Index, Index>{id, 0});
      places.push_back(found != now.end() && found->first == id ? found->second : -1);
    }
    return places;
  }

  /// Work of the ranks, contacts included, the largest over the mean: 1 is even. The same everywhere.
  double imbalance(double work) const {
    double largest = 0, sum = 0;
    for (const double of_rank : gather(*ranks_, work)) {
      largest = std::max(largest, of_rank);
      sum += of_rank;
    }
    return sum > 0 ? largest * ranks_->count() / sum : 1;
  }

  /// Whether it is time to move bodies: the work of ranks is uneven, many have left the space of their rank, or few have
  /// gone so far that others are shown many more. Those that stay a while where they are do no harm, and moving takes the
  /// contacts of all bodies through the host. The same everywhere.
  /// @param patience_ends  any body that left is reason enough
  bool has_work_to_move(BodyStore<B, Real>& store, double work, bool patience_ends) {
    if (imbalance(work) > kMostImbalance) return true;
    upload(*b_, decomposition_.cuts(), cuts_);
    const auto cuts = static_cast<Offset>(decomposition_.cuts().size());
    reduce<Sums<1>>(
        *b_, store.owned_count(),
        CountStrays{std::as_const(cuts_).view(cuts), store.view().position, ranks_->rank()},
        StoreResult<Sums<1>>{strays_.data()});
    const double strays = fetch(*b_, std::as_const(strays_).data()).value[0];
    const bool are_many = strays > kMostStrays * store.owned_count();
    const bool are_far = strays > 0 && ghosts_.count() > kMostGrowth * least_ghosts_;
    return any(*ranks_, are_many || are_far || (patience_ends && strays > 0));
  }

  /// Gives bodies to the ranks that own the places of a state. @param id, x  of all bodies, each once
  void send_to_owners(BodyStore<B, Real>& store, const std::vector<std::int32_t>& id,
                      const std::vector<Vec3d>& x) {
    const Index id_end = id.empty() ? 0 : *std::max_element(id.begin(), id.end()) + 1;
    std::vector<int> owner(static_cast<std::size_t>(id_end), -1);
    for (std::size_t i = 0; i < id.size(); ++i)
      owner[static_cast<std::size_t>(id[i])] = decomposition_.owner(x[i]);
    move_to(store, store.owned_ids(),
            [&](std::size_t, Index body) { return owner[static_cast<std::size_t>(body)]; });
  }

  /// Rank 0 gets all bodies behind its own, as owned ones; the others send theirs and keep them.
  void gather_bodies(BodyStore<B, Real>& store) {
    std::vector<std::vector<Index>> to(static_cast<std::size_t>(ranks_->count()));
    store.set_owned_count(store.owned_count());
    if (ranks_->rank() != 0)
      for (Index i = 0; i < store.owned_count(); ++i) to[0].push_back(i);
    Index came = 0;
    for (const Index count : store.send_bodies(*ranks_, to)) came += count;
    store.set_owned_count(store.owned_count() + came);
  }

  /// Cuts space anew where the work of ranks is uneven, and gives bodies to the ranks in whose space they are. Contacts, by
  /// names, go with them. @param work  of this rank
  void move_bodies(BodyStore<B, Real>& store, double work, const PartNames& names,
                   WorldState& contacts) {
    const std::vector<Vec3d> x = store.owned_positions();
    if (imbalance(work) > kMostImbalance) cut_anew(x, work);
    const std::vector<Index> id = store.owned_ids();
    send_contacts(id, x, names, contacts);
    move_to(store, id, [&](std::size_t i, Index) { return decomposition_.owner(x[i]); });
  }

 private:
  static constexpr double kPromised = 0.25;  ///< of the slack: extents; the rest is for ghosts
  static constexpr double kMostImbalance = 1.05;
  static constexpr double kMostStrays = 0.005;   ///< of owned bodies
  static constexpr double kMostGrowth = 1.25;    ///< of the number of ghosts
  static constexpr std::size_t kSamples = 4096;  ///< of each rank, for new cuts

  /// Tells all ranks inside which extent the bodies of each stay, until one leaves it.
  void promise(const BodyView<Real>& bodies, const ReachOfBody<Real>& reach) {
    reduce<BallExtent>(*b_, bodies.owned_count, MeasureReach<Real>{reach},
                       StorePromise{kPromised * slack_, own_extent_.data()});
    gather_on_ranks(*b_, std::as_const(own_extent_).data(), extent_.view());
  }

  struct Found {
    bool has_unseen;  ///< on any rank, as far as the promised extents tell
    bool is_spent;    ///< the same
  };
  Found find_unseen(const BodyView<Real>& bodies, const ReachOfBody<Real>& reach, bool is_spent) {
    const NearPeers<Real> near = near_peers(reach, 0);
    reduce<Sums<1>>(*b_, bodies.owned_count,
                    CountUnseen<Real>{near, shown_.view(shown_.capacity()), ranks_->rank()},
                    StoreUnseen{near.extent, near.peer, reach.balls.range.period, ranks_->rank(),
                                is_spent ? 1.0 : 0.0, unseen_.data()});
    const Sums<2> found = fetch_over_ranks(*b_, std::as_const(unseen_).data());
    return {found.value[0] > 0, found.value[1] > 0};
  }

  /// Owned bodies go where owner(place, id) says.
  template <class F>
  void move_to(BodyStore<B, Real>& store, const std::vector<Index>& id, F&& owner) {
    std::vector<std::vector<Index>> leave(static_cast<std::size_t>(ranks_->count()));
    std::vector<Index> stay;
    for (std::size_t i = 0; i < id.size(); ++i) {
      const int to = owner(i, id[i]);
      (to == ranks_->rank() ? stay : leave[static_cast<std::size_t>(to)])
          .push_back(static_cast<Index>(i));
    }
    Index next = store.owned_count();
    for (const Index count : store.send_bodies(*ranks_, leave))
      for (Index k = 0; k < count; ++k) stay.push_back(next++);
    store.keep(stay);
    store.clear_room();
    forget();
    least_ghosts_ = std::numeric_limits<Index>::max();
  }

  /// Contacts of bodies that leave go to their new owners; they stay here too, where the other body may be owned.
  /// @param x  of owned bodies
  void send_contacts(const std::vector<Index>& id, const std::vector<Vec3d>& x,
                     const PartNames& names, WorldState& contacts) {
    std::vector<std::pair<Index, int>> new_owner;  // by id, of those that leave
    for (std::size_t i = 0; i < x.size(); ++i)
      if (!owns(x[i])) new_owner.emplace_back(id[i], decomposition_.owner(x[i]));
    std::sort(new_owner.begin(), new_owner.end());
    const auto owner_of = [&](Index name) {
      const Index body = names.body(name);
      const auto found =
          std::lower_bound(new_owner.begin(), new_owner.end(), std::pair<Index, int>{body, -1});
      return found != new_owner.end() && found->first == body ? found->second : -1;
    };
    std::vector<std::vector<std::size_t>> rows(static_cast<std::size_t>(ranks_->count()));
    const auto& a = contacts.at<std::int32_t>("contact/body_a");
    const auto& b = contacts.at<std::int32_t>("contact/body_b");
    for (std::size_t c = 0; c < a.size(); ++c) {
      const int of_a = owner_of(a[c]), of_b = owner_of(b[c]);
      if (of_a >= 0) rows[static_cast<std::size_t>(of_a)].push_back(c);
      if (of_b >= 0 && of_b != of_a) rows[static_cast<std::size_t>(of_b)].push_back(c);
    }
    std::vector<Bytes> to;
    to.reserve(rows.size());
    for (const std::vector<std::size_t>& of_rank : rows)
      to.push_back(packed_contacts(contacts, of_rank));
    for (const Bytes& from : all_to_all(*ranks_, std::move(to))) append_contacts(from, contacts);
  }

  void cut_anew(const std::vector<Vec3d>& x, double work) {
    const std::size_t stride = std::max<std::size_t>(1, x.size() / kSamples);
    std::vector<WorkSample> own;
    for (std::size_t i = 0; i < x.size(); i += stride) own.push_back({x[i]});
    for (WorkSample& sample : own) sample.weight = work / static_cast<double>(own.size());
    decomposition_ = Decomposition::of(gather_values(*ranks_, own), ranks_->count());
  }

  NearPeers<Real> near_peers(const ReachOfBody<Real>& reach, double slack) const {
    return {reach, extent_.view(extent_.capacity()),
            peer_.view(static_cast<Offset>(peer_ranks_.size())), slack};
  }

  /// Ranks whose bodies may meet those of this one, rising.
  std::vector<Index> near_ranks(const std::vector<BallExtent>& all, const Vec3d& period,
                                double slack) const {
    const auto me = static_cast<std::size_t>(ranks_->rank());
    std::vector<Index> near;
    for (std::size_t r = 0; r < all.size(); ++r)
      if (r != me && !all[r].empty() && !all[me].empty() &&
          squared_distance(all[me], all[r], period) <= slack * slack)
        near.push_back(static_cast<Index>(r));
    return near;
  }

  void choose(BodyStore<B, Real>& store, const ReachOfBody<Real>& reach,
              const std::vector<BallExtent>& all) {
    const double slack = (1 - kPromised) * slack_;
    peer_ranks_ = near_ranks(all, reach.balls.range.period, slack);
    const std::vector<Partner> partners =
        joined_.empty() ? std::vector<Partner>{}
                        : partners_elsewhere(*ranks_, joined_, store.owned_ids());
    for (const Partner& partner : partners) peer_ranks_.push_back(partner.rank);
    std::sort(peer_ranks_.begin(), peer_ranks_.end());
    peer_ranks_.erase(std::unique(peer_ranks_.begin(), peer_ranks_.end()), peer_ranks_.end());
    if (peer_ranks_.size() > 64) throw_too_many_peers(peer_ranks_.size());
    const Index n = store.owned_count();
    upload(*b_, peer_ranks_, peer_);
    const Span<std::uint64_t> shown = shown_.resize_discard(n);
    for_each(*b_, n, ChooseShown<Real>{near_peers(reach, slack), shown});
    show_partners(partners, shown);
    std::vector<std::vector<Index>> to(static_cast<std::size_t>(ranks_->count()));
    Buffer<B, Index> flag(*b_, n), list(*b_, n);
    Buffer<B, Offset> before(*b_, static_cast<Offset>(n) + 1);
    for (std::size_t q = 0; q < peer_ranks_.size(); ++q) {
      for_each(*b_, n, FlagShown{shown, static_cast<int>(q), flag.view()});
      exclusive_scan(*b_, Span<const Index>(flag.view()), before.view());
      const Offset count = fetch(*b_, std::as_const(before).data() + n);
      for_each(*b_, n, ListShown{flag.view(), before.view(), list.view()});
      to[static_cast<std::size_t>(peer_ranks_[q])] = download(*b_, list.view(count));
    }
    const std::vector<Index> came = store.send_bodies(*ranks_, to);
    std::vector<GhostPeer> peers;
    std::vector<Index> sent;
    Index first = store.owned_count(), lower = 0, ghosts = 0;
    for (std::size_t r = 0; r < to.size(); ++r) {
      if (to[r].empty() && came[r] == 0) continue;
      peers.push_back({static_cast<int>(r), static_cast<Index>(sent.size()),
                       static_cast<Index>(to[r].size()), first, came[r]});
      sent.insert(sent.end(), to[r].begin(), to[r].end());
      first += came[r];
      ghosts += came[r];
      if (static_cast<int>(r) < ranks_->rank()) lower += came[r];
    }
    ghosts_.set(*b_, std::move(peers), std::move(sent));
    if (const std::string fault = ghosts_.transport_fault(*ranks_); !fault.empty())
      throw CommonError("transport " + to_string(ranks_->transport()) + ": " + fault);
    store.set_ghost_count(ghosts, lower);
    store.clear_room();
    old_ids_ = std::exchange(ids_, store.ghost_ids());
    least_ghosts_ = std::min(least_ghosts_, ghosts);
    is_current_ = true;
  }

  void show_partners(const std::vector<Partner>& partners, Span<std::uint64_t> shown) {
    std::vector<Index> place;
    std::vector<std::uint64_t> peers;
    for (const Partner& partner : partners) {
      const auto q = std::lower_bound(peer_ranks_.begin(), peer_ranks_.end(), partner.rank) -
                     peer_ranks_.begin();
      if (place.empty() || place.back() != partner.place) {
        place.push_back(partner.place);
        peers.push_back(0);
      }
      peers.back() |= std::uint64_t{1} << q;
    }
    Buffer<B, Index> places(*b_);
    Buffer<B, std::uint64_t> bits(*b_);
    upload(*b_, place, places);
    upload(*b_, peers, bits);
    const auto count = static_cast<Index>(place.size());
    for_each(*b_, count,
             ShowToo{std::as_const(places).view(count), std::as_const(bits).view(count), shown});
  }

  B* b_;
  Ranks* ranks_;
  Decomposition decomposition_;
  double slack_;
  std::vector<std::array<Index, 2>> joined_;
  Ghosts<B> ghosts_;
  std::vector<Index> peer_ranks_;  ///< that `shown_` has bits for
  Buffer<B, std::uint64_t> shown_;
  Buffer<B, BallExtent> extent_;  ///< promised, of all ranks
  Buffer<B, Index> peer_;         ///< peer_ranks_
  Buffer<B, BallExtent> own_extent_;
  Buffer<B, Sums<2>> unseen_;  ///< counts
  Buffer<B, Sums<1>> strays_;
  Buffer<B, SpaceCut> cuts_;
  std::vector<Index> ids_, old_ids_;
  Index least_ghosts_ = std::numeric_limits<Index>::max();  ///< since bodies moved
  bool is_current_ = false;
};

}  // namespace scree
