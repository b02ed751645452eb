// What the library of solvers has compiled for the backend that is named BuildBackend: sources that include this call it, and do
// not compile it again.

#include "solvers/coulomb.h"

namespace scree {

extern template class CoulombFixedPoint<BuildBackend, float>;
extern template class CoulombFixedPoint<BuildBackend, double>;

}  // namespace scree
