#pragma once
// Volume, center of mass and moments of rounded solids: of all points that are no farther from a convex core than a
// radius. What lies around the core is taken apart by the point of the core that is nearest (Steiner): over faces there
// are prisms, along edges sectors of a cylinder, at corners sectors of a ball. docs/theory.md, "Rounded shapes".

#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "shapes/solid_sums.h"

namespace scree::rounded {

inline constexpr double kPi = 3.14159265358979323846;

/// Of a solid that is the same under reflections at the planes of its axes.
inline SolidMoments symmetric_moments(double volume, const Vec3d& squares) {
  SolidMoments m;
  m.volume = volume;
  for (int k = 0; k < 3; ++k)
    m.second[static_cast<std::size_t>(k)][static_cast<std::size_t>(k)] = squares[k] / volume;
  return m;
}

/// A box. @param half  edges of the core [m]
inline SolidMoments moments_of_box(const Vec3d& half, double r) {
  const double r2 = r * r, r3 = r2 * r, r4 = r2 * r2;
  const double faces = half.x * half.y + half.y * half.z + half.z * half.x;
  const double volume = 8 * half.x * half.y * half.z + 8 * r * faces +
                        2 * kPi * r2 * (half.x + half.y + half.z) + 4.0 / 3 * kPi * r3;
  Vec3d squares;
  for (int k = 0; k < 3; ++k) {
    const double a = half[k], b = half[(k + 1) % 3], c = half[(k + 2) % 3], a2 = a * a;
    const double beside = (8 * a * (b * c + r * (b + c)) + 2 * kPi * a * r2) * a2 / 3;
    const double before = 8 * b * c * r * (3 * a2 + 3 * a * r + r2) / 3;
    const double edges = 2 * (b + c) * (kPi * r2 * a2 + 8.0 / 3 * a * r3 + kPi * r4 / 4);
    const double corners = 4.0 / 3 * kPi * r3 * a2 + kPi * a * r4 + 4.0 / 15 * kPi * r4 * r;
    squares[k] = beside + before + edges + corners;
  }
  return symmetric_moments(volume, squares);
}

/// Points and weights of Gauss's rule on [0, 1]: the zeros of Legendre's polynomial, by Newton's method.
inline std::vector<std::pair<double, double>> gauss_points(int count) {
  std::vector<std::pair<double, double>> points;
  for (int k = 0; k < count; ++k) {
    double x = std::cos(kPi * (k + 0.75) / (count + 0.5)), slope = 1;
    for (int step = 0; step < 50; ++step) {
      double before = 1, value = x;
      for (int n = 2; n <= count; ++n) {
        const double next = ((2 * n - 1) * x * value - (n - 1) * before) / n;
        before = value;
        value = next;
      }
      slope = count * (x * value - before) / (x * x - 1);
      const double change = value / slope;
      x -= change;
      if (std::abs(change) < 1e-16) break;
    }
    points.emplace_back(0.5 * (1 + x), 1 / ((1 - x * x) * slope * slope));
  }
  return points;
}

/// A solid of revolution about z, from its outline from the lowest to the highest point.
class Revolved {
 public:
  /// Adds what lies within a piece of the outline. @param at  at(t): {distance from the axis, height, slope dz/dt}
  template <class At>
  void add(At&& at) {
    static const std::vector<std::pair<double, double>> points = gauss_points(24);
    for (const auto& [t, weight] : points) {
      const Vec3d p = at(t);
      const double disk = weight * p.z * kPi * p.x * p.x;
      volume_ += disk;
      first_ += disk * p.y;
      along_ += disk * p.y * p.y;
      across_ += disk * p.x * p.x / 4;
    }
  }
  SolidMoments moments() const {
    SolidMoments m = symmetric_moments(volume_, {across_, across_, along_});
    m.center.z = first_ / volume_;
    m.second[2][2] -= m.center.z * m.center.z;
    return m;
  }

