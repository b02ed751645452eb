#pragma once
// sim.json: the states of a run of one of rigid-ipc's scenes as that program writes them, so that its tools read them.
//
// A state has for each body the position of its center of mass [m], the rotation vector of its principal axes [rad],
// velocities, and the rotation matrix's rate. The axes are those that rigid-ipc finds: eigenvectors of the inertia of the
// body as it stands at the start, in the order of moments; the world's where two rotations are fixed. Where moments are
// equal they are not unique, and another program may find others. As there, angular velocities [rad/s] are given by components
// along the axes at the start, and so are angular momenta, which are therefore no sum in one frame.

#include <nlohmann/json.hpp>

#include "host/io/frame_reader.h"
#include "host/scene.h"

namespace scree {

/// What a run was, and what it left.
struct IpcRun {
  const Scene& scene;             ///< as it was read from the fixture
  const nlohmann::json& fixture;  ///< with what it was overridden by
  const FrameReader& frames;
  const std::vector<StepReport>& steps;
  std::uint64_t memory = 0;  ///< most that it held [bytes]
};

/// @throws InputError where frames are not those of the start and of every step after it
/// @throws RunError when the file cannot be written; the one before is then still there
void write_ipc_states(const std::filesystem::path& file, const IpcRun& run);

}  // namespace scree
