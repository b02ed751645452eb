// Contacts packed in 8 bytes, packed and read on the backend.

#include <cmath>
#include <random>
#include <vector>

#include "kernels/contact/packed_contact.h"
#include "tests/backend_fixture.h"

namespace scree {
namespace {

struct PackedTrip {
  static constexpr const char* name = "test_packed_trip";
  Span<Vec3<float>> normal;
  Span<float> weight;
  Span<Index> local;
  SCREE_HD void operator()(Index c) const {
    const PackedContact packed(normal[c], weight[c], static_cast<std::uint32_t>(local[c]));
    normal[c] = packed.normal();
    weight[c] = packed.weight();
    local[c] = static_cast<Index>(packed.local());
  }
};

class PackedContactTest : public BackendTest<float> {
 protected:
  struct Contacts {
    std::vector<Vec3<float>> normal;
    std::vector<float> weight;
    std::vector<Index> local;

    void add(const Vec3<float>& n, float w, Index a) {
      normal.push_back(n);
      weight.push_back(PackedContact::round_weight(w));
      local.push_back(a);
    }
  };
  Contacts after(const Contacts& in) {
    TestBackend& b = backend();
    Buffer<TestBackend, Vec3<float>> normal(b);
    Buffer<TestBackend, float> weight(b);
    Buffer<TestBackend, Index> local(b);
    upload(b, in.normal, normal);
    upload(b, in.weight, weight);
    upload(b, in.local, local);
    for_each(b, static_cast<Index>(in.normal.size()),
             PackedTrip{normal.view(), weight.view(), local.view()});
    return {download(b, normal.view()), download(b, weight.view()), download(b, local.view())};
  }
};

TEST_F(PackedContactTest, NormalsComeBackNearlyAsTheyWere) {
  std::mt19937 random(3);
  std::normal_distribution<double> gauss;
  Contacts in;
  for (int k = 0; k < 20000; ++k) {
    Vec3<double> n(gauss(random), gauss(random), gauss(random));
    if (k % 4 == 1) n[k / 4 % 3] *= 1e-6;  // near an edge of the octahedron
    if (k % 4 == 2) n[k / 4 % 3] *= 1e6;   // near a corner
    n *= 1 / std::sqrt(dot(n, n));
    in.add(Vec3<float>(n), 1, 0);
  }
  const Contacts out = after(in);
  for (std::size_t k = 0; k < in.normal.size(); ++k) {
    const Vec3<double> was(in.normal[k]), is(out.normal[k]);
    // Half a step, 2.4e-7, in x and y, their sum in z, where the octahedron is sqrt(3) away, and
    // the rounding of a few operations.
    ASSERT_LE(std::sqrt(dot(is - was, is - was)), 1.3e-6) << was.x << " " << was.y << " " << was.z;
    ASSERT_NEAR(dot(is, is), 1, 5e-7);
  }
}

TEST_F(PackedContactTest, NormalsAlongAxesAreExact) {
  Contacts in;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float sign : {-1.0f, 1.0f}) {
      Vec3<float> n;
      n[axis] = sign;
      in.add(n, 1, 0);
    }
  }
  EXPECT_EQ(after(in).normal, in.normal);
}

TEST_F(PackedContactTest, WeightsAndBodiesComeBack) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> exponent(-37, 37);
  Contacts in;
  for (int k = 0; k < 4096; ++k)
    in.add({0.6f, 0, -0.8f}, std::pow(10.0f, exponent(random)), k % 256);
  const Contacts out = after(in);
  EXPECT_EQ(out.weight, in.weight);
  EXPECT_EQ(out.local, in.local);
}

/// Upward, by less than one part in 16; what is rounded already stays.
TEST_F(PackedContactTest, WeightsAreRoundedUp) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> exponent(-37, 37);
  for (int k = 0; k < 1000; ++k) {
    const float weight = std::pow(10.0f, exponent(random));
    const float rounded = PackedContact::round_weight(weight);
    EXPECT_GE(rounded, weight);
    EXPECT_LT(rounded, weight * (1 + 1 / 16.0f));
    EXPECT_EQ(PackedContact::round_weight(rounded), rounded);
  }
  EXPECT_EQ(PackedContact::round_weight(1), 1);
  EXPECT_EQ(PackedContact::round_weight(2.5f), 2.5f);
}

}  // namespace
}  // namespace scree
