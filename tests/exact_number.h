#pragma once
// Numbers without rounding, for oracles: whole numbers of any length times a power of two. Every
// double is one; sums, differences and products stay ones.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "kernels/math/vec3.h"

namespace scree::exact {

class Number {
 public:
  Number() = default;
  /// Every double is one of these numbers.
  Number(double value) {
    if (value == 0) return;
    const double fraction = std::frexp(std::abs(value), &exponent_);
    exponent_ -= 53;
    const auto whole = static_cast<std::uint64_t>(std::ldexp(fraction, 53));
    digits_ = {static_cast<std::uint32_t>(whole), static_cast<std::uint32_t>(whole >> 32)};
    negative_ = value < 0;
    trim();
  }

  int sign() const { return digits_.empty() ? 0 : negative_ ? -1 : 1; }

  /// This number times 2^power.
  Number scaled(int power) const {
    Number r = *this;
    if (!r.digits_.empty()) r.exponent_ += power;
    return r;
  }
  /// Nearly its value.
  double approximately() const {
    double sum = 0;
    for (std::size_t k = digits_.size(); k-- > 0;) sum = sum * 4294967296.0 + digits_[k];
    return std::ldexp(negative_ ? -sum : sum, exponent_);
  }

  friend Number operator-(Number a) {
    a.negative_ = !a.negative_ && !a.digits_.empty();
    return a;
  }
  friend Number operator+(const Number& a, const Number& b) {
    if (a.digits_.empty()) return b;
    if (b.digits_.empty()) return a;
    Number r;
    r.exponent_ = std::min(a.exponent_, b.exponent_);
    const Digits x = shifted(a.digits_, a.exponent_ - r.exponent_);
    const Digits y = shifted(b.digits_, b.exponent_ - r.exponent_);
    if (a.negative_ == b.negative_) {
      r.digits_ = added(x, y);
      r.negative_ = a.negative_;
    } else {
      const bool first = !less(x, y);
      r.digits_ = first ? subtracted(x, y) : subtracted(y, x);
      r.negative_ = first ? a.negative_ : b.negative_;
    }
    r.trim();
    return r;
  }
  friend Number operator-(const Number& a, const Number& b) { return a + (-b); }
  friend Number operator*(const Number& a, const Number& b) {
    Number r;
    if (a.digits_.empty() || b.digits_.empty()) return r;
    r.exponent_ = a.exponent_ + b.exponent_;
    r.negative_ = a.negative_ != b.negative_;
    r.digits_.assign(a.digits_.size() + b.digits_.size(), 0);
    for (std::size_t i = 0; i < a.digits_.size(); ++i) {
      std::uint64_t carry = 0;
      for (std::size_t j = 0; j < b.digits_.size(); ++j) {
        carry += static_cast<std::uint64_t>(a.digits_[i]) * b.digits_[j] + r.digits_[i + j];
        r.digits_[i + j] = static_cast<std::uint32_t>(carry);
        carry >>= 32;
      }
      r.digits_[i + b.digits_.size()] = static_cast<std::uint32_t>(carry);
    }
    r.trim();
    return r;
  }
  friend bool operator<(const Number& a, const Number& b) { return (a - b).sign() < 0; }
  friend bool operator<=(const Number& a, const Number& b) { return (a - b).sign() <= 0; }

 private:
  using Digits = std::vector<std::uint32_t>;

