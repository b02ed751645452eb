#include "host/cli/bench/bandwidth.h"

#include "solvers/solver_card.h"

namespace scree {
namespace {

/// One application of a solver on spheres; nothing when it is not counted.
Traffic traffic_of(const SolverSettings& solver, const WorldOptions& options) {
  const SolverCard& card = solver_card(solver.name);
  if (solver.exact_coulomb || card.traffic == nullptr) return {};
  return card.traffic({.real = options.precision == Precision::double_precision ? 8.0 : 4.0,
                       .on_device = options.backend == BackendKind::cuda,
                       .parameters = solver.parameters});
}

}  // namespace

Bandwidth bandwidth_of(const StepFigures& figures, const SolverSettings& solver,
                       const WorldOptions& options, double copy) {
  const Traffic traffic = traffic_of(solver, options);
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
