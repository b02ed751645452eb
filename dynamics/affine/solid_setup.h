#pragma once
// Elastic bodies as tetrahedra, each of which is an affine body whose corners others share.

#include <array>
#include <vector>

#include "dynamics/affine/linked_rows.h"
#include "host/scene.h"
#include "kernels/affine/solid_passes.h"

namespace scree::affine {

struct AffineSetup;

struct SolidSetup {
  std::vector<Solid> solids;
  std::vector<Tetrahedron> tetrahedra;
  std::vector<SolidCorner> corners;
  std::vector<std::vector<std::array<int, 3>>>
      triangles;  ///< of the surface of each solid, by corners of its mesh
  LinkTable links;
};

/// A body of the scene that is elastic. @param storage  its place in the setup
struct ElasticBody {
  Index storage = 0;
  Index id = 0;
  const BodyDescription* body = nullptr;
};

/// Adds tetrahedra behind all bodies, and their rows behind all rows, of a setup that is otherwise complete.
/// @param body_of_id  places of bodies in the setup
void add_solids(const Scene& scene, const std::vector<ElasticBody>& bodies,
                const std::vector<int>& body_of_id, AffineSetup& setup);

}  // namespace scree::affine
