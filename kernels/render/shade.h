#pragma once
// The pixels of the picture from the visibility buffer.

#include "kernels/render/color.h"
#include "kernels/render/edges.h"
#include "kernels/render/light.h"

namespace scree::render {

/// One pixel of a band of rows: shades its samples in linear light, averages them,
/// and stores 8-bit sRGB.
///
/// Bodies get a key light with shadows, a sky that neighbors hide, a darker rim that parts
/// neighbors, and a pattern fixed to the body that shows how it turns. Half-spaces and containers take
/// the background's own color and only receive shadow, so that bodies stand in a plain bright room.
template <class Real>
struct ShadePixel {
  static constexpr const char* name = "render_shade";
  DrawList<Real> list;
  View view;
  Span<const std::uint64_t> samples;
  Span<const std::uint8_t> edges;  ///< marks of EdgeSource; empty when there are no edges
  Span<const Vec3f> color;         ///< [bodies] linear light
  Shadow shadow;
  Occlusion occlusion;
  BodyTaps body_taps;
  WallTaps wall_taps;
  Vec3f to_light;          ///< unit, world
  Vec3f sky_up;            ///< unit, world: where the sky is brightest
  float scene_size = 1;    ///< size of what the camera frames [m]
  int first_row = 0;       ///< of the band [pixels]
  Span<std::uint8_t> rgb;  ///< [3 * pixels of the band] out, rows from the top

  SCREE_HD static Vec3f key_light() { return {1.42f, 1.34f, 1.24f}; }
  SCREE_HD static Vec3f sky_light() { return {0.62f, 0.66f, 0.72f}; }
  SCREE_HD static Vec3f bounce_light() { return {0.30f, 0.29f, 0.28f}; }

  /// Bright, neutral, a little darker to the top and the corners.
  SCREE_HD Vec3f background(int i, int j) const {
    const float u = 2.0f * (static_cast<float>(i) + 0.5f) / static_cast<float>(view.width) - 1.0f;
    const float v = 2.0f * (static_cast<float>(j) + 0.5f) / static_cast<float>(view.height) - 1.0f;
    const Vec3f base =
        mix(Vec3f{0.66f, 0.71f, 0.77f}, Vec3f{0.87f, 0.87f, 0.86f}, smooth_step(-1.1f, 0.5f, v));
    return (1.0f - 0.07f * (u * u + v * v)) * base;
  }

  /// Factor of a body's color at a point of its surface.
  SCREE_HD float pattern(const Solid& solid, const Ray& ray, float depth,
                         const Vec3f& normal) const {
    if (list.bodies.is_fixed(solid.body)) return 1.0f;
    const float footprint = view.footprint(depth);
    float factor = 1.0f;
    ShapeList::visit(solid.kind, [&](auto shape) {
      using S = decltype(shape);
      const Vec3f p = ray.origin + depth * ray.direction;
      if constexpr (requires { S::paint(solid, p, p, footprint); }) {
        const Vec3f n = S::outline == Outline::ball
                            ? rotate_back(Quat<float>(list.orientation[solid.body]), normal)
                            : S::normal_at(solid, ray, depth);
        factor = S::paint(solid, p, n, footprint);
      }
    });
    return factor;
  }

