#include "tests/reference/dense_oracle.h"

#include <algorithm>
#include <cmath>

namespace scree::oracle {
namespace {

using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic>;
using Vector = Eigen::Matrix<double, Eigen::Dynamic, 1>;

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& r) {
  Eigen::Matrix3d m;
  m << 0, -r.z(), r.y(), r.z(), 0, -r.x(), -r.y(), r.x(), 0;
  return m;
}

/// |part rows| <= bound * (normal + apex) of one contact.
struct Part {
  std::vector<int> rows;
  double bound;
};

std::vector<Part> parts(const Problem& p, int c) {
  const Contact& k = p.contacts[c];
  const int first = c * p.rows_per_contact();
  std::vector<Part> all{{{first + 1, first + 2}, k.mu}};
  if (p.has_moments) {
    all.push_back({{first + 4, first + 5}, k.rolling});
    all.push_back({{first + 3}, k.spinning});
  }
  return all;
}

/// Projects the rows of contact c in place. The derivative of half the squared distance in the
/// normal impulse is the minimum, over sets of parts at their bounds, of increasing linear
/// functions; so its root is the largest of theirs.
void project_contact(const Problem& p, int c, const std::vector<Part>& bounded,
                     Eigen::VectorXd& x) {
  const int normal = c * p.rows_per_contact();
  const double apex = p.contacts[c].adhesion;
  double length[3] = {};
  for (std::size_t k = 0; k < bounded.size(); ++k) {
    for (int row : bounded[k].rows) length[k] = std::hypot(length[k], x(row));
  }
  double n = 0;
  for (unsigned set = 0; set < 1u << bounded.size(); ++set) {
    double pull = x(normal) + apex, stiffness = 1;
    for (std::size_t k = 0; k < bounded.size(); ++k) {
      if ((set >> k & 1u) == 0) continue;
      pull += bounded[k].bound * length[k];
      stiffness += bounded[k].bound * bounded[k].bound;
    }
    n = std::max(n, pull / stiffness);
  }
  x(normal) = n - apex;
  for (std::size_t k = 0; k < bounded.size(); ++k) {
    const double bound = bounded[k].bound * n;
    if (length[k] <= bound) continue;
    for (int row : bounded[k].rows) x(row) *= bound / length[k];
  }
}

/// Block Gauss-Seidel sweeps from a point that is nearly right: the barrier stops short where an
/// optimal impulse is not unique.
void polish(const Problem& p, const Eigen::MatrixXd& n, const Eigen::VectorXd& r,
            Eigen::VectorXd& gamma, int sweeps) {
  const int rows = p.rows_per_contact(), contact_count = static_cast<int>(p.contacts.size());
  std::vector<std::vector<Part>> bounded;
  std::vector<double> stiffness;
  for (int c = 0; c < contact_count; ++c) {
    bounded.push_back(parts(p, c));
    const Eigen::MatrixXd block = n.block(c * rows, c * rows, rows, rows);
    stiffness.push_back(block.selfadjointView<Eigen::Lower>().eigenvalues().maxCoeff());
  }
  Eigen::VectorXd u = n * gamma + r;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (int c = 0; c < contact_count; ++c) {
      const Eigen::VectorXd old = gamma.segment(c * rows, rows);
      gamma.segment(c * rows, rows) -= u.segment(c * rows, rows) / stiffness[c];
      project_contact(p, c, bounded[c], gamma);
      u += n.middleCols(c * rows, rows) * (gamma.segment(c * rows, rows) - old);
    }
  }
}

/// Rows bounded by zero leave the problem; what stays is s = G x + h in a product of
/// second-order cones.
struct ConeProgram {
  std::vector<int> kept;  // row of each variable
  Matrix P, G;
  Vector q, h;
  std::vector<int> cone_size;
};

