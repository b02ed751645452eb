#pragma once
// Several numbers in a vector register of the CPU, in the place of one Real: formulas written as
// templates run on all of them at a time.

#include <experimental/simd>
#include <limits>

#include "kernels/types.h"

namespace scree {

template <class Real>
class Lanes {
 public:
  using Vector = std::experimental::native_simd<Real>;
  static constexpr int kCount = static_cast<int>(Vector::size());

  /// One truth value per lane.
  class Mask {
   public:
    explicit Mask(typename Vector::mask_type m) : mask_(m) {}
    friend Mask operator&(const Mask& a, const Mask& b) { return Mask(a.mask_ & b.mask_); }

   private:
    friend class Lanes;
    typename Vector::mask_type mask_;
  };

  Lanes() = default;
  Lanes(Real x) : v_(x) {}
  explicit Lanes(const Vector& v) : v_(v) {}
  /// @param from  kCount numbers, aligned to their whole size
  static Lanes load(const Real* from) {
    return Lanes(Vector(from, std::experimental::vector_aligned));
  }
  /// kCount numbers from anywhere.
  static Lanes load_unaligned(const Real* from) {
    return Lanes(Vector(from, std::experimental::element_aligned));
  }
  const Vector& vector() const { return v_; }
  void store(Real* to) const { v_.copy_to(to, std::experimental::vector_aligned); }

  /// The sum over the lanes, from the first to the last.
  explicit operator double() const {
    double sum = 0;
    for (int k = 0; k < kCount; ++k) sum += static_cast<double>(v_[k]);
    return sum;
  }

  friend Lanes operator+(const Lanes& a, const Lanes& b) { return Lanes(a.v_ + b.v_); }
  friend Lanes operator-(const Lanes& a, const Lanes& b) { return Lanes(a.v_ - b.v_); }
  friend Lanes operator*(const Lanes& a, const Lanes& b) { return Lanes(a.v_ * b.v_); }
  friend Lanes operator-(const Lanes& a) { return Lanes(-a.v_); }
  Lanes& operator+=(const Lanes& b) { return v_ += b.v_, *this; }
  Lanes& operator-=(const Lanes& b) { return v_ -= b.v_, *this; }
  Lanes& operator*=(const Lanes& b) { return v_ *= b.v_, *this; }
  friend Lanes select(const Mask& condition, const Lanes& yes, const Lanes& no) {
    return no.unless(condition, yes);
  }
  friend Mask operator>=(const Lanes& a, const Lanes& b) { return Mask(a.v_ >= b.v_); }
  friend Mask operator<=(const Lanes& a, const Lanes& b) { return Mask(a.v_ <= b.v_); }

  friend bool is_zero(const Lanes& x) { return std::experimental::all_of(x.v_ == Vector(0)); }
  friend Lanes inverse(const Lanes& x) { return Lanes(Vector(1) / x.v_); }
  friend Lanes inverse_sqrt(const Lanes& x) {
    const Vector least(std::numeric_limits<Real>::min());
    return Lanes(Vector(1) / sqrt(std::experimental::max(x.v_, least)));
  }

 private:
  Lanes unless(const Mask& condition, const Lanes& other) const {
    Vector v = v_;
    std::experimental::where(condition.mask_, v) = other.v_;
    return Lanes(v);
  }

  Vector v_ = 0;
};

}  // namespace scree
