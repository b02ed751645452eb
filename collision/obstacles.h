#pragma once
// What bodies touch besides each other: shape records, walls and meshes, handed over once per run.

#include <vector>

#include "collision/mesh_topology.h"
#include "kernels/bodies/parts.h"

namespace scree {

template <class Real>
struct ObstacleData {
  /// Of all bodies that are not spheres; BodyView::shape points here.
  std::vector<ShapeRecord<Real>> shapes;
  std::vector<Index> walls;             ///< indices into `shapes`: fixed and kinematic bodies
  std::vector<MeshSource> meshes;       ///< ShapeRecord::mesh points here
  std::vector<MeshSource> hulls;        ///< that of hulls points here
  std::vector<PartRecord<Real>> parts;  ///< of all compounds
  std::vector<Index> first_part{0};     ///< [compounds + 1] that of compounds points here
};

}  // namespace scree