ConeProgram reduce_program(const Problem& p) {
  ConeProgram r;
  std::vector<int> variable(p.rows(), -1);
  const auto keep = [&](int row) {
    variable[row] = static_cast<int>(r.kept.size());
    r.kept.push_back(row);
  };
  const int contact_count = static_cast<int>(p.contacts.size());
  int cone_rows = 0;
  // A bounded part implies gamma_n >= 0; without one it is a cone of its own.
  const auto is_frictionless = [&](int c) {
    for (const Part& part : parts(p, c)) {
      if (part.bound > 0) return false;
    }
    return true;
  };
  for (int c = 0; c < contact_count; ++c) {
    keep(c * p.rows_per_contact());
    if (is_frictionless(c)) ++cone_rows;
    for (const Part& part : parts(p, c)) {
      if (part.bound <= 0) continue;
      for (int row : part.rows) keep(row);
      cone_rows += 1 + static_cast<int>(part.rows.size());
    }
  }
  const int n = static_cast<int>(r.kept.size());
  const Eigen::MatrixXd delassus_rows = delassus(p);
  const Eigen::VectorXd right = right_side(p);
  r.P.resize(n, n);
  r.q.resize(n);
  for (int i = 0; i < n; ++i) {
    r.q(i) = right(r.kept[i]);
    for (int j = 0; j < n; ++j) r.P(i, j) = delassus_rows(r.kept[i], r.kept[j]);
  }
  r.G = Matrix::Zero(cone_rows, n);
  r.h = Vector::Zero(cone_rows);
  int row = 0;
  for (int c = 0; c < contact_count; ++c) {
    const int normal = variable[c * p.rows_per_contact()];
    const double apex = p.contacts[c].adhesion;
    if (is_frictionless(c)) {
      r.G(row, normal) = 1;
      r.h(row++) = apex;
      r.cone_size.push_back(1);
    }
    for (const Part& part : parts(p, c)) {
      if (part.bound <= 0) continue;
      r.G(row, normal) = part.bound;
      r.h(row++) = part.bound * apex;
      for (int k : part.rows) r.G(row++, variable[k]) = 1;
      r.cone_size.push_back(1 + static_cast<int>(part.rows.size()));
    }
  }
  return r;
}

double lorentz(const Vector& u) { return u(0) * u(0) - u.tail(u.size() - 1).squaredNorm(); }

Vector jordan(const Vector& u, const Vector& v) {
  Vector r(u.size());
  r(0) = u.dot(v);
  r.tail(r.size() - 1) = u(0) * v.tail(v.size() - 1) + v(0) * u.tail(u.size() - 1);
  return r;
}

Vector jordan_divide(const Vector& l, const Vector& r) {
  const Eigen::Index m = l.size() - 1;
  Vector x(l.size());
  x(0) = (l(0) * r(0) - l.tail(m).dot(r.tail(m))) / lorentz(l);
  x.tail(m) = (r.tail(m) - x(0) * l.tail(m)) / l(0);
  return x;
}

/// Largest step <= 1 that keeps s + step d inside the cone.
double cone_step(const Vector& s, const Vector& d) {
  const Eigen::Index m = s.size() - 1;
  const double a = lorentz(d), c = lorentz(s);
  const double b = s(0) * d(0) - s.tail(m).dot(d.tail(m));
  double step = 1;
  if (d(0) < 0) step = std::min(step, -s(0) / d(0));
  // Smallest positive root of a t^2 + 2 b t + c, with c > 0.
  const double root = b * b - a * c;
  if (root >= 0) {
    const double t = b < 0 ? c / (-b + std::sqrt(root)) : (a < 0 ? (-b - std::sqrt(root)) / a : -1);
    if (t > 0) step = std::min(step, t);
  }
  return step;
}

struct Scaling {
  Matrix w, w_inverse;
  Vector lambda;
};

Scaling nesterov_todd(const Vector& s, const Vector& z) {
  const Eigen::Index d = s.size(), m = d - 1;
  const double s_norm = std::sqrt(lorentz(s)), z_norm = std::sqrt(lorentz(z));
  const Vector s_bar = s / s_norm, z_bar = z / z_norm;
  const double half = std::sqrt((1 + s_bar.dot(z_bar)) / 2);
  Vector w = s_bar;
  w(0) += z_bar(0);
  w.tail(m) -= z_bar.tail(m);
  w /= 2 * half;
  const double scale = std::sqrt(s_norm / z_norm);
  Matrix bar = Matrix::Identity(d, d);
  bar(0, 0) = w(0);
  bar.block(0, 1, 1, m) = w.tail(m).transpose();
  bar.block(1, 0, m, 1) = w.tail(m);
  bar.block(1, 1, m, m) += w.tail(m) * w.tail(m).transpose() / (1 + w(0));
  Scaling r;
  r.w = scale * bar;
  bar.block(0, 1, 1, m) *= -1;
  bar.block(1, 0, m, 1) *= -1;
  r.w_inverse = bar / scale;
  r.lambda = r.w * z;
  return r;
}

