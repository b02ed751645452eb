#pragma once
// Affine bodies with barrier contact, stepped by minimizing their incremental potential: few bodies,
// on the host, every matrix assembled and factorized. It is the reference that faster steps are
// measured against. docs/theory.md, "Affine bodies" and "Barrier contact".

#include <memory>
#include <vector>

#include "dynamics/affine/surface.h"
#include "kernels/affine/barrier.h"
#include "kernels/affine/inertial_target.h"

namespace scree::affine {

/// A body with its state.
struct AffineBody {
  std::shared_ptr<const Surface> surface;
  AffineMass mass;
  double stiffness = 0;  ///< kappa times the volume [J]
  AffineVec position;    ///< q: center of mass and columns of A
  AffineVec velocity;
  Vec3d force;   ///< at the center of mass [N]
  Vec3d torque;  ///< world axes [N m]
  bool fixed = false;
};

/// A rigid pose and motion as affine coordinates.
void set_pose(AffineBody& body, const Vec3d& center, const Quat<double>& turn);
void set_motion(AffineBody& body, const Vec3d& velocity, const Vec3d& angular_velocity);

/// Momentum of the turn about the center of mass [kg m^2/s], world axes.
Vec3d angular_momentum(const AffineBody& body);
double kinetic_energy(const AffineBody& body);

/// A point of a body that stays on a point of another body or of the world: three linear equations,
/// which steps meet to rounding. Two such points make a hinge, three or four fix a body.
struct PointJoint {
  std::size_t body = 0;
  Vec3d rest;        ///< in coordinates of the body, about its center of mass [m]
  int other = -1;    ///< the other body; -1: the world
  Vec3d other_rest;  ///< in its coordinates [m]
};

struct AffineSettings {
  double h = 0.01;             ///< time step [s], > 0
  Vec3d gravity{0, 0, -9.81};  ///< [m/s^2]
  StepRule rule = StepRule::bdf2;
  Barrier barrier;
  double mu = 0;             ///< friction coefficient of all contacts [-], >= 0
  double slip_speed = 1e-3;  ///< below which contacts count as sticking [m/s], > 0
  int friction_solves = 1;   ///< minimizations a step, each with the friction of the one before
  double tolerance = 1e-3;   ///< largest speed of a corner in a Newton step that ends it [m/s], > 0
  int most_iterations = 200;  ///< of a minimization
};

/// @throws InvalidParameter naming the setting and its value
void validate(const AffineSettings& settings);

struct AffineReport {
  int iterations = 0;     ///< Newton steps of all minimizations
  double residual = 0;    ///< what the last one would have moved a corner by, over h [m/s]
  bool converged = true;  ///< whether that is below the tolerance, in every minimization
  int contacts = 0;       ///< pairs of corners, edges and triangles within reach, at the end
  double gap = 0;  ///< smallest distance of two bodies at the end [m], at most twice the reach
  /// What the other places have of the potential above the end, see step() [J times the scale of the step]
  double above = 0;
};

class AffineSystem {
 public:
  /// @throws InvalidParameter as validate() does
  explicit AffineSystem(const AffineSettings& settings);

  /// @return its number. @throws InvalidParameter for a body without surface, mass or stiffness
  std::size_t add(AffineBody body);
  /// @throws InvalidParameter for a joint of bodies that there are not, or that are both fixed; whose
  /// points are apart; or whose equations say again, or against, what those of other joints say
  void add(const PointJoint& joint);
  std::vector<AffineBody>& bodies() { return bodies_; }
  const std::vector<AffineBody>& bodies() const { return bodies_; }

  /// Advances all bodies by h. Bodies that do not touch at the start never do.
  /// @param other  places, by body, that the end is compared with: a potential has many minima. Empty: none
  AffineReport step(const std::vector<AffineVec>& other = {});

 private:
  struct Impl;
  /// Gives bodies within reach of each other, or that joints hold together, the lower of their labels, and so on.
  /// @param is_held  marks those that a fixed body or the world touches or holds
  void join(std::vector<std::size_t>& label, std::vector<bool>& is_held,
            const std::vector<AffineVec>& q) const;
  AffineSettings settings_;
  std::vector<AffineBody> bodies_;
  std::vector<PointJoint> joints_;
  std::vector<AffineVec> earlier_position_, earlier_velocity_;  ///< of bdf2, once there are
};

}  // namespace scree::affine
