#include "host/problems/matrix_form.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <Eigen/Sparse>
#include <Eigen/SparseLU>
#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <utility>

#include "host/error.h"
#include "host/problems/contact_frame.h"

namespace scree {
namespace {

using Matrix = Eigen::SparseMatrix<double>;
using RowMatrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;
using Vector = Eigen::VectorXd;
using Block6 = Eigen::Matrix<double, 6, 6>;

constexpr double max_entries = std::numeric_limits<std::int32_t>::max();

Vector vector_of(const std::vector<double>& v) {
  return Eigen::Map<const Vector>(v.data(), static_cast<Eigen::Index>(v.size()));
}

std::vector<double> values_of(const Vector& v) { return {v.data(), v.data() + v.size()}; }

Matrix matrix_of(const SparseMatrix& a) {
  return Eigen::Map<const RowMatrix>(a.row_count, a.column_count, a.entry_count(),
                                     a.row_start.data(), a.column.data(), a.value.data());
}

SparseMatrix plain(const Matrix& a) {
  RowMatrix rows = a;
  rows.makeCompressed();
  SparseMatrix p;
  p.row_count = static_cast<std::int32_t>(rows.rows());
  p.column_count = static_cast<std::int32_t>(rows.cols());
  p.row_start.assign(rows.outerIndexPtr(), rows.outerIndexPtr() + rows.rows() + 1);
  p.column.assign(rows.innerIndexPtr(), rows.innerIndexPtr() + rows.nonZeros());
  p.value.assign(rows.valuePtr(), rows.valuePtr() + rows.nonZeros());
  return p;
}

/// Inverse mass of a body, linear before angular.
Block6 inverse_mass(const BodyProblem& p, int body) {
  Block6 inverse = Block6::Zero();
  if (p.layout == ContactLayout::radial) {
    const RadialInertia<double>& r = p.radial_inertia[static_cast<std::size_t>(body)];
    inverse.diagonal() << r.inv_mass, r.inv_mass, r.inv_mass, r.inv_spin, r.inv_spin, r.inv_spin;
    return inverse;
  }
  const GeneralInertia<double>& g = p.general_inertia[static_cast<std::size_t>(body)];
  const Sym3<double>& i = g.inv_inertia;
  inverse.diagonal().head<3>() << g.inv_mass.x, g.inv_mass.y, g.inv_mass.z;
  inverse.bottomRightCorner<3, 3>() << i.xx, i.xy, i.xz, i.xy, i.yy, i.yz, i.xz, i.yz, i.zz;
  return inverse;
}

/// What a body's rate does to the velocity of B against A at a contact, in contact rows. The
/// velocity of the point at arm r is v + w x r; in the radial layout r w enters as s and the arms
/// are along n, those of A and B with opposite signs.
Eigen::Matrix<double, 3, 6> jacobian(const BodyProblem& p, std::size_t c, bool side_b) {
  const ContactFrame frame = contact_frame(p.normal[c]);
  const bool radial = p.layout == ContactLayout::radial;
  const Vec3d arm = radial ? -1.0 * p.normal[c] : (side_b ? p.arm_b[c] : p.arm_a[c]);
  const double sign = side_b ? 1 : -1;
  Eigen::Matrix<double, 3, 6> j;
  for (int row = 0; row < 3; ++row) {
    const Vec3d e = frame[static_cast<std::size_t>(row)];
    // e . (w x r) = w . (r x e)
    const Vec3d turn = (radial ? 1 : sign) * cross(arm, e);
    j.row(row) << sign * e.x, sign * e.y, sign * e.z, turn.x, turn.y, turn.z;
  }
  return j;
}

Eigen::Matrix<double, 6, 1> rate_of(const BodyProblem& p, int body) {
  const Twist<double>& t = p.free_velocity[static_cast<std::size_t>(body)];
  Eigen::Matrix<double, 6, 1> rate;
  rate << t.linear.x, t.linear.y, t.linear.z, t.angular.x, t.angular.y, t.angular.z;
  return rate;
}

/// The parts from which both forms are made.
struct Parts {
  Matrix mass, inverse;  ///< of the degrees of freedom that can move
  Matrix H;
  Vector free_velocity;  ///< v* of the same
  Vector w;
  Vector apex;  ///< c h e_n of all contacts
  Matrix G;     ///< of bilateral rows
  Vector b;
};

/// Numbers the axes that can move.
/// @return per body and axis the degree of freedom, -1 where there is none
std::vector<std::array<int, 6>> number_axes(const BodyProblem& p, int* count) {
  std::vector<std::array<int, 6>> dof(static_cast<std::size_t>(p.body_count()));
  *count = 0;
  for (int i = 0; i < p.body_count(); ++i) {
    const Block6 inverse = inverse_mass(p, i);
    for (int k = 0; k < 6; ++k)
      dof[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)] =
          inverse(k, k) > 0 ? (*count)++ : -1;
  }
  return dof;
}

void set_bodies(const BodyProblem& p, const std::vector<std::array<int, 6>>& dof, int dof_count,
                Parts& parts) {
  std::vector<Eigen::Triplet<double>> mass, inverse;
  parts.free_velocity = Vector::Zero(dof_count);
  for (int i = 0; i < p.free_count; ++i) {
    std::vector<int> axes;
    for (int k = 0; k < 6; ++k)
      if (dof[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)] >= 0) axes.push_back(k);
    if (axes.empty()) continue;
    const Eigen::MatrixXd block = inverse_mass(p, i)(axes, axes);
    // The linear axes are not coupled to the angular ones: their masses come out as 1 / inv_mass.
    const Eigen::MatrixXd inverted = block.inverse();
    const int first = dof[static_cast<std::size_t>(i)][static_cast<std::size_t>(axes.front())];
    const Eigen::Matrix<double, 6, 1> rate = rate_of(p, i);
    const int size = static_cast<int>(axes.size());
    for (int row = 0; row < size; ++row) {
      parts.free_velocity(first + row) = rate(axes[static_cast<std::size_t>(row)]);
      for (int column = 0; column < size; ++column) {
        if (std::abs(block(row, column)) > 0)
          inverse.emplace_back(first + row, first + column, block(row, column));
        if (std::abs(inverted(row, column)) > 0)
          mass.emplace_back(first + row, first + column, inverted(row, column));
      }
    }
  }
  parts.mass.resize(dof_count, dof_count);
  parts.mass.setFromTriplets(mass.begin(), mass.end());
  parts.inverse.resize(dof_count, dof_count);
  parts.inverse.setFromTriplets(inverse.begin(), inverse.end());
}