Eigen::VectorXd expand(const Problem& p, const ConeProgram& program, const Vector& x) {
  Eigen::VectorXd gamma = Eigen::VectorXd::Zero(p.rows());
  for (std::size_t i = 0; i < program.kept.size(); ++i) {
    gamma(program.kept[i]) = static_cast<double>(x(static_cast<Eigen::Index>(i)));
  }
  return gamma;
}

}  // namespace

Eigen::Matrix3d contact_frame(const Eigen::Vector3d& normal) {
  Eigen::Index smallest;
  normal.cwiseAbs().minCoeff(&smallest);
  const Eigen::Vector3d t1 = normal.cross(Eigen::Vector3d::Unit(smallest)).normalized();
  Eigen::Matrix3d frame;
  frame << normal, t1, normal.cross(t1);
  return frame;
}

Eigen::MatrixXd jacobian(const Problem& p) {
  const int rows = p.rows_per_contact();
  Eigen::MatrixXd j =
      Eigen::MatrixXd::Zero(p.rows(), 6 * static_cast<Eigen::Index>(p.bodies.size()));
  for (std::size_t c = 0; c < p.contacts.size(); ++c) {
    const Contact& k = p.contacts[c];
    const Eigen::Matrix3d to_frame = contact_frame(k.normal).transpose();
    const auto row = static_cast<Eigen::Index>(c) * rows;
    // Velocity of the point x + r of a body is v + w x r = v - [r] w.
    j.block<3, 3>(row, 6 * k.a) -= to_frame;
    j.block<3, 3>(row, 6 * k.a + 3) += to_frame * cross_matrix(k.arm_a);
    j.block<3, 3>(row, 6 * k.b) += to_frame;
    j.block<3, 3>(row, 6 * k.b + 3) -= to_frame * cross_matrix(k.arm_b);
    if (p.has_moments) {
      j.block<3, 3>(row + 3, 6 * k.a + 3) -= k.length * to_frame;
      j.block<3, 3>(row + 3, 6 * k.b + 3) += k.length * to_frame;
    }
  }
  return j;
}

Eigen::MatrixXd inverse_mass(const Problem& p) {
  const auto n = 6 * static_cast<Eigen::Index>(p.bodies.size());
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(n, n);
  for (std::size_t i = 0; i < p.bodies.size(); ++i) {
    const auto first = 6 * static_cast<Eigen::Index>(i);
    m.block<3, 3>(first, first) = p.bodies[i].inv_mass.asDiagonal();
    m.block<3, 3>(first + 3, first + 3) = p.bodies[i].inv_inertia;
  }
  return m;
}

Eigen::MatrixXd delassus(const Problem& p) {
  const Eigen::MatrixXd j = jacobian(p);
  return j * inverse_mass(p) * j.transpose();
}

Eigen::VectorXd free_velocity(const Problem& p) {
  Eigen::VectorXd v(6 * static_cast<Eigen::Index>(p.bodies.size()));
  for (std::size_t i = 0; i < p.bodies.size(); ++i) {
    v.segment<3>(6 * static_cast<Eigen::Index>(i)) = p.bodies[i].velocity;
    v.segment<3>(6 * static_cast<Eigen::Index>(i) + 3) = p.bodies[i].angular_velocity;
  }
  return v;
}

Eigen::VectorXd right_side(const Problem& p) {
  Eigen::VectorXd r = jacobian(p) * free_velocity(p);
  for (std::size_t c = 0; c < p.contacts.size(); ++c) {
    r(static_cast<Eigen::Index>(c) * p.rows_per_contact()) += p.contacts[c].bias;
  }
  return r;
}

Eigen::VectorXd rows_from_world(const Problem& p, const std::vector<Eigen::Vector3d>& vectors) {
  const int per_contact = p.has_moments ? 2 : 1;
  Eigen::VectorXd rows(p.rows());
  for (std::size_t k = 0; k < vectors.size(); ++k) {
    rows.segment<3>(3 * static_cast<Eigen::Index>(k)) =
        contact_frame(p.contacts[k / per_contact].normal).transpose() * vectors[k];
  }
  return rows;
}

