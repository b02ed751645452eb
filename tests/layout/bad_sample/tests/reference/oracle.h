#pragma once
#include <Eigen/Dense>

#include "kernels/types.h"
#include "tests/reference/dense.h"
