#pragma once
// The simulation as a program sees it: make a World from a Scene, step it, read it. No CUDA type is
// visible here; the backend and the precision are chosen at run time.

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/arrays.h"
#include "host/body_constants.h"
#include "host/scene.h"
#include "host/world_state.h"

namespace scree {

class Ranks;  // kernels/backend/ranks.h

enum class Precision { single_precision, double_precision };

/// Who calls a World of several ranks.
enum class RankCalls {
  together,  ///< each rank has one, of the same scene and options, and all make the same calls in the same order, its
  ///< end included; what a call returns about bodies, contacts and pictures is whole on rank 0 only
  led  ///< rank 0 has one at a time, as a World of one rank; the others are in follow_worlds()
};

struct WorldOptions {
  BackendKind backend = BackendKind::cpu;
  Precision precision = Precision::single_precision;
  int threads = 0;  ///< CPU backend: 1 or more; 0 takes what OpenMP offers
  /// Number of the device among those of the backend: CUDA devices as the runtime counts them,
  /// which respects CUDA_VISIBLE_DEVICES; the CPU is device 0. Worlds of one process may use one
  /// device or several, from one thread or each from its own.
  int device = 0;
  /// Backend memory that a run is meant to do with [bytes], for require_memory() and for what is
  /// kept between steps; 0: what is free.
  std::size_t memory_limit = 0;
  /// Whether contacts of spheres are kept apart from those that need lever arms, where a scene has
  /// both. Results are the same within the solver's tolerance; false is for comparisons, and set by programs only.
  bool contact_groups = true;
  /// Whether bodies may be added and removed. The World then keeps the descriptions of all bodies in host memory.
  bool bodies_may_change = true;
  /// Several ranks that simulate the scene together, each a part of its bodies; null: this process alone.
  std::shared_ptr<Ranks> ranks = nullptr;
  RankCalls rank_calls = RankCalls::together;
};

/// Wall-clock time of the stages of one step [ms].
struct StageTimes {
  double collision = 0;  ///< bins, pairs, narrow phase, sort, warm-start matching
  double setup = 0;      ///< right-hand side, body-to-contact lists, solver data
  double solve = 0;
  double integrate = 0;
  double total = 0;
};

/// What one step did; which of it a model of dynamics fills in is in its card. Residuals are the natural map of solvers/residual.h.
struct StepReport {
  std::int64_t step = 0;  ///< number of steps done, this one included
  double time = 0;        ///< simulated time after the step [s]
  int body_count = 0;     ///< free bodies in the simulation
  std::int64_t contact_count = 0;
  int iterations = 0;            ///< solver iterations
  int applications = 0;          ///< operator applications (passes over contacts and bodies)
  bool converged = true;         ///< false: the iteration cap came first
  double residual_rms = 0;       ///< [m/s]
  double residual_max = 0;       ///< [m/s]
  int residual_max_body_a = -1;  ///< ids of the bodies of the worst contact, -1 without contacts
  int residual_max_body_b = -1;
  int residual_max_joint = -1;    ///< number in Scene::joints, -1: a contact is worst
  double residual_relative = 0;   ///< residual_rms / v*
  double exact_residual_rms = 0;  ///< the same with the De Saxce velocity [m/s]
  double objective = 0;           ///< 1/2 gamma N gamma + r gamma [J]
  double max_penetration = 0;     ///< deepest overlap at the start of the step [m]
  /// Farthest that anchors of a joint, or its axes at the size of a body, were apart at the start of
  /// the step [m].
  double max_joint_error = 0;
  int max_joint_error_joint = -1;  ///< number of that joint in Scene::joints, -1: none is off
  double max_cone_violation = 0;   ///< max(|gamma_t| - mu gamma_n) [N s]
  double kinetic_energy = 0;       ///< after the step [J]
  int stopped = 0;                 ///< bodies that were stopped at a box or mesh wall
  double max_turn = 0;      ///< largest turn of a body in the step, of models that bound it [rad]
  std::vector<double> own;  ///< quantities of the model, see Own in dynamics_card.h
  /// With several ranks: bodies of the fullest one over the mean, and ghosts over all free bodies.
  double largest_share = 1;
  double ghost_share = 0;
  StageTimes ms;
};

/// State of all bodies inserted so far, ordered by id. Rows without a body are not a number: of bodies that were removed
/// and, where bodies were added before them, of those of insertions to come.
struct BodyStates {
  std::vector<Vec3d> position;
  std::vector<Quatd> orientation;
  std::vector<Vec3d> velocity;
  std::vector<Vec3d> angular_velocity;   ///< world frame [rad/s]
  std::vector<std::vector<double>> own;  ///< quantities of the model, see Own in dynamics_card.h
  /// Of models whose bodies give way: the columns of A, where a point X of a body is at position + A X. Empty: bodies are rigid.
  std::vector<std::array<Vec3d, 3>> axes;
  /// Of bodies that bend, by id: where the vertices of their meshes are [m].
  std::map<int, std::vector<Vec3d>> bent;
};

/// One contact of the last step, for analysis; ids, not storage indices.
struct ContactRecord {
  int body_a = -1;
  int body_b = -1;
  Vec3d point;     ///< where it acts, with the bodies where they are now, world frame [m]
  Vec3d normal;    ///< unit, from A to B
  double gap = 0;  ///< at the start of the step [m]
  Vec3d impulse;   ///< world frame, acting on B [N s]
};

/// One joint in the last step, its impacts included.
struct JointRecord {
  int body_a = kWorldBody;  ///< ids, or kWorldBody, as in Joint::bodies
  int body_b = kWorldBody;
  Vec3d force;   ///< impulse at the anchor of B, world frame, acting on B [N s]
  Vec3d moment;  ///< about that anchor [N m s]
  /// Of body B against A since time zero, at the start of the step: angle of a hinge [rad], way of a
  /// slider or cylindrical joint [m]; of a ball joint with a swing that [rad]; length of a distance, cable or spring over its own [m]. Else 0.
  double position = 0;
  /// Angles of drives about axes, counted alike: of the `turn` of a cylindrical joint, of both axes of a universal one, of the twist of
  /// a ball joint. Where nothing drives one 0 [rad].
  double turn = 0, second_turn = 0;
  bool is_broken = false;  ///< since this step or an earlier one
};

struct ForceRecord {
  Vec3d force;   ///< [N]
  Vec3d torque;  ///< [N m]
};

/// What contacts and joints did, as means over steps; impacts are in them.
struct MeanForces {
  std::int64_t steps = 0;              ///< that the means are over; without any they are zero
  std::vector<int> bodies;             ///< ids of the fixed and kinematic bodies
  std::vector<ForceRecord> on_bodies;  ///< by contacts on these; torque about the body's position
  /// By contacts with bodies of other groups, in the order of Scene::groups; torque about the origin.
  std::vector<ForceRecord> on_groups;
  /// On body B of each joint, in the order of Scene::joints; torque about its anchor.
  std::vector<ForceRecord> on_joints;
};

/// A picture, 8-bit RGB, rows from the top.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgb;
};

