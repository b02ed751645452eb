// More contacts or pairs than 32 bits number, which no test machine holds.

#include "collision/numbering.h"

#include <gtest/gtest.h>

namespace scree::test {
namespace {

constexpr Offset kLargest = std::numeric_limits<Index>::max();

TEST(Numbering, CountsBelowTheLargestIndexFit) {
  EXPECT_TRUE(can_number(0));
  EXPECT_TRUE(can_number(kLargest - 1));
  EXPECT_EQ(checked_index(kLargest - 1, true, "contacts"), kLargest - 1);
  EXPECT_FALSE(can_number(kLargest));  // a loop to the place behind the last one would not end
  EXPECT_FALSE(can_number(Offset{1} << 32));  // zero in 32 bits
}

TEST(Numbering, PiecesOfAListCountBesideItsPairs) {
  EXPECT_TRUE(can_number(1'000'000, 5'000'000));
  EXPECT_FALSE(can_number(1'000'000, kLargest));
  EXPECT_FALSE(can_number(1'000'000, (Offset{1} << 32) + 5));
  const auto bodies = static_cast<Index>(kLargest - 1000);
  EXPECT_TRUE(can_number(bodies, 0));
  EXPECT_FALSE(can_number(bodies, 1'000'000));  // every body has a piece, long lists have more
}

TEST(Numbering, TooManyAreRefusedWithTheirNumber) {
  for (const Offset count : {kLargest, Offset{3'000'000'000}, Offset{1} << 40}) {
    try {
      checked_index(count, can_number(count), "contacts");
      ADD_FAILURE() << count;
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(std::string(error.what()),
                std::to_string(count) + " contacts are more than one run can number (2^31)");
    }
  }
}

}  // namespace
}  // namespace scree::test
