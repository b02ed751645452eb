#pragma once
// Beds of spheres made in memory, for benchmarks: any size in linear time, at rest after a short
// while. Two parameters say all about one, so that figures of different machines compare.

#include <string>
#include <vector>

#include "host/scene.h"

namespace scree {

struct BedParams {
  int count = 100'000;     ///< spheres, > 0
  int layers = 20;         ///< height of the bed in layers of (the largest) spheres, > 0
  double diameter = 0.01;  ///< of the (largest) spheres [m], > 0
  /// Diameters d / k with k = 1, 2, 3, 5, 10; every size takes the same share of the volume.
  bool polydisperse = false;
  bool walls = true;  ///< false: no side walls, a column that collapses on its floor
};

/// Spheres of 2500 kg/m^3 with friction 0.5 in a box without a lid, time step 5e-4 s. Layers are
/// square and shifted by half a site from one to the next; every eighth site is vacant, the others
/// are displaced a little and touch a sphere below, no spheres overlap. When settled a body has
/// about three contacts. The same parameters give the same scene everywhere.
/// @param overrides  `key.path=value` each, as scene files take them, without particles
/// @throws InputError  an override, or a parameter out of range
Scene bed_scene(const BedParams& bed, const std::vector<std::string>& overrides = {});

/// Height of the bed, about [m].
double bed_height(const BedParams& bed);

/// Number of layers that makes the bed about as high as wide.
int layers_of_cube(int count, bool polydisperse = false);

/// Time in which a bed sinks upon itself, or a column is in the middle of its collapse [s].
double warmup_time(const BedParams& bed);

}  // namespace scree
