#pragma once
// Exact friction for tests of solvers, as the library of solvers has it compiled.

#include "solvers/coulomb.h"

namespace scree {
using BuildBackend = TestBackend;
}
#include "solvers/compiled_parts.inst.h"
