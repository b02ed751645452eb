#pragma once
// What is simulated: bodies, walls, materials and parameters. A Scene is plain data with SI units;
// the scene reader fills it from a file, tests and programs fill it by hand.
// validate() checks all of it.

#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "kernels/math/quat.h"
#include "kernels/math/vec3.h"
#include "shapes/shape.h"

namespace scree {

using Quatd = Quat<double>;

/// Contact law parameters of one material, or of one pair of materials.
struct Material {
  std::string name = "default";
  double friction = 0.5;           ///< Coulomb mu [-], >= 0
  double restitution = 0.0;        ///< Newton e [-], 0 to 1
  double cohesion = 0.0;           ///< largest pulling force of one contact [N], >= 0
  double rolling_friction = 0.0;   ///< rolling coefficient, a length [m], >= 0
  double spinning_friction = 0.0;  ///< spinning coefficient, a length [m], >= 0
};

/// Values that replace the default mix (geometric mean of friction, smaller of the others)
/// for a pair.
struct MaterialPair {
  int material_a = 0;
  int material_b = 0;
  Material values;
};

/// A body keeps the number of its material in 8 bits.
inline constexpr std::size_t kMostMaterials = 256;

/// Prescribed motion of a kinematic body: pose and velocity as functions of time.
struct Motion {
  enum class Kind { none, linear, rotating, oscillating, sampled };
  Kind kind = Kind::none;
  Vec3d velocity;  ///< linear: constant velocity [m/s]
  Vec3d
      angular_velocity;  ///< linear: about the position of the body, constant, world frame [rad/s]
  Vec3d axis{0, 0, 1};   ///< rotating: unit axis; oscillating: unit direction
  Vec3d center;          ///< rotating: a point on the axis [m]
  double rate = 0;       ///< rotating: angular velocity [rad/s]
  double amplitude = 0;  ///< oscillating: amplitude [m]
  double frequency = 0;  ///< oscillating: frequency [Hz]
  double phase = 0;      ///< oscillating: phase [rad]
  double start = 0;      ///< time before which the body rests [s]
  double stop = std::numeric_limits<double>::infinity();  ///< time after which it rests [s]
  std::vector<double> times;                              ///< sampled: increasing times [s]
  std::vector<Vec3d> positions;     ///< sampled: displacement from the initial position [m]
  std::vector<Quatd> orientations;  ///< sampled: rotation applied to the initial pose, may be empty
};

/// A value that few of very many owners have: kept elsewhere, a shared default where
/// it was never set.
template <class T>
class Rare {
 public:
  Rare() = default;
  Rare(T value) : value_(std::make_shared<const T>(std::move(value))) {}
  operator const T&() const { return **this; }
  const T& operator*() const {
    static const T absent{};
    return value_ ? *value_ : absent;
  }
  const T* operator->() const { return &**this; }

 private:
  std::shared_ptr<const T> value_;
};

enum class BodyKind : std::uint8_t { free, fixed, kinematic };

/// Locked degrees of freedom, world axes: bits of BodyDescription::locks.
enum Lock : std::uint8_t {
  lock_x = 1,
  lock_y = 2,
  lock_z = 4,
  lock_rx = 8,
  lock_ry = 16,
  lock_rz = 32,
  lock_rotation = lock_rx | lock_ry | lock_rz,
  lock_all = 63
};

/// Acts on a free body all the time.
struct Load {
  Vec3d force;   ///< at the center of mass [N]
  Vec3d torque;  ///< about it, world axes [N m]
};

/// Of a free body that bends and stretches, whose mesh has tetrahedra.
struct Elasticity {
  double young_modulus = 0;    ///< [Pa], > 0; 0: the body is not elastic
  double poisson_ratio = 0.3;  ///< [-], 0 <= nu < 0.5

