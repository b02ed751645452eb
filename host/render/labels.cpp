#include "host/render/labels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/render/letters.h"
#include "kernels/render/color.h"

namespace scree::render {
namespace {

constexpr int kLeastSide = 160;  // [pixels]

/// Lightens a rectangle, so that dark letters can be read on it.
void lighten(Image& image, double left, double top, double right, double bottom) {
  const int x_end = std::min(image.width, static_cast<int>(std::lround(right)));
  const int y_end = std::min(image.height, static_cast<int>(std::lround(bottom)));
  for (int j = std::max(0, static_cast<int>(std::lround(top))); j < y_end; ++j) {
    for (int i = std::max(0, static_cast<int>(std::lround(left))); i < x_end; ++i) {
      std::uint8_t* pixel = image.rgb.data() + 3 * (static_cast<std::size_t>(j) * image.width + i);
      for (int k = 0; k < 3; ++k)
        pixel[k] = static_cast<std::uint8_t>(255 - (255 - pixel[k]) * 3 / 10);
    }
  }
}

/// @param size  of the letters [pixels]
void add_bar(Image& image, std::string_view title, const ColorRange& range, double size) {
  const double width = 16 * size, height = 0.8 * size, border = 0.9 * size, side = 2.6 * size;
  const double right = image.width - 3.7 * size, left = right - width;
  const double bottom = image.height - 3.6 * size, top = bottom - height;
  lighten(image, left - side, top - 1.7 * size - border, right + side,
          bottom + 1.8 * size + border);
  const int x_begin = static_cast<int>(std::lround(left)),
            x_end = static_cast<int>(std::lround(right));
  const int y_begin = static_cast<int>(std::lround(top)),
            y_end = static_cast<int>(std::lround(bottom));
  for (int i = x_begin; i < x_end; ++i) {
    const Vec3f color =
        color_map((static_cast<float>(i - x_begin) + 0.5f) / static_cast<float>(x_end - x_begin));
    for (int j = y_begin; j < y_end; ++j)
      for (int k = 0; k < 3; ++k)
        image.rgb[3 * (static_cast<std::size_t>(j) * image.width + i) +
                  static_cast<std::size_t>(k)] = to_srgb(color[k]);
  }
  draw_text(image, title, left, top - 0.7 * size, size);
  double free_from = -1e300;  // where the label before ends
  for (const double tick : bar_ticks(range)) {
    const std::string text = fmt::format("{:.6g}", tick);
    const double x =
        left + width * std::clamp((tick - range.low) / (range.high - range.low), 0.0, 1.0);
    const double half = 0.5 * text_width(text, size);
    if (x - half < free_from) continue;
    draw_text(image, text, x - half, bottom + 1.7 * size, size);
    free_from = x + half + 0.6 * size;
  }
}

}  // namespace

std::vector<double> bar_ticks(const ColorRange& range) {
  constexpr double kRounding = 1e-6;  // ends may come from float
  double unit = std::pow(10.0, std::ceil(std::log10(range.high - range.low)));
  for (;; unit /= 10) {
    for (const double factor : {5.0, 2.0, 1.0}) {
      const double step = factor * unit;
      const double first = std::ceil(range.low / step - kRounding);
      const double last = std::floor(range.high / step + kRounding);
      if (last - first < 1) continue;
      std::vector<double> ticks;
      for (double k = first; k <= last; ++k) ticks.push_back(k == 0 ? 0 : k * step);
      return ticks;
    }
  }
}

std::string time_text(double time, double time_step) {
  const double digits = std::clamp(std::ceil(-std::log10(time_step) - 1e-9), 0.0, 9.0);
  return fmt::format("t = {:.{}f} s", time, static_cast<int>(digits));
}

void add_labels(Image& image, ColorBy color_by, const ColorRange& range, double time,
                double time_step) {
  const int side = std::min(image.width, image.height);
  if (side < kLeastSide) return;
  const double size = std::max(0.017 * side, 7.0);
  const std::string text = time_text(time, time_step);
  lighten(image, 1.1 * size, 1.1 * size, 2.9 * size + text_width(text, size), 3.9 * size);
  draw_text(image, text, 2 * size, 3 * size, size);
  if (color_by == ColorBy::speed) add_bar(image, "speed [m/s]", range, size);
  if (color_by == ColorBy::size) add_bar(image, "radius [m]", range, size);
}

}  // namespace scree::render
