#pragma once
// What an APGD sweep reads of a contact besides its impulses and its bias: 8 bytes, where the
// arrays of the plain passes take 17.

#include <bit>
#include <cmath>
#include <cstdint>

#include "kernels/math/vec3.h"

namespace scree {

/// Normal, weight of the metric, and body A within its tile.
///
/// The normal is a point of the octahedron |x| + |y| + |z| = 1, unfolded to a square:
/// two coordinates of 22 bits. It comes back within 1.3e-6: half a step of the grid in
/// both of them, seen from the middle of a face, is 1.0e-6, and the rest is rounding.
/// Along an axis it comes back as it was. Positions in float a meter from the origin leave 6e-6 to
/// the normals of spheres of 1 cm.
/// Source of the unfolding: Meyer et al., On Floating-Point Normal Vectors, CGF 29(4), 2010.
class alignas(8) PackedContact {
 public:
  PackedContact() = default;
  /// @param normal  of length 1
  /// @param weight  with no more bits than round_weight() leaves
  /// @param local   body A, below 256
  SCREE_HD PackedContact(const Vec3<float>& normal, float weight, std::uint32_t local) {
    const float scale = 1 / (std::fabs(normal.x) + std::fabs(normal.y) + std::fabs(normal.z));
    float x = scale * normal.x, y = scale * normal.y;
    if (normal.z < 0) {  // the lower half is folded outward
      const float folded = std::copysign(1 - std::fabs(y), x);
      y = std::copysign(1 - std::fabs(x), y);
      x = folded;
    }
    const std::uint32_t w = std::bit_cast<std::uint32_t>(weight) >> kDroppedBits;
    first_ = to_grid(x) << 10 | (w & 3) << 8 | local;
    second_ = to_grid(y) << 10 | w >> 2;
  }

  SCREE_HD std::uint32_t local() const { return first_ & 255; }
  SCREE_HD float weight() const {
    return std::bit_cast<float>((second_ << 21 & 0x7fe00000u) | (first_ << 11 & 0x00180000u));
  }
  SCREE_HD Vec3<float> normal() const {
    float x = from_grid(first_), y = from_grid(second_);
    const float z = kEdge - std::fabs(x) - std::fabs(y);
    const float below = z < 0 ? -z : 0;
    x -= std::copysign(below, x);
    y -= std::copysign(below, y);
    const float square = x * x + y * y + z * z;
#ifdef __CUDA_ARCH__
    const float scale = rsqrtf(square);
#else
    const float scale = 1 / std::sqrt(square);
#endif
    return {scale * x, scale * y, scale * z};
  }

  /// The next weight upward of those that can be packed: 4 bits after the leading one.
  static SCREE_HD float round_weight(float weight) {
    constexpr std::uint32_t dropped = (1u << kDroppedBits) - 1;
    return std::bit_cast<float>((std::bit_cast<std::uint32_t>(weight) + dropped) & ~dropped);
  }

 private:
  static constexpr int kDroppedBits = 19;                ///< of a positive float
  static constexpr std::int32_t kSteps = (1 << 21) - 1;  ///< of the grid from the middle to an edge
  static constexpr float kEdge = static_cast<float>(kSteps) / (1 << 22);

  /// 1 to 2^22 - 1, the middle is 2^21.
  static SCREE_HD std::uint32_t to_grid(float x) {
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::rint(x * kSteps)) + kSteps +
                                      1);
  }
  /// Upper 22 bits of a word to -kEdge ... kEdge: the fraction of a float between 1 and 2.
  static SCREE_HD float from_grid(std::uint32_t word) {
    return std::bit_cast<float>((word >> 9 & 0x007ffffeu) | 0x3f800000u) - 1.5f;
  }

  std::uint32_t first_;   ///< coordinate << 10 | low bits of the weight << 8 | body
  std::uint32_t second_;  ///< coordinate << 10 | high bits of the weight
};

}  // namespace scree
