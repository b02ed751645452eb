// Time and color bar on pictures.

#include "host/render/labels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "host/render/letters.h"
#include "host/world.h"
#include "kernels/render/color.h"
#include "tests/host/scene_texts.h"

namespace scree::render {
namespace {

Image gray(int width, int height) {
  Image image{width, height, {}};
  image.rgb.assign(static_cast<std::size_t>(3 * width * height), 200);
  return image;
}

const std::uint8_t* pixel(const Image& image, int x, int y) {
  return image.rgb.data() + 3 * (static_cast<std::size_t>(y) * image.width + x);
}

/// Rows and columns of the pixels darker than the paper.
struct Ink {
  int left = 1 << 30, right = -1, top = 1 << 30, bottom = -1;
};
Ink ink(const Image& image) {
  Ink found;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (pixel(image, x, y)[0] > 120) continue;
      found.left = std::min(found.left, x), found.right = std::max(found.right, x);
      found.top = std::min(found.top, y), found.bottom = std::max(found.bottom, y);
    }
  }
  return found;
}

TEST(Letters, StandOnTheBaseLineAndHaveTheirHeightAndWidth) {
  for (const char* text : {"0", "8", "17.25", "t = 0.250 s", "2e-05"}) {
    Image image = gray(400, 100);
    draw_text(image, text, 50, 60, 24);
    const Ink found = ink(image);
    EXPECT_NEAR(found.left, 50, 2) << text;
    EXPECT_NEAR(found.right, 50 + text_width(text, 24), 2.5) << text;
    EXPECT_NEAR(found.top, 60 - 24, 2.5) << text;
    EXPECT_NEAR(found.bottom, 60, 2.5) << text;
  }
}

TEST(BarTicks, AreTwoOrMoreRoundNumbers) {
  const auto expect = [](double low, double high, const std::vector<double>& ticks) {
    const std::vector<double> found = bar_ticks({low, high});
    ASSERT_EQ(found.size(), ticks.size()) << low << " " << high;
    for (std::size_t k = 0; k < ticks.size(); ++k) EXPECT_NEAR(found[k], ticks[k], 1e-12 * high);
  };
  expect(0, 1, {0, 1});
  expect(1, 7.1, {2, 4, 6});
  expect(0.05f, 0.1f, {0.05, 0.1});
  expect(-3, 4.5, {-2, 0, 2, 4});
  expect(997, 1003, {998, 1000, 1002});
  for (double high = 1.001; high < 20; high *= 1.01) {
    const std::size_t count = bar_ticks({1, high}).size();
    EXPECT_GE(count, 2u) << high;
    EXPECT_LE(count, 5u) << high;
  }
}

TEST(Letters, DigitsLookUnlike) {
  std::vector<Image> digits;
  for (char digit = '0'; digit <= '9'; ++digit) {
    Image image = gray(20, 30);
    draw_text(image, std::string(1, digit), 4, 25, 18);
    for (const Image& other : digits) {
      int unlike = 0;
      for (std::size_t k = 0; k < image.rgb.size(); k += 3)
        unlike += std::abs(image.rgb[k] - other.rgb[k]) > 60;
      EXPECT_GT(unlike, 8) << digit;
    }
    digits.push_back(image);
  }
}

TEST(Letters, AreCutOffAtTheBorders) {
  Image image = gray(30, 20);
  for (const double x : {-1000.0, -8.0, 25.0, 1000.0})
    for (const double y : {-1000.0, 0.0, 25.0, 1000.0}) draw_text(image, "0123", x, y, 16);
  EXPECT_EQ(image.rgb.size(), 3u * 30 * 20);
}

TEST(Labels, HaveAllTheirLetters) {
  for (const char* text : {"speed [m/s]", "radius [m]", "t = s", "0123456789.e+-"})
    for (const char letter : std::string(text)) EXPECT_TRUE(has_letter(letter)) << letter;
  EXPECT_FALSE(has_letter('?'));
}