struct BodyProblem;   // host/problems/body_problem.h
class Dynamics;       // dynamics/dynamics.h: implemented once, compiled per backend and precision
class OwnBodiesSink;  // host/own_bodies.h
class Roster;         // host/engine/roster.h

class World {
 public:
  /// @throws InputError when the scene is invalid or the backend is not there; std::runtime_error or std::bad_alloc when
  ///         memory cannot hold it
  World(Scene scene, const WorldOptions& options);
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;

  /// Advances by one time step. @throws RunError naming the body when a state is not finite
  StepReport step();
  /// The same, and hands out the contact problem that the step solves, its warm start included.
  /// @throws InputError in scenes with joints that are driven: limits, motors, friction, cables, springs
  StepReport step(BodyProblem& problem);

  /// Steps for so long [s], to the nearest number of steps, and calls after_step(report) after each one,
  /// which may call this World. It goes on while that returns true. @return the last report
  StepReport run(double seconds, const std::function<bool(const StepReport&)>& after_step = {});

  /// What users should know of the scene, a sentence each; behind that, of the steps so far.
  std::vector<std::string> warnings() const;

  std::int64_t steps_done() const;
  double time() const;
  int body_count() const;  ///< bodies in the simulation now: free, fixed and kinematic
  int id_end() const;      ///< ids of all bodies that were ever in it are below: rows of states()
  /// Whether a body is in the simulation now.
  bool has_body(int id) const;
  BodyStates states() const;
  /// states() without bringing them together: each rank gives its bodies to a sink of its own, rank 0 to this one, and the
  /// others to that of follow_worlds(), or with RankCalls::together to that of their call. begin_own_bodies() comes first.
  /// What fails on one rank is thrown on all. @param resumed_time  of the restored state [s]; not set: the run is new
  void begin_own_bodies(OwnBodiesSink& sink, std::optional<double> resumed_time);
  /// @return how many bodies each rank gave
  std::vector<std::int64_t> give_own_bodies(OwnBodiesSink& sink);
  /// Constants of all bodies, those that join later included; valid until add(), remove() and restore().
  const BodyConstants& constants() const;
  /// Contacts of the last step; none after overlaps(), restore(), add(), remove(),
  /// arrays_changed(Written::poses) and a step that failed; on several ranks none after save() and render() either, but
  /// in scenes with contact frames.
  std::vector<ContactRecord> contacts() const;
  /// What the joints of the scene carried in the last step, in its order. Rigid bodies tell of contacts and joints; other
  /// models of none.
  std::vector<JointRecord> joints() const;

