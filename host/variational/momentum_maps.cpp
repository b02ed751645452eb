#include <fmt/format.h>

#include <numeric>
#include <utility>

#include "host/error.h"
#include "host/mechanical_system.h"

namespace scree {
namespace {

void require_size(const std::string& name, std::size_t size, std::size_t expected) {
  if (size != expected)
    throw InputError(fmt::format(
        "momentum \"{}\" has {} numbers, expected {} for these coordinates", name, size, expected));
}

}  // namespace

MomentumMap linear_momentum(std::string name, std::vector<double> direction) {
  auto value = [name, direction = std::move(direction)](std::span<const double>,
                                                        std::span<const double> p) {
    require_size(name, direction.size(), p.size());
    return std::inner_product(p.begin(), p.end(), direction.begin(), 0.0);
  };
  return {std::move(name), std::move(value)};
}

MomentumMap angular_momentum(std::string name, std::vector<double> generator) {
  auto value = [name, generator = std::move(generator)](std::span<const double> q,
                                                        std::span<const double> p) {
    const std::size_t n = q.size();
    require_size(name, generator.size(), n * n);
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j) sum += p[i] * generator[i * n + j] * q[j];
    return sum;
  };
  return {std::move(name), std::move(value)};
}

}  // namespace scree
