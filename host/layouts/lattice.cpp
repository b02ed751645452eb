#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <utility>
#include <vector>

#include "host/layouts/drawn_sizes.h"
#include "host/layouts/lattice_sites.h"

namespace scree {
namespace {

/// Draws a sphere at a site: its radius, then a random shift that keeps it inside its lattice cell,
/// and so away from its neighbors. @return its center
class Placer {
 public:
  Placer(const LatticeLayout& layout, const SizeLaw& law, std::size_t count, RandomNumbers& random)
      : layout_(layout), sizes_(law, count), random_(random) {}

  Vec3d place(const Vec3d& site) {
    const double radius = sizes_.draw(random_);
    const double room = layout_.jitter * (layout_.spacing / 2 - radius);
    // Named, because the order of evaluation of arguments differs between compilers.
    const double x = random_.uniform(-room, room);
    const double y = random_.uniform(-room, room);
    const double z = random_.uniform(-room, room);
    return site + Vec3d{x, y, z};
  }

  void move_sizes_to(PlacedSpheres& spheres) { sizes_.move_to(spheres); }

 private:
  const LatticeLayout& layout_;
  DrawnSizes sizes_;
  RandomNumbers& random_;
};

/// The numbers 0 to count - 1 in random order, as a shuffle in place would bring them forth. Those
/// far behind the ones that are drawn are not stored.
class Shuffle {
 public:
  explicit Shuffle(long long count) : count_(count) {}

  /// The i-th number; i counts up.
  long long draw(long long i, RandomNumbers& random) {
    const long long left = count_ - i;
    const long long beyond = static_cast<long long>(random.below(static_cast<std::uint64_t>(left)));
    const long long pick = i + std::min(beyond, left - 1);
    const long long drawn = at(pick);
    if (pick != i) moved_[pick] = at(i);
    moved_.erase(i);  // not asked for again
    return drawn;
  }

 private:
  long long at(long long place) const {
    const auto found = moved_.find(place);
    return found == moved_.end() ? place : found->second;
  }

  long long count_;
  std::unordered_map<long long, long long> moved_;  ///< places that do not hold their own number
};

}  // namespace

PlacedSpheres place_on_lattice(const LatticeLayout& layout, const SizeLaw& size, long long count,
                               RandomNumbers& random) {
  const LatticeSites sites(layout, size);
  const bool all = count < 0;
  if (all && sites.cell_count() > std::numeric_limits<Index>::max())
    throw DoesNotFit(
        fmt::format("it holds {:.3g} lattice cells, must be below 2^31", sites.cell_count()));
  const long long most = all ? std::numeric_limits<Index>::max() : count;
  const long long fit = sites.count_up_to(most);
  if (!all && fit < count)
    throw DoesNotFit(
        fmt::format("the region holds {} spheres at a spacing of {} m", fit, layout.spacing));
  require_host_memory(fit, size);
  Placer placer(layout, size, static_cast<std::size_t>(fit), random);
  PlacedSpheres spheres;
  spheres.center.reserve(static_cast<std::size_t>(fit));
  long long left = fit;
  sites.for_each_run(most, [&](const SiteRun& run) {
    for (long long x = run.begin; x < run.end && left > 0; ++x, --left)
      spheres.center.push_back(placer.place(sites.position(run.plane, run.row, x)));
    return left > 0;
  });
  placer.move_sizes_to(spheres);
  return spheres;
}

PlacedSpheres place_rain_batch(const LatticeLayout& layout, const SizeLaw& size, long long count,
                               RandomNumbers& random, double& thickness) {
  const LatticeSites all_sites(layout, size);
  const LowestSites sites(all_sites, layout, count);
  require_host_memory(count, size);
  thickness = static_cast<double>(sites.planes()) * layout.spacing;
  const auto wanted = static_cast<std::size_t>(count);
  Placer placer(layout, size, wanted, random);
  PlacedSpheres spheres;
  spheres.center.reserve(wanted);
  Shuffle shuffle(sites.count());
  for (long long i = 0; i < count; ++i)
    spheres.center.push_back(placer.place(sites.position(shuffle.draw(i, random))));
  placer.move_sizes_to(spheres);
  return spheres;
}

}  // namespace scree
