#pragma once
// What bodies touch besides each other: shape records, walls and meshes, handed over once per run.

#include <vector>

#include "collision/mesh_topology.h"
#include "kernels/bodies/body_view.h"

namespace scree {

template <class Real>
struct ObstacleData {
  /// Of all bodies that are not spheres; BodyView::shape points here.
  std::vector<ShapeRecord<Real>> shapes;
  std::vector<Index> walls;        ///< indices into `shapes`: fixed and kinematic bodies
  std::vector<MeshSource> meshes;  ///< ShapeRecord::mesh points here
  std::vector<MeshSource> hulls;   ///< that of hulls points here
};

}  // namespace scree
