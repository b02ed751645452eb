#pragma once
// Rigid bodies in a plane with barrier contact and lagged friction, as rigid-ipc steps them (Ferguson et al., Intersection-free
// Rigid Body Dynamics, ACM TOG 40(4), 2021): true rotations, implicit Euler, dense. It shares no code with the dynamics "affine",
// which it is to be held against: own distances, own derivatives, own line search.

#include <Eigen/Geometry>
#include <vector>

namespace scree::planar {

using Vec2 = Eigen::Vector2d;

/// Outlines are loops of corners about the center of mass. Only their corners and edges touch.
struct RigidBody {
  std::vector<std::vector<Vec2>> loops;
  double mass = 0;     ///< [kg]
  double inertia = 0;  ///< about the center [kg m^2]
  Vec2 center{0, 0};
  double angle = 0;
  Vec2 velocity{0, 0};
  Vec2 turn{0, 0};  ///< rate of (cos, sin) of the angle, as differences over a step have it [1/s]
  bool fixed = false;
};

struct RigidSettings {
  double h = 0.01;
  Vec2 gravity{0, -9.81};
  double reach = 1e-3;
  double stiffness = 0;  ///< of the barrier [J/m^4]
  double mu = 0;
  double slip_speed = 1e-3;  ///< below which contacts stick [m/s]
  int friction_solves =
      0;  ///< minimizations a step, each with the friction of the one before; 0: until it does not change
  double tolerance = 1e-9;  ///< way of a corner in the last Newton step [m]
};

/// Whose force at half the reach moves a mass by the reach in a step, so many times.
double inertial_stiffness(const RigidSettings& settings, double mass, double times);

class RigidSystem {
 public:
  RigidSystem(const RigidSettings& settings, std::vector<RigidBody> bodies)
      : settings_(settings), bodies_(std::move(bodies)) {}

  const std::vector<RigidBody>& bodies() const { return bodies_; }
  /// Advances all bodies by h. @throws std::runtime_error where Newton's method does not end
  void step();

 private:
  /// A corner of one body beside an edge of another.
  struct Beside {
    std::size_t body = 0, other = 0;
    Vec2 corner, from, to;  ///< in coordinates of their bodies
  };
  /// With the normal force and the place on the edge of an earlier state.
  struct Rubbing {
    Beside pair;
    double share = 0, force = 0;
    Vec2 along;
  };
  using State = Eigen::VectorXd;  ///< center and angle of each body

  std::vector<Beside> near(const State& q, double distance) const;
  bool crosses(const State& q) const;
  std::vector<Rubbing> rubbing(const State& q) const;
  double energy(const State& q, const std::vector<Rubbing>& rubs) const;
  void derivatives(const State& q, const std::vector<Rubbing>& rubs, Eigen::VectorXd& gradient,
                   Eigen::MatrixXd& hessian) const;
  void minimize(State& q, const std::vector<Rubbing>& rubs) const;
  double largest_way(const Eigen::VectorXd& step) const;

  RigidSettings settings_;
  std::vector<RigidBody> bodies_;
  State start_;  ///< of the step
};

}  // namespace scree::planar