 private:
  double volume_ = 0, first_ = 0, along_ = 0, across_ = 0;
};

/// A cylinder or a cone: the disk at its base, and the disk or point at its top, are swept along the line between
/// them. @param bottom, top  radii of these [m]; heights are from the base
inline SolidMoments moments_of_round(double bottom, double top, double height, double r) {
  const double tilt = std::atan2(bottom - top, height);  // of the side's normal against the level
  const auto arc = [&](double across, double z, double from, double to) {
    return [=](double t) {
      const double angle = from + t * (to - from), cosine = std::cos(angle);
      return Vec3d{across + r * cosine, z + r * std::sin(angle), r * cosine * (to - from)};
    };
  };
  const double out = r * std::cos(tilt), up = r * std::sin(tilt);
  Revolved solid;
  solid.add(arc(bottom, 0, -kPi / 2, tilt));
  solid.add([&](double t) {
    return Vec3d{bottom + t * (top - bottom) + out, t * height + up, height};
  });
  solid.add(arc(top, height, tilt, kPi / 2));
  return solid.moments();
}

/// An ellipsoid: the integral over its surface of what the parallel surface adds, by points of the unit sphere that are
/// stretched to it, in one octant. Curvatures peak at the ends of the angles where axes differ much; there the points of
/// the double exponential rule crowd (Takahasi, Mori, 1974). Steps are halved until nothing changes.
inline SolidMoments moments_of_ellipsoid(const Vec3d& half, double r) {
  struct Angle {
    double sine, cosine, weight;
  };
  const double size = std::fmax(half.x, std::fmax(half.y, half.z));
  const Vec3d a = (1 / size) * half, a2 = hadamard(a, a);
  const double radius = r / size, product = a.x * a.y * a.z;
  double volume = 0;
  Vec3d squares;
  for (int halvings = 3; halvings <= 7; ++halvings) {
    const double step = std::ldexp(1.0, -halvings);
    std::vector<Angle> angles;
    for (int k = -(4 << halvings); k <= (4 << halvings); ++k) {
      const double s = kPi / 2 * std::sinh(k * step);
      // From both ends, so that neither loses digits.
      const double from_zero = kPi / 2 / (1 + std::exp(-2 * s));
      const double from_right = kPi / 2 / (1 + std::exp(2 * s));
      const double weight = step * std::cosh(k * step) * 2 * from_zero * from_right;
      angles.push_back({std::sin(from_zero), std::sin(from_right), weight});
    }
    double sum = 0;
    Vec3d sum_squares;
    for (const Angle& theta : angles) {
      for (const Angle& phi : angles) {
        const Vec3d s{theta.sine * phi.cosine, theta.sine * phi.sine, theta.cosine};
        const Vec3d shrunk{s.x / a.x, s.y / a.y, s.z / a.z}, on = hadamard(a, s);
        const double h = 1 / norm(shrunk);  // height of the tangent plane
        const double bend = h * h * h / (product * product);
        const double both = bend * (a2.x + a2.y + a2.z - norm2(on)), gauss = bend * h;
        const double area = 8 * theta.weight * phi.weight * theta.sine * product / h *
                            (1 + radius * both + radius * radius * gauss);
        const Vec3d y = on + radius * h * shrunk;
        sum += area * (h + radius) / 3;
        sum_squares += (area * (h + radius) / 5) * hadamard(y, y);
      }
    }
    const double change =
        std::abs(sum - volume) / sum + norm(sum_squares - squares) / norm(sum_squares);
    volume = sum;
    squares = sum_squares;
    if (change < 1e-13) break;
  }
  const double cube = size * size * size;
  return symmetric_moments(cube * volume, cube * size * size * squares);
}

/// Unit normals of the triangles of a convex mesh. One without an area has that of its neighbor along its longest edge.
inline std::vector<Vec3d> normals_of(
    const TriangleMesh& mesh, const std::map<std::pair<int, int>, std::size_t>& triangle_at) {
  std::vector<Vec3d> normals;
  std::vector<std::size_t> flat;
  for (const std::array<int, 3>& t : mesh.triangles) {
    const Vec3d& origin = mesh.vertices[static_cast<std::size_t>(t[0])];
    const Vec3d u = mesh.vertices[static_cast<std::size_t>(t[1])] - origin;
    const Vec3d v = mesh.vertices[static_cast<std::size_t>(t[2])] - origin, n = cross(u, v);
    if (norm(n) <= 1e-13 * (norm2(u) + norm2(v))) flat.push_back(normals.size());
    normals.push_back(normalized(n));
  }
  for (std::size_t turn = 0; turn < flat.size(); ++turn) {
    for (const std::size_t k : flat) {
      const std::array<int, 3>& t = mesh.triangles[k];
      double longest = -1;
      for (std::size_t i = 0; i < 3; ++i) {
        const int from = t[i], to = t[(i + 1) % 3];
        const double length = norm(mesh.vertices[static_cast<std::size_t>(to)] -
                                   mesh.vertices[static_cast<std::size_t>(from)]);
        if (length <= longest) continue;
        longest = length;
        normals[k] = normals[triangle_at.at({to, from})];
      }
    }
  }
  return normals;
}

/// Where two faces of a convex mesh meet: an edge, from its first to its second corner, with the normal of the face on
/// its left and on its right.
struct MeshCrease {
  int from, to;
  Vec3d left, right;
};

/// Both directions of all edges of a convex mesh at which it bends.
inline std::vector<MeshCrease> creases_of(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, std::size_t> triangle_at;
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k)
    for (std::size_t i = 0; i < 3; ++i)
      triangle_at[{mesh.triangles[k][i], mesh.triangles[k][(i + 1) % 3]}] = k;
  const std::vector<Vec3d> normals = normals_of(mesh, triangle_at);
  std::vector<MeshCrease> creases;
  for (const auto& [edge, left] : triangle_at) {
    const std::size_t right = triangle_at.at({edge.second, edge.first});
    if (norm(cross(normals[left], normals[right])) > 1e-13)
      creases.push_back({edge.first, edge.second, normals[left], normals[right]});
  }
  return creases;
}

