#pragma once
// Bodies that joints hold together while different ranks own them.

#include <array>
#include <vector>

#include "kernels/backend/ranks.h"
#include "kernels/types.h"

namespace scree {

/// An owned body that a joint holds to one of another rank.
struct Partner {
  Index place;  ///< of the body among those owned here
  int rank;     ///< that owns the other one
};

/// All of them, by place, then by rank. A call that all ranks make together.
/// @param joined  ids of the bodies of each joint, the same on every rank  @param owned  ids of the bodies here
std::vector<Partner> partners_elsewhere(Ranks& ranks,
                                        const std::vector<std::array<Index, 2>>& joined,
                                        const std::vector<Index>& owned);

}  // namespace scree
