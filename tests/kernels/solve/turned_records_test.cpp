// Records turned into lanes against plain loads of their numbers.

#include "kernels/solve/turned_records.h"

#include <gtest/gtest.h>

#include <numeric>
#include <vector>

namespace scree {
namespace {

template <class Real>
class TurnedRecordsTest : public ::testing::Test {
 protected:
  using L = Lanes<Real>;
  static constexpr int kCount = L::kCount;

  static std::vector<Real> lanes_of(const L& lanes) {
    alignas(64) Real out[kCount];
    lanes.store(out);
    return {out, out + kCount};
  }
  /// Records whose numbers are all different.
  template <class Record>
  static std::vector<Record> records(int count) {
    std::vector<Record> all(static_cast<std::size_t>(count));
    for (int k = 0; k < count; ++k) {
      Real numbers[sizeof(Record) / sizeof(Real)];
      std::iota(std::begin(numbers), std::end(numbers), static_cast<Real>(10 * k));
      std::memcpy(&all[static_cast<std::size_t>(k)], numbers, sizeof(Record));
    }
    return all;
  }
};
using Reals = ::testing::Types<float, double>;
TYPED_TEST_SUITE(TurnedRecordsTest, Reals);

TYPED_TEST(TurnedRecordsTest, VectorsGoThereAndBack) {
  using Real = TypeParam;
  using Turned = TurnedRecords<Real>;
  if constexpr (!Turned::kWorks) {
    GTEST_SKIP() << "registers of this processor hold no four numbers";
  } else {
    constexpr int kShift = 3;  // no alignment is asked for
    const auto all = this->template records<Vec3<Real>>(this->kCount + kShift);
    const auto turned = Turned::vectors(all.data() + kShift);
    const auto x = this->lanes_of(turned.x), y = this->lanes_of(turned.y),
               z = this->lanes_of(turned.z);
    std::vector<Vec3<Real>> back(static_cast<std::size_t>(this->kCount + kShift));
    Turned::store(turned, back.data() + kShift);
    for (std::size_t k = 0; k < x.size(); ++k) {
      const Vec3<Real>& from = all[k + kShift];
      EXPECT_EQ(Vec3<Real>(x[k], y[k], z[k]), from) << "lane " << k;
      EXPECT_EQ(back[k + kShift], from) << "lane " << k;
    }
  }
}

TYPED_TEST(TurnedRecordsTest, TwistsComeFromAnywhere) {
  using Real = TypeParam;
  using Turned = TurnedRecords<Real>;
  if constexpr (!Turned::kWorks) {
    GTEST_SKIP() << "registers of this processor hold no four numbers";
  } else {
    const int bodies = 3 * this->kCount;
    const auto all = this->template records<Twist<Real>>(bodies);
    std::vector<Index> body;
    for (int k = 0; k < this->kCount; ++k) body.push_back((7 * k + 5) % bodies);
    body[1] = body[0];
    const auto turned = Turned::twists(all.data(), body.data());
    const auto vx = this->lanes_of(turned.linear.x), vy = this->lanes_of(turned.linear.y),
               vz = this->lanes_of(turned.linear.z), wx = this->lanes_of(turned.angular.x),
               wy = this->lanes_of(turned.angular.y), wz = this->lanes_of(turned.angular.z);
    for (std::size_t k = 0; k < vx.size(); ++k) {
      const Twist<Real>& from = all[static_cast<std::size_t>(body[k])];
      EXPECT_EQ(Vec3<Real>(vx[k], vy[k], vz[k]), from.linear) << "lane " << k;
      EXPECT_EQ(Vec3<Real>(wx[k], wy[k], wz[k]), from.angular) << "lane " << k;
    }
  }
}

}  // namespace
}  // namespace scree
