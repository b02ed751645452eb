#pragma once
// Fixture of tests that are compiled once per backend (scree::TestBackend) and typed
// over float and double.

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <type_traits>

namespace scree {

using Reals = ::testing::Types<float, double>;

template <class Real>
class BackendTest : public ::testing::Test {
 protected:
  void SetUp() override {
#ifdef __CUDACC__
    int count = 0;
    if (TestBackend::kIsDevice && (cudaGetDeviceCount(&count) != cudaSuccess || count == 0)) {
      GTEST_SKIP() << "no CUDA device";
    }
#endif
    backend_ = std::make_unique<TestBackend>();
  }

  TestBackend& backend() { return *backend_; }

  /// Tolerance of the build: in float twenty times that of double, at least what rounding leaves
  /// and never more than 1e-3.
  static double tolerance(double in_double, double float_floor = 1e-5) {
    if (std::is_same_v<Real, double>) return in_double;
    return std::min(1e-3, std::max(20 * in_double, float_floor));
  }

 private:
  std::unique_ptr<TestBackend> backend_;
};

}  // namespace scree
