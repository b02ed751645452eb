#include "host/scene/compound.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "host/scene/particle_shapes.h"
#include "host/scene/scene_checks.h"
#include "host/scene/scene_summary.h"
#include "shapes/compound.h"
#include "shapes/rounded.h"
#include "shapes/shape_card.h"
#include "shapes/solid_sums.h"

namespace scree {
namespace {

Vec3d axis(int k) {
  Vec3d e;
  e[k] = 1;
  return e;
}

/// Of a part, by the moments of its card.
SolidSums sums_of(const ShapePart& part) {
  const MassProperties solid = shape_card(part.shape.kind).mass(part.shape, 1);
  const Vec3d& inertia = solid.inertia;
  const double trace = 0.5 * (inertia.x + inertia.y + inertia.z);
  SolidSums s;
  s.volume = solid.mass;
  s.first = solid.mass * part.position;
  for (int k = 0; k < 3; ++k) {
    const Vec3d e = rotate(part.orientation, axis(k));
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) s.add(i, j, (trace - inertia[k]) * e[i] * e[j]);
  }
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) s.add(i, j, solid.mass * part.position[i] * part.position[j]);
  return s;
}

/// What several parts hold, as often as more than one of them holds it: by chords of lines of a lattice across all of it.
class CommonSums {
 public:
  CommonSums(const Scene& scene, const std::vector<ShapePart>& parts)
      : scene_(scene), parts_(parts) {
    for (const ShapePart& part : parts) radius_.push_back(bounding_radius(scene, part.shape));
    // Faces of parts are rarely at a right angle to a direction that nobody would choose.
    axes_ = normalized(Quatd(0.8141, 0.2713, -0.4187, 0.2969));
  }

  SolidSums sum() {
    SolidSums total;
    if (!find_rectangle()) return total;
    constexpr int kLines = 1024;
    const double du = (high_u_ - low_u_) / kLines, dv = (high_v_ - low_v_) / kLines;
    SolidSums local;
    for (int i = 0; i < kLines; ++i)
      for (int j = 0; j < kLines; ++j)
        add_line(low_u_ + (i + 0.5) * du, low_v_ + (j + 0.5) * dv, du * dv, local);
    total.volume = local.volume;
    total.first = rotate(axes_, local.first);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const Vec3d row = rotate_back(axes_, axis(i)), column = rotate_back(axes_, axis(j));
        double value = 0;
        for (std::size_t a = 0; a < 3; ++a)
          for (std::size_t b = 0; b < 3; ++b)
            value += row[static_cast<int>(a)] * local.second[a][b] * column[static_cast<int>(b)];
        total.add(i, j, value);
      }
    return total;
  }

 private:
  /// Across the lines, what pairs of parts may have in common.
  bool find_rectangle() {
    low_u_ = low_v_ = 1e300;
    high_u_ = high_v_ = -1e300;
    for (std::size_t a = 0; a < parts_.size(); ++a)
      for (std::size_t b = a + 1; b < parts_.size(); ++b) {
        if (norm(parts_[b].position - parts_[a].position) >= radius_[a] + radius_[b]) continue;
        const auto [lower_a, upper_a] = extent(a);
        const auto [lower_b, upper_b] = extent(b);
        Vec3d lower, upper;
        bool meet = true;
        for (int k = 0; k < 3; ++k) {
          lower[k] = std::max(lower_a[k], lower_b[k]);
          upper[k] = std::min(upper_a[k], upper_b[k]);
          meet = meet && lower[k] < upper[k];
        }
        if (!meet) continue;
        low_u_ = std::min(low_u_, lower.x), high_u_ = std::max(high_u_, upper.x);
        low_v_ = std::min(low_v_, lower.y), high_v_ = std::max(high_v_, upper.y);
      }
    return low_u_ < high_u_ && low_v_ < high_v_;
  }

  /// Of a part along the axes of the lattice.
  std::pair<Vec3d, Vec3d> extent(std::size_t p) const {
    const ShapePart& part = parts_[p];
    const ShapeCard& card = shape_card(part.shape.kind);
    std::pair<Vec3d, Vec3d> e;
    for (int k = 0; k < 3; ++k) {
      const Vec3d n = rotate_back(part.orientation, rotate(axes_, axis(k)));
      const double center = dot(part.position, rotate(axes_, axis(k)));
      const TriangleMesh* mesh = mesh_of(scene_, part.shape);
      e.second[k] = center + dot(n, card.support(part.shape, mesh, n));
      e.first[k] = center + dot(n, card.support(part.shape, mesh, -n));
    }
    return e;
  }

  void add_line(double u, double v, double area, SolidSums& sums) {
    ends_.clear();
    const Vec3d start = rotate(axes_, {u, v, 0}), along = rotate(axes_, axis(2));
    for (const ShapePart& part : parts_) {
      const Chord chord = shape_card(part.shape.kind)
                              .chord(part.shape, mesh_of(scene_, part.shape),
                                     rotate_back(part.orientation, start - part.position),
                                     rotate_back(part.orientation, along));
      if (chord.is_empty()) continue;
      ends_.emplace_back(chord.in, 1);
      ends_.emplace_back(chord.out, -1);
    }
    std::sort(ends_.begin(), ends_.end());
    int within = 0;
    for (std::size_t k = 0; k + 1 < ends_.size(); ++k) {
      within += ends_[k].second;
      if (within < 2) continue;
      const double a = ends_[k].first, b = ends_[k + 1].first, weight = area * (within - 1);
      const double length = weight * (b - a), middle = length * (a + b) / 2;
      sums.volume += length;
      sums.first += Vec3d{u * length, v * length, middle};
      const double of_u[3] = {u * u * length, u * v * length, u * middle};
      const double of_v[3] = {u * v * length, v * v * length, v * middle};
      const double of_w[3] = {u * middle, v * middle, weight * (b * b * b - a * a * a) / 3};
      for (int j = 0; j < 3; ++j) {
        sums.add(0, j, of_u[j]);
        sums.add(1, j, of_v[j]);
        sums.add(2, j, of_w[j]);
      }
    }
  }

  const Scene& scene_;
  const std::vector<ShapePart>& parts_;
  std::vector<double> radius_;
  Quatd axes_;  ///< of the lattice
  double low_u_ = 0, high_u_ = 0, low_v_ = 0, high_v_ = 0;
  std::vector<std::pair<double, int>> ends_;
};

