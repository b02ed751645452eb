#pragma once
// Brings the bodies of a scene into the simulation when their time has come.

#include <functional>
#include <utility>

#include "dynamics/ranks/gather.h"
#include "dynamics/rigid/body_store.h"
#include "dynamics/rigid/obstacles.h"
#include "host/scene/added_bodies.h"
#include "host/scene/particle_shapes.h"
#include "host/scene/scene_summary.h"

namespace scree {

template <class B, class Real>
class BodyLoading {
 public:
  /// @param scene  loses the descriptions of bodies as they are loaded; it, the store and the
  ///               shapes outlive this object
  /// @param owns   whether a free body that is there belongs to this rank; the others are left out
  BodyLoading(Scene& scene, BodyStore<B, Real>& store, const Obstacles<B, Real>& obstacles,
              std::function<bool(const Vec3d&)> owns = {})
      : scene_(&scene),
        store_(&store),
        obstacles_(&obstacles),
        owns_(std::move(owns)),
        insertion_count_(timed_insertions(scene)),
        added_count_(static_cast<Index>(added_count(scene))),
        id_end_(static_cast<Index>(count_bodies(scene).all())) {}

  /// The bodies that are there from the start.
  void load_first() { load(scene_->bodies, scene_->particles); }

  /// Whether insert_due() will have one.
  bool is_due(double time) const {
    return insertions_done_ < insertion_count_ &&
           scene_->insertions[insertions_done_].time <= time + 1e-9 * scene_->stepping.time_step;
  }

  /// A batch enters before the first step that starts at or after its time; sums and products of
  /// times differ by less than the slack.
  /// @return  whether there was one
  bool insert_due(double time) {
    const std::uint64_t before = insertions_done_;
    while (is_due(time)) insert_next();
    return insertions_done_ > before;
  }

  /// The first insertions of the scene, however late it is: for a restored simulation.
  /// @throws InputError when the scene has fewer
  void insert_first(std::uint64_t count) {
    if (count > insertion_count_) throw_wrong_insertions(count, insertion_count_);
    while (insertions_done_ < count) insert_next();
  }

  std::uint64_t insertions_done() const { return insertions_done_; }

  /// The bodies that a program added, once.
  void insert_added() {
    if (added_count_ == 0 || has_added_) return;
    const Index next = std::exchange(next_id_, first_added());
    load(scene_->insertions.back().bodies, scene_->insertions.back().particles);
    next_id_ = next;
    has_added_ = true;
  }

  /// End of the ids of the bodies that came so far; bodies of insertions yet to come may be among them.
  Index id_end() const { return has_added_ ? id_end_ : next_id_; }
  /// Whether a body came so far.
  bool has_come(Index id) const {
    return id >= 0 && (id < next_id_ || (has_added_ && id >= first_added() && id < id_end_));
  }
  /// First id of the bodies that a program added, and whether they came.
  Index first_added() const { return id_end_ - added_count_; }
  bool has_added() const { return has_added_; }

 private:
  /// Uploads bodies, which get the next ids, and frees the host's memory of them as it goes.
  void load(std::vector<BodyDescription>& bodies, std::vector<ParticleSet>& sets) {
    store_->make_room(store_->owned_count() + free_bodies_here(bodies, sets));
    typename BodyStore<B, Real>::Loader free(*store_, store_->owned_count());
    typename BodyStore<B, Real>::Loader fixed(*store_, store_->fixed_begin());
    for (const BodyDescription& body : bodies) {
      const bool is_free = body.kind == BodyKind::free;
      if (!is_free || owns(body.position))
        (is_free ? free : fixed)
            .add(body, next_id_, obstacles_->shape(next_id_), bounding_radius(*scene_, body));
      ++next_id_;
    }
    bodies = {};
    for (ParticleSet& set : sets) {
      const bool spheres = are_spheres(set);
      for (std::size_t i = 0; i < set.position.size(); ++i, ++next_id_)
        if (owns(set.position[i]))
          free.add(particle_body(set, i), next_id_,
                   spheres ? kSphereShape : obstacles_->shape(next_id_), set.radius[i]);
      set = {};
    }
    sets = {};
    store_->set_owned_count(free.flush());
    fixed.flush();
  }

  bool owns(const Vec3d& position) const { return !owns_ || owns_(position); }
  /// Those of this rank; a run of one has room for all.
  Offset free_bodies_here(const std::vector<BodyDescription>& bodies,
                          const std::vector<ParticleSet>& sets) const {
    return owns_ ? count_free_bodies(bodies, sets, owns_) : 0;
  }

  void insert_next() {
    Insertion& insertion = scene_->insertions[insertions_done_];
    load(insertion.bodies, insertion.particles);
    ++insertions_done_;
  }

  Scene* scene_;
  BodyStore<B, Real>* store_;
  const Obstacles<B, Real>* obstacles_;
  std::function<bool(const Vec3d&)> owns_;
  std::uint64_t insertion_count_;  ///< with a time
  Index added_count_;              ///< by programs
  Index id_end_;                   ///< of all bodies that there can ever be
  bool has_added_ = false;
  Index next_id_ = 0;
  std::uint64_t insertions_done_ = 0;
};

}  // namespace scree
