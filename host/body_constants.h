#pragma once
// What does not change about the bodies of a run.

#include <cstddef>
#include <vector>

#include "host/scene.h"

namespace scree {

struct BodyConstant {
  double radius = 0;  ///< sphere radius, else bounding radius [m]; 0: unbounded
  double mass = 0;    ///< [kg]; 0 for fixed and kinematic bodies
  int group = 0;
  BodyKind kind = BodyKind::free;
  ShapeKind shape = kNoShape;
  int entry = -1;            ///< see BodyDescription and ParticleSet
  bool is_particle = false;  ///< of a set: the entry is one of `particles`
  std::size_t number = 0;    ///< in its set
};

/// Constants of all bodies a run of a scene can ever have, by id; bodies that join later included.
/// Particles share the values of the sets they come from: equal ones take no memory.
class BodyConstants {
 public:
  explicit BodyConstants(const Scene& scene);

  std::size_t size() const { return size_; }
  /// @param id  0 to size() - 1
  BodyConstant operator[](std::size_t id) const;
  /// Half edge lengths of the box about a body, in its frame [m]; zero for spheres, half spaces and meshes.
  Vec3d half_extents(std::size_t id) const;

 private:
  /// Consecutive ids: bodies from a list, or else particles.
  struct Range {
    std::size_t begin = 0;  ///< first id
    std::vector<BodyConstant> bodies;
    std::vector<Vec3d> half_extents;  ///< of them
    ParticleSet particles;            ///< without states
  };
  const Range& range_of(std::size_t id) const;

  std::vector<Range> ranges_;
  std::size_t size_ = 0;
};

}  // namespace scree