  bool is_on() const { return young_modulus != 0; }
};

/// A body that may touch all others.
inline constexpr int kNoCollisionGroup = -1;
/// Of bodies that are not free and name no other; other groups are below it.
inline constexpr int kRestingGroup = 1 << 30;

/// One body as it enters the simulation.
struct BodyDescription {
  BodyKind kind = BodyKind::free;
  Shape shape;             ///< its kind is one of shape_cards()
  Vec3d position;          ///< center of mass, world [m]
  Quatd orientation;       ///< body to world
  Vec3d velocity;          ///< [m/s]
  Vec3d angular_velocity;  ///< world frame [rad/s]
  double mass = 0;         ///< [kg], > 0 for free bodies
  Vec3d inertia;           ///< principal moments, body frame [kg m^2], > 0 for free bodies
  int material = 0;        ///< index into Scene::materials
  int group = 0;           ///< index into Scene::groups; colors pictures, names outputs
  std::uint8_t locks = 0;  ///< Lock bits
  int collision_group = kNoCollisionGroup;  ///< bodies of the same one do not touch
  Rare<Motion> motion;                      ///< kinematic bodies only
  Rare<Load> load;                          ///< free bodies only
  Rare<Elasticity> elastic;                 ///< free bodies with a mesh of their own only
  int entry = -1;  ///< number in the list `bodies` of the scene file, for messages
};

/// A property of many particles: one value for all of them, or one for each.
/// Copies share the values.
template <class T>
class PerParticle {
 public:
  PerParticle(T same = T{}) : same_(same) {}
  explicit PerParticle(std::vector<T> values)
      : values_(std::make_shared<const std::vector<T>>(std::move(values))) {}

  bool uniform() const { return values_ == nullptr; }
  const T& operator[](std::size_t i) const { return values_ ? (*values_)[i] : same_; }
  /// Whether there is a value for each of so many particles.
  bool fits(std::size_t count) const { return !values_ || values_->size() == count; }

 private:
  T same_{};
  std::shared_ptr<const std::vector<T>> values_;
};

/// Many free bodies. Runs of hundreds of millions of spheres are described this way, so what
/// particles have in common is stored once.
struct ParticleSet {
  std::vector<Vec3d> position;          ///< centers, world [m]; gives the number of particles
  PerParticle<double> radius;           ///< of spheres, else of bounding spheres [m]
  PerParticle<Shape> shape;             ///< of kind kNoShape: a sphere of that radius
  PerParticle<double> density;          ///< [kg/m^3]; not used where the mass is given
  PerParticle<double> mass;             ///< [kg]; 0: from the density
  PerParticle<Quatd> orientation;       ///< body to world
  PerParticle<Vec3d> velocity;          ///< [m/s]
  PerParticle<Vec3d> angular_velocity;  ///< world frame [rad/s]
  PerParticle<int> material;            ///< index into Scene::materials
  PerParticle<int> group;               ///< index into Scene::groups
  std::uint8_t locks = 0;               ///< Lock bits
  int entry = -1;  ///< number in the list `particles` of the scene file, for messages
};

/// Bodies that join a run when their time has come (rain).
struct Insertion {
  double time = 0;  ///< [s]; the batch enters before the first step that starts at or after it
  std::vector<BodyDescription> bodies = {};  ///< free bodies only
  std::vector<ParticleSet> particles = {};
};

/// What a step is.
struct DynamicsSettings {
  std::string type = "rigid";  ///< one of dynamics_names()
  /// Values of parameters of the model by key, of choices their number; those that are missing
  /// have their default.
  std::map<std::string, double> parameters = {};
};

/// In place of a body of a joint: the world, which rests.
inline constexpr int kWorldBody = -1;

/// What a joint leaves free, or holds.
enum class JointKind : std::uint8_t {
  hinge,        ///< turning about its axis
  ball,         ///< turning
  fixed,        ///< nothing
  slider,       ///< moving along its axis
  cylindrical,  ///< moving along its axis and turning about it
  universal,    ///< turning about two axes, one of each body, at a right angle
  distance,     ///< holds the distance of two points: a rod without mass
  cable,        ///< the same, where they are not nearer
  spring        ///< pulls two points to a distance, and damps
};

/// Drives a joint along or about its axis. With `force` it gives that, less damping times the speed; else
/// with stiffness or damping it is a spring and damper that pulls to `position`; else it keeps `speed`.
struct JointMotor {
  double speed = 0;      ///< of the second body against the first [rad/s or m/s]
  double position = 0;   ///< from that at time zero [rad or m]
  double stiffness = 0;  ///< [N m/rad or N/m], >= 0
  double damping = 0;    ///< [N m s/rad or N s/m], >= 0
  /// Most that it gives [N m or N], > 0.
  double max_force = std::numeric_limits<double>::infinity();
  /// On the second body, of either sign [N m or N]; then it has no speed, position, stiffness and largest force.
  std::optional<double> force{};

