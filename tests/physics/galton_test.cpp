// The Galton board of the scenes: balls go left or right at each row of pegs, so the bins fill like a binomial distribution.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "host/scene_reader.h"
#include "tests/physics/scene_builder.h"

namespace scree::physics {
namespace {

TEST(Galton, BinsFillLikeABinomialDistribution) {
  constexpr int kRows = 12, kBins = kRows + 1, kBalls = 120;
  constexpr double kWidth = 0.026;  // of a bin [m]
  Scene scene = read_scene(std::string(SCREE_SCENE_DIR) + "/galton.json");
  scene.insertions.resize(kBalls);  // one ball each
  for (const Insertion& one : scene.insertions) ASSERT_EQ(one.bodies.size(), 1);
  const std::size_t board = scene.bodies.size();
  World world(scene, cpu_options(1, Precision::single_precision));
  run_for(world, scene, 0.06 * kBalls + 1.5);

  const BodyStates s = world.states();
  std::array<int, kBins> count{};
  double sum = 0, squares = 0;
  ASSERT_EQ(s.position.size(), board + kBalls);
  for (std::size_t i = board; i < s.position.size(); ++i) {
    ASSERT_LT(s.position[i].z, 0.2) << "in a bin";
    const int bin = static_cast<int>(std::lround(s.position[i].x / kWidth));
    ASSERT_LE(std::abs(bin), kRows / 2);
    ++count[static_cast<std::size_t>(bin + kRows / 2)];
    sum += bin;
    squares += bin * bin;
  }
  const double mean = sum / kBalls;
  const double deviation = std::sqrt(squares / kBalls - mean * mean);
  const double binomial = std::sqrt(kRows) / 2;
  // Three deviations of a mean of so many; what a ball does at a row depends a little on the row above.
  EXPECT_LT(std::abs(mean), 3 * binomial / std::sqrt(kBalls));
  EXPECT_NEAR(deviation / binomial, 1, 0.3);
  // It falls off to both sides.
  const auto of_bins = [&](int first, int last) {
    double n = 0;
    for (int k = first; k <= last; ++k) n += count[static_cast<std::size_t>(k)];
    return n / (last - first + 1);
  };
  EXPECT_GT(of_bins(5, 7), 2 * of_bins(3, 4));
  EXPECT_GT(of_bins(5, 7), 2 * of_bins(8, 9));
  EXPECT_GT(of_bins(3, 4), of_bins(0, 2));
  EXPECT_GT(of_bins(8, 9), of_bins(10, 12));
}

}  // namespace
}  // namespace scree::physics
