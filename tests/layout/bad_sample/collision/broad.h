#pragma once
#include "../kernels/types.h"
#include "collision/bins.h"
#include "kernels/types.h"
#include "solvers/solver.h"
