// What ranks send each other, with threads as ranks.

#include "host/ranks/thread_ranks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

namespace scree {
namespace {

using SharedRanks = std::shared_ptr<Ranks>;

/// As many bytes as the two ranks make, empty from rank 0 to rank 0; which ones tells who sends them to whom.
Bytes bytes_for(int from, int to) {
  Bytes bytes(static_cast<std::size_t>(10 * from + to));
  std::iota(bytes.begin(), bytes.end(), static_cast<unsigned char>(100 * from + to));
  return bytes;
}

TEST(ThreadRanks, GatherGivesTheValuesInTheOrderOfRanks) {
  for (const int count : {1, 2, 5}) {
    std::vector<int> expected(static_cast<std::size_t>(count));
    std::iota(expected.begin(), expected.end(), 7);
    std::atomic<int> calls = 0;
    run_thread_ranks(count, [&](const SharedRanks& ranks) {
      EXPECT_EQ(ranks->count(), count);
      for (int repeat = 0; repeat < 20; ++repeat)
        EXPECT_EQ(gather(*ranks, ranks->rank() + 7), expected);
      EXPECT_EQ(ranks->sent().messages, 20 * (count - 1));
      EXPECT_EQ(ranks->sent().bytes, 20 * (count - 1) * 4);
      ++calls;
    });
    EXPECT_EQ(calls, count);
  }
}

TEST(ThreadRanks, ARecordIsCombinedInTheOrderOfRanks) {
  struct Digits {
    double value = 0;
    void combine(const Digits& other) { value = 10 * value + other.value; }
  };
  run_thread_ranks(4, [](const SharedRanks& ranks) {
    EXPECT_EQ(combined(*ranks, Digits{static_cast<double>(ranks->rank() + 1)}).value, 1234);
    EXPECT_TRUE(any(*ranks, ranks->rank() == 2));
    EXPECT_FALSE(any(*ranks, false));
  });
}

/// Around a ring: each rank sends to the next one, and gets of the one before it.
TEST(ThreadRanks, ExchangeBringsMessagesToTheirRanks) {
  constexpr int count = 4;
  run_thread_ranks(count, [&](const SharedRanks& ranks) {
    const int next = (ranks->rank() + 1) % count;
    const int before = (ranks->rank() + count - 1) % count;
    Bytes out = bytes_for(ranks->rank(), next);
    Bytes in(bytes_for(before, ranks->rank()).size());
    ranks->exchange({{next, out.data(), out.size()}}, {{before, in.data(), in.size()}});
    EXPECT_EQ(in, bytes_for(before, ranks->rank()));
    EXPECT_EQ(ranks->sent().messages, 1);
    EXPECT_EQ(ranks->sent().bytes, static_cast<std::int64_t>(out.size()));
    ranks->exchange({}, {});
  });
}

TEST(ThreadRanks, AllToAllGivesEachRankWhatOthersHaveForIt) {
  for (const int count : {1, 2, 5}) {
    run_thread_ranks(count, [&](const SharedRanks& ranks) {
      std::vector<Bytes> to;
      for (int r = 0; r < count; ++r) to.push_back(bytes_for(ranks->rank(), r));
      const std::vector<Bytes> from = all_to_all(*ranks, std::move(to));
      ASSERT_EQ(from.size(), static_cast<std::size_t>(count));
      for (int r = 0; r < count; ++r)
        EXPECT_EQ(from[static_cast<std::size_t>(r)], bytes_for(r, ranks->rank()));
    });
  }
}

TEST(ThreadRanks, BytesAreGatheredAtOneRankOrEverywhere) {
  run_thread_ranks(3, [](const SharedRanks& ranks) {
    const Bytes own = bytes_for(ranks->rank(), 0);
    const std::vector<Bytes> all{bytes_for(0, 0), bytes_for(1, 0), bytes_for(2, 0)};
    EXPECT_EQ(gather_bytes_at(*ranks, own, 1), ranks->rank() == 1 ? all : std::vector<Bytes>{});
    EXPECT_EQ(gather_bytes(*ranks, own), all);
  });
}

TEST(ThreadRanks, BroadcastGivesAllTheBytesOfOne) {
  run_thread_ranks(3, [](const SharedRanks& ranks) {
    for (const int root : {0, 2})
      EXPECT_EQ(broadcast(*ranks, bytes_for(ranks->rank(), 5), root), bytes_for(root, 5));
    EXPECT_TRUE(broadcast(*ranks, ranks->rank() == 0 ? Bytes{} : Bytes{1, 2}, 0).empty());
  });
}

TEST(ThreadRanks, ARankThatThrowsEndsThoseThatWaitForIt) {
  std::atomic<int> ended = 0;
  const auto body = [&](const SharedRanks& ranks) {
    gather(*ranks, 1);
    if (ranks->rank() == 1) throw std::out_of_range("no such body");
    try {
      gather(*ranks, 2);
    } catch (const RankAborted& error) {
      EXPECT_EQ(std::string(error.what()), "rank 1: no such body");
      ++ended;
      throw;
    }
    FAIL() << "rank 1 is not there";
  };
  EXPECT_THROW(run_thread_ranks(3, body), std::out_of_range);
  EXPECT_EQ(ended, 2);
}

TEST(ThreadRanks, AbortEndsAllWithARankAndAReason) {
  std::atomic<int> ended = 0;
  try {
    run_thread_ranks(3, [&](const SharedRanks& ranks) {
      try {
        if (ranks->rank() == 2) ranks->abort("disk full", 1);
        ranks->exchange({}, {});
      } catch (const RankAborted&) {
        ++ended;
        throw;
      }
    });
    FAIL() << "all ranks have ended";
  } catch (const RankAborted& error) {
    EXPECT_EQ(std::string(error.what()), "rank 2: disk full");
  }
  EXPECT_EQ(ended, 3);
}

/// Otherwise a rank would go on with bytes that nobody sent.
TEST(ThreadRanks, MessagesOfUnequalSizeAreFound) {
  const auto body = [](const SharedRanks& ranks) {
    Bytes data(4);
    if (ranks->rank() == 0) ranks->exchange({{1, data.data(), 4}}, {});
    if (ranks->rank() == 1) ranks->exchange({}, {{0, data.data(), 3}});
  };
  EXPECT_THROW(run_thread_ranks(2, body), std::logic_error);
  EXPECT_THROW(run_thread_ranks(0, body), std::invalid_argument);
}

}  // namespace
}  // namespace scree
