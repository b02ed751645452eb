#pragma once
// Which rank owns which part of space.

#include <utility>
#include <vector>

#include "kernels/bodies/space_cut.h"

namespace scree {

/// A place with the share of the work that it stands for.
struct WorkSample {
  Vec3<double> position;
  double weight = 1;
};

/// Recursive bisection: every cut is across the longest side of the box of the samples that are left, and divides their
/// weight as the ranks on both sides ask for. Boxes have small surfaces, so few bodies are near a border.
/// Source: M. J. Berger & S. H. Bokhari, IEEE Trans. Comput. C-36, 1987.
class Decomposition {
 public:
  Decomposition() = default;  ///< all to rank 0
  /// The same on every rank that has the same samples in the same order.
  static Decomposition of(std::vector<WorkSample> samples, int ranks);

  int owner(const Vec3<double>& x) const {
    return owner_of({cuts_.data(), static_cast<Offset>(cuts_.size())}, x);
  }
  const std::vector<SpaceCut>& cuts() const { return cuts_; }

 private:
  std::vector<SpaceCut> cuts_;
};

}  // namespace scree
