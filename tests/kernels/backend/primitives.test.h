// Parallel primitives at sizes 0, 1, a warp plus one, a block plus one, and large.
#include <cstdint>
#include <random>
#include <vector>

#include "tests/backend_fixture.h"

namespace scree {
namespace {

const std::vector<Index> kSizes{0, 1, 33, 257, 100003};

struct SquareElements {
  static constexpr const char* name = "square";
  Span<Index> out;
  SCREE_HD void operator()(Index i) const { out[i] = i % 1000 * (i % 1000); }
};

struct ReadElement {
  static constexpr const char* name = "read";
  Span<const double> in;
  SCREE_HD Sums<1> operator()(Index i) const { return {{in[i]}}; }
};

template <class B>
double sum_of(B& b, const std::vector<double>& values) {
  Buffer<B, double> in(b);
  upload(b, values, in);
  Buffer<B, Sums<1>> result(b, 1);
  reduce<Sums<1>>(b, static_cast<Index>(values.size()),
                  ReadElement{std::as_const(in).view(static_cast<Offset>(values.size()))},
                  StoreResult<Sums<1>>{result.data()});
  return fetch(b, result.data()).value[0];
}

template <class B>
void sort_on(B& b, std::vector<std::uint64_t>& keys, std::vector<Index>& values, int bits) {
  Buffer<B, std::uint64_t> key_buffer(b);
  Buffer<B, Index> value_buffer(b);
  SortSpace<B> space(b);
  upload(b, keys, key_buffer);
  upload(b, values, value_buffer);
  const auto n = static_cast<Offset>(keys.size());
  sort_pairs(b, space, key_buffer.view(n), value_buffer.view(n), bits);
  keys = download(b, key_buffer.view(n));
  values = download(b, value_buffer.view(n));
}

std::vector<double> random_values(Index n) {
  std::mt19937 generator(3);
  std::normal_distribution<double> normal;
  std::vector<double> values(n);
  for (double& v : values) v = normal(generator);
  return values;
}

class PrimitivesTest : public BackendTest<double> {};

TEST_F(PrimitivesTest, ForEachVisitsEveryElementOnce) {
  for (Index n : kSizes) {
    Buffer<TestBackend, Index> out(backend(), n);
    for_each(backend(), n, SquareElements{out.view(n)});
    const std::vector<Index> host = download(backend(), out.view(n));
    for (Index i = 0; i < n; ++i) ASSERT_EQ(host[i], i % 1000 * (i % 1000)) << "size " << n;
  }
}

TEST_F(PrimitivesTest, FillAndCopyKeepValues) {
  for (Index n : kSizes) {
    Buffer<TestBackend, double> from(backend(), n), to(backend(), n);
    fill(backend(), from.view(n), 2.5);
    copy(backend(), std::as_const(from).view(n), to.view(n));
    for (double v : download(backend(), to.view(n))) ASSERT_EQ(v, 2.5);
  }
}

TEST_F(PrimitivesTest, NotesAreWhatTheQueueLeft) {
  Buffer<TestBackend, double> value(backend(), 2);
  fill(backend(), value.view(), 1.5);
  send_note(backend(), std::as_const(value).data());
  fill(backend(), value.view(), 2.5);
  EXPECT_EQ(fetch(backend(), std::as_const(value).data() + 1), 2.5);
  EXPECT_EQ(read_note<double>(backend()), 1.5);
  send_note(backend(), std::as_const(value).data());
  EXPECT_EQ(read_note<double>(backend()), 2.5);
  EXPECT_EQ(read_note<double>(backend()), 2.5);
}

TEST_F(PrimitivesTest, ReduceAddsAllElements) {
  for (Index n : kSizes) {
    const std::vector<double> values = random_values(n);
    long double exact = 0, size = 0;
    for (double v : values) exact += v, size += std::abs(v);
    EXPECT_NEAR(sum_of(backend(), values), static_cast<double>(exact),
                1e-14 * static_cast<double>(size))
        << n;
  }
}

TEST_F(PrimitivesTest, ReduceToHostGivesTheTotal) {
  const std::vector<double> values{3, 1, 4, 1, 5};
  Buffer<TestBackend, double> in(backend());
  upload(backend(), values, in);
  double sum = 0;
  for (Index n = 0; n <= 5; ++n) {
    EXPECT_EQ(reduce_to_host<Sums<1>>(backend(), n, ReadElement{in.view()}).value[0], sum) << n;
    if (n < 5) sum += values[static_cast<std::size_t>(n)];
  }
}

TEST_F(PrimitivesTest, ReduceRepeatsItsBits) {
  const std::vector<double> values = random_values(100003);
  const double first = sum_of(backend(), values);
  for (int repeat = 0; repeat < 5; ++repeat) EXPECT_EQ(sum_of(backend(), values), first);
}

TEST_F(PrimitivesTest, ExclusiveScanMatchesTheSerialSum) {
  // Also where a device goes from one block of threads to many.
  std::vector<Index> sizes = kSizes;
  for (Index n : {1024, 1025, 40000, 1 << 16, (1 << 16) + 1}) sizes.push_back(n);
  for (Index n : sizes) {
    std::vector<Index> in(n);
    for (Index i = 0; i < n; ++i) in[i] = (i * 37) % 11;
    Buffer<TestBackend, Index> in_buffer(backend());
    Buffer<TestBackend, Offset> out(backend(), n + 1);
    upload(backend(), in, in_buffer);
    exclusive_scan(backend(), std::as_const(in_buffer).view(n), out.view(n + 1));
    const std::vector<Offset> host = download(backend(), out.view(n + 1));
    Buffer<TestBackend, Index> narrow(backend(), n + 1);
    exclusive_scan(backend(), std::as_const(in_buffer).view(n), narrow.view(n + 1));
    const std::vector<Index> narrow_host = download(backend(), narrow.view(n + 1));
    Offset sum = 0;
    for (Index i = 0; i < n; ++i) {
      ASSERT_EQ(host[i], sum);
      ASSERT_EQ(narrow_host[i], sum);
      sum += in[i];
    }
    EXPECT_EQ(host[n], sum);
    EXPECT_EQ(narrow_host[n], sum);
  }
}

TEST_F(PrimitivesTest, ExclusiveScanPassesThirtyTwoBits) {
  const std::vector<Index> in(5, 2000000000);
  Buffer<TestBackend, Index> in_buffer(backend());
  Buffer<TestBackend, Offset> out(backend(), 6);
  upload(backend(), in, in_buffer);
  exclusive_scan(backend(), std::as_const(in_buffer).view(5), out.view(6));
  EXPECT_EQ(download(backend(), out.view(6)).back(), Offset{10000000000});
}

TEST_F(PrimitivesTest, SortIsStableAndComplete) {
  for (Index n : kSizes) {
    for (int bits : {1, 7, 22, 40}) {
      std::mt19937_64 generator(n + bits);
      std::vector<std::uint64_t> keys(n);
      std::vector<Index> values(n);
      for (Index i = 0; i < n; ++i) {
        keys[i] = generator() >> (64 - bits);
        values[i] = i;
      }
      std::vector<Index> expected = values;
      std::stable_sort(expected.begin(), expected.end(),
                       [&](Index a, Index b) { return keys[a] < keys[b]; });
      std::vector<std::uint64_t> sorted_keys = keys;
      sort_on(backend(), sorted_keys, values, bits);
      ASSERT_EQ(values, expected) << "size " << n << ", bits " << bits;
      for (Index i = 0; i < n; ++i) ASSERT_EQ(sorted_keys[i], keys[expected[i]]);
    }
  }
}

TEST_F(PrimitivesTest, ThreadCountDoesNotChangeBits) {
  if constexpr (!TestBackend::kIsDevice) {  // threads belong to the cpu backend
    const std::vector<double> values = random_values(100003);
    TestBackend one(1);
    const double sum = sum_of(one, values);
    std::vector<std::uint64_t> keys(100003), sorted_keys;
    std::vector<Index> ids(100003), sorted_ids;
    for (Index i = 0; i < 100003; ++i) {
      keys[i] = static_cast<std::uint64_t>(i) * 2654435761U % 5000;
      ids[i] = i;
    }
    for (int threads : {1, 2, 3}) {
      TestBackend some(threads);
      EXPECT_EQ(sum_of(some, values), sum);
      std::vector<std::uint64_t> k = keys;
      std::vector<Index> v = ids;
      sort_on(some, k, v, 13);
      if (threads == 1) sorted_keys = k, sorted_ids = v;
      EXPECT_EQ(k, sorted_keys);
      EXPECT_EQ(v, sorted_ids);
    }
  }
}

TEST(BitsFor, TellsThatManyValuesApart) {
  EXPECT_EQ(bits_for(1), 1);
  EXPECT_EQ(bits_for(2), 1);
  EXPECT_EQ(bits_for(3), 2);
  EXPECT_EQ(bits_for(1024), 10);
  EXPECT_EQ(bits_for(1025), 11);
}

}  // namespace
}  // namespace scree
