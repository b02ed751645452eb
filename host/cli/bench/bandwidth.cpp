#include "host/cli/bench/bandwidth.h"

#include <type_traits>

#include "solvers/traffic.h"

namespace scree {
namespace {

/// One application of a solver on spheres. The plain program of Schwarz, on the CPU, moves more
/// than is counted.
template <class Real>
Traffic traffic_of(const SolverSettings& solver) {
  if (solver.exact_coulomb) return {};
  if (solver.name == "apgd") {
    if constexpr (std::is_same_v<Real, float>) return apgd_fused_iteration_traffic();
    return apgd_iteration_traffic<Real>(solver.diagonal_metric ? ApgdMetricKind::diagonal
                                                               : ApgdMetricKind::euclidean);
  }
  if (solver.name == "schwarz") return schwarz_pass_traffic<Real>();
  if (solver.name == "jacobi") return jacobi_iteration_traffic<Real>();
  if (solver.name == "gauss_seidel" || solver.name == "gauss_seidel_colored")
    return gauss_seidel_sweep_traffic<Real>();
  return {};
}

}  // namespace

Bandwidth bandwidth_of(const StepFigures& figures, const SolverSettings& solver,
                       const WorldOptions& options, double copy) {
  const Traffic traffic = options.precision == Precision::double_precision
                              ? traffic_of<double>(solver)
                              : traffic_of<float>(solver);
  Bandwidth result;
  result.least_bytes = traffic.least(figures.contacts, figures.bodies);
  const double seconds = 1e-3 * figures.ms("solve").mean;
  if (!(seconds > 0 && copy > 0)) return result;
  result.bytes_per_s = result.least_bytes * figures.applications / seconds;
  result.of_copy = result.bytes_per_s / copy;
  return result;
}

Json to_json(const Bandwidth& bandwidth) {
  if (!bandwidth.is_counted()) return Json::object();
  return {{"least_bytes_per_iteration", bandwidth.least_bytes},
          {"bytes_per_s", bandwidth.bytes_per_s},
          {"of_copy_bandwidth", bandwidth.of_copy}};
}

}  // namespace scree
