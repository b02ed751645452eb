// The beds of scree bench: as many spheres as asked for, inside the box, none overlapping.

#include <gtest/gtest.h>

#include <algorithm>

#include "host/error.h"
#include "host/scene/bed_scene.h"

namespace scree::test {
namespace {

/// Deepest overlap of spheres with each other and with the box, over the largest diameter.
double deepest_overlap(const Scene& scene, double diameter) {
  const ParticleSet& set = scene.particles.at(0);
  const BodyDescription& box = scene.bodies.at(0);
  double deepest = 0;
  for (std::size_t i = 0; i < set.position.size(); ++i) {
    const Vec3d& x = set.position[i];
    for (int axis = 0; axis < 3; ++axis) {
      const double low = box.position[axis] - box.shape.half_extents[axis];
      deepest = std::max(deepest, low + set.radius[i] - x[axis]);
      if (axis < 2) {
        const double high = box.position[axis] + box.shape.half_extents[axis];
        deepest = std::max(deepest, x[axis] + set.radius[i] - high);
      }
    }
    for (std::size_t j = 0; j < i; ++j)
      deepest = std::max(deepest, set.radius[i] + set.radius[j] - norm(x - set.position[j]));
  }
  return deepest / diameter;
}

TEST(BenchBed, HoldsTheSpheresWithoutOverlap) {
  for (const int count : {1, 2, 37, 1500}) {
    for (const bool mixed : {false, true}) {
      const BedParams bed{.count = count, .layers = 6, .polydisperse = mixed};
      const Scene scene = bed_scene(bed);
      ASSERT_EQ(scene.particles.at(0).position.size(), static_cast<std::size_t>(count));
      EXPECT_LT(deepest_overlap(scene, bed.diameter), 1e-9) << count << (mixed ? " mixed" : "");
      EXPECT_NO_THROW(validate(scene));
    }
  }
}

TEST(BenchBed, IsAsHighAsAskedForAndTheSameEveryTime) {
  const BedParams bed{.count = 20'000, .layers = 20};
  const Scene scene = bed_scene(bed), again = bed_scene(bed);
  double top = 0;
  for (std::size_t i = 0; i < scene.particles[0].position.size(); ++i) {
    top = std::max(top, scene.particles[0].position[i].z);
    EXPECT_EQ(scene.particles[0].position[i].z, again.particles[0].position[i].z);
  }
  EXPECT_NEAR(top, bed_height(bed), 0.1 * bed_height(bed));
}

/// A vacant site must not end the bed.
TEST(BenchBed, OfOneSiteALayerIsAStack) {
  const Scene scene = bed_scene({.count = 60, .layers = 100});
  EXPECT_EQ(scene.particles.at(0).position.size(), 60u);
  EXPECT_LT(deepest_overlap(scene, 0.01), 1e-9);
}

TEST(BenchBed, TakesOverridesAndRefusesNonsense) {
  EXPECT_EQ(bed_scene({.count = 5}, {"solver.name=jacobi"}).solver.name, "jacobi");
  EXPECT_EQ(bed_scene({.count = 5}, {"materials.grain.friction=0.2"}).materials[0].friction, 0.2);
  EXPECT_THROW(bed_scene({.count = 0}), InputError);
  EXPECT_THROW(bed_scene({.count = 5, .layers = 0}), InputError);
  EXPECT_THROW(bed_scene({.count = 5, .diameter = -1}), InputError);
  EXPECT_THROW(bed_scene({.count = 5}, {"nonsense=1"}), InputError);
}

}  // namespace
}  // namespace scree::test
