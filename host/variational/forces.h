#pragma once
// Potential and gradient of a mechanical system; both zero where there are no forces.

#include <utility>

#include "host/mechanical_system.h"
#include "host/variational/first_hit.h"

namespace scree::variational {

class Forces {
 public:
  explicit Forces(const MechanicalSystem& system)
      : potential_(system.potential), gradient_(system.potential_gradient) {}

  bool any() const { return static_cast<bool>(potential_); }
  double potential(const Vector& q) const { return potential_ ? potential_(as_span(q)) : 0; }
  void gradient(const Vector& q, Vector& out) const {
    if (gradient_)
      gradient_(as_span(q), as_span(out));
    else
      out.setZero();
  }

 private:
  std::function<double(std::span<const double>)> potential_;
  std::function<void(std::span<const double>, std::span<double>)> gradient_;
};

}  // namespace scree::variational
