#pragma once
// Random numbers as a function of (seed, index): any order, any backend, the same values.

#include "kernels/contact/contact_problem.h"

namespace scree::bench {

/// 64 mixed bits of a counter (splitmix64).
SCREE_HD inline std::uint64_t random_bits(std::uint64_t seed, std::uint64_t index) {
  std::uint64_t x = (index + 1) * 0x9e3779b97f4a7c15ull + seed * 0xd1b54a32d192ed03ull;
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ x >> 27) * 0x94d049bb133111ebull;
  return x ^ x >> 31;
}

/// Uniform in [-1, 1).
template <class Real>
SCREE_HD Real random_real(std::uint64_t seed, std::uint64_t index) {
  return static_cast<Real>(static_cast<double>(random_bits(seed, index) >> 11) * 0x1p-52 - 1);
}

template <class Real>
SCREE_HD Vec3<Real> random_vec3(std::uint64_t seed, std::uint64_t index) {
  return {random_real<Real>(seed, 3 * index), random_real<Real>(seed, 3 * index + 1),
          random_real<Real>(seed, 3 * index + 2)};
}

/// Element program: components uniform in scale [-1, 1), plus an offset.
template <class Real>
struct RandomVectors {
  static constexpr const char* name = "random_vectors";
  std::uint64_t seed;
  Real scale;
  Vec3<Real> offset;
  Span<Vec3<Real>> out;
  SCREE_HD void operator()(Index i) const {
    out[i] = offset + scale * random_vec3<Real>(seed, static_cast<std::uint64_t>(i));
  }
};

/// Element program: the same for body rates; the offset goes to the linear part.
template <class Real>
struct RandomTwists {
  static constexpr const char* name = "random_twists";
  std::uint64_t seed;
  Real scale;
  Vec3<Real> offset;
  Span<Twist<Real>> out;
  SCREE_HD void operator()(Index i) const {
    const auto k = 2 * static_cast<std::uint64_t>(i);
    out[i] = {offset + scale * random_vec3<Real>(seed, k), scale * random_vec3<Real>(seed, k + 1)};
  }
};

/// Element program: the low `bits` of random words.
template <class T>
struct RandomWords {
  static constexpr const char* name = "random_words";
  std::uint64_t seed;
  int bits;
  Span<T> out;
  SCREE_HD void operator()(Index i) const {
    out[i] = static_cast<T>(random_bits(seed, static_cast<std::uint64_t>(i)) >> (64 - bits));
  }
};

}  // namespace scree::bench
