#pragma once
// Bodies and contacts of a run that several ranks simulate together: who owns which from step to step, and the state of all
// of them as that of one rank. All ranks make its calls together.

#include <numeric>
#include <optional>
#include <string>

#include "dynamics/ranks/common_error.h"
#include "dynamics/rigid/rank_share.h"
#include "dynamics/rigid/saved_state.h"

namespace scree {

template <class B, class Real>
class SharedState {
 public:
  /// @param diameter  median of the free bodies [m]
  /// @param joined    ids of the free bodies that joints hold together
  /// @param store, parts, detector, solver  of the run; they outlive this object
  /// @param names     of parts
  /// @param reach     of bodies with parts
  /// @param vectors   of the impulse of a contact
  SharedState(B& b, Ranks& ranks, Decomposition decomposition, double diameter,
              std::vector<std::array<Index, 2>> joined, BodyStore<B, Real>& store,
              PartStore<B, Real>& parts, PartNames names, const PartReach<Real>& reach,
              ContactDetector<B, Real>& detector, Solver<B, Real>& solver, int vectors)
      : b_(&b),
        ranks_(&ranks),
        store_(&store),
        parts_(&parts),
        part_names_(std::move(names)),
        reach_(reach),
        detector_(&detector),
        solver_(&solver),
        vectors_(vectors),
        share_(b, ranks, std::move(decomposition), kSlack * diameter, std::move(joined)) {}

  const Ghosts<B>& ghosts() const { return share_.ghosts(); }
  /// Whether a body at this place belongs to this rank.
  bool owns(const Vec3d& x) const { return share_.owns(x); }
  /// Owned bodies changed places, and contacts have their new names.
  void follow(BodyOrder<B>& order) { share_.follow(order); }

  /// Contacts of the last step by names, until there are ghosts again: before bodies, or their parts, change places.
  void remember_contacts() {
    if (remembered_) return;
    remembered_ = no_contacts();
    std::vector<std::uint64_t> key;
    detector_->save(*b_, key, remembered_->at<Vec3d>("contact/impulse"));
    NamedContacts named = names_of(key, detector_->keys(), names());
    remembered_->at<std::int32_t>("contact/body_a") = std::move(named.body_a);
    remembered_->at<std::int32_t>("contact/body_b") = std::move(named.body_b);
    remembered_->at<std::uint64_t>("contact/feature") = std::move(named.feature);
  }

  /// Before a step: inserts bodies, and gives those that left the space of this rank to the ones where they are.
  /// @param step     number of steps done  @param inserts  whether bodies are due  @param insert  puts them behind the others
  template <class F>
  void move_bodies(std::int64_t step, bool inserts, F&& insert) {
    if (!inserts && step % kMoveEvery != 0) return;
    const double contacts = static_cast<double>(detector_->impulses().size) / vectors_;
    const double work = store_->owned_count() + 2 * contacts;
    if (!inserts && !share_.has_work_to_move(*store_, work, step % kPatience == 0)) return;
    remember_contacts();
    drop_ghosts();
    insert();
    share_.move_bodies(*store_, work, part_names_, *remembered_);
    parts_->forget();
  }

  /// Brings ghosts up to date; where there are others, remembered contacts follow them.
  void renew_ghosts(const ContactRange& range) {
    const auto renewal = share_.renew(*store_, range, reach_, detector_->has_spent_list());
    if (renewal.is_spent) detector_->renew_list();
    if (!renewal.has_others) return;
    if (!remembered_) {
      const std::vector<Index> places =
          parts_->follow_ghosts(store_->view(), share_.new_places(store_->owned_count()));
      if (!remembered_) {  // there was room for their parts
        detector_->rename_ghosts(*b_, parts_->place(store_->view()).owned_count, places);
        return;
      }
    } else {
      parts_->forget();
    }
    const BodyView<Real> seen = parts_->place(store_->view());
    const std::vector<Index> known_names = names();
    keep_known_contacts(known_names, seen.owned_count, *remembered_);
    const RememberedContacts known =
        remembered_contacts(*remembered_, detector_->name_elements(seen), known_names,
                            seen.owned_count, static_cast<std::size_t>(vectors_));
    detector_->restore(*b_, known.key, known.impulse);
    remembered_.reset();
  }

