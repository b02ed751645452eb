// Entries of `particles`: many free bodies from a generator or a file.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "host/layouts/layouts.h"
#include "host/scene/particle_table.h"
#include "host/scene_reader/particle_shapes.h"
#include "host/scene_reader/parts.h"

namespace scree::reader {
namespace {

enum class Layout { lattice, random, rain, file };

/// What all particles of an entry share, and the values of those a file does not give: a set without
/// positions and radii. Without a density in the entry that is 0.
ParticleSet read_common(const Node& node, Draft& draft) {
  Vec3d velocity;
  Vec3d angular_velocity;
  double density = 0;
  ParticleSet common;
  common.material = read_material(node, draft);
  const auto group = node.find("group");
  common.group = group_index(group ? group->text() : "bodies", draft);
  node.read("velocity", velocity, "m/s");
  node.read("angular_velocity", angular_velocity, "rad/s");
  if (const auto lock = node.find("lock")) common.locks = read_locks(*lock);
  node.read("density", density, kPositive, "kg/m^3");
  common.velocity = velocity;
  common.angular_velocity = angular_velocity;
  common.density = density;
  return common;
}

double size(const Node& node, const char* key) {
  return node.at(key, "must be positive [m]").number(kPositive, "m");
}

Region read_region(const Node& node) {
  node.check_keys(scene_keys("region"));
  Region region;
  if (const auto cylinder = node.find("cylinder")) {
    for (const char* key : {"min", "max"})
      if (const auto other = node.find(key)) other->fail("give either min and max, or cylinder");
    cylinder->check_keys(scene_keys("cylinder"));
    region.kind = Region::Kind::cylinder;
    if (const auto axis = cylinder->find("axis")) region.axis = axis->direction();
    region.center = cylinder->at("center", "must be three numbers [x, y, z] [m]").vector("m");
    region.radius = size(*cylinder, "radius");
    region.length = size(*cylinder, "length");
    return region;
  }
  region.lower = node.at("min", "must be the lower corner [x, y, z] [m]").vector("m");
  const Node max = node.at("max", "must be the upper corner [x, y, z] [m]");
  region.upper = max.vector("m");
  if (!(region.lower.x < region.upper.x && region.lower.y < region.upper.y &&
        region.lower.z < region.upper.z))
    max.refuse("must be above min on every axis [m]");
  return region;
}

LatticeLayout read_lattice(const Node& node, const Region& region, const SizeLaw& size) {
  LatticeLayout lattice;
  lattice.region = region;
  lattice.spacing = 2 * size.largest() * 1.01;
  if (const auto spacing = node.find("spacing")) {
    lattice.spacing = spacing->number(kPositive, "m");
    if (lattice.spacing < 2 * size.largest() * (1 - 1e-12))
      spacing->refuse(
          fmt::format("must be at least the largest diameter, {:.6g} [m]", 2 * size.largest()));
  }
  node.read("jitter", lattice.jitter, kFraction, "-");
  return lattice;
}

/// How the particles of an entry are turned.
class Orientations {
 public:
  /// Their random numbers are a sequence of their own: sequences of places count up from zero,
  /// these down from the last.
  Orientations(const Node& node, std::uint64_t seed, std::size_t index) : random_(seed, ~index) {
    const auto key = node.find("orientation");
    is_random_ = key && key->json().is_string();
    if (!is_random_) {
      read_orientation(node, same_);
      return;
    }
    if (key->text() != "random")
      key->refuse("must be \"random\" or a quaternion [w, x, y, z] of length 1");
    if (const auto both = node.find("rotation_deg"))
      both->fail("give either orientation or rotation_deg");
  }

  PerParticle<Quatd> draw(std::size_t count) {
    if (!is_random_) return same_;
    std::vector<Quatd> drawn(count);
    for (Quatd& q : drawn) q = random_orientation(random_);
    return PerParticle<Quatd>(std::move(drawn));
  }
  /// Of the host for a particle.
  double bytes() const { return is_random_ ? sizeof(Quatd) : 0; }

