# Public headers live under scree/ for programs that use the library: host/world.h is <scree/world.h>, and
# what it includes of kernels/ and solvers/ is in <scree/kernels/...>. Copies with these names are written to
# ${SCREE_PUBLIC_INCLUDE_DIR}/scree when CMake configures; installing copies that folder.

set(SCREE_PUBLIC_INCLUDE_DIR "${PROJECT_BINARY_DIR}/include")
set(SCREE_PUBLIC_HEADERS # these, and all that they include
  host/world.h host/scene_reader.h host/state_hash.h host/error.h host/version.h
  host/hulls.h host/compounds.h host/meshes.h shapes/capsule.h shapes/container.h shapes/half_space.h shapes/mesh.h
  shapes/rounded.h host/collision_integrator.h host/collision_walls.h
  host/io/problem_file.h host/problems/assembled_form.h host/problems/matrix_form.h
  host/solve/solve_problem.h host/ranks/mpi_ranks.h host/ranks/thread_ranks.h)

# scree_public_name(<out> <path>): what a path from the root is called below scree/.
function(scree_public_name out path)
  string(REGEX REPLACE "^host/" "" path "${path}")
  set(${out} "${path}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE "${SCREE_PUBLIC_INCLUDE_DIR}/scree")
set(to_do ${SCREE_PUBLIC_HEADERS})
set(done "")
while(to_do)
  list(POP_FRONT to_do path)
  if(path IN_LIST done)
    continue()
  endif()
  list(APPEND done "${path}")
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/${path}")
  file(READ "${PROJECT_SOURCE_DIR}/${path}" text)
  string(REGEX MATCHALL "#include \"[^\"]+\"" includes "${text}")
  foreach(include IN LISTS includes)
    string(REGEX REPLACE "#include \"([^\"]+)\"" "\\1" included "${include}")
    list(APPEND to_do "${included}")
    scree_public_name(name "${included}")
    string(REPLACE "#include \"${included}\"" "#include \"scree/${name}\"" text "${text}")
  endforeach()
  scree_public_name(name "${path}")
  file(WRITE "${SCREE_PUBLIC_INCLUDE_DIR}/scree/${name}" "${text}")
endwhile()
