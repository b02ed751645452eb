#include "host/scene/bed_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "host/error.h"
#include "host/layouts/random_numbers.h"
#include "host/scene_reader.h"

namespace scree {
namespace {

constexpr double kDensity = 2500;  // [kg/m^3]
constexpr double kGravity = 9.81;  // [m/s^2]

// Equal spheres, lengths in diameters.
constexpr double kSpacing = 1.12;      // of sites within a layer; neighbors do not touch
constexpr double kLayerHeight = 0.62;  // about: spheres rest on four below
constexpr double kVacant = 0.12;       // share of vacant sites
constexpr double kJitter = 0.005;      // largest displacement along x and along y
constexpr double kGap = 1e-4;          // vertical, to the highest sphere below

// Sizes of a polydisperse bed: a cubic cell of the lattice holds k^3 spheres of diameter d / k.
constexpr std::array<int, 5> kDivisions{1, 2, 3, 5, 10};
constexpr double kCell = 1.01;        // edge of a cell, of its spheres' grid as well
constexpr double kCellJitter = 0.45;  // of the free way to the neighbor
constexpr double kBodiesPerCell = (1 + 8 + 27 + 125 + 1000) / 5.0;

/// Sites along an edge of a layer.
int side(const BedParams& bed) {
  const double per_layer = static_cast<double>(bed.count) / bed.layers;
  const double sites = bed.polydisperse ? per_layer / kBodiesPerCell : per_layer / (1 - kVacant);
  return std::max(1, static_cast<int>(std::ceil(std::sqrt(sites))));
}

double width(const BedParams& bed) {
  if (bed.polydisperse) return bed.diameter * kCell * side(bed);
  return bed.diameter * (1 + (side(bed) - 0.5) * kSpacing + 2 * kJitter);
}

/// Layer after layer, each sphere on the highest of those below it.
class EqualSpheres {
 public:
  explicit EqualSpheres(const BedParams& bed)
      : bed_(bed), side_(side(bed)), below_(sites()), layer_(sites()) {}

  ParticleSet make() {
    ParticleSet set;
    set.radius = 0.5 * bed_.diameter;
    set.density = kDensity;
    set.position.reserve(static_cast<std::size_t>(bed_.count));
    const auto count = static_cast<std::size_t>(bed_.count);
    for (int z = 0; set.position.size() < count;) {
      const std::size_t before = set.position.size();
      for (int y = 0; y < side_; ++y)
        for (int x = 0; x < side_; ++x) place(x, y, z, set);
      if (set.position.size() == before) continue;  // all sites vacant: nothing would rest on it
      std::swap(below_, layer_);
      ++z;
    }
    return set;
  }

 private:
  struct Site {
    Vec3d center;
    bool taken = false;
  };

  std::size_t sites() const { return static_cast<std::size_t>(side_) * side_; }
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y) * side_ + x; }

  void place(int x, int y, int z, ParticleSet& set) {
    Site& site = layer_[index(x, y)];
    site.taken =
        random_.unit() >= kVacant && set.position.size() < static_cast<std::size_t>(bed_.count);
    if (!site.taken) return;
    const double d = bed_.diameter;
    const double start = d * (0.5 + (z % 2 == 0 ? 0 : 0.5 * kSpacing));
    site.center.x = start + d * (x * kSpacing + random_.uniform(0, 2 * kJitter));
    site.center.y = start + d * (y * kSpacing + random_.uniform(0, 2 * kJitter));
    site.center.z = z == 0 ? 0.5 * d : 0;
    const int first = z % 2 == 0 ? -1 : 0;  // the four sites below begin here
    for (int j = y + first; z > 0 && j < y + first + 2; ++j)
      for (int i = x + first; i < x + first + 2; ++i) rest_on(i, j, site);
    site.taken = site.center.z > 0;  // nothing below: vacant too
    if (!site.taken) return;
    site.center.z += kGap * d;
    set.position.push_back(site.center);
  }

  /// Lifts the sphere of a site until it touches one of the layer below.
  void rest_on(int i, int j, Site& site) const {
    if (i < 0 || j < 0 || i >= side_ || j >= side_ || !below_[index(i, j)].taken) return;
    const Vec3d& support = below_[index(i, j)].center;
    const double dx = site.center.x - support.x, dy = site.center.y - support.y;
    const double rise = bed_.diameter * bed_.diameter - dx * dx - dy * dy;
    site.center.z = std::max(site.center.z, support.z + std::sqrt(std::max(rise, 0.0)));
  }

