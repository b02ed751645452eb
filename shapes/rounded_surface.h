#pragma once
// Surfaces of rounded solids for files: enough corners to see how they are rounded.

#include <algorithm>
#include <cmath>

#include "shapes/rounded_moments.h"
#include "shapes/surface.h"

namespace scree::rounded {

/// A cylinder or a cone, by its outline. @param bottom, top  radii of its ends [m]
inline Surface surface_of_round(double bottom, double top, double base, double end, double r) {
  constexpr int kAround = 24, kArc = 5;
  const double tilt = std::atan2(bottom - top, end - base);
  std::vector<std::pair<double, double>>
      outline;  // distance from the axis, height; without the poles
  for (int k = bottom > 0 ? 0 : 1; k <= kArc; ++k) {
    const double angle = -kPi / 2 + (tilt + kPi / 2) * k / kArc;
    outline.emplace_back(bottom + r * std::cos(angle), base + r * std::sin(angle));
  }
  for (int k = 0; k <= (top > 0 ? kArc : kArc - 1); ++k) {
    const double angle = tilt + (kPi / 2 - tilt) * k / kArc;
    outline.emplace_back(top + r * std::cos(angle), end + r * std::sin(angle));
  }
  Surface s;
  for (const auto& [across, z] : outline)
    for (int k = 0; k < kAround; ++k) {
      const double angle = 2 * kPi * k / kAround;
      s.vertices.push_back({across * std::cos(angle), across * std::sin(angle), z});
    }
  const int south = static_cast<int>(s.vertices.size()), last = south - kAround;
  s.vertices.push_back({0, 0, base - r});
  s.vertices.push_back({0, 0, end + r});
  for (int k = 0; k < kAround; ++k) {
    const int next = (k + 1) % kAround;
    s.faces.push_back({south, next, k});
    for (int first = 0; first < last; first += kAround)
      s.faces.push_back({first + k, first + next, first + kAround + next, first + kAround + k});
    s.faces.push_back({last + k, last + next, south + 1});
  }
  return s;
}

/// A convex polyhedron: its faces moved out, strips along its edges, and patches at its corners, each with corners of its
/// own.
inline Surface surface_of_polyhedron(const TriangleMesh& mesh, double r) {
  constexpr double kLargest = kPi / 12;  // angle of a part of an arc
  Surface s;
  const auto place = [&](int v) { return mesh.vertices[static_cast<std::size_t>(v)]; };
  const auto add = [&](const Vec3d& x) {
    s.vertices.push_back(x);
    return static_cast<int>(s.vertices.size()) - 1;
  };
  for (const std::array<int, 3>& t : mesh.triangles) {
    const Vec3d n = normalized(cross(place(t[1]) - place(t[0]), place(t[2]) - place(t[0])));
    s.faces.push_back(
        {add(place(t[0]) + r * n), add(place(t[1]) + r * n), add(place(t[2]) + r * n)});
  }
  const std::vector<MeshCrease> creases = creases_of(mesh);
  std::vector<Vec3d> middle(mesh.vertices.size());  // of the normals at a corner
  for (const MeshCrease& e : creases) middle[static_cast<std::size_t>(e.from)] += e.left + e.right;
  for (const MeshCrease& e : creases) {
    const double angle = std::atan2(norm(cross(e.left, e.right)), dot(e.left, e.right));
    const int parts = std::max(1, static_cast<int>(std::ceil(angle / kLargest)));
    const auto normal = [&](int k) {  // from that of the right face to that of the left one
      return normalized(std::sin(angle * (parts - k) / parts) * e.right +
                        std::sin(angle * k / parts) * e.left);
    };
    if (e.from < e.to) {
      for (int k = 0; k < parts; ++k)
        s.faces.push_back({add(place(e.from) + r * normal(k)), add(place(e.to) + r * normal(k)),
                           add(place(e.to) + r * normal(k + 1)),
                           add(place(e.from) + r * normal(k + 1))});
    }
    const Vec3d center = normalized(middle[static_cast<std::size_t>(e.from)]);
    constexpr int kRings = 4;
    const auto on_patch = [&](int ring, int k) {
      return add(place(e.from) + r * normalized(center + (static_cast<double>(ring) / kRings) *
                                                             (normal(k) - center)));
    };
    for (int k = 0; k < parts; ++k) {
      s.faces.push_back({on_patch(0, k), on_patch(1, k), on_patch(1, k + 1)});
      for (int ring = 1; ring < kRings; ++ring)
        s.faces.push_back({on_patch(ring, k), on_patch(ring + 1, k), on_patch(ring + 1, k + 1),
                           on_patch(ring, k + 1)});
    }
  }
  return s;
}

}  // namespace scree::rounded
