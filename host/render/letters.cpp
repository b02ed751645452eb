#include "host/render/letters.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace scree::render {
namespace {

/// Strokes as pairs of digits (x, y), strokes apart by spaces. The base line is y = 2, digits reach
/// to y = 8, small letters to y = 6.
struct Letter {
  char letter;
  int width;
  const char* strokes;
};

constexpr double kBase = 2, kHeight = 6, kGap = 1.6, kHalfStroke = 0.42;  // in the font's units

constexpr Letter kLetters[] = {
    {' ', 1, ""},
    {'0', 4, "123243473818070312"},
    {'1', 2, "071812 0222"},
    {'2', 4, "07183847460242"},
    {'3', 4, "07183847463544433212 1535 1203"},
    {'4', 4, "32380444"},
    {'5', 4, "480805354443321203"},
    {'6', 4, "473818070312324344351504"},
    {'7', 4, "084812"},
    {'8', 4, "15060718384746351504031232434435"},
    {'9', 4, "031232434738180706153546"},
    {'.', 0, "0202"},
    {'-', 3, "0535"},
    {'+', 4, "0545 2327"},
    {'=', 4, "0444 0646"},
    {'/', 3, "0139"},
    {'[', 2, "29090121"},
    {']', 2, "09292101"},
    {'a', 4, "4642 4536160503123243"},
    {'d', 4, "4842 4536160503123243"},
    {'e', 4, "04444536160503123243"},
    {'i', 0, "0206 0808"},
    {'m', 6, "0206 0516263532 3546566562"},
    {'p', 4, "0006 0516364543321203"},
    {'r', 3, "0206 042636"},
    {'s', 4, "45361605143443321203"},
    {'t', 3, "18132232 0636"},
    {'u', 4, "0603123243 4642"},
};

const Letter* find(char letter) {
  const auto* found = std::find_if(std::begin(kLetters), std::end(kLetters),
                                   [&](const Letter& l) { return l.letter == letter; });
  return found == std::end(kLetters) ? nullptr : found;
}

struct Point {
  double x, y;
};

double distance(const Point& p, const Point& a, const Point& b) {
  const double dx = b.x - a.x, dy = b.y - a.y, length2 = dx * dx + dy * dy;
  const double along = length2 > 0 ? ((p.x - a.x) * dx + (p.y - a.y) * dy) / length2 : 0.0;
  const double s = std::clamp(along, 0.0, 1.0);
  return std::hypot(p.x - a.x - s * dx, p.y - a.y - s * dy);
}

/// Distance of a point from the strokes of a letter, all in pixels.
/// @param origin  where the letter's (0, base line) is   @param unit  pixels per unit of the font
double distance(const Point& p, const Letter& letter, const Point& origin, double unit) {
  double least = 1e300;
  for (const char* stroke = letter.strokes; *stroke != 0;) {
    const auto take = [&]() -> Point {
      const Point q{origin.x + unit * (stroke[0] - '0'),
                    origin.y - unit * (stroke[1] - '0' - kBase)};
      stroke += 2;
      return q;
    };
    for (Point a = take(); *stroke != 0 && *stroke != ' ';) {
      const Point b = take();
      least = std::min(least, distance(p, a, b));
      a = b;
    }
    if (*stroke == ' ') ++stroke;
  }
  return least;
}

}  // namespace

bool has_letter(char letter) { return find(letter) != nullptr; }

double text_width(std::string_view text, double size) {
  double width = 0;
  for (const char c : text)
    if (const Letter* letter = find(c)) width += letter->width + kGap;
  return std::max(width - kGap, 0.0) * size / kHeight;
}

void draw_text(Image& image, std::string_view text, double x, double y, double size) {
  const double unit = size / kHeight, half = kHalfStroke * unit;
  for (const char c : text) {
    const Letter* letter = find(c);
    if (letter == nullptr) continue;
    const auto cut = [](double value, int end) {
      return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(end)));
    };
    const int x_begin = cut(x - half - 1, image.width);
    const int x_end = cut(x + letter->width * unit + half + 2, image.width);
    const int y_begin = cut(y - 7 * unit - half - 1, image.height);
    const int y_end = cut(y + 2 * unit + half + 2, image.height);
    for (int j = y_begin; j < y_end; ++j) {
      for (int i = x_begin; i < x_end; ++i) {
        const double away = distance({i + 0.5, j + 0.5}, *letter, {x, y}, unit);
        const double ink = std::clamp(half - away + 0.5, 0.0, 1.0);
        if (ink == 0) continue;
        const std::size_t at = 3 * (static_cast<std::size_t>(j) * image.width + i);
        for (std::size_t k = at; k < at + 3; ++k)
          image.rgb[k] =
              static_cast<std::uint8_t>(std::lround((1 - ink) * image.rgb[k] + ink * 45));
      }
    }
    x += (letter->width + kGap) * unit;
  }
}

}  // namespace scree::render
