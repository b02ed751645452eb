#pragma once
// Colors of bodies. All of them are made in OKLCh, where equal steps look equal (B. Ottosson, "A
// perceptual color space for image processing", 2020), and leave as linear-light RGB.

#include "kernels/bodies/body_view.h"
#include "kernels/render/view.h"

namespace scree::render {

enum class ColorMode : std::uint8_t { speed, size, id, group };

/// OKLCh to linear-light RGB, cut to the colors a screen can show.
/// @param lightness  0 to 1   @param chroma  0 (gray) to about 0.3   @param hue  [rad]
SCREE_HD inline Vec3f from_lch(float lightness, float chroma, float hue) {
  const float a = chroma * std::cos(hue), b = chroma * std::sin(hue);
  const float l = lightness + 0.3963377774f * a + 0.2158037573f * b;
  const float m = lightness - 0.1055613458f * a - 0.0638541728f * b;
  const float s = lightness - 0.0894841775f * a - 1.2914855480f * b;
  const float l3 = l * l * l, m3 = m * m * m, s3 = s * s * s;
  return {clamp(4.0767416621f * l3 - 3.3077115913f * m3 + 0.2309699292f * s3, 0.0f, 1.0f),
          clamp(-1.2684380046f * l3 + 2.6097574011f * m3 - 0.3413193965f * s3, 0.0f, 1.0f),
          clamp(-0.0041960863f * l3 - 0.7034186147f * m3 + 1.7076147010f * s3, 0.0f, 1.0f)};
}

/// The color map of values: lightness rises evenly from a deep blue over teal and green to a light
/// yellow, so it also reads in gray.
/// @param t  0 to 1; values outside take the end colors
SCREE_HD inline Vec3f color_map(float t) {
  t = clamp(t, 0.0f, 1.0f);
  constexpr float kDegree = 0.01745329252f;
  const float hue = (266.0f - 166.0f * t) * kDegree;
  // The blues and yellows of a screen are richer than its teals.
  const float off_teal = (t - 0.38f) / 0.62f;
  const float chroma = 0.110f + 0.062f * off_teal * off_teal;
  return from_lch(0.44f + 0.47f * t, chroma, hue);
}

/// A well mixed 32-bit hash (Wang-style multiply and shift rounds).
SCREE_HD inline std::uint32_t hash(std::uint32_t k) {
  k = (k ^ (k >> 16)) * 0x45d9f3bu;
  k = (k ^ (k >> 15)) * 0x2c1b3c6du;
  return k ^ (k >> 16);
}

/// A quiet color of its own for every id.
SCREE_HD inline Vec3f id_color(Index id) {
  const std::uint32_t h = hash(static_cast<std::uint32_t>(id) + 1u);
  const float hue = static_cast<float>(h & 0xffffu) * (6.2831853f / 65536.0f);
  const float lightness = 0.62f + 0.18f * static_cast<float>((h >> 16) & 0xffu) / 255.0f;
  return from_lch(lightness, 0.105f, hue);
}

/// Colors of groups: eight chosen ones (sand, blue, green, coral, violet, gold, teal, rose), then
/// the golden angle.
SCREE_HD inline Vec3f group_color(Index group) {
  constexpr float kDegree = 0.01745329252f;
  switch (group) {
    case 0:
      return from_lch(0.76f, 0.090f, 72 * kDegree);
    case 1:
      return from_lch(0.58f, 0.125f, 252 * kDegree);
    case 2:
      return from_lch(0.70f, 0.125f, 148 * kDegree);
    case 3:
      return from_lch(0.64f, 0.160f, 30 * kDegree);
    case 4:
      return from_lch(0.58f, 0.130f, 300 * kDegree);
    case 5:
      return from_lch(0.84f, 0.140f, 92 * kDegree);
    case 6:
      return from_lch(0.68f, 0.095f, 200 * kDegree);
    case 7:
      return from_lch(0.74f, 0.110f, 0 * kDegree);
    default:
      break;
  }
  return from_lch(0.60f + 0.08f * static_cast<float>(group % 3), 0.11f,
                  2.39996323f * static_cast<float>(group));
}

/// Fixed and kinematic bodies: a neutral gray.
SCREE_HD inline Vec3f fixed_color() { return {0.36f, 0.37f, 0.39f}; }

/// The number that the color map shows: speed [m/s] or radius [m].
template <class Real>
struct ColorValue {
  ColorMode mode = ColorMode::speed;
  Span<const Vec3<Real>> velocity;
  PerBody<Real> radius;
  SCREE_HD Real operator()(Index body) const {
    return mode == ColorMode::speed ? norm(velocity[body]) : radius[body];
  }
};

/// Linear-light color of every body.
template <class Real>
struct ColorBodies {
  static constexpr const char* name = "render_color_bodies";
  ColorValue<Real> value;
  float low = 0;      ///< value at the dark end
  float high = 1;     ///< value at the light end, > low
  BodyRanges bodies;  ///< without ghosts
  PerBody<Index> group;
  Span<const Index> id;
  Span<Vec3f> color;  ///< [count] out
  SCREE_HD void operator()(Index body) const {
    if (!bodies.exists(body)) return;
    Vec3f c;
    if (bodies.is_fixed(body)) {
      // Walls keep out of the picture's colors unless the scene gave them a group of their own.
      c = value.mode == ColorMode::group && group[body] > 0 ? group_color(group[body])
                                                            : fixed_color();
    } else if (value.mode == ColorMode::id) {
      c = id_color(id[body]);
    } else if (value.mode == ColorMode::group) {
      c = group_color(group[body]);
    } else {
      const float v = static_cast<float>(value(body));
      c = color_map(v - v == 0.0f ? (v - low) / (high - low) : 1.0f);
    }
    color[body] = c;
  }
};

/// Linear light to the 8-bit value of a screen (sRGB, IEC 61966-2-1).
/// @param threshold  value in (0, 1) at which the last digit rounds up; varying it over the picture
///                   keeps slow gradients free of bands
SCREE_HD inline std::uint8_t to_srgb(float linear, float threshold = 0.5f) {
  const float c = clamp(linear, 0.0f, 1.0f);
  const float s = c <= 0.0031308f ? 12.92f * c : 1.055f * std::pow(c, 1.0f / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(s * 255.0f + threshold);
}

}  // namespace scree::render