  SCREE_HD Vec3f shade(const Solid& solid, float depth, int i, int j) const {
    const float x = view.plane_x(i), y = view.plane_y(j);
    const Ray ray = solid.eye.ray(x, y);
    const Vec3f local = solid.normal_at(ray, depth);
    const Vec3f normal_view{dot(local, solid.eye.right), dot(local, solid.eye.up),
                            dot(local, solid.eye.forward)};
    const Vec3f point_view = view.at(x, y, depth);
    const Eye world{{0, 0, 0}, view.right, view.up, view.forward, view.orthographic};
    const Vec3f normal = world.from_view(normal_view);
    const Vec3f point = world.from_view(point_view);
    const Vec3f to_eye = world.from_view(normalized(-point_view));

    const int sub = (i & 1) + 2 * (j & 1);
    const float facing_light = larger(dot(normal, to_light), 0.0f);
    const bool is_movable = !list.bodies.is_fixed(solid.body);
    float lit = 0.0f;
    if (facing_light > 0.0f) {
      lit = facing_light * (is_movable ? shadow(body_taps, sub, point, normal)
                                       : shadow(wall_taps, sub, point, normal));
    }
    const float upward = dot(normal, sky_up);
    const bool is_plain = is_backdrop(solid.kind);
    float open = 1.0f;
    if (is_movable) {
      open -= occlusion(body_taps, i, j, point_view, normal_view, true);
    } else if (!is_plain) {
      open -= occlusion(wall_taps, i, j, point_view, normal_view, false);
    } else if (upward > 0.0f) {
      // Bodies ground on floors. A bright wall behind them would show it as a dark rim around them.
      open -= upward * occlusion(wall_taps, i, j, point_view, normal_view, false);
    }
    const float sky = 0.5f + 0.5f * upward;
    const Vec3f ambient = mix(bounce_light(), sky_light(), sky);

    if (is_plain) {
      const Vec3f full = facing_light * key_light() + ambient;
      const Vec3f here = lit * key_light() + (0.25f + 0.75f * open) * ambient;
      const Vec3f ratio{here.x / full.x, here.y / full.y, here.z / full.z};
      // A plane fades into the background with distance; walls are a shade darker than floors.
      const bool is_plane = outline_of(solid.kind) == Outline::plane;
      const float tone = 0.91f + 0.06f * larger(upward, 0.0f) + 0.02f * facing_light;
      const float fade =
          is_plane ? smooth_step(2.0f * scene_size, 12.0f * scene_size, depth) : 0.0f;
      return hadamard(mix(tone * ratio, Vec3f{1, 1, 1}, fade), background(i, j));
    }

    const float facing_eye = clamp(dot(normal, to_eye), 0.0f, 1.0f);
    const float rim = 1.0f - 0.5f * (1.0f - facing_eye) * (1.0f - facing_eye) * (1.0f - facing_eye);
    const Vec3f light = lit * key_light() + (open * (0.35f + 0.65f * open)) * ambient;
    const Vec3f albedo = pattern(solid, ray, depth, normal) * color[solid.body];
    // A dull highlight: (n.h)^32 by repeated squaring.
    const float nh = larger(dot(normal, normalized(to_light + to_eye)), 0.0f);
    const float nh2 = nh * nh, nh4 = nh2 * nh2, nh8 = nh4 * nh4, nh16 = nh8 * nh8;
    const float gloss = lit > 0.0f ? 0.10f * nh16 * nh16 * (lit / facing_light) : 0.0f;
    return rim * hadamard(albedo, light) + Vec3f{gloss, gloss, gloss};
  }

  /// Rolls bright values off towards white instead of cutting them; the background stays as it is.
  SCREE_HD static float shoulder(float v) {
    constexpr float kStart = 0.80f;
    if (v <= kStart) return v;
    const float over = (v - kStart) / (1.0f - kStart);
    return kStart + (1.0f - kStart) * over / (1.0f + 0.55f * over);
  }
  /// 4x4 ordered dither, thresholds (k + 1/2) / 16: the bits of x ^ y and y, interleaved,
  /// low bits first.
  SCREE_HD static float round_up_at(int px, int py) {
    const int a = px ^ py;
    const int k = ((a & 1) << 3) | ((py & 1) << 2) | (a & 2) | ((py & 2) >> 1);
    return (static_cast<float>(k) + 0.5f) / 16.0f;
  }

  SCREE_HD void operator()(Index pixel) const {
    const int width = view.width / kSupersampling;
    const int px = pixel % width, py = first_row + pixel / width;
    Vec3f sum;
    Solid solid;
    Index resolved = -1;
    for (int sub = 0; sub < kSupersampling * kSupersampling; ++sub) {
      const int i = px * kSupersampling + (sub & 1), j = py * kSupersampling + (sub >> 1);
      const Offset at = view.index(i, j);
      const std::uint64_t sample = samples[at];
      Vec3f c;
      if (sample == kNothing) {
        c = background(i, j);
      } else {
        if (primitive_of(sample) != resolved) {
          resolved = primitive_of(sample);
          solid = resolve(list, view, resolved, false);
        }
        c = shade(solid, depth_of(sample), i, j);
      }
      if (!edges.empty() && edges[at] != 0) {
        const bool over_body = sample != kNothing && !list.bodies.is_fixed(solid.body);
        c = mix(c, Vec3f{0.20f, 0.22f, 0.25f}, over_body ? 0.30f : 0.45f);
      }
      sum += c;
    }
    sum *= 1.0f / static_cast<float>(kSupersampling * kSupersampling);
    const float threshold = round_up_at(px, py);
    std::uint8_t* out = rgb.data + 3 * static_cast<Offset>(pixel);
    out[0] = to_srgb(shoulder(sum.x), threshold);
    out[1] = to_srgb(shoulder(sum.y), threshold);
    out[2] = to_srgb(shoulder(sum.z), threshold);
  }
};

}  // namespace scree::render
