#pragma once
// Convex hulls in backend memory.

#include "collision/hull_tables.h"
#include "kernels/backend/backend.h"

namespace scree {

template <class B>
class HullBuffers {
 public:
  HullBuffers(B& b, const std::vector<MeshSource>& hulls)
      : points_(b), first_face_(b), face_at_(b), faces_(b), corners_(b), hulls_(b) {
    const HullTables tables = build_hull_tables(hulls);
    upload(b, tables.points, points_);
    upload(b, tables.first_face, first_face_);
    upload(b, tables.face_at, face_at_);
    upload(b, tables.faces, faces_);
    upload(b, tables.corners, corners_);
    upload(b, tables.hulls, hulls_);
  }

  HullSet view() const {
    return {whole(points_), whole(first_face_), whole(face_at_),
            whole(faces_),  whole(corners_),    whole(hulls_)};
  }

 private:
  template <class T>
  static Span<const T> whole(const Buffer<B, T>& buffer) {
    return buffer.view(buffer.capacity());
  }
  Buffer<B, Vec3d> points_;
  Buffer<B, std::uint32_t> first_face_;
  Buffer<B, FaceAtPoint> face_at_;
  Buffer<B, HullFace> faces_;
  Buffer<B, std::uint32_t> corners_;
  Buffer<B, HullInfo> hulls_;
};

}  // namespace scree
