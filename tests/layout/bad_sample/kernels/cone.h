#pragma once
#include <Eigen/Dense>
#include <cmath>
#include <cub/cub.cuh>

#include "kernels/types.h"
#include "solvers/apgd.h"
