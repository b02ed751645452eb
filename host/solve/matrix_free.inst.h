// Compiled once per backend.
#include <chrono>
#include <type_traits>
#include <utility>

#include "host/problems/upload_problem.h"
#include "host/solve/matrix_free.h"
#include "solvers/compiled_parts.inst.h"

namespace scree {
namespace {

std::unique_ptr<BuildBackend> make_backend(const WorldOptions& world) {
  if constexpr (BuildBackend::kIsDevice) {
    return std::make_unique<BuildBackend>(world.device);
  } else {
    return std::make_unique<BuildBackend>(world.threads);
  }
}

template <class Real>
class Uploaded final : public MatrixFreeProblem {
 public:
  Uploaded(const BodyProblem& problem, const WorldOptions& world)
      : backend_(make_backend(world)), uploaded_(*backend_, problem) {}

  MatrixFreeSolution solve(const std::string& name, AssembledModel model,
                           const std::vector<Vec3d>& guess, int limit, int inner_limit) override {
    BuildBackend& b = *backend_;
    const Span<Vec3<Real>> gamma = uploaded_.impulses();
    fill(b, gamma, Vec3<Real>{});
    if (!guess.empty()) {
      const std::vector<Vec3<Real>> start(guess.begin(), guess.end());
      upload(b, start.data(), gamma);
    }
    fill(b, uploaded_.problem().mark, Index(-1));  // nothing is carried from run to run
    const bool exact = model == AssembledModel::exact;
    SolverParams params;
    params.max_iterations = exact ? inner_limit : limit;
    auto solver = make_solver<BuildBackend, Real>(name, params);
    if (exact) {
      solver = std::make_unique<CoulombFixedPoint<BuildBackend, Real>>(std::move(solver), limit);
    }
    // The fixed point takes any tolerance but zero as leave to end inner solves early.
    const double tolerance = exact ? 1e-300 : 0;
    b.synchronize();
    const auto start = std::chrono::steady_clock::now();
    const SolveStats stats = solver->solve(b, uploaded_.problem(), gamma, tolerance);
    b.synchronize();
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    MatrixFreeSolution solution;
    for (const Vec3<Real>& impulse : download(b, Span<const Vec3<Real>>(gamma)))
      solution.impulse.push_back(Vec3d(impulse));
    solution.iterations = stats.iterations;
    solution.applications = stats.applications;
    solution.seconds = seconds.count();
    return solution;
  }

 private:
  std::unique_ptr<BuildBackend> backend_;
  UploadedProblem<BuildBackend, Real> uploaded_;
};

}  // namespace

template <>
std::unique_ptr<MatrixFreeProblem> upload_matrix_free_on<BuildBackend>(const BodyProblem& problem,
                                                                       const WorldOptions& world) {
  if (world.precision == Precision::double_precision)
    return std::make_unique<Uploaded<double>>(problem, world);
  return std::make_unique<Uploaded<float>>(problem, world);
}

}  // namespace scree
