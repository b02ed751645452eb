// Compiled once per backend: its solvers of assembled problems by name.
#include "solvers/assembled/backend_solver.h"

namespace scree {

template <>
std::shared_ptr<BuildBackend> make_assembled_backend<BuildBackend>([[maybe_unused]] int threads) {
  if constexpr (BuildBackend::kIsDevice) {
    return std::make_shared<BuildBackend>();
  } else {
    return std::make_shared<BuildBackend>(threads);
  }
}

template <>
std::unique_ptr<AssembledSolver> make_assembled_solver_on<BuildBackend>(
    const std::string& name, std::shared_ptr<BuildBackend> backend) {
#define SCREE_ASSEMBLED_SOLVER(known)
#define SCREE_ASSEMBLED_BACKEND_SOLVER(known) \
  if (name == #known) return make_assembled_##known<BuildBackend>(std::move(backend));
#include "solvers/assembled/solver_list.inc"
#undef SCREE_ASSEMBLED_BACKEND_SOLVER
#undef SCREE_ASSEMBLED_SOLVER
  return nullptr;
}

}  // namespace scree