std::vector<Eigen::Vector3d> world_from_rows(const Problem& p, const Eigen::VectorXd& rows) {
  const int per_contact = p.has_moments ? 2 : 1;
  std::vector<Eigen::Vector3d> vectors(p.contacts.size() * per_contact);
  for (std::size_t k = 0; k < vectors.size(); ++k) {
    vectors[k] = contact_frame(p.contacts[k / per_contact].normal) *
                 rows.segment<3>(3 * static_cast<Eigen::Index>(k));
  }
  return vectors;
}

Eigen::VectorXd project(const Problem& p, const Eigen::VectorXd& x) {
  Eigen::VectorXd y = x;
  for (int c = 0; c < static_cast<int>(p.contacts.size()); ++c)
    project_contact(p, c, parts(p, c), y);
  return y;
}

Residual residual(const Problem& p, const Eigen::VectorXd& gamma) {
  const Eigen::MatrixXd n = delassus(p);
  const Eigen::VectorXd u = n * gamma + right_side(p);
  Eigen::VectorXd u_exact = u, rho(p.rows());
  const int rows = p.rows_per_contact();
  for (int c = 0; c < static_cast<int>(p.contacts.size()); ++c) {
    const int first = c * rows;
    rho.segment(first, rows).setConstant(3 / n.diagonal().segment<3>(first).sum());
    for (const Part& part : parts(p, c)) {
      double speed = 0;
      for (int row : part.rows) speed += u(row) * u(row);
      u_exact(first) += part.bound * std::sqrt(speed);
    }
  }
  const auto rms = [&](const Eigen::VectorXd& velocity) {
    const Eigen::VectorXd moved = project(p, gamma - rho.cwiseProduct(velocity));
    return std::sqrt((gamma - moved).cwiseQuotient(rho).squaredNorm() / p.contacts.size());
  };
  return {rms(u), rms(u_exact)};
}

double objective(const Problem& p, const Eigen::VectorXd& gamma) {
  return 0.5 * gamma.dot(delassus(p) * gamma) + right_side(p).dot(gamma);
}

