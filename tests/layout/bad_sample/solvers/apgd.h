#pragma once
#include <nlohmann/json.hpp>
#include <vector>

#include "collision/broad.h"
#include "kernels/types.h"
#include "solvers/solver.h"
