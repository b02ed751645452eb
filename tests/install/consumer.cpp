// A program outside the source tree: the installed headers and libraries are enough
// to build and run it.
#include <cstdio>

#include "scree/io/problem_file.h"
#include "scree/meshes.h"
#include "scree/ranks/mpi_ranks.h"
#include "scree/scene_reader.h"
#include "scree/shapes/capsule.h"
#include "scree/shapes/container.h"
#include "scree/shapes/half_space.h"
#include "scree/shapes/mesh.h"
#include "scree/version.h"
#include "scree/world.h"

/// A tetrahedron above a floor, filled in by hand.
scree::Scene filled_scene() {
  scree::Scene scene;
  scene.dynamics.type = "affine";
  scree::BodyDescription floor, solid;
  floor.kind = scree::BodyKind::fixed;
  floor.shape.kind = scree::shapes::HalfSpace::kind;
  scene.bodies.push_back(floor);
  solid.shape.kind = scree::shapes::Mesh::kind;
  solid.mass = 1;
  solid.inertia = {0.05, 0.05, 0.05};
  solid.position = {0, 0, 1};
  scree::set_free_mesh(scene, solid,
                       {"tetrahedron",
                        {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                        {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}},
                        true});
  scene.bodies.push_back(solid);
  return scene;
}

/// @param argv  a scene file; prints the version and the height of the last body after three steps
int main(int argc, char** argv) {
  if (argc != 2) return 2;
  scree::WorldOptions options;
  options.ranks = scree::mpi_ranks();  // none: no launcher started this program
  scree::World world(scree::read_scene(argv[1], {}), options);
  while (world.steps_done() < 3) world.step();
  std::printf("scree %s: %d bodies, z = %g m\n", scree::version(), world.body_count(),
              world.states().position.back().z);
  scree::World filled(filled_scene(), {});
  filled.step();
  return filled.steps_done() == 1 ? 0 : 1;
}
