#pragma once
// Reads parts of the arrays of a VTKHDF file, as its frames use them.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "host/io/h5.h"

namespace scree::test {

/// `count` rows of an array, from row `first` on.
template <class T>
std::vector<T> rows(const h5::Group& vtk, const std::string& name, std::int64_t first,
                    std::int64_t count) {
  std::vector<T> out(static_cast<std::size_t>(count) * vtk.shape(name).values_per_row());
  vtk.read(name, std::span<T>(out), static_cast<std::uint64_t>(first));
  return out;
}

}  // namespace scree::test