  BedParams bed_;
  int side_;
  std::vector<Site> below_, layer_;
  RandomNumbers random_{1, 0};
};

/// Coordinates of point `index` of a grid that is n points wide along x and y.
Vec3d grid_point(int index, int n) {
  const int row = index / n, layer = row / n;
  return {static_cast<double>(index % n), static_cast<double>(row % n), static_cast<double>(layer)};
}

/// A cubic lattice of cells, each filled with a cubic grid of spheres of one size.
ParticleSet mixed_spheres(const BedParams& bed) {
  RandomNumbers random(1, 0);
  const auto count = static_cast<std::size_t>(bed.count);
  const int n = side(bed);
  const double cell = bed.diameter * kCell;
  ParticleSet set;
  std::vector<double> radius;
  set.position.reserve(count);
  radius.reserve(count);
  for (int index = 0; set.position.size() < count; ++index) {
    const int division = kDivisions[random.below(kDivisions.size())];
    const double spacing = cell / division, d = bed.diameter / division;
    const double way = kCellJitter * (spacing - d);
    const Vec3d corner = cell * grid_point(index, n);
    for (int k = 0; k < division * division * division && set.position.size() < count; ++k) {
      const Vec3d grid = grid_point(k, division) + Vec3d{0.5, 0.5, 0.5};
      set.position.push_back(
          corner + spacing * grid +
          Vec3d{random.uniform(-way, way), random.uniform(-way, way), random.uniform(-way, way)});
      radius.push_back(0.5 * d);
    }
  }
  set.radius = PerParticle<double>(std::move(radius));
  set.density = kDensity;
  return set;
}

/// The scene as a file would say it. One sphere stands for all: readers want a free body.
std::string scene_text(const BedParams& bed) {
  const double d = bed.diameter;
  const std::string floor =
      bed.walls ? fmt::format(R"({{"shape": "container", "open": ["+z"], "min": [0, 0, 0], )"
                              R"("max": [{0}, {0}, {1}]}})",
                              width(bed), 2 * bed_height(bed) + d)
                : R"({"shape": "half_space"})";
  const std::string sphere =
      fmt::format(R"({{"layout": "lattice", "count": 1, "radius": {0}, "density": {1}, )"
                  R"("region": {{"min": [0, 0, 0], "max": [{2}, {2}, {2}]}}}})",
                  d / 2, kDensity, 2 * d);
  return fmt::format(R"({{"name": "{}", "time_step": 5e-4, "duration": 1, )"
                     R"("materials": {{"grain": {{"friction": 0.5}}}}, )"
                     R"("bodies": [{}], "particles": [{}]}})",
                     bed.walls ? "bed" : "column", floor, sphere);
}

}  // namespace

double bed_height(const BedParams& bed) {
  return bed.diameter * bed.layers * (bed.polydisperse ? kCell : kLayerHeight);
}

int layers_of_cube(int count, bool polydisperse) {
  if (polydisperse) return std::max(1, static_cast<int>(std::cbrt(count / kBodiesPerCell)));
  // side^2 layers (1 - vacant) = count and side * spacing = layers * layer height
  const double ratio = kLayerHeight / kSpacing;
  return std::max(1, static_cast<int>(std::cbrt(count / (ratio * ratio * (1 - kVacant)))));
}

double warmup_time(const BedParams& bed) {
  const double height = bed_height(bed);
  if (!bed.walls) return std::sqrt(height / kGravity);
  const double sinking = bed.polydisperse ? 0.06 : 0.05;  // share of the height
  return 0.05 + std::sqrt(2 * sinking * height / kGravity);
}

Scene bed_scene(const BedParams& bed, const std::vector<std::string>& overrides) {
  if (bed.count <= 0) throw InputError(fmt::format("bed: {} spheres, expected some", bed.count));
  if (bed.layers <= 0) throw InputError(fmt::format("bed: {} layers, expected some", bed.layers));
  if (!(bed.diameter > 0))
    throw InputError(fmt::format("bed: diameter {}, must be positive [m]", bed.diameter));
  for (const std::string& setting : overrides)
    if (setting.starts_with("particles"))
      throw InputError(fmt::format("override \"{}\": the spheres of a bed are given", setting));
  Scene scene = parse_scene(scene_text(bed), "scene of the benchmark", ".", overrides);
  scene.particles = {bed.polydisperse ? mixed_spheres(bed) : EqualSpheres(bed).make()};
  return scene;
}

}  // namespace scree
