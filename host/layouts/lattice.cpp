#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/layouts/layouts.h"

namespace scree {
namespace {

constexpr auto kNoLimit = static_cast<std::size_t>(-1);

/// Random shift that keeps a sphere inside its lattice cell, and so away from its neighbors.
Vec3d jitter_shift(const LatticeLayout& layout, double radius, RandomNumbers& random) {
  const double room = layout.jitter * (layout.spacing / 2 - radius);
  // Named, because the order of evaluation of arguments differs between compilers.
  const double x = random.uniform(-room, room);
  const double y = random.uniform(-room, room);
  const double z = random.uniform(-room, room);
  return {x, y, z};
}

PlacedSphere placed(const LatticeLayout& layout, const Vec3d& site, const RadiusLaw& radius,
                    RandomNumbers& random) {
  const double r = radius.draw(random);
  return {site + jitter_shift(layout, r, random), r};
}

}  // namespace

LatticeSites lattice_sites(const LatticeLayout& layout, double margin, std::size_t limit) {
  Vec3d low;
  Vec3d high;
  layout.region.bounds(low, high);
  const double s = layout.spacing;
  long long cells[3];
  Vec3d first;
  for (int k = 0; k < 3; ++k) {
    // A region of exactly n spacings holds n cells in spite of rounding.
    cells[k] = static_cast<long long>(
        std::min(1e12, std::floor((high[k] - low[k]) / s * (1 + 1e-12) + 1e-9)));
    first[k] = low[k] + s / 2;
    if (k < 2)
      first[k] += std::fma(-static_cast<double>(cells[k]), s, high[k] - low[k]) / 2;  // centered
  }
  const double total =
      static_cast<double>(cells[0]) * static_cast<double>(cells[1]) * static_cast<double>(cells[2]);
  if (limit == kNoLimit && total > std::numeric_limits<Index>::max())
    throw DoesNotFit(fmt::format("it holds {:.3g} lattice cells, must be below 2^31", total));
  // In a box whole cells fit; in a cylinder every sphere must, anywhere in its jitter range. How
  // far it reaches from its site is linear in its radius, so the two ends are the worst cases.
  const bool box = layout.region.kind == Region::Kind::box;
  const double shift = std::sqrt(3.0) * layout.jitter;
  const double reach = std::max(margin + shift * (s / 2 - margin), shift * s / 2);
  LatticeSites result;
  for (long long iz = 0; iz < cells[2]; ++iz) {
    for (long long iy = 0; iy < cells[1]; ++iy)
      for (long long ix = 0; ix < cells[0]; ++ix) {
        const Vec3d site{std::fma(s, static_cast<double>(ix), first.x),
                         std::fma(s, static_cast<double>(iy), first.y),
                         std::fma(s, static_cast<double>(iz), first.z)};
        if (box || layout.region.contains(site, reach)) result.sites.push_back(site);
      }
    result.plane_ends.push_back(result.sites.size());
    if (result.sites.size() >= limit) break;
  }
  return result;
}

std::vector<PlacedSphere> place_on_lattice(const LatticeLayout& layout, const RadiusLaw& radius,
                                           long long count, RandomNumbers& random) {
  const std::size_t limit = count < 0 ? kNoLimit : static_cast<std::size_t>(count);
  const LatticeSites lattice = lattice_sites(layout, radius.largest(), limit);
  if (count >= 0 && lattice.sites.size() < limit)
    throw DoesNotFit(fmt::format("the region holds {} spheres at a spacing of {} m",
                                 lattice.sites.size(), layout.spacing));
  std::vector<PlacedSphere> spheres;
  const std::size_t wanted = count < 0 ? lattice.sites.size() : limit;
  spheres.reserve(wanted);
  for (std::size_t i = 0; i < wanted; ++i)
    spheres.push_back(placed(layout, lattice.sites[i], radius, random));
  return spheres;
}

std::vector<PlacedSphere> place_rain_batch(const LatticeLayout& layout, const RadiusLaw& radius,
                                           long long count, RandomNumbers& random,
                                           double& thickness) {
  const auto wanted = static_cast<std::size_t>(count);
  LatticeSites lattice = lattice_sites(layout, radius.largest(), wanted);
  if (lattice.sites.size() < wanted)
    throw DoesNotFit(
        fmt::format("the region holds {} spheres of one batch at a spacing of {} m, "
                    "a batch has {}",
                    lattice.sites.size(), layout.spacing, wanted));
  thickness = static_cast<double>(lattice.plane_ends.size()) * layout.spacing;
  std::vector<PlacedSphere> spheres;
  spheres.reserve(wanted);
  for (std::size_t i = 0; i < wanted; ++i) {  // the first steps of a shuffle
    const std::size_t pick = i + random.below(lattice.sites.size() - i);
    std::swap(lattice.sites[i], lattice.sites[pick]);
    spheres.push_back(placed(layout, lattice.sites[i], radius, random));
  }
  return spheres;
}

}  // namespace scree
