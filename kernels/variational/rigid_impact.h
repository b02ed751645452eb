#pragma once
// The impact of two rigid bodies, or of a body and a wall, at one or several points, without friction.
//
// Each point has a gap g_k, whose gradient by the places of both bodies is (-n, -r_a x n, n, r_b x n). In the metric of the
// inverse masses, the momentum P has the projection -d on the cone of the -grad g_k of points that approach: d = sum beta_k grad g_k,
// beta >= 0, is the least one that leaves none of them approaching (Moreau). The impact adds lambda d; lambda = 2 keeps p . M^-1 p.
// The discrete energy of a body in a part of a step of length h that begins or ends with the momentum p is, without the
// potential of this place, p^2 / (2 m) - m g^2 h^2 / 8 and its spin energy: the quadrature of the potential of gravity g is
// Verlet's, and the rotation is the flow. So the energy equation of the impact (Fetecau, Marsden, Ortiz, West, SIAM J. Appl. Dyn.
// Syst. 2 (2003)), E_d(P + lambda d, T) = E with what the part before had and the rest T of the step, is quadratic:
//
//     (V4) lambda = 1 + r,   r^2 = 1 - 2 (E_d(P, T) - E) / (d . M^-1 d)
//
// where r is how fast the bodies separate along d, over how fast they approached.

#include "kernels/variational/free_rotation.h"

namespace scree {

/// A point at which two bodies touch.
struct ImpactPoint {
  Vec3d normal;  ///< unit, from A to B
  Vec3d arm_a;   ///< from the center of A [m]
  Vec3d arm_b;   ///< from that of B to the same point [m]
};

/// Of more points than there is room for, the inner one of the two that are most alike goes: on a face it lies
/// between others, and adds nothing.
struct ImpactPoints {
  static constexpr int kMost = 8;
  int count = 0;
  ImpactPoint point[kMost];

  SCREE_HD void add(const ImpactPoint& p) {
    if (count < kMost) {
      point[count++] = p;
      return;
    }
    const auto at = [&](int k) -> const ImpactPoint& { return k < kMost ? point[k] : p; };
    double least = -1;
    int out = kMost;
    for (int i = 1; i <= kMost; ++i) {
      for (int j = 0; j < i; ++j) {
        const double apart = norm2(at(i).arm_a - at(j).arm_a) +
                             norm2(at(i).arm_a) * norm2(at(i).normal - at(j).normal);
        if (least >= 0 && apart >= least) continue;
        least = apart;
        out = norm2(at(i).arm_a) < norm2(at(j).arm_a) ? i : j;
      }
    }
    if (out < kMost) point[out] = p;
  }
};

/// A body at an impact.
struct ImpactBody {
  double mass = 0;  ///< zero: a wall, which stays [kg]
  Vec3d moments;    ///< principal [kg m^2]
  Quatd orientation;
  Vec3d momentum;  ///< [kg m/s]
  Vec3d spin;      ///< angular momentum about its center, world axes [kg m^2/s]
  Vec3d gravity;   ///< [m/s^2]

  SCREE_HD Vec3d turned_spin() const { return rotate_back(orientation, spin); }

  /// Discrete energy, without the potential of this place, of a part of a step that begins or ends now [J].
  /// @param h  its length [s]
  SCREE_HD double energy(double h) const {
    if (mass == 0) return 0;
    return norm2(momentum) / (2 * mass) - mass * norm2(gravity) * h * h / 8 +
           spin_energy(moments, turned_spin());
  }

  SCREE_HD Vec3d velocity() const { return mass == 0 ? Vec3d{} : (1 / mass) * momentum; }
  SCREE_HD Vec3d rate(const Vec3d& of_spin) const {
    if (mass == 0) return {};
    return rotate(orientation, rate_of(moments, rotate_back(orientation, of_spin)));
  }
};

enum class ImpactOutcome : std::uint8_t {
  none,       ///< no point approaches; nothing has changed
  reflected,  ///< with (V4)
  grazing     ///< (V4) has no root, or one that has little to do with the approach: r = 1
};

struct ImpactResult {
  ImpactOutcome outcome = ImpactOutcome::none;
  double approach_speed = 0;  ///< the largest of the points [m/s]
  Vec3d impulse;              ///< on B [N s]
};

namespace variational_parts {

/// The least non-negative beta of W beta + u >= 0: minimum of beta . W beta / 2 + u . beta (Lawson, Hanson, Solving least squares
/// problems, 1974). W may be singular: W beta is unique, and points join only while they are independent.
struct ConeProjection {
  static constexpr int kMost = ImpactPoints::kMost;
  int count = 0;
  double w[kMost][kMost] = {};
  double u[kMost] = {};
  double beta[kMost] = {};

  SCREE_HD void solve() {
    double scale = 0;
    for (int k = 0; k < count; ++k) scale = std::abs(u[k]) > scale ? std::abs(u[k]) : scale;
    for (int turn = 0; turn < 4 * kMost; ++turn) {
      int next = -1;
      double most = 1e-13 * scale;
      for (int k = 0; k < count; ++k) {
        if (joined_[k] || left_out_[k]) continue;
        double missing = -u[k];
        for (int j = 0; j < count; ++j) missing -= w[k][j] * beta[j];
        if (!(missing > most)) continue;
        most = missing;
        next = k;
      }
      if (next < 0) return;
      joined_[next] = true;
      if (!settle()) {
        // It depends on the others but for rounding.
        joined_[next] = false;
        left_out_[next] = true;
        settle();
      }
    }
  }

 private:
  bool joined_[kMost] = {};
  bool left_out_[kMost] = {};
  /// Where the joined ones would be if they might pull; zero for others.
  double free_[kMost] = {};

