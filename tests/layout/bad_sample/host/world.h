#pragma once
#include <cuda_runtime.h>

#include "kernels/backend/cuda.cuh"
#include "solvers/solver.h"
// #include "scenes/wall.h" is only a comment
