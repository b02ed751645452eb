#include "host/problems/body_measures.h"

#include <algorithm>
#include <cmath>

#include "kernels/backend/cpu.h"
// After the backend.
#include "host/problems/upload_problem.h"
#include "solvers/residual.h"

namespace scree {
namespace {

/// |u| over all contacts.
template <class R>
double velocity_norm(const ContactProblem<double>& p, Span<const Twist<double>> velocity) {
  double sum = 0;
  for (Index c = 0; c < p.contact_count; ++c) {
    const auto u = R::velocity(p, c, velocity[p.body_a[c]], velocity[p.body_b[c]]);
    sum += dot(u, u);
  }
  return std::sqrt(sum);
}

}  // namespace

AssembledResidual measure(const BodyProblem& problem, AssembledModel model,
                          const std::vector<Vec3d>& impulse) {
  Cpu cpu(1);
  UploadedProblem<Cpu, double> uploaded(cpu, problem);
  const ContactProblem<double>& p = uploaded.problem();
  const Span<Vec3<double>> gamma = uploaded.impulses();
  upload(cpu, impulse.data(), gamma);
  Buffer<Cpu, Twist<double>> velocity(cpu, p.bodies.count);
  for_each(cpu, p.bodies.count, StartVelocity<double>{p, velocity.view()});
  AssembledResidual result;
  with_rows<double>(p.layout, [&](auto rows) {
    using R = decltype(rows);
    const double free = velocity_norm<R>(p, velocity.view());
    for_each(cpu, p.bodies.owned_count, BodyVelocity<R, double>{p, gamma, velocity.view()});
    ResidualEvaluator<Cpu, double> evaluator(cpu);
    const Residual r =
        evaluator.template evaluate_with_objective<R>(cpu, p, gamma, velocity.view());
    const double rms = model == AssembledModel::exact ? r.exact_rms : r.rms;
    result.absolute = rms * std::sqrt(static_cast<double>(p.contact_count));
    // At rest without loads every number is an error as it stands.
    const auto over = [&](double size) { return result.absolute / (size > 0 ? size : 1); };
    result.relative = result.unit_free = over(free);
    result.to_largest = over(std::max(free, velocity_norm<R>(p, velocity.view())));
    result.objective = r.objective;
  });
  return result;
}

std::vector<double> world_numbers(const std::vector<Vec3d>& vectors) {
  std::vector<double> numbers;
  numbers.reserve(3 * vectors.size());
  for (const Vec3d& v : vectors) numbers.insert(numbers.end(), {v.x, v.y, v.z});
  return numbers;
}

}  // namespace scree
