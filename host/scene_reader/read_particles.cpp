// Entries of `particles`: many spheres from a generator or a file.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "host/layouts/layouts.h"
#include "host/scene/particle_table.h"
#include "host/scene_reader/parts.h"

namespace scree::reader {
namespace {

enum class Layout { lattice, random, rain, file };

/// What all spheres of an entry share, and the values of those a file does not give: a set without
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

RadiusLaw read_radius(const Node& node) {
  RadiusLaw law;
  if (node.json().is_number()) {
    law.low = law.high = node.number(kPositive, "m");
    return law;
  }
  if (!node.json().is_object())
    node.refuse("must be a positive number [m] or one of {min, max}, {values, weights}, {normal}");
  node.check_keys(scene_keys("radius"));
  if (node.has("values") + node.has("normal") + (node.has("min") || node.has("max")) != 1)
    node.refuse("must have exactly one of {min, max}, {values, weights}, {normal} [m]");
  if (const auto values = node.find("values")) {
    law.kind = RadiusLaw::Kind::discrete;
    for (const Node& value : values->elements()) law.values.push_back(value.number(kPositive, "m"));
    if (law.values.empty()) values->refuse("must hold one radius or more [m]");
    law.weights.assign(law.values.size(), 1.0);
    if (const auto weights = node.find("weights")) {
      const std::vector<Node> entries = weights->elements();
      if (entries.size() != law.values.size()) weights->refuse("must be one weight per value");
      double sum = 0;
      for (std::size_t i = 0; i < entries.size(); ++i)
        sum += law.weights[i] = entries[i].number(kNonNegative, "");
      if (!(sum > 0 && sum < kInfinity))
        weights->refuse("must have a positive sum, and a finite one");
    }
    return law;
  }
  if (const auto weights = node.find("weights")) weights->fail("weights belong to values");
  const auto normal = node.find("normal");
  const Node& ends = normal ? *normal : node;
  if (normal) {
    normal->check_keys(scene_keys("radius_normal"));
    law.kind = RadiusLaw::Kind::normal;
    law.mean = size(*normal, "mean");
    law.deviation =
        normal->at("deviation", "must be zero or positive [m]").number(kNonNegative, "m");
  } else {
    law.kind = RadiusLaw::Kind::uniform;
  }
  law.low = size(ends, "min");
  const Node max = ends.at("max", "must be positive [m]");
  law.high = max.number(kPositive, "m");
  if (law.high < law.low) max.refuse("must not be below min [m]");
  // A range that holds the mean is likely enough for draws to hit it, or narrow.
  if (normal && !(law.low <= law.mean && law.mean <= law.high))
    normal->at("mean", "").refuse("must be from min to max [m]");
  return law;
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

LatticeLayout read_lattice(const Node& node, const Region& region, const RadiusLaw& radius) {
  LatticeLayout lattice;
  lattice.region = region;
  lattice.spacing = 2 * radius.largest() * 1.01;
  if (const auto spacing = node.find("spacing")) {
    lattice.spacing = spacing->number(kPositive, "m");
    if (lattice.spacing < 2 * radius.largest() * (1 - 1e-12))
      spacing->refuse(
          fmt::format("must be at least the largest diameter, {:.6g} [m]", 2 * radius.largest()));
  }
  node.read("jitter", lattice.jitter, kFraction, "-");
  return lattice;
}

ParticleSet particles(const ParticleSet& common, PlacedSpheres spheres) {
  ParticleSet set = common;
  set.position = std::move(spheres.center);
  set.radius = std::move(spheres.radius);
  return set;
}

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

void read_rain(const Node& node, const ParticleSet& common, const LatticeLayout& lattice,
               const RadiusLaw& radius, RandomNumbers& random, Draft& draft) {
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
    PlacedSpheres batch = place_rain_batch(lattice, radius, upto - placed, random, thickness);
    placed = upto;
    tallest = std::max(tallest, thickness);
    if (k == 0 && layers > 1) check_fall(node, draft, common, interval, lattice, thickness);
    draft.inserted[start + static_cast<double>(k) * interval].particles.push_back(
        particles(common, std::move(batch)));
  }
  if (layers > 1) check_fall(node, draft, common, interval, lattice, tallest);
}

/// Indices into the names of a file as those of the scene.
PerParticle<int> renumbered(const PerParticle<int>& index, std::size_t count,
                            const std::vector<int>& index_in_scene) {
  std::vector<int> out(count);
  for (std::size_t i = 0; i < count; ++i)
    out[i] = index_in_scene[static_cast<std::size_t>(index[i])];
  return PerParticle<int>(std::move(out));
}

void read_file(const Node& node, const ParticleSet& common, Draft& draft) {
  const Node named = node.at("file", "must be the name of a .csv or .h5 file");
  const std::filesystem::path path = named.file();
  ParticleTable table;
  if (path.extension() == ".h5") {
    table.particles = read_checkpoint_particles(path);
  } else {
    table = read_particle_csv(path);
  }
  ParticleSet& set = table.particles;
  if (set.position.empty()) named.refuse("the file holds no particles");
  std::vector<int> groups;
  std::vector<int> materials;
  for (const std::string& name : table.groups) groups.push_back(group_index(name, draft));
  for (const std::string& name : table.materials)
    materials.push_back(material_index(named, name, draft));
  const auto radius = node.find("radius");
  const double default_radius = radius ? radius->number(kPositive, "m") : 0;
  if (set.radius.uniform()) set.radius = default_radius;
  if (!(set.radius[0] > 0))
    node.fail_missing("radius", "the file has no radius column, so one is needed here [m]");
  if (set.density.uniform()) set.density = common.density;
  if (set.mass.uniform() && !(set.density[0] > 0))
    node.fail_missing("density",
                      "the file has no mass or density column, so one is needed here [kg/m^3]");
  if (set.velocity.uniform()) set.velocity = common.velocity;
  if (set.angular_velocity.uniform()) set.angular_velocity = common.angular_velocity;
  const std::size_t count = set.position.size();
  set.group = set.group.uniform() ? common.group : renumbered(set.group, count, groups);
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
  if (layout == Layout::file) {
    read_file(node, common, draft);
    return;
  }
  if (common.density[0] == 0) node.fail_missing("density", "must be positive [kg/m^3]");
  const RadiusLaw radius = read_radius(node.at("radius", "must be positive [m]"));
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
          particles(common, place_at_random(region, radius, wanted, random)));
    } else if (layout == Layout::lattice) {
      const LatticeLayout lattice = read_lattice(node, region, radius);
      const long long wanted = count ? count->integer(1, most) : -1;
      draft.scene.particles.push_back(
          particles(common, place_on_lattice(lattice, radius, wanted, random)));
    } else {
      const LatticeLayout lattice = read_lattice(node, region, radius);
      read_rain(node, common, lattice, radius, random, draft);
    }
  } catch (const DoesNotFit& fault) {
    (count ? *count : node.at("region", "")).refuse(fault.what());
  }
}

}  // namespace scree::reader