  /// Calls draw() on rank 0, where all bodies are owned ones meanwhile.
  template <class F>
  void with_all_bodies(F&& draw) {
    remember_contacts();
    const Index own = store_->owned_count(), room = store_->capacity();
    const Index part_room = parts_->capacity();
    share_.gather_bodies(*store_);
    parts_->forget();
    std::string fault;
    try {
      if (ranks_->rank() == 0) draw();
    } catch (const std::exception& error) {
      fault = error.what();
    }
    store_->set_owned_count(own);
    store_->set_capacity(room);
    parts_->set_capacity(part_room);
    parts_->forget();
    share_.forget();
    throw_on_all(ranks_, !fault.empty(), [&] { throw RunError(fault); });
  }

  /// The whole state, on every rank; each then goes on as one that was restored from it.
  void save(WorldState& s) {
    remember_contacts();
    WorldState own = *remembered_;
    store_->save_owned(own);
    s.arrays = gather_arrays(*ranks_, own).arrays;
    std::vector<Index> all(static_cast<std::size_t>(part_names_.end()));
    std::iota(all.begin(), all.end(), Index(0));
    keep_known_contacts(all, part_names_.end(), s);  // once, where two ranks have them
    s.add("solver/memory", solver_->memory());
    restore(s);
  }

  /// @param s  of all bodies, the same on every rank  @throws InputError on all ranks
  void restore(const WorldState& s) {
    const std::vector<std::int32_t>& id = s.at<std::int32_t>("body/id");
    const std::vector<Vec3d>& x = s.at<Vec3d>("body/position");
    require_whole(s, id);
    share_.set_decomposition(Decomposition::of(work_samples(x), ranks_->count()));
    drop_ghosts();
    share_.send_to_owners(*store_, id, x);
    const WorldState own = shared_part(
        s, [&](const Vec3d& place) { return share_.owns(place); }, part_names_);
    store_->arrange(own.at<std::int32_t>("body/id"));
    store_->restore_owned(own);
    parts_->forget();
    detector_->restore(*b_, {}, {});
    remembered_ = contacts_of(own);
    solver_->restore_memory(s.at<double>("solver/memory"));
  }

 private:
  /// Steps between two looks whether bodies left the space of their rank; a function of their number only, so that a
  /// resumed run moves bodies at the same steps.
  static constexpr std::int64_t kMoveEvery = 16;
  /// Steps after which a body that left goes to where it is, even if it is the only one.
  static constexpr std::int64_t kPatience = 256;
  /// Slack of ghosts, over the median diameter.
  static constexpr double kSlack = 0.2;

  /// Of all parts as they were listed last, in storage order.
  std::vector<Index> names() const { return parts_->names(store_->ids(), part_names_.id_count); }

  void drop_ghosts() { store_->set_owned_count(store_->owned_count()); }

  /// All ranks have the whole state, so all refuse it or none.
  void require_whole(const WorldState& s, const std::vector<std::int32_t>& id) {
    std::size_t all = 0;
    for (const Index count : gather(*ranks_, store_->owned_count()))
      all += static_cast<std::size_t>(count);
    require_rows(s, id.size(), static_cast<std::size_t>(vectors_));
    if (id.size() != all) throw_wrong_body_count(id.size(), all);
    std::vector<std::int32_t> sorted = id;
    std::sort(sorted.begin(), sorted.end());
    const auto again = std::adjacent_find(sorted.begin(), sorted.end());
    if (again != sorted.end()) throw_unknown_body(*again);
    std::int32_t unknown = -1;
    for (const Index own : store_->owned_ids())
      if (!std::binary_search(sorted.begin(), sorted.end(), own)) unknown = own;
    for (const std::int32_t of_rank : gather(*ranks_, unknown))
      if (of_rank >= 0) throw_unknown_body(of_rank);
  }

  B* b_;
  Ranks* ranks_;
  BodyStore<B, Real>* store_;
  PartStore<B, Real>* parts_;
  PartNames part_names_;
  PartReach<Real> reach_;
  ContactDetector<B, Real>* detector_;
  Solver<B, Real>* solver_;
  int vectors_;
  RankShare<B, Real> share_;
  std::optional<WorldState>
      remembered_;  ///< contacts by names, while places of ghosts are not known
};

}  // namespace scree
