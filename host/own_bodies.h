#pragma once
// The bodies of each rank where they are, for files that ranks write side by side.

#include <cstdint>
#include <optional>
#include <vector>

#include "host/world.h"

namespace scree {

/// Bodies that one rank has to tell of: the free ones that it owns, and on rank 0 those that are not free.
struct OwnBodies {
  std::vector<std::int32_t> id;  ///< rising
  BodyStates states;             ///< a row for each
};

/// Takes the bodies that a rank owns, in the process of that rank. See World::give_own_bodies().
class OwnBodiesSink {
 public:
  virtual ~OwnBodiesSink() = default;

  /// The first call. @param constants  of all bodies of the run
  /// @param resumed_time  of the state that the run goes on from [s]; not set: it is new
  virtual void begin(const BodyConstants& constants, std::optional<double> resumed_time) = 0;
  /// @param time  [s]  @param constants  of all bodies of the run
  virtual void take(double time, const OwnBodies& bodies, const BodyConstants& constants) = 0;
};

}  // namespace scree
