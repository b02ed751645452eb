#pragma once
// Initial packings of spheres. Every function is deterministic for a given seed, on every platform,
// and returns spheres that overlap neither each other nor the border of the region.

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "host/layouts/random_numbers.h"
#include "host/scene.h"

namespace scree {

/// Space to fill: an upright box or a cylinder of any direction.
struct Region {
  enum class Kind { box, cylinder };
  Kind kind = Kind::box;
  Vec3d lower;          ///< box [m]
  Vec3d upper;          ///< box [m]
  Vec3d axis{0, 0, 1};  ///< cylinder: unit
  Vec3d center;         ///< cylinder: middle of the axis [m]
  double radius = 0;    ///< cylinder [m]
  double length = 0;    ///< cylinder, along the axis [m]

  /// True when a sphere lies inside entirely.
  bool contains(const Vec3d& center, double sphere_radius) const;
  /// Corners of the smallest upright box around the region.
  void bounds(Vec3d& low, Vec3d& high) const;
};

/// How radii are drawn [m], or factors of the lengths of shapes [-].
struct RadiusLaw {
  enum class Kind { constant, uniform, discrete, normal };
  Kind kind = Kind::constant;
  double low = 0;        ///< constant: the radius; uniform, normal: smallest
  double high = 0;       ///< uniform, normal: largest
  double mean = 0;       ///< normal
  double deviation = 0;  ///< normal: standard deviation before values beyond the ends are redrawn
  std::vector<double> values;   ///< discrete
  std::vector<double> weights;  ///< discrete: relative numbers of spheres, one per value

  double draw(RandomNumbers& random) const;
  double smallest() const;
  double largest() const;

 private:
  double draw_normal(RandomNumbers& random) const;
};

/// How particles are drawn: spheres by their radius, others by a shape and a factor of its lengths.
struct SizeLaw {
  SizeLaw(RadiusLaw law) : scale(std::move(law)) {}

  struct Size {
    double radius = 0;  ///< of the sphere that holds it [m]
    double scale = 0;   ///< as drawn by the law `scale`
    int shape = 0;      ///< number of its shape
  };
  Size draw(RandomNumbers& random) const;
  double smallest() const;  ///< radius [m]
  double largest() const;
  bool has_shapes() const { return !radii.empty(); }
  /// Whether all particles are drawn alike.
  bool is_constant() const;

  RadiusLaw scale;              ///< spheres: of their radii
  std::vector<double> radii;    ///< of the spheres about the shapes at scale one [m]; none: spheres
  std::vector<double> weights;  ///< relative numbers of particles, one per shape
};

/// Particles, or the spheres that hold them.
struct PlacedSpheres {
  std::vector<Vec3d> center;       ///< [m]
  PerParticle<double> radius;      ///< [m]
  PerParticle<double> scale{1.0};  ///< where the law has shapes
  PerParticle<int> shape;          ///< where the law has shapes
};

/// A rotation, all of them alike likely.
Quatd random_orientation(RandomNumbers& random);

/// The region cannot hold as many spheres as were asked for.
struct DoesNotFit : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Positions are numbers of 53 bits: so far from the origin they must still tell a small fraction
/// of a sphere. @throws DoesNotFit
void require_resolution(const Region& region, double smallest_radius);

/// @throws DoesNotFit when so many particles would not fit in the memory that is free
void require_host_memory(long long count, const SizeLaw& size);
/// The same of a part of what they take. @param bytes  of a particle
void require_host_memory(long long count, double bytes);

/// A cubic lattice, filled from the bottom (lowest z) up.
struct LatticeLayout {
  Region region;
  double spacing = 0;  ///< between neighbors [m]; at least the largest diameter
  double jitter = 0;   ///< random displacement, 1: up to touching the neighbor's cell [-], 0 to 1
};

/// Takes time and memory by the spheres placed, however wide the region is.
/// @param count  spheres; -1: as many as the region holds. @throws DoesNotFit
PlacedSpheres place_on_lattice(const LatticeLayout& layout, const SizeLaw& size, long long count,
                               RandomNumbers& random);

/// Random sequential addition, the largest spheres first (they come first in the result too).
/// Reaches a solid fraction of about 0.35. @throws DoesNotFit naming how many fitted
PlacedSpheres place_at_random(const Region& region, const SizeLaw& size, long long count,
                              RandomNumbers& random);

/// One batch of rain: `count` sites of a jittered lattice, chosen at random from as few of its
/// lowest planes as hold them. @param thickness  out: height taken by the batch [m]
/// @throws DoesNotFit
PlacedSpheres place_rain_batch(const LatticeLayout& layout, const SizeLaw& size, long long count,
                               RandomNumbers& random, double& thickness);

}  // namespace scree