  /// From now on steps sum up what take_forces() tells, and save() holds the sums. A step takes 12
  /// bytes a contact of memory for it, and copies the contacts of walls and between groups to the host.
  /// @throws InputError in models of dynamics that do not tell
  void track_forces();
  /// Means over the steps since track_forces(), or since the call before. @throws InputError without
  /// track_forces()
  MeanForces take_forces();

  /// By contacts in the last step, after track_forces(): on a fixed or kinematic body, torque about its position; on
  /// a group from bodies of others, torque about the origin. Zero before the first step. @throws InputError
  /// for a free body, unknown ones and without track_forces()
  ForceRecord force_on(int body) const;
  ForceRecord force_on_group(const std::string& name) const;

  /// Id of the body of that name, see Scene::body_names and add(). @throws InputError listing the names
  int body(const std::string& name) const;
  /// Index of a group of the scene. @throws InputError listing the names
  int group(const std::string& name) const;

  /// Adds a free body, which is there in the next step. Its material, group, mesh, hull or compound is one of the scene's
  /// (a mesh that none of its bodies has will do). Ids follow those of all bodies that the run can have, insertions to come
  /// included, and are never given twice, but after restore() of a state in which they were not given. Contacts, impulses and loads of the others stay, and so do tolerance, envelope
  /// and skin; views of arrays and constants() end. It takes about as long as making the World: give many at once to add_all().
  /// @param name  for body(); empty: none
  /// @return its id
  /// @throws InputError naming the body, the value and what was expected, also for shapes that could meet one without a
  ///         pair function; std::runtime_error or std::bad_alloc when memory cannot hold it; the World is then as it was
  int add(const BodyDescription& body, const std::string& name = {});
  /// The same for several. @param names  one for each, or none
  std::vector<int> add_all(const std::vector<BodyDescription>& bodies,
                           const std::vector<std::string>& names = {});
  /// Removes a free body with its name, contacts, impulses and loads. Ids of the others stay. Takes as long as add().
  /// @throws InputError naming the body: it is not there, not free, or named by a joint, be that broken; the World is then as it was
  void remove(int body);
  /// The same for several.
  void remove_all(const std::vector<int>& bodies);

  /// Gravity of the steps from now on [m/s^2]; save() holds it. @throws InputError
  void set_gravity(const Vec3d& gravity);
  /// Of a free body, along its free axes; or of a kinematic one, which has no other motion from now on.
  /// @param angular_velocity  world frame [rad/s]; of a kinematic one see set_motion()
  /// @throws InputError for fixed bodies, values out of range
  void set_velocity(int body, const Vec3d& velocity, const Vec3d& angular_velocity = {});
  /// A kinematic body goes on from where it is by this motion, whose times count from now on; save() holds it.
  /// It may turn in scenes where a free body is not a sphere, or a wall turns; a wall that fills a period, about that axis only.
  /// @throws InputError
  void set_motion(int body, const Motion& motion);
  /// Acts on a free body in the next step, along its free axes; those of several calls add up, and to the arrays
  /// "force" and "torque". Memory as for these. @param force  through the center of mass, world frame [N]
  /// @param torque  about it [N m]  @throws InputError
  void apply_force(int body, const Vec3d& force, const Vec3d& torque = {});

  /// Pairs of bodies that overlap where they are now, impulses left zero.
  std::vector<ContactRecord> overlaps() const;

