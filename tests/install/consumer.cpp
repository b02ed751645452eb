// A program outside the source tree: the installed headers and libraries are enough
// to build and run it.
#include <cstdio>

#include "scree/io/problem_file.h"
#include "scree/ranks/mpi_ranks.h"
#include "scree/scene_reader.h"
#include "scree/version.h"
#include "scree/world.h"

/// @param argv  a scene file; prints the version and the height of the last body after three steps
int main(int argc, char** argv) {
  if (argc != 2) return 2;
  scree::WorldOptions options;
  options.ranks = scree::mpi_ranks();  // none: no launcher started this program
  scree::World world(scree::read_scene(argv[1], {}), options);
  while (world.steps_done() < 3) world.step();
  std::printf("scree %s: %d bodies, z = %g m\n", scree::version(), world.body_count(),
              world.states().position.back().z);
  return 0;
}
