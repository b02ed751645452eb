#pragma once
// The axes in which matrix problems count the rows of a contact.

#include <array>

#include "host/scene.h"

namespace scree {

/// The unit vectors n, t1, t2 of a contact, right-handed.
using ContactFrame = std::array<Vec3d, 3>;

/// The frame of a normal, whose length may be off by rounding; a function of the normal alone.
inline ContactFrame contact_frame(const Vec3d& normal) {
  const Vec3d n = normalized(normal);
  const Vec3d t1 = any_orthogonal(n);
  return {n, t1, cross(n, t1)};
}

/// Components of a world vector along n, t1, t2.
inline Vec3d to_frame(const ContactFrame& frame, const Vec3d& v) {
  return {dot(frame[0], v), dot(frame[1], v), dot(frame[2], v)};
}
/// The world vector with these components.
inline Vec3d from_frame(const ContactFrame& frame, const Vec3d& v) {
  return v.x * frame[0] + v.y * frame[1] + v.z * frame[2];
}

}  // namespace scree
