#include "host/scene/mesh_shells.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <vector>

#include "host/disjoint_sets.h"
#include "shapes/solid_angle.h"

namespace scree {
namespace {

/// Triangles that belong together over their edges.
struct Shell {
  std::vector<int> triangles;
  Vec3d low, high;
  double volume = 0;  ///< below zero: its inside is outside [m^3]

  bool holds(const Shell& other) const {
    for (int k = 0; k < 3; ++k)
      if (other.low[k] < low[k] || other.high[k] > high[k]) return false;
    return true;
  }
};

class Shells {
 public:
  explicit Shells(const TriangleMesh& mesh) : mesh_(mesh) {
    DisjointSets sets(mesh.triangles.size());
    std::map<std::array<int, 2>, std::size_t> first_of_edge;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k) {
        const auto [a, b] = std::minmax(mesh.triangles[t][k], mesh.triangles[t][(k + 1) % 3]);
        sets.join(t, first_of_edge.try_emplace({a, b}, t).first->second);
      }
    std::map<std::size_t, std::size_t> number;  // by root, which is the first triangle
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto [place, is_new] = number.try_emplace(sets.root(t), shells_.size());
      if (is_new) shells_.emplace_back();
      shells_[place->second].triangles.push_back(static_cast<int>(t));
    }
    for (Shell& shell : shells_) measure(shell);
  }

  std::optional<WrongShell> wrong() const {
    if (shells_.size() < 2) return std::nullopt;
    double volume = 0;
    for (const Shell& shell : shells_) volume += shell.volume;
    for (const Shell& shell : shells_) {
      const std::optional<int> around = times_around(shell, volume < 0);
      const bool is_outward = (shell.volume < 0) == (volume < 0);
      if (around && *around != (is_outward ? 0 : 1))
        return WrongShell{shell.triangles[0], is_outward};
    }
    return std::nullopt;
  }

 private:
  std::array<Vec3d, 3> corners(int t) const {
    std::array<Vec3d, 3> c;
    for (std::size_t k = 0; k < 3; ++k)
      c[k] =
          mesh_.vertices[static_cast<std::size_t>(mesh_.triangles[static_cast<std::size_t>(t)][k])];
    return c;
  }

  void measure(Shell& shell) const {
    const Vec3d origin = corners(shell.triangles[0])[0];
    shell.low = shell.high = origin;
    for (const int t : shell.triangles) {
      const std::array<Vec3d, 3> c = corners(t);
      for (const Vec3d& v : c)
        for (int k = 0; k < 3; ++k) {
          shell.low[k] = std::min(shell.low[k], v[k]);
          shell.high[k] = std::max(shell.high[k], v[k]);
        }
      shell.volume += dot(c[0] - origin, cross(c[1] - origin, c[2] - origin)) / 6;
    }
  }

  /// How often other shells are around one, less the cavities that it is in; nothing where that is not clear.
  std::optional<int> times_around(const Shell& shell, bool is_inside_out) const {
    std::vector<const Shell*> others;
    for (const Shell& other : shells_)
      if (&other != &shell && other.holds(shell)) others.push_back(&other);
    // A surface is half around what lies in it: the next triangle may lie elsewhere.
    constexpr std::size_t kMostTries = 16;
    constexpr double kClear = 0.01;
    const std::size_t stride = 1 + shell.triangles.size() / kMostTries;
    for (std::size_t k = 0; k < shell.triangles.size(); k += stride) {
      const std::array<Vec3d, 3> c = corners(shell.triangles[k]);
      const Vec3d middle = (1.0 / 3) * (c[0] + c[1] + c[2]);
      double sum = 0;
      for (const Shell* other : others)
        for (const int t : other->triangles) sum += solid_angle(corners(t), middle);
      sum *= (is_inside_out ? -1 : 1) / (4 * std::numbers::pi);
      if (std::abs(sum - std::round(sum)) < kClear) return static_cast<int>(std::lround(sum));
    }
    return std::nullopt;
  }

  const TriangleMesh& mesh_;
  std::vector<Shell> shells_;
};

}  // namespace

std::optional<WrongShell> wrong_shell(const TriangleMesh& mesh) { return Shells(mesh).wrong(); }

}  // namespace scree
