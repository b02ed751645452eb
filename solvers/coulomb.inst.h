// Compiled once per backend, which the build names BuildBackend.
#include "solvers/coulomb.h"

namespace scree {

template class CoulombFixedPoint<BuildBackend, float>;
template class CoulombFixedPoint<BuildBackend, double>;

}  // namespace scree