  /// What array() knows in this scene: an array that no body of the scene needs is not there.
  std::vector<ArrayInfo> arrays() const;
  /// An array in backend memory, without a copy. Arrays of bodies have a row for each free body, in
  /// an order that changes from step to step: `id` says which body a row is. A view shows what is
  /// there until the next step(), overlaps(), add(), remove() or restore(); then ask again. Work of the World on a
  /// device is done when its calls return; what a program reads or writes must be done, or ordered
  /// before the work on the view's stream, when it makes the next call. A program may write
  ///   velocity, angular_velocity, position, orientation   between steps: arrays_changed() follows;
  ///   force, torque   at any time between steps: they act in every step until they are changed. A
  ///                   row for each id, which never moves; rows of bodies that are not free do
  ///                   nothing. From the first call on they cost 24 bytes a body in float, 48 more
  ///                   in a step, and a pass over bodies; checkpoints do not hold them.
  /// Arrays of contacts are those of the last step; without rows after overlaps(), restore() and
  /// arrays_changed(Written::poses).
  /// @throws InputError naming the arrays there are
  ArrayView array(const std::string& name);
  /// Takes over what a program wrote: checks it, and after poses brings positions back into the
  /// periodic box, orientations to unit length, and forgets near pairs, impulses for the warm start
  /// and the contacts of the last step, so that writing poses in every step costs speed.
  /// @throws InputError naming the first body in storage with values that are not finite or out of
  ///         range; they stay as written
  void arrays_changed(Written what);

  /// Bodies that were added or removed are in it.
  WorldState save() const;
  /// The bodies are those of the state then, whichever came or were removed since. Back over insertions, additions and removals
  /// it takes as long as making the World.
  /// @throws InputError when the state does not fit the scene
  void restore(const WorldState& state);

  Image render(const PictureSettings& settings) const;

  /// Whether another rank was asked to end, see follow_worlds(): rank 0 knows since its last call that all took part in.
  bool is_asked_to_end() const;

  /// Bytes held in backend memory now, and the most ever held.
  std::size_t memory() const;
  std::size_t peak_memory() const;

 private:
  void release() noexcept;
  BodyKind kind_of(int body) const;
  void require_changing_bodies(const char* call) const;
  /// Makes a run of other bodies and calls go_on(its dynamics, state of this run). When that fails, this run goes on.
  void become(std::unique_ptr<Roster> next,
              const std::function<void(Dynamics&, const WorldState&)>& go_on);

  /// What of the scene outlives it.
  struct Names {
    std::map<std::string, int> bodies;
    std::vector<std::string> groups;
    double time_step = 0;  ///< [s]
  };
  Names names_;
  WorldOptions options_;
  std::unique_ptr<Roster> roster_;  ///< null: bodies do not change
  std::size_t peak_before_ = 0;     ///< of runs of other bodies before this one [bytes]
  std::unique_ptr<Dynamics> dynamics_;
};

/// Takes part in the worlds that rank 0 makes of this scene, on the ranks above it; WorldOptions::ranks is theirs. Returns
/// after rank 0 called release_followers(). What fails here alone ends all ranks, see Ranks::abort().
/// @param sink  gets the bodies of this rank when rank 0 calls give_own_bodies(); null: it does not
/// @param asks_to_end  whether this rank was asked to end; rank 0 gets to know by World::is_asked_to_end(). Empty: never
void follow_worlds(const Scene& scene, const WorldOptions& options, OwnBodiesSink* sink = nullptr,
                   const std::function<bool()>& asks_to_end = {});

/// On rank 0: the others return from follow_worlds().
void release_followers(Ranks& ranks);

/// Whether this build and machine can run the backend on a device; the reason when they cannot,
/// which lists the devices when there is none of that number.
bool backend_available(BackendKind kind, std::string* reason = nullptr, int device = 0);

/// Devices of a backend on this machine: 1 for the CPU.
int device_count(BackendKind kind);

/// Name and memory of a device.
struct DeviceInfo {
  std::string name;
  std::size_t memory_bytes = 0;
  std::size_t free_bytes = 0;  ///< of them, that this process can still get
  int threads = 0;             ///< CPU threads or multiprocessors
};
DeviceInfo device_info(BackendKind kind, int device = 0);

/// CPU threads that a World of these options has, or multiprocessors of its GPU.
int threads_of(const WorldOptions& options);

/// @throws InputError when the solver does not run on the backend, or does not know
///         the contacts of the scene
void require_solver(const Scene& scene, const WorldOptions& options);

/// @throws InputError saying how many bodies fit when the scene is expected to need more memory
///         than is free on the device, or than the limit of the options
void require_memory(const Scene& scene, const WorldOptions& options);

/// Bodies like those of a scene that fit, about; the list of near pairs not kept.
double bodies_that_fit(const Scene& scene, const WorldOptions& options);

/// Backend memory a scene is expected to need at its fullest [bytes].
std::size_t expected_memory(const Scene& scene, const WorldOptions& options);

}  // namespace scree
