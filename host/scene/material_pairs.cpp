// What two materials in contact are like.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "host/error.h"
#include "host/scene/scene_checks.h"

namespace scree {
namespace {

Material mixed(const Material& a, const Material& b) {
  Material mix;
  mix.name.clear();
  mix.friction = std::sqrt(a.friction * b.friction);
  mix.restitution = std::min(a.restitution, b.restitution);
  mix.cohesion = std::min(a.cohesion, b.cohesion);
  mix.rolling_friction = std::min(a.rolling_friction, b.rolling_friction);
  mix.spinning_friction = std::min(a.spinning_friction, b.spinning_friction);
  return mix;
}

}  // namespace

Material pair_values(const Scene& scene, int material_a, int material_b) {
  for (const MaterialPair& pair : scene.material_pairs)
    if (std::minmax(pair.material_a, pair.material_b) == std::minmax(material_a, material_b))
      return pair.values;
  const Material& a = scene.materials.at(static_cast<std::size_t>(material_a));
  const Material& b = scene.materials.at(static_cast<std::size_t>(material_b));
  Material mix = mixed(a, b);
  mix.name = a.name + " - " + b.name;
  return mix;
}

std::vector<Material> all_pair_values(const Scene& scene) {
  const std::size_t n = scene.materials.size();
  std::vector<Material> table;
  table.reserve(n * n);
  for (const Material& a : scene.materials)
    for (const Material& b : scene.materials) table.push_back(mixed(a, b));
  for (const MaterialPair& pair : scene.material_pairs) {
    const auto a = static_cast<std::size_t>(pair.material_a);
    const auto b = static_cast<std::size_t>(pair.material_b);
    table[a * n + b] = table[b * n + a] = pair.values;
  }
  return table;
}

void require_no_values(const Scene& scene,
                       std::span<const std::pair<const char*, double Material::*>> values,
                       const std::string& why) {
  const std::vector<Material> pairs = all_pair_values(scene);
  const std::size_t n = scene.materials.size();
  for (std::size_t k = 0; k < pairs.size(); ++k)
    for (const auto& [key, value] : values)
      if (pairs[k].*value > 0)
        throw InputError(
            fault_text(fmt::format("materials: pair (\"{}\", \"{}\"): {}",
                                   scene.materials[k / n].name, scene.materials[k % n].name, key),
                       fmt::format("{:g}", pairs[k].*value), "must be 0: " + why));
}

}  // namespace scree
