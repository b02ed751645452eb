#include "solvers/assembled/solve_checks.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "solvers/assembled/assembled_solver.h"

namespace scree {
namespace {

void require(bool ok, const std::string& what) {
  if (!ok) throw AssembledError(what);
}

void require_size(const char* name, std::size_t size, std::size_t expected) {
  require(size == expected, std::string(name) + " has " + std::to_string(size) +
                                " values, expected " + std::to_string(expected));
}

void check_matrix(const ProblemParts& p) {
  require_size("row_start", p.row_start.size(), p.matrix_rows + 1);
  require_size("column", p.column.size(), p.entry_count);
  require(p.row_start.front() == 0 &&
              static_cast<std::size_t>(p.row_start.back()) == p.entry_count &&
              std::is_sorted(p.row_start.begin(), p.row_start.end()),
          "row_start must ascend from 0 to " + std::to_string(p.entry_count));
  for (const int column : p.column)
    require(column >= 0 && static_cast<std::size_t>(column) < p.matrix_rows,
            "column holds " + std::to_string(column) + ", expected 0 to " +
                std::to_string(p.matrix_rows - 1));
}

void check_options(const AssembledOptions& o) {
  // NaN is no such number either.
  require(o.tolerance >= 0, "tolerance must not be negative, got " + std::to_string(o.tolerance));
  require(o.max_iterations >= 0,
          "max_iterations must not be negative, got " + std::to_string(o.max_iterations));
  require(o.check_every >= 0,
          "check_every must not be negative, got " + std::to_string(o.check_every));
  require(o.max_seconds >= 0,
          "max_seconds must not be negative, got " + std::to_string(o.max_seconds));
  require(o.relaxation >= 0 && o.relaxation < 2,
          "relaxation must lie in (0, 2), got " + std::to_string(o.relaxation));
}

}  // namespace

void check_rows_and_options(const ProblemParts& p, const AssembledOptions& o) {
  const auto require_rows = [&](const char* name, const std::vector<double>& v) {
    require_size(
        name, v.size(),
        static_cast<std::size_t>(p.contact_rows) * static_cast<std::size_t>(p.contact_count));
    require(std::all_of(v.begin(), v.end(), [](double x) { return std::isfinite(x); }),
            std::string(name) + " holds a value that is not finite");
  };
  require(p.contact_count > 0, "the problem has no contacts");
  for (const auto& [name, values] : p.coefficients)
    require_size(name, values->size(), static_cast<std::size_t>(p.contact_count));
  require_rows("q", p.q);
  if (!o.guess.empty()) require_rows("guess", o.guess);
  if (!o.reference_velocity.empty()) require_rows("reference_velocity", o.reference_velocity);
  if (!o.reference_impulse.empty()) require_rows("reference_impulse", o.reference_impulse);
  check_matrix(p);
  check_options(o);
}

}  // namespace scree