  bool keeps_speed() const { return !force && stiffness == 0 && damping == 0; }
  /// Most that it gives beside `force` [N m or N].
  double most_beside_force() const { return force && damping == 0 ? 0 : max_force; }
};

/// What acts along or about the axis of a joint.
struct AxisDrive {
  /// Least and largest angle [rad] or way [m] of the second body from time zero.
  std::array<double, 2> limits{-std::numeric_limits<double>::infinity(),
                               std::numeric_limits<double>::infinity()};
  std::optional<JointMotor> motor{};
  double friction = 0;  ///< moment [N m] or force [N] that keeps it at rest, >= 0
};

/// Holds two bodies together. They do not touch each other.
struct Joint {
  JointKind kind = JointKind::hinge;
  /// Ids of two of Scene::bodies, of which one or both are free; or kWorldBody in place of one.
  std::array<int, 2> bodies{kWorldBody, 0};
  /// Point of both bodies at time zero, world [m]; distance, cable, spring: of the first one.
  Vec3d anchor;
  /// Unit, world, at time zero; universal: that of the cross in the first body; ball: what `swing`, `limits` and `motor` are about.
  Vec3d axis{0, 0, 1};
  Vec3d second_anchor{};       ///< distance, cable, spring: point of the second body [m]
  Vec3d second_axis{1, 0, 0};  ///< universal: in the second body, unit, at a right angle to `axis`
  /// Distance, cable, spring: of the two points, longest, at rest [m]; negative: that at time zero.
  double length = -1;
  /// Hinge, slider, cylindrical: least and largest angle [rad] or way [m] of the second body from time zero; ball, universal: about
  /// `axis`. The angle about the axis of a ball joint, its twist, is that of what is left of the rotation without its swing.
  std::array<double, 2> limits{-std::numeric_limits<double>::infinity(),
                               std::numeric_limits<double>::infinity()};
  std::optional<JointMotor> motor{};  ///< of these
  /// Of these: moment [N m] or force [N] that keeps it at rest, >= 0; ball: against turning in any direction.
  double friction = 0;
  double stiffness = 0;  ///< spring [N/m], >= 0
  double damping = 0;    ///< spring [N s/m], >= 0
  /// A joint that carried more than one of these in a step is no more in those after it [N], [N m], > 0.
  double break_force = std::numeric_limits<double>::infinity();
  double break_moment = std::numeric_limits<double>::infinity();
  AxisDrive turn{};  ///< cylindrical: about its axis, while limits, motor and friction act along it
  AxisDrive second_turn{};  ///< universal: about `second_axis`, while these act about `axis`
  /// Ball: largest angle between `axis` in the first body and `swing_axis` in the second [rad], > 0.
  double swing = std::numeric_limits<double>::infinity();
  std::optional<Vec3d> swing_axis{};  ///< at time zero, unit, world; without it `axis`

  /// Limits, motor and friction.
  AxisDrive drive() const { return {limits, motor, friction}; }
};

/// Corners of an elastic body that another body carries, or that stay where they are.
struct Attachment {
  int body = 0;         ///< elastic: index in Scene::bodies
  int to = kWorldBody;  ///< index of one that is not elastic, or kWorldBody
  Vec3d low, high;      ///< corners within this box at time zero, world [m]