std::optional<std::string> part_fault(const Scene& scene, const ShapePart& part) {
  if (!is_shape(part.shape.kind)) return "has no shape";
  const ShapeCard& card = shape_card(part.shape.kind);
  if (!card.may_be_part())
    return fmt::format("is a {}: a part must be a {}", card.name,
                       shape_names(&ShapeCard::may_be_part, " or "));
  if ((card.has_mesh || has_hull(part.shape)) && mesh_of(scene, part.shape) == nullptr)
    return fmt::format("names mesh {} of {}", part.shape.mesh, scene.meshes.size());
  if (const auto fault = card.fault(part.shape))
    return fmt::format("has {} {}, which {}", fault->field, fault->value, fault->expected);
  if (!(std::isfinite(norm(part.position))))
    return fmt::format("is at {}, which must be three finite numbers [m]",
                       vector_text(part.position));
  const Quatd& q = part.orientation;
  if (!(std::abs(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z - 1) < 1e-6))
    return "has an orientation that is not of length 1";
  return std::nullopt;
}

/// The same in another frame about its center.
SolidMoments seen_from(const SolidMoments& solid, const LocalFrame& frame) {
  SolidMoments out;
  out.volume = solid.volume;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      const Vec3d row = rotate(frame.axes, axis(static_cast<int>(i)));
      const Vec3d column = rotate(frame.axes, axis(static_cast<int>(j)));
      for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = 0; b < 3; ++b)
          out.second[i][j] +=
              row[static_cast<int>(a)] * solid.second[a][b] * column[static_cast<int>(b)];
    }
  return out;
}

void add_surface(const Scene& scene, ShapePart& part, TriangleMesh& mesh) {
  const Surface surface =
      shape_card(part.shape.kind).surface(part.shape, mesh_of(scene, part.shape), 0);
  const int first = static_cast<int>(mesh.vertices.size());
  part.first_vertex = first;
  part.vertex_count = static_cast<int>(surface.vertices.size());
  for (const Vec3d& v : surface.vertices)
    mesh.vertices.push_back(part.position + rotate(part.orientation, v));
  for (const std::vector<int>& face : surface.faces)
    for (std::size_t k = 2; k < face.size(); ++k)
      mesh.triangles.push_back({first + face[0], first + face[k - 1], first + face[k]});
}

/// Keeps the corners of rounded hulls behind the surfaces, where no triangle uses them: they tell how far these reach.
void add_cores(const Scene& scene, std::vector<ShapePart>& parts, TriangleMesh& mesh) {
  for (ShapePart& part : parts) {
    if (part.shape.rounded.core != shapes::Hull::kind) continue;
    const Surface core =
        shapes::Hull::surface(shapes::Rounded::core(part.shape), mesh_of(scene, part.shape), 0);
    part.first_vertex = static_cast<int>(mesh.vertices.size());
    part.vertex_count = static_cast<int>(core.vertices.size());
    for (const Vec3d& v : core.vertices)
      mesh.vertices.push_back(part.position + rotate(part.orientation, v));
  }
}

void check_parts(const Scene& scene, const std::vector<ShapePart>& parts) {
  if (parts.empty()) throw std::invalid_argument("a compound must have one part or more");
  for (std::size_t k = 0; k < parts.size(); ++k)
    if (const auto fault = part_fault(scene, parts[k]))
      throw std::invalid_argument(fmt::format("part {} {}", k, *fault));
}

