#pragma once
// The parts of a step where free bodies are convex and turn: their ways, and their impacts.

#include "dynamics/rigid/part_store.h"
#include "dynamics/variational/island_rounds.h"
#include "kernels/variational/rigid_islands.h"

namespace scree {

/// Memory: 232 bytes a body beside places and velocities after the step, 16 of islands, and some 280 for each that may be in one.
template <class B>
class RigidFlight {
 public:
  /// @param data, shapes, fixed_count, fixed_begin, box  see PartStore
  RigidFlight(B& b, Index bodies, const ObstacleData<double>& data,
              Span<const ShapeRecord<double>> shapes, Index fixed_count, Index fixed_begin,
              const PeriodicBox& box)
      : parts_(b, data, shapes, fixed_count, fixed_begin, box),
        islands_(b, bodies),
        way_(b, bodies),
        q_(b, bodies),
        spin_(b, bodies),
        flight_(b, 1),
        motion_(b, 1) {}

  /// Parts of compounds where their bodies are, and all other bodies: what walls name, and pictures show.
  BodyView<double> parts(const BodyView<double>& bodies) { return parts_.place(bodies); }
  /// Bodies changed their places.
  void forget() { parts_.forget(); }

  /// @param base  as for spheres
  /// @param seen  see parts()
  RigidStage stage(const Stage<true>& base, const ShapeSet<double>& shapes,
                   const BodyView<double>& seen) {
    RigidStage s;
    static_cast<Stage<true>&>(s) = base;
    s.shapes = shapes;
    s.parts = parts_.set();
    s.wall_material = seen.material;
    s.ways = way_.view(base.bodies.owned_count);
    return s;
  }

  /// The ways of all bodies in a step.
  void set_out(B& b, const BodyView<double>& bodies, const Vec3d& gravity, double h) {
    const Index n = bodies.owned_count;
    for_each(b, n, SetOut{bodies, gravity, h, way_.view(n)});
  }

  /// @param x, v  out: [owned]
  FlightSums fly(B& b, const RigidStage& stage, Span<Vec3d> x, Span<Vec3d> v) {
    const Index n = stage.bodies.owned_count;
    reduce<FlightSums>(
        b, n,
        FlyRigid{stage, after(n, x, v), islands_.partner(), islands_.is_active(), islands_.place()},
        StoreResult<FlightSums>{flight_.data()});
    return fetch(b, flight_.data());
  }

  ImpactReport run(B& b, const RigidStage& stage, Index active, Span<Vec3d> x, Span<Vec3d> v) {
    const RigidStates states = after(stage.bodies.owned_count, x, v);
    return islands_.run(b, stage, active, [&](Span<const RigidMember> members) {
      return FinishRigidIslands{stage, members, states};
    });
  }

  MotionSums take(B& b, const BodyView<double>& bodies, const PeriodicBox& box,
                  const Vec3d& gravity, double h, Span<Vec3d> x, Span<Vec3d> v) {
    const Index n = bodies.owned_count;
    reduce<MotionSums>(b, n, TakeRigid{after(n, x, v), bodies, box, gravity, h},
                       StoreResult<MotionSums>{motion_.data()});
    return fetch(b, motion_.data());
  }

 private:
  RigidStates after(Index n, Span<Vec3d> x, Span<Vec3d> v) {
    return {x, v, q_.view(n), spin_.view(n)};
  }

  PartStore<B, double> parts_;
  IslandRounds<B, RigidMember> islands_;
  Buffer<B, RigidPath> way_;
  Buffer<B, Quatd> q_;
  Buffer<B, Vec3d> spin_;
  Buffer<B, FlightSums> flight_;
  Buffer<B, MotionSums> motion_;
};

}  // namespace scree
