#pragma once
// What bodies touch besides each other: shape records, walls and meshes, handed over once per run.

#include <cstdint>
#include <map>
#include <vector>

#include "collision/mesh_topology.h"
#include "kernels/bodies/parts.h"

namespace scree {

/// A wall that fills the period along some axes: its ends and the images there are not felt.
struct EndlessWall {
  std::uint8_t axes = 0;      ///< bits
  Vec3<double> half_extents;  ///< with ends so far away that no body meets them [m]
};

template <class Real>
struct ObstacleData {
  /// Of all bodies that are not spheres; BodyView::shape points here.
  std::vector<ShapeRecord<Real>> shapes;
  std::vector<Index> walls;              ///< indices into `shapes`: fixed and kinematic bodies
  std::map<Index, EndlessWall> endless;  ///< by index into `shapes`
  std::vector<MeshSource> meshes;        ///< ShapeRecord::mesh points here
  std::vector<MeshSource> hulls;         ///< that of hulls points here
  std::vector<PartRecord<Real>> parts;   ///< of all compounds
  std::vector<Index> first_part{0};      ///< [compounds + 1] that of compounds points here
};

}  // namespace scree
