#pragma once
// Checks that the validation of all stored problems shares. Internal to host/.

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <vector>

#include "host/error.h"

namespace scree {

/// @throws InputError "<name> has <size> values, expected <expected> (<why>)"
template <class T>
void require_size(const std::vector<T>& values, std::size_t expected, const std::string& name,
                  const char* why) {
  if (values.size() != expected)
    throw InputError(
        fmt::format("{} has {} values, expected {} ({})", name, values.size(), expected, why));
}

/// @throws InputError "<name>[<k>] is <value>, expected <what>" for the first value that fails
template <class T, class Accept>
void require_each(const std::vector<T>& values, const std::string& name, const char* what,
                  Accept accept) {
  for (std::size_t k = 0; k < values.size(); ++k)
    if (!accept(values[k]))
      throw InputError(fmt::format("{}[{}] is {}, expected {}", name, k, values[k], what));
}

inline void require_finite(const std::vector<double>& values, const std::string& name) {
  require_each(values, name, "a finite number", [](double x) { return std::isfinite(x); });
}

inline void require_not_negative(const std::vector<double>& values, const std::string& name) {
  require_each(values, name, "a finite number that is not negative",
               [](double x) { return std::isfinite(x) && x >= 0; });
}

}  // namespace scree
