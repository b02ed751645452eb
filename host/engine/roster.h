#pragma once
// Which bodies a World has: those of its scene, those that programs added, without those that they removed.

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "host/scene.h"
#include "host/world_state.h"

namespace scree {

class Roster {
 public:
  explicit Roster(Scene scene) : scene_(std::move(scene)) {}

  /// With the bodies that were added, see host/scene/added_bodies.h; those that were removed are still described.
  const Scene& scene() const { return scene_; }
  /// Ids, rising.
  const std::vector<int>& removed() const { return removed_; }
  bool is_removed(int id) const;
  /// Names of the bodies that there are, and of those to come.
  const std::map<std::string, int>& names() const { return scene_.body_names; }

  /// @return ids of the new bodies  @throws InputError naming the body and its fault: then it is no longer one
  std::vector<int> add(const std::vector<BodyDescription>& bodies,
                       const std::vector<std::string>& names);
  /// @param id  of a free body that is there  @throws InputError when a joint holds it
  void remove(int id);

  /// Adds what differs from the scene to a state; nothing when nothing does.
  void save(WorldState& s) const;
  /// That of a state of a World of the same scene. @throws InputError when it is not one
  Roster restored(const WorldState& s) const;
  /// Whether it has other bodies than its scene.
  bool has_changes() const;

 private:
  /// @throws InputError with the names of added bodies in place of their places in the scene
  void check() const;

  Scene scene_;
  std::vector<int> removed_;
  std::map<std::string, int> lost_names_;  ///< of bodies of the scene that were removed
};

/// Whether a state tells of bodies that programs added or removed.
bool has_changed_bodies(const WorldState& s);

}  // namespace scree
