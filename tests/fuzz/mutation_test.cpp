// Every reader takes files that a seeded generator has spoiled, for some seconds: it reads or
// refuses them, without a crash, a hang or memory that the file does not account for.
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <chrono>
#include <random>

#include "host/error.h"
#include "host/io/problem_file.h"
#include "tests/fuzz/readers.h"
#include "tests/host/io/output_fixtures.h"

namespace scree::fuzz {
namespace {

using Generator = std::mt19937;

std::size_t below(Generator& random, std::size_t n) {
  return random() % std::max<std::size_t>(n, 1);
}

/// One change: a bit, a byte, a number, a piece taken out, doubled or put elsewhere.
void mutate(std::string& bytes, Generator& random) {
  static const std::string odd[] = {"-1", "0",    "1e308", "nan", "1e-320", "99999999999999999999",
                                    "\"", "{",    "}",     ",",   "\n",     "null",
                                    "[]", "-0.0", "1e400", "\xff"};
  const std::size_t at = below(random, bytes.size());
  const std::size_t length = 1 + below(random, 20);
  switch (below(random, 6)) {
    case 0:
      if (!bytes.empty()) bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(random, 8)));
      return;
    case 1:
      if (!bytes.empty()) bytes[at] = static_cast<char>(random());
      return;
    case 2:
      bytes.insert(at, odd[below(random, std::size(odd))]);
      return;
    case 3: {  // a number, if there is one, becomes another
      const std::size_t begin = bytes.find_first_of("0123456789", at);
      if (begin == std::string::npos) return;
      const std::size_t end = bytes.find_first_not_of("0123456789.e+-", begin);
      bytes.replace(begin, end - begin, odd[below(random, 6)]);
      return;
    }
    case 4:
      bytes.erase(at, length);
      return;
    default:
      bytes.insert(below(random, bytes.size()), bytes.substr(at, length));
  }
}

/// Of this process so far [kB].
long peak_memory() {
  rusage used{};
  ::getrusage(RUSAGE_SELF, &used);
  return used.ru_maxrss;
}

class Mutations : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Readers, Mutations, ::testing::ValuesIn(readers()),
                         [](const auto& info) { return info.param; });

TEST_P(Mutations, AreReadOrRefused) {
  const std::string reader = GetParam();
  const bool by_edits = reader == "problem" || reader == "checkpoint" || reader == "fclib";
  const int runs = !by_edits ? 10000 : reader == "problem" ? 500 : 250;
  const std::vector<std::filesystem::path> files = seeds(reader);
  ASSERT_FALSE(files.empty());
  for (std::size_t k = 0; k < files.size(); ++k) {
    const std::string whole = by_edits ? std::string(1, static_cast<char>(k)) : contents(files[k]);
    EXPECT_TRUE(read_bytes(reader, whole)) << files[k];
  }
  const long memory_before = peak_memory();
  Generator random(20240607);
  auto slowest = std::chrono::steady_clock::duration::zero();
  for (int run = 0; run < runs; ++run) {
    std::string bytes;
    if (by_edits) {
      bytes.resize(1 + 6 * (1 + below(random, 3)));
      for (char& c : bytes) c = static_cast<char>(random());
    } else {
      bytes = contents(files[below(random, files.size())]);
      for (std::size_t k = 1 + below(random, 4); k > 0; --k) mutate(bytes, random);
    }
    const auto start = std::chrono::steady_clock::now();
    try {
      read_bytes(reader, bytes);
    } catch (const std::exception& error) {
      FAIL() << reader << ", run " << run << ": " << error.what();
    }
    slowest = std::max(slowest, std::chrono::steady_clock::now() - start);
  }
  EXPECT_LT(std::chrono::duration<double>(slowest).count(), 5) << reader;
  EXPECT_LT(peak_memory() - memory_before, 1'000'000) << "kB";
}

/// Bytes that HDF5 itself has to make sense of: in a child process first.
TEST(MutatedHdf5Bytes, AreReadOrRefused) {
  const test::ScratchDirectory scratch;
  const std::filesystem::path file = scratch / "problem.hdf5";
  Generator random(11);
  for (const std::filesystem::path& seed : seeds("fclib")) {
    for (int run = 0; run < 60; ++run) {
      std::string bytes = contents(seed);
      for (std::size_t k = 1 + below(random, 8); k > 0; --k) {
        const std::size_t at = below(random, bytes.size());
        bytes[at] =
            static_cast<char>(below(random, 2) ? random() : bytes[at] ^ (1 << below(random, 8)));
      }
      test::put(file, bytes);
      try {
        read_problem(file);
      } catch (const InputError&) {
        // Most of them.
      }
    }
  }
}

}  // namespace
}  // namespace scree::fuzz
