#pragma once
// Loads that redundant joints may share in many ways.

#include <vector>

#include "dynamics/rigid/sparse_factor.h"

namespace scree {

/// How far to go along directions so that the sum of squares of some values is least.
/// @param values      by row
/// @param directions  entries by direction, their column; linearly independent
/// @return  by direction: with these times the directions taken away, values are least. Empty where rounding leaves none
std::vector<double> ways_to_least(const std::vector<double>& values,
                                  const std::vector<FactorEntry>& directions);

}  // namespace scree