 private:
  bool is_random_ = false;
  Quatd same_;
  RandomNumbers random_;
};

/// Velocities of the particles of an entry: all the same, or about it as in a gas.
class Velocities {
 public:
  /// Their random numbers are a sequence of their own, far from those of places and orientations.
  Velocities(const Node& node, std::uint64_t seed, std::size_t index)
      : random_(seed, index + (std::uint64_t{1} << 62)) {
    node.read("velocity_spread", spread_, kNonNegative, "m/s");
  }

  /// @param mean  of those drawn, to rounding
  PerParticle<Vec3d> draw(const Vec3d& mean, std::size_t count) {
    if (!(spread_ > 0) || count == 0) return mean;
    std::vector<Vec3d> drawn(count);
    Vec3d sum;
    for (Vec3d& v : drawn) {
      for (int axis = 0; axis < 3; ++axis) v[axis] = spread_ * random_.normal();
      sum += v;
    }
    const Vec3d shift = mean - (1 / static_cast<double>(count)) * sum;
    for (Vec3d& v : drawn) v += shift;
    return PerParticle<Vec3d>(std::move(drawn));
  }
  /// Of the host for a particle.
  double bytes() const { return spread_ > 0 ? sizeof(Vec3d) : 0; }

 private:
  double spread_ = 0;
  RandomNumbers random_;
};

/// What placed particles need to become a set.
struct Recipe {
  ParticleSet common;
  ParticleShapes shapes;
  Orientations orientations;
  Velocities velocities;