TEST(Labels, TimeHasTheDigitsThatTellStepsApart) {
  EXPECT_EQ(time_text(0.25, 1e-3), "t = 0.250 s");
  EXPECT_EQ(time_text(12, 2e-4), "t = 12.0000 s");
  EXPECT_EQ(time_text(3, 1), "t = 3 s");
  EXPECT_EQ(time_text(0, 1e-30), "t = 0.000000000 s");
}

TEST(Labels, BarShowsTheColorMapFromEndToEnd) {
  for (const auto& [width, height] : {std::pair{640, 480}, {1280, 960}, {300, 900}}) {
    Image image = gray(width, height);
    add_labels(image, ColorBy::speed, {0, 0.5}, 1.0, 1e-3);
    const auto is_color = [&](const std::uint8_t* p, float t) {
      const Vec3f color = color_map(t);
      for (int k = 0; k < 3; ++k)
        if (std::abs(p[k] - to_srgb(color[k])) > 4) return false;
      return true;
    };
    // One row of the picture holds all colors, from left to right.
    bool found = false;
    for (int y = 0; y < height && !found; ++y) {
      int x = 0, seen = 0;
      for (int step = 0; step <= 20; ++step) {
        while (x < width && !is_color(pixel(image, x, y), 0.05f * static_cast<float>(step))) ++x;
        seen += x < width;
      }
      found = seen == 21;
    }
    EXPECT_TRUE(found) << width;
  }
}

TEST(Labels, OnlyValuesHaveABarAndSmallPicturesNothing) {
  const auto dark = [](ColorBy color_by, int width, int height) {
    Image image = gray(width, height);
    add_labels(image, color_by, {0.008, 0.012}, 0.5, 1e-3);
    const Ink found = ink(image);
    return std::pair{found.right >= 0, found.bottom > height / 2};
  };
  for (const ColorBy value : {ColorBy::speed, ColorBy::size})
    EXPECT_EQ(dark(value, 640, 480), std::pair(true, true));
  for (const ColorBy mark : {ColorBy::id, ColorBy::group})
    EXPECT_EQ(dark(mark, 640, 480), std::pair(true, false));
  EXPECT_EQ(dark(ColorBy::speed, 640, 100), std::pair(false, false));
}

TEST(Labels, OfARunCanBeTurnedOff) {
  // A sphere in the middle of the picture; labels are what is dark in the corners.
  const auto dark_corners = [](const std::string& labels) {
    const Scene scene = test::parsed(test::with_sphere(
        R"("output": {"picture": {"width": 320, "height": 240, "color_range": [0, 1], )" + labels +
        R"("camera": {"position": [0, -40, 0], "target": [0, 0, 0]}}})"));
    World world(scene, {.backend = BackendKind::cpu});
    Image image = world.render(scene.output.picture);
    for (int y = 80; y < 160; ++y)  // the middle
      std::fill_n(image.rgb.begin() + 3 * y * image.width, 3 * image.width, std::uint8_t{200});
    const Ink found = ink(image);
    return std::pair{found.top < 80, found.bottom >= 160};
  };
  EXPECT_EQ(dark_corners(""), std::pair(true, true));
  EXPECT_EQ(dark_corners(R"("labels": true, )"), std::pair(true, true));
  EXPECT_EQ(dark_corners(R"("labels": false, )"), std::pair(false, false));
}

TEST(Labels, AnyRangeGetsNumbers) {
  for (const ColorRange& range :
       {ColorRange{0, 1e-12}, {0, 1e12}, {-3, 5}, {99.9, 100.1}, {1, 2}}) {
    Image image = gray(640, 480);
    add_labels(image, ColorBy::speed, range, 0.5, 1e-3);
    EXPECT_GT(ink(image).bottom, 440);
  }
}

}  // namespace
}  // namespace scree::render
