#pragma once
// How many frames a file of frames holds.

#include <cstdint>
#include <filesystem>

#include "host/io/h5.h"

namespace scree::test {

inline std::int64_t frame_count(const std::filesystem::path& frames) {
  return h5::File::open(frames)
      .root()
      .open_group("VTKHDF")
      .open_group("Steps")
      .attribute<std::int64_t>("NSteps");
}

}  // namespace scree::test
