#pragma once
// Contact problems written densely from the equations, and solved to rounding by an interior-point
// method. Shares no code with kernels/: a mistake there cannot be repeated here by inclusion.

#include <Eigen/Dense>
#include <vector>

namespace scree::oracle {

/// Inverse mass matrix and rates of a body, world frame. A fixed body has zero inverse
/// mass and inertia.
struct Body {
  Eigen::Vector3d inv_mass = Eigen::Vector3d::Zero();          ///< per axis [1/kg]
  Eigen::Matrix3d inv_inertia = Eigen::Matrix3d::Zero();       ///< [1/(kg m^2)]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          ///< v* [m/s]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< [rad/s]
};

/// Rows n, t1, t2 and, with moments, the same three of the moment impulse divided by `length`.
struct Contact {
  int a = 0;
  int b = 0;
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  ///< unit, from A to B
  Eigen::Vector3d arm_a = Eigen::Vector3d::Zero();    ///< [m]
  Eigen::Vector3d arm_b = Eigen::Vector3d::Zero();
  double mu = 0;
  double bias = 0;      ///< [m/s]
  double adhesion = 0;  ///< [N s]
  double length = 1;    ///< [m]
  double rolling = 0;   ///< |m_t| <= rolling * (gamma_n + adhesion)
  double spinning = 0;  ///< |m_n| <= spinning * (gamma_n + adhesion)
};

struct Problem {
  bool has_moments = false;
  int free_count = 0;
  std::vector<Body> bodies;
  std::vector<Contact> contacts;

  int rows_per_contact() const { return has_moments ? 6 : 3; }
  int rows() const { return rows_per_contact() * static_cast<int>(contacts.size()); }
};

/// Columns n, t1, t2 of a contact's frame.
Eigen::Matrix3d contact_frame(const Eigen::Vector3d& normal);

/// J [rows x 6 bodies]: contact velocity of B against A from body twists (v, w).
Eigen::MatrixXd jacobian(const Problem& p);
/// M^-1 [6 bodies x 6 bodies].
Eigen::MatrixXd inverse_mass(const Problem& p);
/// N = J M^-1 J^T [1/kg].
Eigen::MatrixXd delassus(const Problem& p);
/// r = J v* + bias [m/s].
Eigen::VectorXd right_side(const Problem& p);
/// v* of all bodies, (v, w) by turns.
Eigen::VectorXd free_velocity(const Problem& p);

/// World vectors (force, then moment when there are moments) of every contact to rows, and back.
Eigen::VectorXd rows_from_world(const Problem& p, const std::vector<Eigen::Vector3d>& vectors);
std::vector<Eigen::Vector3d> world_from_rows(const Problem& p, const Eigen::VectorXd& rows);

/// Nearest point of the product of cones, Euclidean.
Eigen::VectorXd project(const Problem& p, const Eigen::VectorXd& x);

struct Residual {
  double rms = 0;        ///< natural map, rho = 3 / trace of the three force rows [m/s]
  double exact_rms = 0;  ///< with the De Saxce velocity
};
Residual residual(const Problem& p, const Eigen::VectorXd& gamma);

double objective(const Problem& p, const Eigen::VectorXd& gamma);

struct Solution {
  Eigen::VectorXd gamma;  ///< rows [N s]
  double objective = 0;   ///< [J]
  double rms = 0;         ///< natural map [m/s]
  double exact_rms = 0;   ///< De Saxce [m/s]
  int iterations = 0;
};

/// Minimizer of 1/2 gamma^T N gamma + r^T gamma over the cones. Primal-dual interior point with
/// Nesterov-Todd scaling and a predictor-corrector step (Vandenberghe, "The CVXOPT linear
/// and quadratic cone program solvers", 2010), then Gauss-Seidel sweeps to a residual of about
/// 1e-13 m/s. N may be singular.
Solution solve_convex(const Problem& p);

/// Coulomb's law: the De Saxce fixed point around solve_convex, to `tolerance` in the shift [m/s].
Solution solve_coulomb(Problem p, double tolerance = 1e-13, int max_iterations = 400);

}  // namespace scree::oracle