/// c h along the normal as it is stored, which is a unit vector to rounding.
double apex_impulse(const BodyProblem& p, std::size_t contact) {
  return p.adhesion[contact] * norm(p.normal[contact]);
}

void set_contacts(const BodyProblem& p, const std::vector<std::array<int, 6>>& dof, int dof_count,
                  Parts& parts) {
  const int rows = 3 * p.contact_count();
  std::vector<Eigen::Triplet<double>> h;
  parts.w = Vector::Zero(rows);
  parts.apex = Vector::Zero(rows);
  for (int c = 0; c < p.contact_count(); ++c) {
    const auto contact = static_cast<std::size_t>(c);
    // The bias, too, acts along the normal as it is stored.
    parts.w(3 * c) = p.bias[contact] * norm(p.normal[contact]);
    if (!p.drift.empty()) {
      const ContactFrame frame = contact_frame(p.normal[contact]);
      for (int row = 0; row < 3; ++row)
        parts.w(3 * c + row) += dot(frame[static_cast<std::size_t>(row)], p.drift[contact]);
    }
    parts.apex(3 * c) = apex_impulse(p, contact);
    for (const bool side_b : {false, true}) {
      const int body = side_b ? p.body_b[contact] : p.body_a[contact];
      const Eigen::Matrix<double, 3, 6> j = jacobian(p, contact, side_b);
      const Eigen::Matrix<double, 6, 1> rate = rate_of(p, body);
      for (int k = 0; k < 6; ++k) {
        const int column = dof[static_cast<std::size_t>(body)][static_cast<std::size_t>(k)];
        for (int row = 0; row < 3; ++row) {
          if (column < 0) {
            parts.w(3 * c + row) += j(row, k) * rate(k);
          } else if (std::abs(j(row, k)) > 0) {
            h.emplace_back(column, 3 * c + row, j(row, k));
          }
        }
      }
    }
  }
  parts.H.resize(dof_count, rows);
  parts.H.setFromTriplets(h.begin(), h.end());
}

