#pragma once
// Convex hulls as tables: their corners, their faces, and which faces meet at a corner. The tables of all hulls of a run are
// concatenated.

#include <cmath>

#include "kernels/math/vec3.h"
#include "kernels/types.h"

namespace scree {

using Vec3d = Vec3<double>;

/// A flat face.
struct HullFace {
  Vec3d normal;              ///< unit, out of the hull
  double height = 0;         ///< of its plane above the origin [m]
  std::uint32_t corner = 0;  ///< of the first one, in HullSet::corners
  std::uint32_t count = 0;   ///< of corners, counterclockwise seen from outside
};

/// A face at one of its corners.
struct FaceAtPoint {
  Vec3d normal;            ///< that of the face
  Vec3d along;             ///< unit, from this corner to the next
  std::uint32_t face = 0;  ///< of the hull
  std::uint32_t next =
      0;  ///< corner of the face after this one, counterclockwise; those of all faces are all neighbors
};

/// Where the parts of a hull are. Indices of corners and faces are its own, from zero.
struct HullInfo {
  std::uint32_t point = 0, point_count = 0;
  std::uint32_t face = 0, face_count = 0;
  double inverse_half_x = 1;  ///< of the box about it, from its origin [1/m]
};

/// A hull of some size.
struct Hull {
  static constexpr std::uint32_t kMostCorners = 8;  ///< of a face, in contacts

  const Vec3d* point = nullptr;               ///< [m], before scaling
  const std::uint32_t* first_face = nullptr;  ///< [point] of those that meet there, in `face_at`
  const FaceAtPoint* face_at = nullptr;
  const HullFace* face = nullptr;         ///< before scaling
  const std::uint32_t* corner = nullptr;  ///< points; HullFace::corner counts from here
  std::uint32_t point_count = 0, face_count = 0;
  double scale = 1;

  /// The point farthest along a direction.
  SCREE_HD std::uint32_t farthest(const Vec3d& n) const {
    std::uint32_t best = 0;
    double most = dot(point[0], n);
    for (std::uint32_t k = 1; k < point_count; ++k) {
      const double height = dot(point[k], n);
      if (height > most) {
        most = height;
        best = k;
      }
    }
    return best;
  }
  /// Of the faces that meet at a point, the one whose normal is nearest to a direction.
  SCREE_HD std::uint32_t facing(std::uint32_t at, const Vec3d& n) const {
    std::uint32_t best = first_face[at];
    double most = dot(face_at[best].normal, n);
    for (std::uint32_t k = best + 1; k < first_face[at + 1]; ++k) {
      const double along = dot(face_at[k].normal, n);
      if (along > most) {
        most = along;
        best = k;
      }
    }
    return face_at[best].face;
  }
  /// How many corners of a face make its contacts.
  SCREE_HD std::uint32_t shown_count(std::uint32_t f) const {
    return face[f].count < kMostCorners ? face[f].count : kMostCorners;
  }
  /// Corner k of those: all of a small face; of a large one the first of each part of the way around, or `top`, the
  /// farthest point, in its own part: without it the deepest contact would be missing.
  SCREE_HD std::uint32_t shown_corner(std::uint32_t f, std::uint32_t k, std::uint32_t top) const {
    const std::uint32_t* around = corner + face[f].corner;
    const std::uint32_t shown = shown_count(f);
    const std::uint32_t first = k * face[f].count / shown, end = (k + 1) * face[f].count / shown;
    for (std::uint32_t i = first; i < end; ++i) {
      if (around[i] == top) return top;
    }
    return around[first];
  }
};

struct HullSet {
  Span<const Vec3d> points;
  Span<const std::uint32_t> first_face;  ///< [points + hulls]; one more for each hull
  Span<const FaceAtPoint> face_at;
  Span<const HullFace> faces;
  Span<const std::uint32_t> corners;
  Span<const HullInfo> hulls;

  /// @param half_x  half the edge along x of the box about it, from its origin [m]
  SCREE_HD Hull hull(Index k, double half_x) const {
    const HullInfo& info = hulls[k];
    return {points.data + info.point,
            first_face.data + info.point + static_cast<std::uint32_t>(k),
            face_at.data,
            faces.data + info.face,
            corners.data,
            info.point_count,
            info.face_count,
            half_x * info.inverse_half_x};
  }
};

}  // namespace scree
