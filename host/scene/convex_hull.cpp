#include "host/scene/convex_hull.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <utility>

#include "shapes/polyhedron.h"
#include "shapes/rounded.h"

namespace scree {
namespace {

using Edge = std::pair<int, int>;

/// In sizes of the hull: what is as near to a plane is said to lie in it.
constexpr double kThickness = 1e-10;
/// By so much a hull that did not come from convex_hull() may be off.
constexpr double kTolerance = 1e-6;

class Quickhull {
 public:
  explicit Quickhull(const std::vector<Vec3d>& points) : points_(points) {}

  std::vector<std::array<int, 3>> triangles() {
    start();
    for (std::size_t f = 0; f < faces_.size(); ++f)
      while (faces_[f].is_there && !faces_[f].outside.empty()) extend(f);
    std::vector<std::array<int, 3>> out;
    for (const Face& face : faces_)
      if (face.is_there) out.push_back(face.corner);
    return out;
  }

 private:
  struct Face {
    std::array<int, 3> corner;
    Vec3d normal;
    double height;
    std::vector<int> outside;  ///< points above it
    bool is_there = true;
  };

  const Vec3d& at(int i) const { return points_[static_cast<std::size_t>(i)]; }
  double above(const Face& face, int i) const { return dot(face.normal, at(i)) - face.height; }

  template <class Measure>
  int largest(Measure&& measure) const {
    int best = 0;
    for (int i = 1; i < static_cast<int>(points_.size()); ++i)
      if (measure(i) > measure(best)) best = i;
    return best;
  }

