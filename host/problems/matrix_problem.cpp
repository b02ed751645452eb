#include "host/problems/matrix_problem.h"

#include <fmt/format.h>

#include <cmath>

#include "host/problems/checks.h"

namespace scree {
namespace {

[[noreturn]] void refuse(const std::string& what) { throw InputError(what); }

std::string shape_of(const SparseMatrix& a) {
  return fmt::format("{} x {}", a.row_count, a.column_count);
}

void require_shape(const SparseMatrix& a, std::size_t rows, std::size_t columns, const char* name,
                   const char* why) {
  if (static_cast<std::size_t>(a.row_count) != rows ||
      static_cast<std::size_t>(a.column_count) != columns)
    refuse(fmt::format("{} is {}, expected {} x {} ({})", name, shape_of(a), rows, columns, why));
}

void require_square(const SparseMatrix& a, const char* name) {
  if (a.row_count != a.column_count)
    refuse(fmt::format("{} is {}, expected a square matrix", name, shape_of(a)));
}

void require_finite_matrix(const SparseMatrix& a, const char* name) {
  for (std::int32_t row = 0; row < a.row_count; ++row) {
    for (std::int32_t k = a.row_start[row]; k < a.row_start[row + 1]; ++k)
      if (!std::isfinite(a.value[k]))
        refuse(fmt::format("{} in row {}, column {} is {}, expected a finite number", name, row,
                           a.column[k], a.value[k]));
  }
}

/// Friction of all contacts, and with it their number.
void check_contacts(int dimension, const std::vector<double>& mu, const std::vector<double>& mu_r,
                    std::size_t rows, const char* rows_name) {
  if (dimension != 2 && dimension != 3 && dimension != 5)
    refuse(fmt::format("spacedim is {}, expected 2, 3, or 5 with rolling friction", dimension));
  if (rows == 0) refuse(fmt::format("{} is 0: the problem has no contacts", rows_name));
  if (rows % static_cast<std::size_t>(dimension) != 0)
    refuse(
        fmt::format("{} is {}, expected a multiple of spacedim, {}", rows_name, rows, dimension));
  require_size(mu, rows / static_cast<std::size_t>(dimension), "mu", "one a contact");
  require_not_negative(mu, "mu");
  if (dimension == 5) {
    require_size(mu_r, mu.size(), "mu_r", "one a contact");
    require_not_negative(mu_r, "mu_r");
  } else if (!mu_r.empty()) {
    refuse(fmt::format("mu_r is there and spacedim is {}, expected 5", dimension));
  }
}

void check_vector(const std::vector<double>& values, std::size_t size, const std::string& name,
                  const char* why) {
  require_size(values, size, name, why);
  require_finite(values, name);
}

void check_point(const ProblemPoint& point, std::size_t n, std::size_t rows, std::size_t p,
                 const std::string& name) {
  const auto check = [&](const std::vector<double>& values, std::size_t size, const char* part) {
    if (!values.empty()) check_vector(values, size, name + "/" + part, "the size of the problem");
  };
  check(point.v, n, "v");
  check(point.u, rows, "u");
  check(point.r, rows, "r");
  check(point.l, p, "l");
}

}  // namespace

void validate(const LocalProblem& p) {
  require_square(p.W, "W");
  const auto rows = static_cast<std::size_t>(p.W.row_count);
  check_contacts(p.dimension, p.mu, p.mu_r, rows, "the number of rows of W");
  require_finite_matrix(p.W, "W");
  check_vector(p.q, rows, "q", "one a row of W");
  require_square(p.R, "R");
  const auto bilateral = static_cast<std::size_t>(p.R.row_count);
  if (bilateral > 0 || !p.V.empty())
    require_shape(p.V, rows, bilateral, "V", "rows of W by rows of R");
  require_finite_matrix(p.V, "V");
  require_finite_matrix(p.R, "R");
  check_vector(p.s, bilateral, "s", "one a row of R");
}

void validate(const GlobalProblem& p) {
  require_square(p.M, "M");
  const auto n = static_cast<std::size_t>(p.M.row_count);
  if (n == 0) refuse("M is 0 x 0: the problem has no degrees of freedom");
  const auto rows = static_cast<std::size_t>(p.H.column_count);
  require_shape(p.H, n, rows, "H", "rows of M by rows of all contacts");
  check_contacts(p.dimension, p.mu, p.mu_r, rows, "the number of columns of H");
  require_finite_matrix(p.M, "M");
  require_finite_matrix(p.H, "H");
  check_vector(p.f, n, "f", "one a row of M");
  check_vector(p.w, rows, "w", "one a column of H");
  const auto bilateral = static_cast<std::size_t>(p.G.column_count);
  if (bilateral > 0) require_shape(p.G, n, bilateral, "G", "rows of M by bilateral constraints");
  require_finite_matrix(p.G, "G");
  check_vector(p.b, bilateral, "b", "one a column of G");
}

void validate(const ProblemPoint& point, const LocalProblem& p, const std::string& name) {
  check_point(point, 0, p.q.size(), p.s.size(), name);
}

void validate(const ProblemPoint& point, const GlobalProblem& p, const std::string& name) {
  check_point(point, p.f.size(), p.w.size(), p.b.size(), name);
}

}  // namespace scree
