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
  /// @param store, detector, solver  of the run; they outlive this object
  /// @param vectors   of the impulse of a contact
  SharedState(B& b, Ranks& ranks, Decomposition decomposition, double diameter,
              std::vector<std::array<Index, 2>> joined, BodyStore<B, Real>& store,
              ContactDetector<B, Real>& detector, Solver<B, Real>& solver, int vectors)
      : b_(&b),
        ranks_(&ranks),
        store_(&store),
        detector_(&detector),
        solver_(&solver),
        vectors_(vectors),
        share_(b, ranks, std::move(decomposition), kSlack * diameter, std::move(joined)) {}

  const Ghosts<B>& ghosts() const { return share_.ghosts(); }
  /// Whether a body at this place belongs to this rank.
  bool owns(const Vec3d& x) const { return share_.owns(x); }
  /// Owned bodies changed places, and contacts have their new names.
  void follow(BodyOrder<B>& order) { share_.follow(order); }

  /// Contacts of the last step by the ids of their bodies, until there are ghosts again: before bodies change places.
  void remember_contacts() {
    if (remembered_) return;
    remembered_ = no_contacts();
    std::vector<std::uint64_t> key;
    detector_->save(*b_, key, remembered_->at<Vec3d>("contact/impulse"));
    NamedContacts names = names_of(key, detector_->keys(), store_->ids());
    remembered_->at<std::int32_t>("contact/body_a") = std::move(names.body_a);
    remembered_->at<std::int32_t>("contact/body_b") = std::move(names.body_b);
    remembered_->at<std::uint64_t>("contact/feature") = std::move(names.feature);
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
    share_.move_bodies(*store_, work, *remembered_);
  }

  /// Brings ghosts up to date; where there are others, remembered contacts follow them.
  void renew_ghosts(const ContactRange& range) {
    if (!share_.renew(*store_, range)) return;
    const Index owned = store_->owned_count();
    if (!remembered_) {
      detector_->rename_ghosts(*b_, owned, share_.new_places(owned));
      return;
    }
    const std::vector<Index> ids = store_->ids();
    keep_known_contacts(ids, owned, *remembered_);
    const RememberedContacts known =
        remembered_contacts(*remembered_, detector_->name_elements(store_->view()), ids, owned,
                            static_cast<std::size_t>(vectors_));
    detector_->restore(*b_, known.key, known.impulse);
    remembered_.reset();
  }

  /// Calls draw() on rank 0, where all bodies are owned ones meanwhile.
  template <class F>
  void with_all_bodies(F&& draw) {
    remember_contacts();
    const Index own = store_->owned_count(), room = store_->capacity();
    share_.gather_bodies(*store_);
    std::string fault;
    try {
      if (ranks_->rank() == 0) draw();
    } catch (const std::exception& error) {
      fault = error.what();
    }
    store_->set_owned_count(own);
    store_->set_capacity(room);
    share_.forget();
    throw_on_all(ranks_, !fault.empty(), [&] { throw RunError(fault); });
  }

  /// The whole state, on every rank; each then goes on as one that was restored from it. @param id_end  of all bodies
  void save(Index id_end, WorldState& s) {
    remember_contacts();
    WorldState own = *remembered_;
    store_->save_owned(own);
    s.arrays = gather_arrays(*ranks_, own).arrays;
    std::vector<Index> all(static_cast<std::size_t>(id_end));
    std::iota(all.begin(), all.end(), Index(0));
    keep_known_contacts(all, id_end, s);  // once, where two ranks have them
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
    const WorldState own = shared_part(s, [&](const Vec3d& place) { return share_.owns(place); });
    store_->arrange(own.at<std::int32_t>("body/id"));
    store_->restore_owned(own);
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
  ContactDetector<B, Real>* detector_;
  Solver<B, Real>* solver_;
  int vectors_;
  RankShare<B, Real> share_;
  std::optional<WorldState> remembered_;  ///< contacts by ids, while places of ghosts are not known
};

}  // namespace scree
