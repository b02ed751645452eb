#pragma once
// Random numbers with the same values on every platform. The generator of the standard library is
// specified to the bit, its distributions are not; the few that are needed are written out here.
// Where a product is added to something, std::fma is spelled out: left to the compiler, whether the
// product is rounded first depends on the platform.

#include <cmath>
#include <cstdint>
#include <random>

namespace scree {

class RandomNumbers {
 public:
  /// @param stream  independent sequences of one seed, such as one per entry of `particles`
  RandomNumbers(std::uint64_t seed, std::uint64_t stream)
      : generator_(mixed(seed + 0x9e3779b97f4a7c15ull * (stream + 1))) {}

  /// Uniform in [0, 1), a multiple of 2^-53.
  double unit() { return static_cast<double>(generator_() >> 11) * 0x1.0p-53; }

  /// Uniform in [low, high).
  double uniform(double low, double high) { return std::fma(high - low, unit(), low); }

  /// Uniform in 0 .. count - 1; count > 0. The bias of the product is below 2^-32
  /// for 32-bit counts.
  std::uint64_t below(std::uint64_t count) {
    return static_cast<std::uint64_t>(unit() * static_cast<double>(count));
  }

  /// Standard normal, by the ratio of uniforms (Kinderman & Monahan 1977). The value is a quotient
  /// of uniforms, so a last-bit difference between math libraries does not enter it.
  double normal() {
    for (;;) {
      const double u = 1.0 - unit();                         // in (0, 1]
      const double v = 1.7155277699214135 * (unit() - 0.5);  // 2 sqrt(2 / e) wide
      const double x = v / u;
      if (x * x <= -4.0 * std::log(u)) return x;
    }
  }

 private:
  /// Finalizer of splitmix64: neighboring seeds give unrelated sequences.
  static std::uint64_t mixed(std::uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
    return z ^ (z >> 31);
  }

  std::mt19937_64 generator_;
};

}  // namespace scree
