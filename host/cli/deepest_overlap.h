#pragma once
// Bodies that ran into each other deeply in a run, where steps are too long for their speeds, or appeared in each other.

#include <cstdint>
#include <string>

#include "host/scene/overlaps.h"

namespace scree {

/// The pair of bodies that overlapped deepest since the start, over how thin they are.
class DeepestOverlap {
 public:
  /// To be asked after each step, on all ranks. Contacts are read only where the deepest overlap is half again as deep as ever
  /// before: what overlaps at the start is told before.
  void note(const World& world, const StepReport& report);
  /// Empty where no two overlap by a tenth of the thinner one.
  std::string warning(const BodyConstants& bodies) const;

 private:
  double least_ = 0;              ///< that is looked at [m]
  std::int64_t body_count_ = -1;  ///< after the step before
  std::int64_t step_ = 0;
  double time_ = 0;          ///< [s]
  bool has_joined_ = false;  ///< whether bodies joined with that step
  Overlaps deepest_;
};

}  // namespace scree
