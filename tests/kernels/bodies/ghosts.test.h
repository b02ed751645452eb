// Rows of bodies on their way to other ranks: packed and taken out again, and where each has its place.

#include <cstring>
#include <utility>
#include <vector>

#include "kernels/bodies/ghosts.h"
#include "kernels/math/quat.h"
#include "kernels/math/vec3.h"
#include "tests/backend_fixture.h"

namespace scree {
namespace {

template <class Real>
class GhostRowsTest : public BackendTest<Real> {
 protected:
  using B = TestBackend;
  static constexpr Index kBodies = 9;

  /// State k of an array: another one for each body and each number.
  static Vec3<double> place(Index k) { return {0.1 * k, 1 + 0.3 * k, -7.0 * k}; }
  static Quat<Real> turn(Index k) {
    return Quat<Real>(Quat<double>{1, 0.5 * k, -0.25 * k, 2.0 + k});
  }

  template <class T, class F>
  static std::vector<T> rows(const F& f) {
    std::vector<T> all;
    for (Index k = 0; k < kBodies; ++k) all.push_back(f(k));
    return all;
  }
};
TYPED_TEST_SUITE(GhostRowsTest, Reals);

/// In float a row of the second array begins at a multiple of 4 bytes, of which the first one has numbers of 8.
TYPED_TEST(GhostRowsTest, ComeOutAsTheyWentIn) {
  using Fixture = TestFixture;
  using B = TestBackend;
  B& b = this->backend();
  const std::vector<Vec3<TypeParam>> speeds = Fixture::template rows<Vec3<TypeParam>>(
      [](Index k) { return Vec3<TypeParam>(Fixture::place(3 * k)); });
  const auto places = Fixture::template rows<Vec3<double>>(Fixture::place);
  const auto turns = Fixture::template rows<Quat<TypeParam>>(Fixture::turn);
  const std::vector<Index> sent{7, 2, 4};
  Buffer<B, Vec3<TypeParam>> speed(b);
  Buffer<B, Vec3<double>> position(b);
  Buffer<B, Quat<TypeParam>> orientation(b);
  Buffer<B, Index> body(b);
  upload(b, speeds, speed);
  upload(b, places, position);
  upload(b, turns, orientation);
  upload(b, sent, body);
  using Arrays = RowArrays<Vec3<TypeParam>, Vec3<double>, Quat<TypeParam>>;
  EXPECT_EQ(Arrays::kBytes, static_cast<Index>(7 * sizeof(TypeParam) + 24));
  const Arrays arrays(speed.view(), position.view(), orientation.view());
  Buffer<B, unsigned char> bytes(b, Offset{3} * Arrays::kBytes);
  for_each(b, 3, PackRows<Arrays>{std::as_const(body).view(3), arrays, bytes.data()});
  constexpr Index first = 5;
  for_each(b, 3, UnpackRows<Arrays>{bytes.data(), first, arrays});
  const auto speeds_now = download(b, speed.view());
  const auto places_now = download(b, position.view());
  const auto turns_now = download(b, orientation.view());
  for (Index k = 0; k < Fixture::kBodies; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const bool is_ghost = k >= first && k < first + 3;
    const auto from =
        is_ghost ? static_cast<std::size_t>(sent[static_cast<std::size_t>(k - first)]) : i;
    EXPECT_EQ(norm2(speeds_now[i] - speeds[from]), 0) << k;
    EXPECT_EQ(norm2(places_now[i] - places[from]), 0) << k;
    EXPECT_EQ(turns_now[i].x, turns[from].x) << k;
    EXPECT_EQ(turns_now[i].z, turns[from].z) << k;
  }
}

/// Words of a row are those of its arrays, one after the other.
TYPED_TEST(GhostRowsTest, AreTakenApartWordByWord) {
  using Fixture = TestFixture;
  if constexpr (TestBackend::kIsDevice) return;  // they are in memory of the host
  using B = TestBackend;
  B& b = this->backend();
  Buffer<B, Vec3<double>> position(b);
  Buffer<B, Quat<TypeParam>> orientation(b);
  upload(b, Fixture::template rows<Vec3<double>>(Fixture::place), position);
  upload(b, Fixture::template rows<Quat<TypeParam>>(Fixture::turn), orientation);
  using Arrays = RowArrays<Vec3<double>, Quat<TypeParam>>;
  const Arrays arrays(position.view(), orientation.view());
  const auto words = Arrays::kBytes / static_cast<Index>(sizeof(std::uint32_t));
  std::vector<unsigned char> row(static_cast<std::size_t>(Arrays::kBytes));
  arrays.store(4, row.data());
  for (Index k = 0; k < words; ++k) {
    std::uint32_t word;
    std::memcpy(&word, row.data() + static_cast<std::size_t>(k) * sizeof(word), sizeof(word));
    EXPECT_EQ(*arrays.piece(4, k), word) << k;
  }
}

/// Two ranks get rows: each finds its own behind those of lower ranks, in the room of the exchange.
TYPED_TEST(GhostRowsTest, HaveTheirPlacesInTheRoomsOfOthers) {
  std::vector<unsigned char> memory(5000);
  GhostLinks links;
  links.targets = 2;
  links.target[0] = {0, 3, 10, memory.data()};
  links.target[1] = {3, 5, 0, memory.data() + 1};
  links.room_bytes = 1000;
  constexpr Index row = 24;
  const auto place = [&](Index k, int room, int of) {
    return links.place(k, room, row) - (memory.data() + of);
  };
  EXPECT_EQ(place(0, 0, 0), 240);
  EXPECT_EQ(place(2, 3, 0), 3000 + 12 * 24);
  EXPECT_EQ(place(3, 2, 1), 2000);
  EXPECT_EQ(place(4, 1, 1), 1024);
}

/// Bodies that are sent have new places, their order among each other stays.
TYPED_TEST(GhostRowsTest, FollowANewOrderOfBodies) {
  using B = TestBackend;
  B& b = this->backend();
  Buffer<B, Index> new_of_old(b), sent(b);
  upload(b, std::vector<Index>{3, 0, 1, 4, 2}, new_of_old);
  upload(b, std::vector<Index>{4, 0, 3, 4}, sent);
  for_each(b, 4, RenumberSent{std::as_const(new_of_old).view(5), sent.view(4)});
  EXPECT_EQ(download(b, sent.view(4)), (std::vector<Index>{2, 3, 4, 2}));
}

}  // namespace
}  // namespace scree