/// A convex polyhedron.
inline SolidMoments moments_of_hull(const TriangleMesh& mesh, double r) {
  const SolidMoments core = moments_of(mesh);
  const auto place = [&](int v) {
    return mesh.vertices[static_cast<std::size_t>(v)] - core.center;
  };
  const double r2 = r * r, r3 = r2 * r;
  SolidSums sums;
  sums.volume = core.volume;
  sums.second = core.second;
  for (auto& row : sums.second)
    for (double& value : row) value *= core.volume;
  for (const std::array<int, 3>& t : mesh.triangles) {
    const Vec3d a = place(t[0]), b = place(t[1]), c = place(t[2]);
    const Vec3d n2 = cross(b - a, c - a), middle = (1.0 / 3) * (a + b + c);
    const double area = 0.5 * norm(n2);
    if (!(area > 0)) continue;
    const Vec3d n = normalized(n2);
    sums.add_at(middle, area * r, (area * r2 / 2) * n);
    for (const Vec3d& x : {a - middle, b - middle, c - middle})
      sums.add_second(area * r / 12, x, x);
    sums.add_second(area * r3 / 3, n, n);
  }
  std::vector<Vec3d> first_normal(mesh.vertices.size());
  std::vector<bool> has_normal(mesh.vertices.size(), false);
  for (const MeshCrease& e : creases_of(mesh)) {
    const Vec3d a = place(e.from), b = place(e.to), along = normalized(b - a);
    const double angle = std::atan2(norm(cross(e.left, e.right)), dot(e.left, e.right));
    const Vec3d both = std::tan(angle / 2) * (e.left + e.right);  // of unit vectors over the arc
    if (e.from < e.to) {  // the sector of a cylinder along the edge
      const double length = norm(b - a), piece = length * r2 * angle / 2;
      sums.add_at(0.5 * (a + b), piece, (length * r3 / 3) * both);
      sums.add_second(piece * length * length / 12, along, along);
      const Vec3d middle = normalized(both), side = cross(along, middle);
      const double part = length * r2 * r2 / 8;
      sums.add_second(part * (angle + std::sin(angle)), middle, middle);
      sums.add_second(part * (angle - std::sin(angle)), side, side);
    }
    // At its first corner the normals from those of the right face to those of the left one bound the sector of a ball.
    // Over a part of the unit sphere, grad . (c - (c.u) u) = -2 c.u, and that of (a.u)(b - (b.u) u) = a.b - 3 (a.u)(b.u):
    // so its integrals of u and u u^T are those over the arcs around it, whose normal within the sphere is `along`.
    const auto v = static_cast<std::size_t>(e.from);
    if (!has_normal[v]) first_normal[v] = e.left, has_normal[v] = true;
    const Vec3d& w = first_normal[v];
    const double solid_angle =
        2 * std::atan2(dot(w, cross(e.right, e.left)),
                       1 + dot(w, e.right) + dot(e.right, e.left) + dot(e.left, w));
    sums.add_at(a, r3 / 3 * solid_angle, (-r2 * r2 / 8 * angle) * along);
    for (int k = 0; k < 3; ++k) {
      Vec3d axis;
      axis[k] = 1;
      sums.add_second(r3 * r2 / 15 * solid_angle, axis, axis);
    }
    sums.add_second(-r3 * r2 / 15, both, along);
  }
  SolidMoments m = sums.moments();
  m.center += core.center;
  return m;
}

}  // namespace scree::rounded