  static Digits shifted(const Digits& a, int bits) {
    if (bits == 0) return a;
    Digits r(static_cast<std::size_t>(bits / 32), 0);
    const int rest = bits % 32;
    std::uint64_t carry = 0;
    for (const std::uint32_t d : a) {
      carry |= static_cast<std::uint64_t>(d) << rest;
      r.push_back(static_cast<std::uint32_t>(carry));
      carry >>= 32;
    }
    if (carry != 0) r.push_back(static_cast<std::uint32_t>(carry));
    return r;
  }
  static Digits added(const Digits& a, const Digits& b) {
    Digits r;
    std::uint64_t carry = 0;
    for (std::size_t k = 0; k < std::max(a.size(), b.size()) || carry != 0; ++k) {
      carry += (k < a.size() ? a[k] : 0ull) + (k < b.size() ? b[k] : 0ull);
      r.push_back(static_cast<std::uint32_t>(carry));
      carry >>= 32;
    }
    return r;
  }
  /// @pre a is not less than b.
  static Digits subtracted(const Digits& a, const Digits& b) {
    Digits r;
    std::int64_t borrow = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
      std::int64_t d = static_cast<std::int64_t>(a[k]) - (k < b.size() ? b[k] : 0) + borrow;
      borrow = d < 0 ? -1 : 0;
      r.push_back(static_cast<std::uint32_t>(d - borrow * (std::int64_t{1} << 32)));
    }
    return r;
  }
  static bool less(const Digits& a, const Digits& b) {
    const auto digit = [](const Digits& d, std::size_t k) { return k < d.size() ? d[k] : 0u; };
    for (std::size_t k = std::max(a.size(), b.size()); k-- > 0;)
      if (digit(a, k) != digit(b, k)) return digit(a, k) < digit(b, k);
    return false;
  }
  void trim() {
    while (!digits_.empty() && digits_.back() == 0) digits_.pop_back();
    if (digits_.empty()) {
      negative_ = false;
      exponent_ = 0;
      return;
    }
    std::size_t zeros = 0;
    while (digits_[zeros] == 0) ++zeros;
    digits_.erase(digits_.begin(), digits_.begin() + static_cast<std::ptrdiff_t>(zeros));
    exponent_ += 32 * static_cast<int>(zeros);
  }

  bool negative_ = false;
  Digits digits_;  ///< lowest first; the first and the last are not zero
  int exponent_ = 0;
};

/// Vectors of numbers or of polynomials.
template <class T>
using Vector = std::array<T, 3>;

inline Vector<Number> vector(const Vec3<double>& v) { return {v.x, v.y, v.z}; }

template <class T>
Vector<T> operator-(const Vector<T>& a, const Vector<T>& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
template <class T>
T dot(const Vector<T>& a, const Vector<T>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
template <class T>
Vector<T> cross(const Vector<T>& a, const Vector<T>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// A polynomial by ascending powers.
struct Polynomial {
  std::vector<Number> c;

  friend Polynomial operator+(const Polynomial& a, const Polynomial& b) {
    Polynomial r{std::vector<Number>(std::max(a.c.size(), b.c.size()))};
    for (std::size_t k = 0; k < a.c.size(); ++k) r.c[k] = a.c[k];
    for (std::size_t k = 0; k < b.c.size(); ++k) r.c[k] = r.c[k] + b.c[k];
    return r;
  }
  friend Polynomial operator-(const Polynomial& a, const Polynomial& b) {
    Polynomial minus = b;
    for (Number& n : minus.c) n = -n;
    return a + minus;
  }
  friend Polynomial operator*(const Polynomial& a, const Polynomial& b) {
    Polynomial r{std::vector<Number>(a.c.size() + b.c.size() - 1)};
    for (std::size_t i = 0; i < a.c.size(); ++i)
      for (std::size_t j = 0; j < b.c.size(); ++j) r.c[i + j] = r.c[i + j] + a.c[i] * b.c[j];
    return r;
  }

  /// p(t / 2), which has on [0, 1] what p has on [0, 1/2].
  Polynomial lower_half() const {
    Polynomial r = *this;
    for (std::size_t k = 0; k < c.size(); ++k) r.c[k] = c[k].scaled(-static_cast<int>(k));
    return r;
  }
  /// p(t + 1).
  Polynomial moved_by_one() const {
    Polynomial r = *this;
    for (std::size_t i = 0; i + 1 < c.size(); ++i)
      for (std::size_t j = c.size() - 1; j-- > i;) r.c[j] = r.c[j] + r.c[j + 1];
    return r;
  }
  /// Positive multiples of its Bernstein coefficients on [0, 1]: where all have one sign, so has p.
  std::vector<Number> bernstein() const {
    const std::size_t n = c.size();
    std::vector<Number> r(n);
    for (std::size_t j = 0; j < n; ++j) {
      for (std::size_t i = 0; i <= j; ++i) {
        double binomial = 1;  // n - 1 - i over j - i
        for (std::size_t k = 1; k <= j - i; ++k)
          binomial = binomial * static_cast<double>(n - i - k) / static_cast<double>(k);
        r[j] = r[j] + c[i] * Number(binomial);
      }
    }
    return r;
  }
};

}  // namespace scree::exact