void set_bilateral(const BodyProblem& p, const std::vector<std::array<int, 6>>& dof, int dof_count,
                   Parts& parts) {
  const int rows = static_cast<int>(p.bilateral.size());
  std::vector<Eigen::Triplet<double>> g;
  parts.b = Vector::Zero(rows);
  for (int k = 0; k < rows; ++k) {
    const BilateralRow& r = p.bilateral[static_cast<std::size_t>(k)];
    parts.b(k) = r.bias;
    for (const bool side_b : {false, true}) {
      const int body = side_b ? r.body_b : r.body_a;
      const double sign = side_b ? 1 : -1;
      // f . (w x arm) = w . (arm x f)
      const Vec3d turn = cross(side_b ? r.arm_b : r.arm_a, r.force) + r.moment;
      const double j[6] = {r.force.x, r.force.y, r.force.z, turn.x, turn.y, turn.z};
      const Eigen::Matrix<double, 6, 1> rate = rate_of(p, body);
      for (int axis = 0; axis < 6; ++axis) {
        const int row = dof[static_cast<std::size_t>(body)][static_cast<std::size_t>(axis)];
        if (row < 0) {
          parts.b(k) += sign * j[axis] * rate(axis);
        } else if (std::abs(j[axis]) > 0) {
          g.emplace_back(row, k, sign * j[axis]);
        }
      }
    }
  }
  parts.G.resize(dof_count, rows);
  parts.G.setFromTriplets(g.begin(), g.end());
}

Vector bilateral_guess(const BodyProblem& p) {
  Vector l(static_cast<Eigen::Index>(p.bilateral.size()));
  for (Eigen::Index k = 0; k < l.size(); ++k)
    l(k) = p.bilateral[static_cast<std::size_t>(k)].impulse;
  return l;
}

Parts parts_of(const BodyProblem& p) {
  validate(p);
  if (p.layout == ContactLayout::rolling)
    throw InputError(
        "the problem has rolling friction, which matrices of three rows a contact do not hold; "
        "expected layout radial or general (scree solve --matrix-free takes all without bilateral "
        "rows)");
  if (18.0 * 2 * p.contact_count() > max_entries)
    throw InputError(
        fmt::format("H of {} contacts would hold more than 2^31 entries", p.contact_count()));
  int dof_count = 0;
  const auto dof = number_axes(p, &dof_count);
  if (dof_count == 0) throw InputError("no body can move: the problem has no degrees of freedom");
  Parts parts;
  set_bodies(p, dof, dof_count, parts);
  set_contacts(p, dof, dof_count, parts);
  set_bilateral(p, dof, dof_count, parts);
  return parts;
}

[[noreturn]] void refuse_large_operator(int contacts, double entries) {
  throw InputError(fmt::format(
      "W of {} contacts could hold {:.3g} entries, expected at most 2^31; take the global form",
      contacts, entries));
}

/// @throws InputError when W would not fit 32-bit indices: a body couples all its contacts
void require_room(const BodyProblem& p) {
  std::vector<double> contacts(static_cast<std::size_t>(p.body_count()), 0);
  for (int c = 0; c < p.contact_count(); ++c) {
    ++contacts[static_cast<std::size_t>(p.body_a[static_cast<std::size_t>(c)])];
    ++contacts[static_cast<std::size_t>(p.body_b[static_cast<std::size_t>(c)])];
  }
  double entries = 0;
  for (int i = 0; i < p.free_count; ++i)
    entries += 9 * contacts[static_cast<std::size_t>(i)] * contacts[static_cast<std::size_t>(i)];
  if (entries > max_entries) refuse_large_operator(p.contact_count(), entries);
}

