#pragma once
// One rigid body among fixed surfaces, without friction, as rigid-ipc steps it: true rotations, implicit Euler, all pairs of
// corners, edges and triangles. It shares no code with the dynamics "affine", which it is to be held against.

#include <Eigen/Geometry>
#include <array>
#include <vector>

namespace scree::spatial {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

struct TriangleSurface {
  std::vector<Vec3> corners;
  std::vector<std::array<int, 2>> edges;
  std::vector<std::array<int, 3>> triangles;
};

struct FallingSettings {
  double h = 0.01;
  Vec3 gravity{0, 0, -9.81};
  double reach = 1e-3;
  double stiffness = 0;     ///< of the barrier [J/m^4]
  double tolerance = 1e-9;  ///< way of a corner in the last Newton step [m]
};

/// Whose force at half the reach moves a mass by the reach in a step, so many times.
double inertial_stiffness(const FallingSettings& settings, double mass, double times);

class RigidAmongFixed {
 public:
  /// @param own     about the center of mass. @param second  integral of the density times x x^T
  /// @param others  in the world
  RigidAmongFixed(const FallingSettings& settings, TriangleSurface own, double mass,
                  const Mat3& second, const Vec3& center, TriangleSurface others);

  const Vec3& center() const { return center_; }
  const Mat3& rotation() const { return rotation_; }  ///< since the start
  int iterations() const { return iterations_; }      ///< Newton steps of all steps
  /// Advances by h. @throws std::runtime_error where Newton's method does not end
  void step();

 private:
  struct State {
    Vec3 center;
    Mat3 rotation;
  };
  using Six = Eigen::Matrix<double, 6, 1>;  ///< way of the center, then turn
  using SixSix = Eigen::Matrix<double, 6, 6>;
  /// A corner and a triangle, or two edges: numbers of corners, of which `split` are of A.
  struct Pair {
    std::array<int, 4> corner{};
    bool is_edges = false;
    bool first_is_own = true;
    double apart = 0;  ///< where they were listed
  };
  struct Nearest;

  static State moved(const State& at, const Six& way);
  Nearest nearest(const State& at, const Pair& pair) const;
  Six barrier_gradient(const State& at, const Pair& pair) const;
  SixSix barrier_hessian(const State& at, const Pair& pair) const;
  double energy(const State& at) const;
  double free_share(const State& at, const Six& way) const;
  double largest_way(const Six& way) const;
  /// Lists the pairs that are nearer than that, for ways of corners so long in all that none of others comes within reach.
  void gather(const State& at, double margin);
  template <class F>
  void for_pairs(double distance, F f) const;

  FallingSettings settings_;
  TriangleSurface own_, others_;
  double mass_;
  Mat3 second_;
  double radius_ = 0;
  Vec3 center_, velocity_{0, 0, 0};
  Mat3 rotation_ = Mat3::Identity(), turning_ = Mat3::Zero();
  Vec3 goal_;
  Mat3 goal_rotation_;
  std::vector<Pair> pairs_;  ///< near ones, the nearest first
  double went_ = 0;          ///< most that a corner went since they were listed
  int iterations_ = 0;
};

}  // namespace scree::spatial