  ParticleSet make(PlacedSpheres placed, const Scene& scene) {
    ParticleSet set = common;
    const std::size_t count = placed.center.size();
    require_host_memory(static_cast<long long>(count), orientations.bytes() + velocities.bytes());
    set.orientation = orientations.draw(count);
    set.velocity = velocities.draw(common.velocity[0], count);
    set_placed(shapes, std::move(placed), scene, set);
    return set;
  }
};

/// Batches of rain must have left the region before the next one enters it.
void check_fall(const Node& node, const Draft& draft, const ParticleSet& common, double interval,
                const LatticeLayout& lattice, double thickness) {
  Vec3d low;
  Vec3d high;
  lattice.region.bounds(low, high);
  // A batch enters up to one step late.
  const double t = std::max(0.0, interval - draft.scene.stepping.time_step);
  const Vec3d fall = t * common.velocity[0] + 0.5 * t * t * draft.scene.gravity;
  const Vec3d extent{high.x - low.x, high.y - low.y, thickness};
  for (int k = 0; k < 3; ++k)
    if (std::abs(fall[k]) >= extent[k]) return;
  const auto blamed = node.find("interval");
  (blamed ? *blamed : node)
      .refuse(
          fmt::format("a batch of height {:.4g} m moves only {:.4g} m before the next one; use a "
                      "longer interval [s], a wider region or more layers",
                      thickness, norm(fall)));
}

void read_rain(const Node& node, Recipe& recipe, const LatticeLayout& lattice,
               RandomNumbers& random, Draft& draft) {
  constexpr long long most = std::numeric_limits<Index>::max();
  const long long count = node.at("count", "must be a whole number, 1 or more").integer(1, most);
  const double interval =
      node.at("interval", "must be positive, the time between batches [s]").number(kPositive, "s");
  double start = 0;
  node.read("start", start, kNonNegative, "s");
  long long layers = 0;
  if (const auto rate = node.find("rate")) {
    if (const auto both = node.find("layers")) both->fail("give either layers or rate");
    const double batch = rate->number(kPositive, "spheres/s") * interval;
    if (!(batch >= 1)) rate->refuse("must give one sphere or more per interval [spheres/s]");
    const double most_of_batch = std::min(std::floor(batch), static_cast<double>(count));
    layers = static_cast<long long>(std::ceil(static_cast<double>(count) / most_of_batch));
  } else {
    layers =
        node.at("layers", "the number of batches; give it, or a rate [spheres/s]").integer(1, most);
    if (layers > count) node.at("layers", "").refuse("must not be above count");
  }
  const double last = start + static_cast<double>(layers - 1) * interval;
  if (layers > 1 && !(last - interval < last && last < kInfinity))
    node.at("interval", "")
        .refuse(fmt::format(
            "must be longer: the last batch would enter at {:g} s, where times cannot tell "
            "it from the one before [s]",
            last));
  double tallest = 0;
  for (long long k = 0, placed = 0; k < layers; ++k) {
    // Equal shares, with the remainder spread over the batches.
    const long long upto = count / layers * (k + 1) + count % layers * (k + 1) / layers;
    double thickness = 0;
    PlacedSpheres batch =
        place_rain_batch(lattice, recipe.shapes.size, upto - placed, random, thickness);
    placed = upto;
    tallest = std::max(tallest, thickness);
    if (k == 0 && layers > 1) check_fall(node, draft, recipe.common, interval, lattice, thickness);
    draft.inserted[start + static_cast<double>(k) * interval].particles.push_back(
        recipe.make(std::move(batch), draft.scene));
  }
  if (layers > 1) check_fall(node, draft, recipe.common, interval, lattice, tallest);
}

/// Indices into the names of a file as those of the scene.
PerParticle<int> renumbered(const PerParticle<int>& index, std::size_t count,
                            const std::vector<int>& index_in_scene) {
  std::vector<int> out(count);
  for (std::size_t i = 0; i < count; ++i)
    out[i] = index_in_scene[static_cast<std::size_t>(index[i])];
  return PerParticle<int>(std::move(out));
}

/// Shapes and sizes of the particles of a file: as its columns say, else drawn.
PlacedSpheres with_sizes(const ParticleShapes& shapes, ParticleTable& table,
                         RandomNumbers& random) {
  PlacedSpheres placed;
  placed.center = std::move(table.particles.position);
  const std::size_t count = placed.center.size();
  if (shapes.size.is_constant() && table.scale.uniform()) {
    placed.scale = shapes.size.scale.smallest();
    placed.radius = shapes.size.smallest();
    return placed;
  }
  std::vector<double> scale(count), radius(count);
  std::vector<int> shape(count);
  for (std::size_t i = 0; i < count; ++i) {
    const SizeLaw::Size drawn = shapes.size.draw(random);
    scale[i] = table.scale.uniform() ? drawn.scale : table.scale[i];
    shape[i] = table.shape.uniform() ? drawn.shape : table.shape[i];
    radius[i] = scale[i] * shapes.size.radii[static_cast<std::size_t>(shape[i])];
  }
  placed.scale = PerParticle<double>(std::move(scale));
  placed.radius = PerParticle<double>(std::move(radius));
  placed.shape = PerParticle<int>(std::move(shape));
  return placed;
}

/// Reads the table that an entry names, which has one particle or more.
ParticleTable read_table(const Node& named, int shapes) {
  const bool is_checkpoint = named.file().extension() == ".h5";
  if (is_checkpoint && shapes > 0)
    named.refuse("must be a .csv file: of checkpoints, spheres are read, and a shape is given");
  ParticleTable table = named.from_file([&](const auto& path) {
    ParticleTable read;
    if (is_checkpoint) {
      read.particles = read_checkpoint_particles(path);
    } else {
      read = read_particle_csv(path, shapes);
    }
    return read;
  });
  if (table.particles.position.empty()) named.refuse("the file holds no particles");
  return table;
}

void set_radii(const Node& node, ParticleSet& set) {
  const auto radius = node.find("radius");
  const double default_radius = radius ? radius->number(kPositive, "m") : 0;
  if (set.radius.uniform()) set.radius = default_radius;
  if (!(set.radius[0] > 0))
    node.fail_missing("radius", "the file has no radius column, so one is needed here [m]");
}

void read_file(const Node& node, std::size_t index, const ParticleSet& common,
               Orientations orientations, Velocities velocities, Draft& draft) {
  const Node named = node.at("file", "must be the name of a .csv or .h5 file");
  const ParticleShapes shapes = read_shapes_of_file(node, draft);
  ParticleTable table = read_table(named, static_cast<int>(shapes.shapes.size()));
  ParticleSet& set = table.particles;
  const std::size_t count = set.position.size();
  std::vector<int> groups;
  std::vector<int> materials;
  for (const std::string& name : table.groups) groups.push_back(group_index(name, draft));
  for (const std::string& name : table.materials)
    materials.push_back(material_index(named, name, draft));
  const PerParticle<int> own_group = set.group;
  set.group = common.group;
  if (shapes.shapes.empty()) {
    set_radii(node, set);
  } else {
    check_scales(named, shapes, table.scale, count);
    RandomNumbers random(draft.scene.seed, index);
    set_placed(shapes, with_sizes(shapes, table, random), draft.scene, set);
  }
  if (!own_group.uniform()) set.group = renumbered(own_group, count, groups);
  if (set.density.uniform()) set.density = common.density;
  if (set.mass.uniform() && !(set.density[0] > 0))
    node.fail_missing("density",
                      "the file has no mass or density column, so one is needed here [kg/m^3]");
  if (set.angular_velocity.uniform()) set.angular_velocity = common.angular_velocity;
  if (set.orientation.uniform()) set.orientation = orientations.draw(count);
  if (set.velocity.uniform()) set.velocity = velocities.draw(common.velocity[0], count);
  set.material =
      set.material.uniform() ? common.material : renumbered(set.material, count, materials);
  set.locks = common.locks;
  set.entry = common.entry;
  draft.scene.particles.push_back(std::move(set));
}

/// Keys that mean something for each layout, beside those all have.
void check_layout_keys(const Node& node, Layout layout, const std::string& name) {
  const std::vector<std::pair<std::string, std::vector<Layout>>> layout_keys{
      {"count", {Layout::lattice, Layout::random, Layout::rain}},
      {"region", {Layout::lattice, Layout::random, Layout::rain}},
      {"spacing", {Layout::lattice, Layout::rain}},
      {"jitter", {Layout::lattice, Layout::rain}},
      {"layers", {Layout::rain}},
      {"rate", {Layout::rain}},
      {"start", {Layout::rain}},
      {"interval", {Layout::rain}},
      {"file", {Layout::file}}};
  for (const auto& [key, layouts] : layout_keys) {
    if (std::find(layouts.begin(), layouts.end(), layout) != layouts.end()) continue;
    if (key == "file" && (node.has("shape") || node.has("shapes"))) continue;  // of a shape
    if (const auto found = node.find(key))
      found->fail("the layout \"" + name + "\" has no such key");
  }
}

}  // namespace

void read_particles(const Node& node, std::size_t index, Draft& draft) {
  node.check_keys(scene_keys("particles"));
  const Node named =
      node.at("layout", "must be one of \"lattice\", \"random\", \"rain\", \"file\"");
  const Layout layout = named.choice<Layout>({{"lattice", Layout::lattice},
                                              {"random", Layout::random},
                                              {"rain", Layout::rain},
                                              {"file", Layout::file}});
  check_layout_keys(node, layout, named.text());
  ParticleSet common = read_common(node, draft);
  common.entry = static_cast<int>(index);
  Orientations orientations(node, draft.scene.seed, index);
  Velocities velocities(node, draft.scene.seed, index);
  if (layout == Layout::file) {
    read_file(node, index, common, orientations, velocities, draft);
    return;
  }
  if (common.density[0] == 0) node.fail_missing("density", "must be positive [kg/m^3]");
  Recipe recipe{std::move(common), read_particle_shapes(node, draft), orientations, velocities};
  const SizeLaw& size = recipe.shapes.size;
  const Region region =
      read_region(node.at("region", "the space to fill, {min, max} or {cylinder}"));
  RandomNumbers random(draft.scene.seed, index);
  const auto count = node.find("count");
  constexpr long long most = std::numeric_limits<Index>::max();
  try {
    if (layout == Layout::random) {
      const long long wanted =
          node.at("count", "must be a whole number, 1 or more").integer(1, most);
      draft.scene.particles.push_back(
          recipe.make(place_at_random(region, size, wanted, random), draft.scene));
    } else if (layout == Layout::lattice) {
      const LatticeLayout lattice = read_lattice(node, region, size);
      const long long wanted = count ? count->integer(1, most) : -1;
      draft.scene.particles.push_back(
          recipe.make(place_on_lattice(lattice, size, wanted, random), draft.scene));
    } else {
      const LatticeLayout lattice = read_lattice(node, region, size);
      read_rain(node, recipe, lattice, random, draft);
    }
  } catch (const DoesNotFit& fault) {
    (count ? *count : node.at("region", "")).refuse(fault.what());
  }
}

}  // namespace scree::reader