/// The parts of M that nothing couples, by row: [n] a number below n.
std::vector<std::int32_t> parts_of_mass(const SparseMatrix& mass) {
  std::vector<std::int32_t> part(static_cast<std::size_t>(mass.row_count));
  std::iota(part.begin(), part.end(), 0);
  const auto root = [&](std::int32_t i) {
    for (; part[i] != i; i = part[i]) part[i] = part[part[i]];
    return i;
  };
  for (std::int32_t row = 0; row < mass.row_count; ++row)
    for (std::int32_t k = mass.row_start[row]; k < mass.row_start[row + 1]; ++k)
      part[root(mass.column[k])] = root(row);
  for (std::int32_t row = 0; row < mass.row_count; ++row) part[row] = root(row);
  return part;
}

/// The same of a global problem: a part of M couples all rows of contacts that touch it.
void require_room(const GlobalProblem& p) {
  const std::vector<std::int32_t> part = parts_of_mass(p.M);
  std::vector<double> rows(part.size(), 0);
  std::vector<std::int32_t> last(part.size(), -1);
  const SparseMatrix by_contact = transpose(p.H);
  for (std::int32_t row = 0; row < by_contact.row_count; ++row)
    for (std::int32_t k = by_contact.row_start[row]; k < by_contact.row_start[row + 1]; ++k) {
      const auto at = static_cast<std::size_t>(part[by_contact.column[k]]);
      if (std::exchange(last[at], row) != row) ++rows[at];
    }
  double entries = 0;
  for (const double n : rows) entries += n * n;
  if (entries > max_entries) refuse_large_operator(p.contact_count(), entries);
}

/// An empty row or column makes a matrix singular; a factorization may not come back from many.
void require_entries(const SparseMatrix& mass) {
  std::vector<bool> has_column(static_cast<std::size_t>(mass.column_count), false);
  for (const std::int32_t column : mass.column) has_column[column] = true;
  for (std::int32_t k = 0; k < mass.row_count; ++k) {
    const bool has_row = mass.row_start[k] < mass.row_start[k + 1];
    if (!has_row || !has_column[k])
      throw InputError(fmt::format("M is singular: {} {} is empty", has_row ? "column" : "row", k));
  }
}

LocalProblem local_of(const BodyProblem& p, const Parts& parts) {
  const Matrix weighted = parts.inverse * parts.H;
  LocalProblem local;
  local.W = plain(Matrix(parts.H.transpose() * weighted));
  local.q = values_of(parts.w + parts.H.transpose() * parts.free_velocity -
                      parts.H.transpose() * Vector(weighted * parts.apex));
  local.mu = p.friction;
  if (!p.bilateral.empty()) {
    const Matrix weighted_G = parts.inverse * parts.G;
    local.V = plain(Matrix(parts.H.transpose() * weighted_G));
    local.R = plain(Matrix(parts.G.transpose() * weighted_G));
    local.s = values_of(parts.b + parts.G.transpose() * parts.free_velocity -
                        weighted_G.transpose() * Vector(parts.H * parts.apex));
  }
  return local;
}

GlobalProblem global_of(const BodyProblem& p, const Parts& parts) {
  GlobalProblem global;
  global.M = plain(parts.mass);
  global.H = plain(parts.H);
  global.f = values_of(parts.mass * parts.free_velocity - parts.H * parts.apex);
  global.w = values_of(parts.w);
  global.mu = p.friction;
  if (!p.bilateral.empty()) {
    global.G = plain(parts.G);
    global.b = values_of(parts.b);
  }
  return global;
}

ProblemInfo info_of(const BodyProblem& p, const Parts& parts) {
  const ProblemSource& s = p.source;
  ProblemInfo info;
  info.title = s.scene;
  info.description =
      fmt::format("Step {} of scene {} at {} s, time step {} s, in {} on {}; written by {}", s.step,
                  s.scene, s.time, s.time_step, s.precision, s.backend, s.program);
  info.math_info = "Impulses [N s], velocities [m/s]; rows: normal, two tangents.";
  if (parts.apex.maxCoeff() > 0)
    info.math_info += " Cohesion: impulses hold c h along the normal on top of the physical ones.";
  return info;
}

}  // namespace

GlobalProblem global_form(const BodyProblem& problem) {
  return global_of(problem, parts_of(problem));
}

LocalProblem local_form(const BodyProblem& problem) {
  require_room(problem);
  return local_of(problem, parts_of(problem));
}