/// The parts as one body with a frame of its own.
CompoundBody assembled(const Scene& scene, std::vector<ShapePart> parts, const SolidMoments& solid,
                       const LocalFrame& frame) {
  CompoundBody body;
  body.frame = frame;
  for (ShapePart& part : parts) {
    part.position = rotate_back(frame.axes, part.position - frame.origin);
    part.orientation = conjugate(frame.axes) * part.orientation;
  }
  body.mesh.name = "compound";
  for (ShapePart& part : parts) add_surface(scene, part, body.mesh);
  add_cores(scene, parts, body.mesh);
  body.mesh.parts = std::move(parts);
  body.shape.kind = shapes::Compound::kind;
  body.shape.half_extents = shapes::Compound::box_about_parts(body.mesh);
  body.shape.volume = solid.volume;
  body.shape.moments = seen_from(solid, frame).principal_moments();
  return body;
}

}  // namespace

SolidMoments moments_of(const Scene& scene, const std::vector<ShapePart>& parts,
                        SharedMass shared) {
  SolidSums sums;
  for (const ShapePart& part : parts) sums.add(sums_of(part), 1);
  if (shared == SharedMass::each_part || parts.size() < 2) return sums.moments();
  for (const ShapePart& part : parts) {
    const ShapeCard& card = shape_card(part.shape.kind);
    if (card.chord == nullptr)
      throw std::invalid_argument(
          fmt::format("what parts have in common cannot count once where one is a {}", card.name));
  }
  sums.add(CommonSums(scene, parts).sum(), -1);
  return sums.moments();
}

CompoundBody make_compound(const Scene& scene, std::vector<ShapePart> parts, SharedMass shared,
                           bool is_free) {
  check_parts(scene, parts);
  // The mass of bodies that are not free counts nowhere.
  const SolidMoments solid = moments_of(scene, parts, is_free ? shared : SharedMass::each_part);
  return assembled(scene, std::move(parts), solid, is_free ? principal_frame(solid) : LocalFrame{});
}

CompoundBody make_compound_in(const Scene& scene, std::vector<ShapePart> parts,
                              const LocalFrame& frame) {
  check_parts(scene, parts);
  const SolidMoments solid = moments_of(scene, parts, SharedMass::each_part);
  return assembled(scene, std::move(parts), solid, frame);
}

void set_compound(Scene& scene, BodyDescription& body, std::vector<ShapePart> parts,
                  SharedMass shared) {
  CompoundBody made = make_compound(scene, std::move(parts), shared, body.kind == BodyKind::free);
  body.position += rotate(body.orientation, made.frame.origin);
  body.orientation = body.orientation * made.frame.axes;
  body.shape = made.shape;
  body.shape.mesh = static_cast<int>(scene.meshes.size());
  scene.meshes.push_back(std::move(made.mesh));
}

std::optional<std::string> compound_fault(const Scene& scene, const TriangleMesh& mesh) {
  if (mesh.parts.empty()) return "has no parts";
  for (std::size_t k = 0; k < mesh.parts.size(); ++k) {
    const ShapePart& part = mesh.parts[k];
    if (const auto fault = part_fault(scene, part))
      return fmt::format("has a part {} that {}", k, *fault);
    if (part.first_vertex < 0 || part.vertex_count < 1 ||
        part.first_vertex + part.vertex_count > static_cast<int>(mesh.vertices.size()))
      return fmt::format("has a part {} without a surface", k);
  }
  return std::nullopt;
}

std::vector<ShapePart> parts_of(const Scene& scene, const Shape& shape) {
  if (!is_shape(shape.kind) || !shape_card(shape.kind).is_compound) return {};
  const TriangleMesh& mesh = *mesh_of(scene, shape);
  std::vector<ShapePart> parts = mesh.parts;
  const double size = shapes::Compound::scale(shape, mesh);
  if (size == 1) return parts;
  for (ShapePart& part : parts) {
    part.shape = shape_card(part.shape.kind).scaled(part.shape, size);
    part.position *= size;
  }
  return parts;
}

std::size_t part_count_of(const Scene& scene, const Shape& shape) {
  if (!is_shape(shape.kind) || !shape_card(shape.kind).is_compound) return 1;
  return mesh_of(scene, shape)->parts.size();
}

std::map<ShapeKind, std::size_t> part_shape_counts(const Scene& scene, const ParticleSet& set) {
  std::map<ShapeKind, std::size_t> count = particle_shape_counts(set);
  if (count.erase(shapes::Compound::kind) == 0) return count;
  std::map<int, std::size_t> bodies_of_mesh;
  for (std::size_t i = 0; i < set.position.size(); ++i)
    if (set.shape[i].kind == shapes::Compound::kind) ++bodies_of_mesh[set.shape[i].mesh];
  for (const auto& [mesh, bodies] : bodies_of_mesh)
    for (const ShapePart& part : scene.meshes[static_cast<std::size_t>(mesh)].parts)
      count[part.shape.kind] += bodies;
  return count;
}

}  // namespace scree
