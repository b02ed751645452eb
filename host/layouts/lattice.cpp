#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "host/layouts/layouts.h"

namespace scree {
namespace {

/// The sites of a layout, in horizontal planes from the bottom up.
class Lattice {
 public:
  /// @param margin  radius of the largest sphere [m]
  Lattice(const LatticeLayout& layout, double margin)
      : region_(layout.region), spacing_(layout.spacing) {
    Vec3d low;
    Vec3d high;
    region_.bounds(low, high);
    const double s = spacing_;
    for (int k = 0; k < 3; ++k) {
      // A region of exactly n spacings holds n cells in spite of rounding.
      cells_[k] = static_cast<long long>(
          std::min(1e12, std::floor((high[k] - low[k]) / s * (1 + 1e-12) + 1e-9)));
      first_[k] = low[k] + s / 2;
      if (k < 2)
        first_[k] +=
            std::fma(-static_cast<double>(cells_[k]), s, high[k] - low[k]) / 2;  // centered
    }
    // In a box whole cells fit; in a cylinder every sphere must, anywhere in its jitter range. How
    // far it reaches from its site is linear in its radius, so the two ends are the worst cases.
    const double shift = std::sqrt(3.0) * layout.jitter;
    reach_ = std::max(margin + shift * (s / 2 - margin), shift * s / 2);
  }

  double cell_count() const {
    return static_cast<double>(cells_[0]) * static_cast<double>(cells_[1]) *
           static_cast<double>(cells_[2]);
  }
  long long planes() const { return cells_[2]; }

  template <class F>
  void for_each_site(long long plane, F f) const {
    const bool box = region_.kind == Region::Kind::box;
    for (long long iy = 0; iy < cells_[1]; ++iy)
      for (long long ix = 0; ix < cells_[0]; ++ix) {
        const Vec3d site{std::fma(spacing_, static_cast<double>(ix), first_.x),
                         std::fma(spacing_, static_cast<double>(iy), first_.y),
                         std::fma(spacing_, static_cast<double>(plane), first_.z)};
        if (box || region_.contains(site, reach_)) f(site);
      }
  }

  /// The sites of the lowest planes, of as many as hold `wanted` sites if there are so many.
  struct Fill {
    long long planes = 0;
    std::size_t sites = 0;
  };
  Fill fill(std::size_t wanted) const {
    Fill fill;
    while (fill.planes < cells_[2]) {
      for_each_site(fill.planes++, [&](const Vec3d&) { ++fill.sites; });
      if (fill.sites >= wanted) break;
    }
    return fill;
  }

 private:
  const Region& region_;
  double spacing_;
  double reach_;  ///< of the largest sphere from its site [m]
  long long cells_[3];
  Vec3d first_;
};

/// Draws a sphere at a site: its radius, then a random shift that keeps it inside its lattice cell,
/// and so away from its neighbors. @return its center
class Placer {
 public:
  Placer(const LatticeLayout& layout, const RadiusLaw& law, std::size_t count,
         RandomNumbers& random)
      : layout_(layout), law_(law), random_(random) {
    if (varied()) radii_.reserve(count);
  }

  Vec3d place(const Vec3d& site) {
    const double radius = law_.draw(random_);
    if (varied()) radii_.push_back(radius);
    const double room = layout_.jitter * (layout_.spacing / 2 - radius);
    // Named, because the order of evaluation of arguments differs between compilers.
    const double x = random_.uniform(-room, room);
    const double y = random_.uniform(-room, room);
    const double z = random_.uniform(-room, room);
    return site + Vec3d{x, y, z};
  }

  PerParticle<double> radii() {
    return varied() ? PerParticle<double>(std::move(radii_)) : PerParticle<double>(law_.low);
  }

 private:
  bool varied() const { return law_.kind != RadiusLaw::Kind::constant; }

  const LatticeLayout& layout_;
  const RadiusLaw& law_;
  RandomNumbers& random_;
  std::vector<double> radii_;
};

}  // namespace

PlacedSpheres place_on_lattice(const LatticeLayout& layout, const RadiusLaw& radius,
                               long long count, RandomNumbers& random) {
  const Lattice lattice(layout, radius.largest());
  if (count < 0 && lattice.cell_count() > std::numeric_limits<Index>::max())
    throw DoesNotFit(
        fmt::format("it holds {:.3g} lattice cells, must be below 2^31", lattice.cell_count()));
  constexpr auto no_limit = static_cast<std::size_t>(-1);
  const Lattice::Fill fill = lattice.fill(count < 0 ? no_limit : static_cast<std::size_t>(count));
  const std::size_t wanted = count < 0 ? fill.sites : static_cast<std::size_t>(count);
  if (fill.sites < wanted)
    throw DoesNotFit(fmt::format("the region holds {} spheres at a spacing of {} m", fill.sites,
                                 layout.spacing));
  Placer placer(layout, radius, wanted, random);
  PlacedSpheres spheres;
  spheres.center.reserve(wanted);
  for (long long plane = 0; plane < fill.planes; ++plane)
    lattice.for_each_site(plane, [&](const Vec3d& site) {
      if (spheres.center.size() < wanted) spheres.center.push_back(placer.place(site));
    });
  spheres.radius = placer.radii();
  return spheres;
}

PlacedSpheres place_rain_batch(const LatticeLayout& layout, const RadiusLaw& radius,
                               long long count, RandomNumbers& random, double& thickness) {
  const auto wanted = static_cast<std::size_t>(count);
  const Lattice lattice(layout, radius.largest());
  const Lattice::Fill fill = lattice.fill(wanted);
  if (fill.sites < wanted)
    throw DoesNotFit(
        fmt::format("the region holds {} spheres of one batch at a spacing of {} m, "
                    "a batch has {}",
                    fill.sites, layout.spacing, wanted));
  thickness = static_cast<double>(fill.planes) * layout.spacing;
  std::vector<Vec3d> sites;
  sites.reserve(fill.sites);
  for (long long plane = 0; plane < fill.planes; ++plane)
    lattice.for_each_site(plane, [&](const Vec3d& site) { sites.push_back(site); });
  Placer placer(layout, radius, wanted, random);
  PlacedSpheres spheres;
  spheres.center.reserve(wanted);
  for (std::size_t i = 0; i < wanted; ++i) {  // the first steps of a shuffle
    const std::size_t pick = i + random.below(sites.size() - i);
    std::swap(sites[i], sites[pick]);
    spheres.center.push_back(placer.place(sites[i]));
  }
  spheres.radius = placer.radii();
  return spheres;
}

}  // namespace scree