  /// Lets the joined ones be free, and those leave that would pull. @return  false: they are not independent
  SCREE_HD bool settle() {
    for (int turn = 0; turn < kMost; ++turn) {
      if (!solve_joined()) return false;
      double part = 1;
      int leaving = -1;
      for (int k = 0; k < count; ++k) {
        if (!joined_[k] || free_[k] > 0) continue;
        const double to = beta[k] / (beta[k] - free_[k]);
        if (leaving >= 0 && to >= part) continue;
        part = to;
        leaving = k;
      }
      for (int k = 0; k < count; ++k) {
        if (joined_[k]) beta[k] += (leaving >= 0 ? part : 1) * (free_[k] - beta[k]);
      }
      if (leaving < 0) return true;
      joined_[leaving] = false;
      beta[leaving] = 0;
    }
    return true;
  }
  /// W x = -u among the joined, by Cholesky; the rows of others are those of the unit matrix.
  SCREE_HD bool solve_joined() {
    double l[kMost][kMost];
    for (int i = 0; i < count; ++i) {
      free_[i] = joined_[i] ? -u[i] : 0;
      for (int j = 0; j <= i; ++j) {
        double sum = i == j ? 1 : 0;
        if (joined_[i] && joined_[j]) sum = w[i][j];
        for (int k = 0; k < j; ++k) sum -= l[i][k] * l[j][k];
        if (i == j && !(sum > 1e-12 * (joined_[i] ? w[i][i] : 1))) return false;
        l[i][j] = i == j ? std::sqrt(sum) : sum / l[j][j];
      }
      for (int k = 0; k < i; ++k) free_[i] -= l[i][k] * free_[k];
      free_[i] /= l[i][i];
    }
    for (int i = count - 1; i >= 0; --i) {
      for (int k = i + 1; k < count; ++k) free_[i] -= l[k][i] * free_[k];
      free_[i] /= l[i][i];
    }
    return true;
  }
};

}  // namespace variational_parts

/// Two bodies at an impact.
struct RigidImpact {
  ImpactBody a, b;
  ImpactPoints points;

  /// With which speed a point opens [m/s]; negative: it approaches.
  SCREE_HD double opening_speed(const ImpactPoint& p) const {
    return dot(p.normal, b.velocity() + cross(b.rate(b.spin), p.arm_b) - a.velocity() -
                             cross(a.rate(a.spin), p.arm_a));
  }

  /// Changes the momenta of both.
  /// @param energy       what their discrete energies must be afterwards, without the potential of this place: the sum of
  ///                     ImpactBody::energy() [J]
  /// @param rest         what is left of the step [s]
  /// @param restitution  of the speed after it that (V4) gives [-]
  [[gnu::noinline]] SCREE_HD ImpactResult collide(double energy, double rest, double restitution) {
    ImpactResult out;
    variational_parts::ConeProjection cone;
    int name[ImpactPoints::kMost];
    for (int k = 0; k < points.count; ++k) {
      const double u = opening_speed(points.point[k]);
      if (!(u < 0)) continue;
      out.approach_speed = -u > out.approach_speed ? -u : out.approach_speed;
      cone.u[cone.count] = u;
      name[cone.count++] = k;
    }
    if (cone.count == 0) return out;
    for (int i = 0; i < cone.count; ++i) {
      for (int j = 0; j <= i; ++j) {
        cone.w[i][j] = cone.w[j][i] = coupling(points.point[name[i]], points.point[name[j]]);
      }
    }
    cone.solve();
    // The direction of the impulse on B, and its moments.
    Vec3d d, turn_a, turn_b;
    for (int i = 0; i < cone.count; ++i) {
      const ImpactPoint& p = points.point[name[i]];
      const Vec3d j = cone.beta[i] * p.normal;
      d += j;
      turn_a -= cross(p.arm_a, j);
      turn_b += cross(p.arm_b, j);
    }
    // d . M^-1 d = -beta . u, since W beta = -u where beta is not zero.
    double square = 0;
    for (int k = 0; k < cone.count; ++k) square -= cone.beta[k] * cone.u[k];
    const double ratio2 = 1 - 2 * (a.energy(rest) + b.energy(rest) - energy) / square;
    // A factor of two in speed either way, so that neither gains nor losses are preferred.
    const bool is_grazing = !(ratio2 > 0.25 && ratio2 < 4);
    out.outcome = is_grazing ? ImpactOutcome::grazing : ImpactOutcome::reflected;
    const double lambda = 1 + restitution * (is_grazing ? 1 : std::sqrt(ratio2));
    out.impulse = lambda * d;
    push(a, -lambda, d, lambda, turn_a);
    push(b, lambda, d, lambda, turn_b);
    return out;
  }

 private:
  SCREE_HD static void push(ImpactBody& body, double along, const Vec3d& d, double turning,
                            const Vec3d& turn) {
    if (body.mass == 0) return;
    body.momentum += along * d;
    body.spin += turning * turn;
  }
  /// How fast point p opens by an impulse at point q [1/kg].
  SCREE_HD double coupling(const ImpactPoint& p, const ImpactPoint& q) const {
    double sum = 0;
    if (a.mass > 0) {
      sum += dot(p.normal, q.normal) / a.mass +
             dot(cross(p.arm_a, p.normal), a.rate(cross(q.arm_a, q.normal)));
    }
    if (b.mass > 0) {
      sum += dot(p.normal, q.normal) / b.mass +
             dot(cross(p.arm_b, p.normal), b.rate(cross(q.arm_b, q.normal)));
    }
    return sum;
  }
};

}  // namespace scree
