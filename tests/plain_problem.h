#pragma once
// Contact problems as plain arrays of doubles, for the dense oracle. Their makers
// are compiled once.

#include <vector>

#include "kernels/contact/contact_problem.h"
#include "tests/reference/dense_oracle.h"

namespace scree::fixtures {

/// A problem in double. Of radial contacts the arms are +radius[a] * n and -radius[b] * n, inertias
/// are isotropic and fixed bodies do not rotate.
struct PlainProblem {
  ContactLayout layout = ContactLayout::radial;
  oracle::Problem data;
  std::vector<double> radius;            ///< [m] per body
  std::vector<double> mass;              ///< [kg] per body
  std::vector<Eigen::Matrix3d> inertia;  ///< [kg m^2] per body, not in the radial layout
  std::vector<bool> is_sphere;           ///< per body: free and made by add_sphere()
  int radial_count = 0;                  ///< mixed layout: so many contacts come first

  Index contact_count() const { return static_cast<Index>(data.contacts.size()); }

  /// Adds a sphere (or, with spin_factor 0, a block that does not turn).
  /// @param spin_factor  r^2 m / I: 2.5 for a solid sphere
  int add_sphere(double m, double r, double spin_factor = 2.5);
  int add_general(double m, const Eigen::Matrix3d& body_inertia);
  int add_fixed();

  /// A contact whose arms lie along the normal, as in the radial layout.
  oracle::Contact& add_radial_contact(int a, int b, const Eigen::Vector3d& n, double mu);

 private:
  int add(const oracle::Body& body, double m, double r, const Eigen::Matrix3d& body_inertia,
          bool sphere);
};

struct RandomProblem {
  ContactLayout layout = ContactLayout::radial;
  int free_count = 10;
  int fixed_count = 2;
  int contact_count = 20;
  unsigned seed = 1;
  bool has_adhesion = false;
  double mu_max = 1.0;
  int hub_contacts = 0;       ///< so many of them are with one free body
  bool only_spheres = false;  ///< mixed layout: general contacts are with fixed bodies that turn
};

/// Random bodies and contacts. A velocity strictly inside all dual cones exists by construction, so
/// the minimum is finite; v* is pushed away from it, so that many contacts are active.
PlainProblem random_problem(const RandomProblem& options);

/// Spheres on a face-centered lattice of 4 n^3 sites; a share of the neighbors touches.
PlainProblem lattice_problem(int n, double share, unsigned seed);

/// Rounds every number to Real, so that oracle and solver see the same problem.
template <class Real>
void round_to(PlainProblem& p);

}  // namespace scree::fixtures
