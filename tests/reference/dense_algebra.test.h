// Eigen in units of a backend.

#include <gtest/gtest.h>

#include "tests/reference/dense_algebra.h"

namespace scree::oracle {
namespace {

// Units that disagree share functions of the same name: with those of nvcc without vectors, others with them, least_norm() was called
// with what it could not read.
TEST(DenseAlgebra, AllUnitsTakeAsManyNumbersAtATime) {
  EXPECT_EQ(Eigen::internal::packet_traits<double>::size, numbers_at_a_time());
}

}  // namespace
}  // namespace scree::oracle
