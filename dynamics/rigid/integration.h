#pragma once
// The motion of bodies at the end of a step.

#include <type_traits>

#include "kernels/step/integrate.h"

namespace scree {

template <class B, class Real>
class Integration {
 public:
  explicit Integration(B& b) : sums_(b, 1) {}

  /// Gives owned bodies the velocities that a solver found, and moves them; ghosts are for their
  /// owners to move. One host read.
  /// @param solved  of the problem of the step [bodies.count]
  /// @param walls   that centers of bodies may not pass
  /// @param held    bodies that do not touch each other
  /// @param parts   that `walls` names
  /// @param shapes  of bodies
  IntegrateSums run(B& b, const BodyView<Real>& bodies, Span<const Twist<Real>> solved,
                    ContactLayout layout, double h, const PeriodicBox& box,
                    const WallView<Real>& walls, const IgnoredPairs& held,
                    const BodyView<Real>& parts, Span<const ShapeRecord<Real>> shapes) {
    const Index n = bodies.owned_count;
    Buffer<B, Twist<Real>> plain(b);
    if (layout == ContactLayout::mixed) {
      plain.reserve_discard(n);
      for_each(b, n, PlainRates<Real>{bodies, solved, plain.view(n)});
      solved = plain.view(n);
    }
    const auto along = [&](const auto& way) {
      using Way = std::decay_t<decltype(way)>;
      const bool is_radial = layout == ContactLayout::radial;
      reduce<IntegrateSums>(b, n, Integrate<Real, Way>{bodies, solved, is_radial, h, box, way},
                            StoreResult<IntegrateSums>{sums_.data()});
    };
    if (walls.solids.size > 0) {
      along(GuardedWay<Real>{bodies, walls, box.length, h, held, parts, shapes});
    } else {
      along(StraightWay<Real>{bodies, h});
    }
    return fetch(b, sums_.data());
  }

 private:
  Buffer<B, IntegrateSums> sums_;
};

}  // namespace scree