LocalProblem local_form(const GlobalProblem& problem) {
  validate(problem);
  require_entries(problem.M);
  require_room(problem);
  const Matrix M = matrix_of(problem.M), H = matrix_of(problem.H);
  Eigen::SparseLU<Matrix> factors(M);
  if (factors.info() != Eigen::Success) throw InputError("M is singular");
  const Matrix inverse_H = factors.solve(H);
  const Vector inverse_f = factors.solve(vector_of(problem.f));
  LocalProblem local;
  local.dimension = problem.dimension;
  local.mu = problem.mu;
  local.mu_r = problem.mu_r;
  local.W = plain(Matrix(H.transpose() * inverse_H));
  local.q = values_of(vector_of(problem.w) + H.transpose() * inverse_f);
  if (!problem.b.empty()) {
    const Matrix G = matrix_of(problem.G);
    const Matrix inverse_G = factors.solve(G);
    local.V = plain(Matrix(H.transpose() * inverse_G));
    local.R = plain(Matrix(G.transpose() * inverse_G));
    local.s = values_of(vector_of(problem.b) + G.transpose() * inverse_f);
  }
  validate(local);
  return local;
}

StoredProblem as_matrices(const BodyProblem& problem, MatrixForm form) {
  if (form == MatrixForm::local) require_room(problem);
  const Parts parts = parts_of(problem);
  StoredProblem stored;
  stored.info = info_of(problem, parts);
  const Vector r = vector_of(impulse_rows(problem, problem.impulse));
  const Vector l = bilateral_guess(problem);
  const Vector v =
      parts.free_velocity + parts.inverse * Vector(parts.H * Vector(r - parts.apex) + parts.G * l);
  ProblemPoint guess;
  guess.r = values_of(r);
  guess.l = values_of(l);
  guess.u = values_of(parts.w + parts.H.transpose() * v);
  if (form == MatrixForm::global) {
    guess.v = values_of(v);
    stored.form = global_of(problem, parts);
  } else {
    stored.form = local_of(problem, parts);
  }
  stored.guesses.push_back(std::move(guess));
  return stored;
}

StoredProblem as_matrices(const StoredProblem& problem, MatrixForm form) {
  if (const auto* bodies = std::get_if<BodyProblem>(&problem.form))
    return as_matrices(*bodies, form);
  const auto* global = std::get_if<GlobalProblem>(&problem.form);
  if (form == MatrixForm::global) {
    if (global == nullptr)
      throw InputError("it holds a local problem: M and H of a global one do not follow from W");
    return problem;
  }
  if (global == nullptr) return problem;
  StoredProblem local;
  local.form = local_form(*global);
  local.info = problem.info;
  local.solution = problem.solution;
  local.guesses = problem.guesses;
  if (local.solution) local.solution->v.clear();
  for (ProblemPoint& guess : local.guesses) guess.v.clear();
  return local;
}

std::vector<double> to_rows(const BodyProblem& problem, const std::vector<Vec3d>& vectors) {
  std::vector<double> rows;
  rows.reserve(3 * vectors.size());
  for (std::size_t c = 0; c < vectors.size(); ++c) {
    const Vec3d v = to_frame(contact_frame(problem.normal[c]), vectors[c]);
    rows.insert(rows.end(), {v.x, v.y, v.z});
  }
  return rows;
}

std::vector<double> impulse_rows(const BodyProblem& problem, const std::vector<Vec3d>& impulses) {
  std::vector<double> rows = to_rows(problem, impulses);
  for (std::size_t c = 0; c < impulses.size(); ++c) rows[3 * c] += apex_impulse(problem, c);
  return rows;
}

std::vector<Vec3d> to_world(const BodyProblem& problem, const std::vector<double>& rows) {
  std::vector<Vec3d> vectors;
  vectors.reserve(rows.size() / 3);
  for (std::size_t c = 0; 3 * c < rows.size(); ++c)
    vectors.push_back(from_frame(contact_frame(problem.normal[c]),
                                 {rows[3 * c], rows[3 * c + 1], rows[3 * c + 2]}));
  return vectors;
}

}  // namespace scree