  void start() {
    if (points_.size() < 4) throw std::invalid_argument("must be four points or more");
    for (const Vec3d& x : points_)
      if (!is_finite(x)) throw std::invalid_argument("must be finite");
    const int a = largest([&](int i) { return at(i).x; });
    const int b = largest([&](int i) { return norm2(at(i) - at(a)); });
    const Vec3d along = at(b) - at(a);
    least_ = kThickness * norm(along);
    const int c = largest([&](int i) { return norm2(cross(at(i) - at(a), along)); });
    const Vec3d normal = normalized(cross(along, at(c) - at(a)), {0, 0, 0});
    const int d = largest([&](int i) { return std::abs(dot(at(i) - at(a), normal)); });
    const double side = dot(at(d) - at(a), normal);
    // Ten times as thick, so that no face of the first four is a sliver.
    if (!(std::abs(side) > 10 * least_)) throw std::invalid_argument("must not lie in one plane");
    const int e = side < 0 ? c : b, f = side < 0 ? b : c;
    for (const auto& corners : {std::array{a, f, e}, {a, e, d}, {e, f, d}, {f, a, d}}) add(corners);
    std::vector<int> all(points_.size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
    hand_out(all, 0);
  }

  void add(const std::array<int, 3>& corner) {
    Face face{corner, {}, 0, {}};
    face.normal =
        normalized(cross(at(corner[1]) - at(corner[0]), at(corner[2]) - at(corner[0])), {0, 0, 0});
    face.height = dot(face.normal, at(corner[0]));
    for (std::size_t k = 0; k < 3; ++k) face_of_[{corner[k], corner[(k + 1) % 3]}] = faces_.size();
    faces_.push_back(std::move(face));
  }

  /// Gives points to the faces from `first` on that they are above.
  void hand_out(const std::vector<int>& points, std::size_t first) {
    for (const int i : points) {
      for (std::size_t f = first; f < faces_.size(); ++f) {
        if (above(faces_[f], i) <= least_) continue;
        faces_[f].outside.push_back(i);
        break;
      }
    }
  }

  /// Puts the highest point above a face in place of all faces that it is above.
  void extend(std::size_t f) {
    const std::vector<int>& outside = faces_[f].outside;
    const int top = *std::max_element(outside.begin(), outside.end(), [&](int a, int b) {
      return above(faces_[f], a) < above(faces_[f], b);
    });
    std::vector<std::size_t> seen{f};
    std::vector<Edge> horizon;
    std::vector<int> left;
    faces_[f].is_there = false;
    for (std::size_t s = 0; s < seen.size(); ++s) {
      const std::array<int, 3> corner = faces_[seen[s]].corner;
      for (std::size_t k = 0; k < 3; ++k) {
        const Edge edge{corner[k], corner[(k + 1) % 3]};
        Face& other = faces_[face_of_.at({edge.second, edge.first})];
        if (!other.is_there) continue;
        if (above(other, top) > least_) {
          other.is_there = false;
          seen.push_back(face_of_.at({edge.second, edge.first}));
        } else {
          horizon.push_back(edge);
        }
      }
    }
    for (const std::size_t s : seen) {
      for (const int i : faces_[s].outside)
        if (i != top) left.push_back(i);
      faces_[s].outside = {};
    }
    const std::size_t first = faces_.size();
    for (const Edge& edge : horizon) add({edge.first, edge.second, top});
    hand_out(left, first);
  }

  const std::vector<Vec3d>& points_;
  double least_ = 0;  ///< [m]
  std::vector<Face> faces_;
  std::map<Edge, std::size_t> face_of_;
};

/// Of a hull, rounded or not.
SolidMoments solid_of(const TriangleMesh& mesh, double rounding) {
  return rounding > 0 ? rounded::moments_of_hull(mesh, rounding) : moments_of(mesh);
}

}  // namespace

TriangleMesh convex_hull(const std::vector<Vec3d>& points, const std::string& name) {
  TriangleMesh mesh;
  mesh.name = name;
  std::map<int, int> number;
  for (const std::array<int, 3>& t : Quickhull(points).triangles()) {
    std::array<int, 3> corner{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [place, is_new] = number.emplace(t[k], static_cast<int>(mesh.vertices.size()));
      if (is_new) mesh.vertices.push_back(points[static_cast<std::size_t>(t[k])]);
      corner[k] = place->second;
    }
    mesh.triangles.push_back(corner);
  }
  return mesh;
}

LocalFrame principal_frame(const SolidMoments& solid) {
  LocalFrame frame;
  frame.origin = solid.center;
  Eigen::Matrix3d second;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      second(i, j) = solid.second[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  const Eigen::Matrix3d mixed = second - Eigen::Matrix3d(second.diagonal().asDiagonal());
  if (mixed.norm() > 1e-12 * second.norm()) {
    Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(second).eigenvectors();
    if (axes.determinant() < 0) axes.col(0) = -axes.col(0);
    const Eigen::Quaterniond q(axes);
    frame.axes = normalized(Quatd(q.w(), q.x(), q.y(), q.z()));
  }
  return frame;
}

LocalFrame move_to_principal_frame(TriangleMesh& mesh, double rounding) {
  const LocalFrame frame = principal_frame(solid_of(mesh, rounding));
  for (Vec3d& v : mesh.vertices) v = rotate_back(frame.axes, v - frame.origin);
  return frame;
}

Shape hull_of(const TriangleMesh& mesh, double rounding) {
  Shape hull;
  shapes::Hull::measure(mesh, hull);
  return rounding > 0 ? shapes::Rounded::of(hull, rounding, &mesh) : hull;
}

void set_hull(Scene& scene, BodyDescription& body, const std::vector<Vec3d>& points,
              double rounding) {
  if (!(rounding >= 0 && std::isfinite(rounding)))
    throw std::invalid_argument(
        fmt::format("a rounding of {} is not zero, or positive and finite", rounding));
  TriangleMesh mesh = convex_hull(points, "hull");
  if (body.kind == BodyKind::free) {
    const LocalFrame frame = move_to_principal_frame(mesh, rounding);
    body.position += rotate(body.orientation, frame.origin);
    body.orientation = body.orientation * frame.axes;
  }
  body.shape = hull_of(mesh, rounding);
  body.shape.mesh = static_cast<int>(scene.meshes.size());
  scene.meshes.push_back(std::move(mesh));
}

std::optional<std::string> hull_fault(const TriangleMesh& mesh, bool is_free, double rounding) {
  const double size = norm(box_about(mesh));
  std::map<Edge, int> edges;
  for (const std::array<int, 3>& t : mesh.triangles) {
    const auto corner = [&](std::size_t k) {
      return mesh.vertices[static_cast<std::size_t>(t[k % 3])];
    };
    const Vec3d n = cross(corner(1) - corner(0), corner(2) - corner(0));
    for (std::size_t k = 0; k < 3; ++k) ++edges[{t[k], t[(k + 1) % 3]}];
    for (const Vec3d& v : mesh.vertices)
      if (dot(v - corner(0), n) > kTolerance * size * norm(n)) return "is not convex";
  }
  for (const auto& [edge, count] : edges)
    if (count != 1 || edges.count({edge.second, edge.first}) == 0) return "is not closed";
  if (!(moments_of(mesh).volume > 0)) return "has no volume";
  if (!is_free) return std::nullopt;
  const SolidMoments solid = solid_of(mesh, rounding);
  if (norm(solid.center) > kTolerance * (size + rounding))
    return "has its center of mass off the origin";
  for (const auto& [i, j] : {std::pair{0, 1}, {1, 2}, {2, 0}}) {
    const double mixed = solid.second[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    if (std::abs(mixed) > kTolerance * (size + rounding) * (size + rounding))
      return "has principal axes of its own";
  }
  return std::nullopt;
}

}  // namespace scree
