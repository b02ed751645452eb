#pragma once
// Rays of pictures, in the frame of a shape.

#include "kernels/math/vec3.h"

namespace scree {

using Vec3f = Vec3<float>;

struct Ray {
  Vec3f origin;     ///< [m]
  Vec3f direction;  ///< scaled so that the ray parameter is the depth
};

/// Depth of a ray that misses.
inline constexpr float kMiss = -1e30f;
/// Keeps divisions by vanishing direction components finite.
inline constexpr float kTiny = 1e-20f;

/// How a shape looks in pictures.
enum class Outline {
  ball,      ///< as a sphere of its radius; its orientation shows in its paint only
  box,       ///< within the box of its half extents
  plane,     ///< anywhere in the picture
  triangles  ///< each triangle of its mesh is drawn by itself
};

/// 0 below `low`, 1 above `high`, a smooth cubic between.
SCREE_HD inline float smooth_step(float low, float high, float a) {
  float t = (a - low) / (high - low);
  t = t > 0.0f ? t : 0.0f;
  t = t < 1.0f ? t : 1.0f;
  return t * t * (3.0f - 2.0f * t);
}

/// Brightness of a body painted as two unlike halves, so that turning shows; far away they blend.
/// @param r          its radius [m]
/// @param p          point of its surface, body frame [m]
/// @param footprint  of a pixel there [m]
SCREE_HD inline float two_halves(float r, const Vec3f& p, float footprint) {
  const float blur = 0.02f + footprint / r;
  const float half = smooth_step(-blur, blur, p.x / r);
  return 1.0f - smooth_step(2.0f, 7.0f, r / footprint) * 0.15f * half;
}

}  // namespace scree
