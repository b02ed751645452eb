#pragma once
// Synthetic beds of equal spheres with their contacts, for benchmarks: any size in linear time.
//
// A bed is a body-centered cubic lattice of touching spheres on a floor, as wide as deep and half
// as high, from which sites are left out at random until a sphere has about three contacts. Each
// sphere is then displaced a little, so that gaps and normals vary. Numbers of contacts per body,
// order of bodies, and sizes of records are those of a settled bed; forces are not: there are no
// force chains and nothing holds the upper layers up. A synthetic bed therefore measures what a
// pass costs. It says nothing about how many passes a real problem needs.

#include <cstdint>
#include <vector>

#include "kernels/math/vec3.h"

namespace scree::bench {

struct BedParams {
  Index sphere_count = 10000;      ///< > 0
  double diameter = 0.01;          ///< [m], > 0
  double contacts_per_sphere = 3;  ///< aimed at, in (0, 4); met to 2 % from 1000 spheres
  double jitter = 0.01;            ///< largest displacement per axis, in diameters, in [0, 0.03]
  std::uint64_t seed = 1;
};

/// Spheres in Morton order of their lattice cells; contacts sorted by (body a, body b), a < b. The
/// floor is body `sphere_count`. The same parameters give the same bed everywhere.
struct Bed {
  double diameter = 0;                 ///< [m]
  std::vector<Vec3<double>> position;  ///< [sphere_count] centers [m]
  std::vector<Index> body_a;           ///< [contact_count]
  std::vector<Index> body_b;           ///< [contact_count]
  std::vector<Vec3<float>> normal;     ///< [contact_count] unit, from A to B
  std::vector<float> gap;              ///< [contact_count] signed distance [m]

  Index sphere_count() const { return static_cast<Index>(position.size()); }
  Index contact_count() const { return static_cast<Index>(body_a.size()); }
};

/// Time and memory grow linearly with the number of spheres: about 100 bytes a sphere.
/// @throws std::invalid_argument  a parameter out of range, or more contacts than Index can count
Bed make_bed(const BedParams& params);

}  // namespace scree::bench
