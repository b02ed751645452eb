#pragma once
// The simulation behind World: what a step is. A model of dynamics implements this interface once,
// as a template on the backend and the precision (model_on.h has what models share), and says what
// it has in its card (dynamics_card.h).

#include "host/own_bodies.h"
#include "host/world.h"

namespace scree {

class Dynamics {
 public:
  virtual ~Dynamics() = default;

  /// Advances by one time step. @param problem  out, when asked for: the contact problem of the
  /// step, left empty by models that have none
  virtual StepReport step(BodyProblem* problem) = 0;
  virtual std::int64_t steps_done() const = 0;
  virtual double time() const = 0;

  /// See World.
  virtual std::vector<std::string> warnings() const { return {}; }
  virtual int body_count() const = 0;
  /// What frames show, see DynamicsCard::frame.
  virtual BodyStates states() = 0;
  /// See World; of one rank, which has all bodies.
  virtual void begin_own_bodies(OwnBodiesSink& sink, std::optional<double> resumed_time);
  virtual std::vector<std::int64_t> give_own_bodies(OwnBodiesSink& sink);
  virtual const BodyConstants& constants() const = 0;

  /// Contacts of the last step, and pairs that overlap now; none in models without contacts.
  virtual std::vector<ContactRecord> contacts() { return {}; }
  virtual std::vector<ContactRecord> overlaps() { return {}; }
  /// Joints in the last step; none in models without them.
  virtual std::vector<JointRecord> joints() { return {}; }

  /// See World::track_forces(); models without contacts refuse.
  virtual void track_forces();
  virtual MeanForces take_forces() { return {}; }

  /// See World; models that cannot refuse. Bodies are in the simulation, and of the kind that the call is for.
  virtual ForceRecord force_on_body(int body);
  virtual ForceRecord force_on_group(int group);
  virtual void set_gravity(const Vec3d& gravity);
  virtual void set_velocity(int body, const Vec3d& velocity, const Vec3d& angular_velocity);
  virtual void set_motion(int body, const Motion& motion);
  virtual void apply_force(int body, const Vec3d& force, const Vec3d& torque);

  /// For World::add() and remove(), which make a run of other bodies that goes on from this one. Models that cannot say so.
  virtual bool bodies_may_change() const { return false; }
  /// Whether a body is in the simulation now, and the end of the ids of those that were inserted.
  virtual bool has_body(int id) const { return id >= 0 && id < body_count(); }
  virtual int id_end() const { return body_count(); }
  /// Insertions of the scene that have come. A run cannot take a state of fewer.
  virtual std::uint64_t insertions_done() const { return 0; }
  /// First call to a new run: the bodies that programs added enter (host/scene/added_bodies.h), others are no more.
  /// @param removed  ids, rising
  virtual void change_bodies(const std::vector<int>& removed);
  /// A state with what checkpoints do not hold, for enter() of a run of other bodies: contacts of bodies that are no more
  /// are left out, new ones come as they are described.
  virtual WorldState leave() { return save(); }
  virtual void enter(const WorldState& left) { restore(left); }
  /// restore() in a run of other bodies: what a state does not hold stays as it was left.
  virtual void restore_after(const WorldState& /*left*/, const WorldState& state) {
    restore(state);
  }

  virtual std::vector<ArrayInfo> arrays() = 0;
  virtual ArrayView array(const std::string& name) = 0;
  virtual void arrays_changed(Written what) = 0;

  virtual WorldState save() = 0;
  virtual void restore(const WorldState& state) = 0;

  virtual Image render(const PictureSettings& settings) = 0;

  /// See World.
  virtual bool is_asked_to_end() const { return false; }

  /// CUDA device that must be the current one during a call; negative: none.
  virtual int cuda_device() const = 0;
  virtual std::size_t memory() const = 0;
  virtual std::size_t peak_memory() const = 0;
};

/// The dynamics that the scene names. Compiled once per backend: B is Cpu or Cuda.
template <class B>
std::unique_ptr<Dynamics> make_dynamics(Scene scene, const WorldOptions& options);

}  // namespace scree
