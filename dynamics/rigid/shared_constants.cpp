#include "dynamics/rigid/shared_constants.h"

#include <cstddef>

#include "host/scene/bodies_by_id.h"
#include "host/scene/particle_shapes.h"
#include "shapes/shape_card.h"

namespace scree {
namespace {

/// One value as long as all that were seen are equal.
template <class T>
class Common {
 public:
  void see(const T& value) {
    if (!seen_) value_ = value;
    seen_ = true;
    if (value_ && !(*value_ == value)) value_.reset();
  }
  /// @param of  value of the i-th of `count` bodies
  template <class F>
  void see_all(std::size_t count, bool uniform, F of) {
    if (uniform && count > 0) count = 1;
    for (std::size_t i = 0; i < count && (value_ || !seen_); ++i) see(of(i));
  }
  const std::optional<T>& value() const { return value_; }

 private:
  bool seen_ = false;
  std::optional<T> value_;
};

}  // namespace

SharedConstants shared_constants(const Scene& scene) {
  Common<double> radius, mass;
  Common<std::uint8_t> locks;
  Common<int> material, group;
  bool spheres = true;
  const auto see_body = [&](std::size_t, const BodyDescription& body) {
    if (body.kind != BodyKind::free) return;
    spheres = spheres && shape_card(body.shape.kind).is_ball;
    radius.see(body.shape.radius);
    mass.see(body.mass);
    locks.see(body.locks);
    material.see(body.material);
    group.see(body.group);
  };
  const auto see_set = [&](std::size_t, const ParticleSet& set) {
    const std::size_t n = set.position.size();
    spheres = spheres && are_spheres(set);
    const auto of = [](const auto& values) { return [&](std::size_t i) { return values[i]; }; };
    radius.see_all(n, set.radius.uniform(), of(set.radius));
    mass.see_all(
        n,
        set.radius.uniform() && set.shape.uniform() && set.density.uniform() && set.mass.uniform(),
        [&](std::size_t i) { return particle_mass(set, i); });
    locks.see_all(n, true, [&](std::size_t) { return set.locks; });
    material.see_all(n, set.material.uniform(), of(set.material));
    group.see_all(n, set.group.uniform(), of(set.group));
  };
  for_each_by_id(scene, see_body, see_set);
  SharedConstants shared{{}, mass.value(), locks.value(), material.value(), group.value(), spheres};
  if (spheres) shared.radius = radius.value();  // of others it is that of a bounding sphere
  return shared;
}

}  // namespace scree