  /// Whether a corner that is there at time zero is one of them.
  bool holds(const Vec3d& corner) const {
    return corner.x >= low.x && corner.x <= high.x && corner.y >= low.y && corner.y <= high.y &&
           corner.z >= low.z && corner.z <= high.z;
  }
};

/// When a solver stops. Levels are those of the theory page: relative to v* and to d/h.
struct StopRule {
  enum class Level { quality, preview, absolute, fixed_iterations };
  Level level = Level::quality;
  double residual = 0;  ///< absolute: RMS natural-map residual [m/s], > 0
};

struct SolverSettings {
  std::string name = "apgd";  ///< one of solver_names()
  StopRule stop;
  int max_iterations = 400;  ///< [-], > 0
  int check_every = 10;      ///< most iterations between residual checks, > 0
  bool warm_start = true;
  bool exact_coulomb = false;     ///< De Saxce fixed point around the convex solve
  int max_outer_iterations = 50;  ///< exact Coulomb: fixed point iterations, > 0
  /// Values of parameters of solver_parameters() by key, of choices their number; those that are
  /// missing have their default.
  std::map<std::string, double> parameters = {};
};

/// How contacts bounce. docs/theory.md, section "Impacts".
enum class RestitutionLaw : std::uint8_t {
  poisson,  ///< impacts come before the loads, one after the other; none adds energy
  newton    ///< a bias of the one contact problem of a step
};

struct SteppingSettings {
  double time_step = 1e-3;          ///< h [s], > 0
  double duration = 1.0;            ///< [s], >= 0
  double max_recovery_speed = 0.5;  ///< fastest push-out of an overlap [m/s], >= 0
  RestitutionLaw restitution_law = RestitutionLaw::poisson;
  double restitution_threshold = 1e-2;  ///< approach speed below which e = 0 [m/s], >= 0
  /// Contacts are listed up to this gap [m]; negative: 1 % of the median diameter.
  double envelope = -1;
  double skin = -1;  ///< how far bodies move, about, until near pairs are listed again [m]; changes
                     ///< speed only; negative: 10 % of the median diameter
};

struct CameraSettings {
  Vec3d position{3, -3, 2};
  Vec3d target{0, 0, 0};
  Vec3d up{0, 0, 1};
  double vertical_angle = 35;  ///< field of view [deg], in (0, 170)
  bool automatic = true;       ///< frame all bodies; above only `up` and the angle count then
};

enum class ColorBy { speed, size, id, group };

struct PictureSettings {
  double interval = 0;  ///< simulated time between pictures [s]; 0: one at the end; negative: none
  int width = 1280;     ///< [pixels], 16 to 16384
  int height = 720;
  ColorBy color_by = ColorBy::speed;
  double color_min = 0;  ///< value at the low end of the color map; equal ends: automatic range
  double color_max = 0;
  bool labels = true;  ///< the time, and a color bar where colors show a value
  CameraSettings camera;
};

struct OutputSettings {
  /// Simulated time between frames in frames.vtkhdf [s]; 0: first and last.
  double frame_interval = 0;
  /// Whether each rank writes the frames of its own bodies, to frames_0.vtkhdf and so on, and frames.vtkhdf brings them
  /// together.
  bool frame_pieces = false;
  double checkpoint_interval = 0;  ///< [s]; 0: at the end (and on an interrupt) only
  bool contact_frames = false;     ///< the contacts at the times of the frames, in contacts.vtkhdf
  bool surface_frames = false;  ///< surfaces of the other bodies at those times, in surfaces.vtkhdf
  /// Simulated time that each line of forces.csv is the mean over [s]; 0: no such file.
  double force_interval = 0;
  PictureSettings picture;
};

/// Periodic box: axes with periodic[k] repeat with period upper[k] - lower[k].
struct Periodicity {
  std::array<bool, 3> periodic{false, false, false};
  Vec3d lower;
  Vec3d upper;
};

/// Ids number the bodies from zero: Scene::bodies, the particles of Scene::particles set by set,
/// then in the same way the bodies and particles of each insertion.
struct Scene {
  std::string name = "scene";
  Vec3d gravity{0, 0, -9.81};  ///< [m/s^2]
  std::uint64_t seed = 1;
  std::vector<Material> materials{Material{}};
  std::vector<MaterialPair> material_pairs;
  std::vector<std::string> groups{"bodies"};
  std::vector<TriangleMesh> meshes;
  std::vector<BodyDescription> bodies;  ///< present at time zero, any kind and order
  /// Names that some of the bodies have, those of insertions included, and their ids.
  std::map<std::string, int> body_names;
  std::vector<ParticleSet> particles;   ///< present at time zero
  std::vector<Insertion> insertions;    ///< increasing times
  std::vector<Joint> joints;            ///< of `bodies`, from time zero
  std::vector<Attachment> attachments;  ///< of elastic ones of `bodies`
  Periodicity periodicity;
  DynamicsSettings dynamics;
  SteppingSettings stepping;
  SolverSettings solver;
  OutputSettings output;
  std::string backend = "auto";     ///< auto, cpu or cuda; the command line overrides
  std::string precision = "float";  ///< float or double; the command line overrides
};

/// A value outside its range, an unknown name or an impossible combination; what() names the key
/// path, the value and what was expected.
class InputError;

/// Checks every field of the scene. @throws InputError at the first fault.
void validate(const Scene& scene);

/// Mass and principal moments of a solid of the given density [kg/m^3].
/// @throws InputError for shapes that have no mass
void set_mass_from_density(BodyDescription& body, double density);

/// Shape of one particle of a set; a sphere has its radius.
Shape particle_shape(const ParticleSet& set, std::size_t i);
/// One particle of a set as a body of its own.
BodyDescription particle_body(const ParticleSet& set, std::size_t i);
/// Its mass alone [kg].
double particle_mass(const ParticleSet& set, std::size_t i);

/// Contact values for a pair of materials: the listed pair, else geometric mean of friction and the
/// smaller of the other values.
Material pair_values(const Scene& scene, int material_a, int material_b);
/// The same for all pairs: that of a and b at a * scene.materials.size() + b.
std::vector<Material> all_pair_values(const Scene& scene);

}  // namespace scree