Solution solve_convex(const Problem& p) {
  const ConeProgram program = reduce_program(p);
  const Matrix &P = program.P, &G = program.G;
  const Eigen::Index n = P.rows(), m = G.rows();
  const std::vector<int>& size = program.cone_size;

  // Typical impulse and velocity set the first point.
  const double velocity = std::max(1e-12, program.q.cwiseAbs().maxCoeff());
  const double impulse = velocity / std::max(1e-12, P.diagonal().maxCoeff());
  Vector x = Vector::Zero(n), s = Vector::Zero(m), z = Vector::Zero(m);
  for (Eigen::Index k = 0, first = 0; k < static_cast<Eigen::Index>(size.size());
       first += size[k++]) {
    s(first) = impulse;
    z(first) = velocity;
  }

  Solution best;
  best.rms = INFINITY;
  const auto try_point = [&](int iteration) {
    const Eigen::VectorXd gamma = project(p, expand(p, program, x));
    const Residual r = residual(p, gamma);
    if (r.rms < best.rms) best = {gamma, 0, r.rms, r.exact_rms, iteration};
  };
  for (int iteration = 0; iteration < 80; ++iteration) {
    try_point(iteration);
    if (best.rms < 1e-12 * velocity) break;
    const double gap = s.dot(z) / static_cast<double>(size.size());
    if (gap < 1e-25 * impulse * velocity) break;
    const Vector r_x = P * x + program.q - G.transpose() * z;
    const Vector r_s = G * x + program.h - s;

    std::vector<Scaling> scaling;
    Matrix scaled_g(m, n);
    for (Eigen::Index k = 0, first = 0; k < static_cast<Eigen::Index>(size.size());
         first += size[k++]) {
      scaling.push_back(nesterov_todd(s.segment(first, size[k]), z.segment(first, size[k])));
      scaled_g.middleRows(first, size[k]) = scaling[k].w_inverse * G.middleRows(first, size[k]);
    }
    const Eigen::LDLT<Matrix> system(P + scaled_g.transpose() * scaled_g);
    Vector d_x, d_s(m), d_z(m);
    // b: right side of the linearized complementarity, already divided by lambda.
    const auto direction = [&](const Vector& b) {
      Vector target(m);
      for (Eigen::Index k = 0, first = 0; k < static_cast<Eigen::Index>(size.size());
           first += size[k++]) {
        target.segment(first, size[k]) =
            b.segment(first, size[k]) - scaling[k].w_inverse * r_s.segment(first, size[k]);
      }
      d_x = system.solve(-r_x + scaled_g.transpose() * target);
      const Vector scaled_d_z = target - scaled_g * d_x;
      d_s = G * d_x + r_s;
      for (Eigen::Index k = 0, first = 0; k < static_cast<Eigen::Index>(size.size());
           first += size[k++]) {
        d_z.segment(first, size[k]) = scaling[k].w_inverse * scaled_d_z.segment(first, size[k]);
      }
    };
    const auto longest = [&] {
      double step = 1;
      for (Eigen::Index k = 0, first = 0; k < static_cast<Eigen::Index>(size.size());
           first += size[k++]) {
        step = std::min(step, cone_step(s.segment(first, size[k]), d_s.segment(first, size[k])));
        step = std::min(step, cone_step(z.segment(first, size[k]), d_z.segment(first, size[k])));
      }
      return step;
    };
    Vector b(m);
    for (Eigen::Index k = 0, first = 0; k < static_cast<Eigen::Index>(size.size());
         first += size[k++]) {
      b.segment(first, size[k]) = -scaling[k].lambda;
    }
    direction(b);
    const double affine = longest();
    const double sigma = std::pow(1 - affine, 3.0);
    const double correction = affine > 0.3 ? 1 : 0;  // of no use when the affine step fails early
    for (Eigen::Index k = 0, first = 0; k < static_cast<Eigen::Index>(size.size());
         first += size[k++]) {
      const Scaling& w = scaling[k];
      Vector right = -jordan(w.lambda, w.lambda) -
                     correction * jordan(w.w_inverse * d_s.segment(first, size[k]),
                                         w.w * d_z.segment(first, size[k]));
      right(0) += sigma * gap;
      b.segment(first, size[k]) = jordan_divide(w.lambda, right);
    }
    direction(b);
    const double step = std::min(1.0, 0.99 * longest());
    if (!(step > 1e-10) || !d_x.allFinite()) break;
    x += step * d_x;
    s += step * d_s;
    z += step * d_z;
  }
  const Eigen::MatrixXd dense = delassus(p);
  const Eigen::VectorXd right = right_side(p);
  for (int k = 0; k < 400 && best.rms > 1e-13; ++k) {
    Eigen::VectorXd gamma = best.gamma;
    polish(p, dense, right, gamma, 100);
    const Residual r = residual(p, gamma);
    if (!(r.rms < best.rms)) break;
    best = {gamma, 0, r.rms, r.exact_rms, best.iterations + 100};
  }
  best.objective = objective(p, best.gamma);
  return best;
}

Solution solve_coulomb(Problem p, double tolerance, int max_iterations) {
  const Problem original = p;
  std::vector<double> shift(p.contacts.size(), 0);
  Solution solution;
  for (int iteration = 1; iteration <= max_iterations; ++iteration) {
    solution = solve_convex(p);
    const Eigen::VectorXd u = delassus(original) * solution.gamma + right_side(original);
    double change = 0;
    for (int c = 0; c < static_cast<int>(p.contacts.size()); ++c) {
      double next = 0;
      for (const Part& part : parts(p, c)) {
        double speed = 0;
        for (int row : part.rows) speed += u(row) * u(row);
        next += part.bound * std::sqrt(speed);
      }
      change = std::max(change, std::abs(next - shift[c]));
      shift[c] = next;
      p.contacts[c].bias = original.contacts[c].bias + next;
    }
    solution.iterations = iteration;
    if (change < tolerance) break;
  }
  const Residual r = residual(original, solution.gamma);
  solution.rms = r.rms;
  solution.exact_rms = r.exact_rms;
  solution.objective = objective(original, solution.gamma);
  return solution;
}

}  // namespace scree::oracle
