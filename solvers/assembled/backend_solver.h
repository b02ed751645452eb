#pragma once
// Solvers of assembled problems that run on any backend. The class of each stands in
// solvers/assembled/<name>.inst.h, which is compiled once per backend and defines
// make_assembled_<name>() for it; solver_list.inc has the names.

#include <memory>
#include <utility>

#include "solvers/assembled/assembled_solver.h"
#include "solvers/assembled/backend_problem.h"

namespace scree {

class Cpu;
class Cuda;

/// A backend for solvers. @param threads  of a CPU; 0 takes what OpenMP offers
/// @throws DeviceError when there is no device
template <class B>
std::shared_ptr<B> make_assembled_backend(int threads);

/// Makes a solver for a backend. @return null when the name is none of those that run on backends
template <class B>
std::unique_ptr<AssembledSolver> make_assembled_solver_on(const std::string& name,
                                                          std::shared_ptr<B> backend);

#define SCREE_ASSEMBLED_SOLVER(name)
#define SCREE_ASSEMBLED_BACKEND_SOLVER(name) \
  template <class B>                         \
  std::unique_ptr<AssembledSolver> make_assembled_##name(std::shared_ptr<B> backend);
#include "solvers/assembled/solver_list.inc"
#undef SCREE_ASSEMBLED_BACKEND_SOLVER
#undef SCREE_ASSEMBLED_SOLVER

/// Holds the backend of a solver, and the library for its products: setting that up takes longer
/// than many a solve, and is none of its time.
template <class B>
class BackendSolver : public AssembledSolver {
 public:
  explicit BackendSolver(std::shared_ptr<B> backend)
      : backend_(std::move(backend)), product_(*backend_) {}

 protected:
  B& backend() const { return *backend_; }
  /// @param p  outlives the result
  BackendProblem<B> upload_problem(const AssembledProblem& p) const {
    return BackendProblem<B>(*backend_, product_, p);
  }

 private:
  std::shared_ptr<B> backend_;
  BlockProduct<B> product_;
};

}  // namespace scree
