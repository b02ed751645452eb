#pragma once
// The GPUs that ranks work with.

#include <array>
#include <cstdint>
#include <vector>

namespace scree {

/// The device of a rank.
struct RankDevice {
  std::array<char, 16> card{};  ///< the same for ranks that share one, and for them alone
  int number = 0;               ///< as the process of the rank counts devices
  std::uint64_t process = 0;    ///< a number that no other process has, as far as chance goes
};

/// The current device of the thread. Without one that can be asked its card is all zeros.
RankDevice this_device();

/// Whether each rank has a device of its own, as far as is known.
bool have_own_cards(const std::vector<RankDevice>& devices);
/// Whether some ranks are threads of one process.
bool share_a_process(const std::vector<RankDevice>& devices);

}  // namespace scree
