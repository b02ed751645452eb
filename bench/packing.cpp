#include "bench/packing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "bench/random_values.h"

namespace scree::bench {
namespace {

/// Cells of the lattice; each has a site at its corner and one at its center.
struct Grid {
  Offset x, y, z;
  Offset cells() const { return x * y * z; }
  Offset sites() const { return 2 * cells(); }
  /// Nearest neighbors: corner-center pairs. The outer faces, edges and corners lack theirs.
  double pairs() const { return double(2 * x - 1) * double(2 * y - 1) * double(2 * z - 1); }
  Offset cell(Offset i, Offset j, Offset k) const { return i + x * (j + y * k); }
  /// Contacts per sphere expected when n of all sites are kept: pairs, and corners on the floor.
  double contacts_per_sphere(Offset n) const {
    const double kept = static_cast<double>(n) / static_cast<double>(sites());
    return (kept * pairs() + static_cast<double>(x * y)) / static_cast<double>(sites());
  }
};

/// The grid, about twice as wide as high, on which n spheres come closest to the wanted contacts.
Grid choose_grid(Offset n, double contacts_per_sphere) {
  const double share =
      std::min(contacts_per_sphere / 4, 1.0);  // of eight neighbors, each shared by two
  const double half_width = std::cbrt(static_cast<double>(n) / share / 8);
  Grid best{0, 0, 0};
  double best_error = std::numeric_limits<double>::max();
  const auto low = static_cast<Offset>(half_width * 0.85),
             high = static_cast<Offset>(half_width * 1.15) + 2;
  for (Offset width = std::max<Offset>(2 * low, 1); width <= 2 * high; ++width) {
    for (Offset height = std::max<Offset>(low, 1); height <= high; ++height) {
      const Grid grid{width, width, height};
      if (grid.sites() < n) continue;
      const double error = std::abs(grid.contacts_per_sphere(n) - contacts_per_sphere);
      if (error < best_error) best_error = error, best = grid;
    }
  }
  return best;
}

/// Calls f(i, j, k) for each cell of the grid in Morton order, x fastest.
template <class F>
void visit_cells(const Grid& grid, Offset i, Offset j, Offset k, Offset size, F& f) {
  if (i >= grid.x || j >= grid.y || k >= grid.z) return;
  if (size == 1) return f(i, j, k);
  const Offset half = size / 2;
  for (int child = 0; child < 8; ++child) {
    visit_cells(grid, i + (child & 1 ? half : 0), j + (child & 2 ? half : 0),
                k + (child & 4 ? half : 0), half, f);
  }
}

/// A number in [-1, 1), the same for the same seed, site and axis.
double displacement(std::uint64_t seed, Offset site, int axis) {
  return random_real<double>(
      seed, 4 * static_cast<std::uint64_t>(site) + static_cast<std::uint64_t>(axis));
}

void require(bool ok, const std::string& what) {
  if (!ok) throw std::invalid_argument("bed: " + what);
}

}  // namespace

Bed make_bed(const BedParams& params) {
  require(params.sphere_count > 0,
          "sphere_count must be positive, got " + std::to_string(params.sphere_count));
  require(params.diameter > 0, "diameter must be positive, got " + std::to_string(params.diameter));
  require(
      params.contacts_per_sphere > 0 && params.contacts_per_sphere < 4,
      "contacts_per_sphere must lie in (0, 4), got " + std::to_string(params.contacts_per_sphere));
  require(params.jitter >= 0 && params.jitter <= 0.03,
          "jitter must lie in [0, 0.03], got " + std::to_string(params.jitter));

  const Offset n = params.sphere_count;
  const double diameter = params.diameter;
  const Grid grid = choose_grid(n, params.contacts_per_sphere);
  const double expected = grid.contacts_per_sphere(n) * static_cast<double>(n);
  require(1.05 * expected < std::numeric_limits<Index>::max(),
          "more contacts than a 32-bit index counts");

  Bed bed;
  bed.diameter = diameter;
  bed.position.reserve(static_cast<std::size_t>(n));

  // Sites are kept with the odds that leave exactly n of them (selection sampling).
  const double pitch = 2 / std::sqrt(3.0) * diameter;  // neighbors along the diagonal touch
  std::vector<Index> body_of_site(static_cast<std::size_t>(grid.sites()), -1);
  std::vector<Offset> site_of_body;
  site_of_body.reserve(static_cast<std::size_t>(n));
  Offset sites_left = grid.sites();
  auto place = [&](Offset i, Offset j, Offset k) {
    for (int center = 0; center < 2; ++center, --sites_left) {
      const Offset site = 2 * grid.cell(i, j, k) + center;
      const Offset wanted = n - static_cast<Offset>(site_of_body.size());
      const double chance =
          random_real<double>(~params.seed, static_cast<std::uint64_t>(site)) / 2 + 0.5;
      if (chance * static_cast<double>(sites_left) >= static_cast<double>(wanted)) continue;
      body_of_site[static_cast<std::size_t>(site)] = static_cast<Index>(site_of_body.size());
      site_of_body.push_back(site);
      const double shift = center * pitch / 2, jitter = params.jitter * diameter;
      bed.position.push_back(
          {static_cast<double>(i) * pitch + shift + jitter * displacement(params.seed, site, 0),
           static_cast<double>(j) * pitch + shift + jitter * displacement(params.seed, site, 1),
           static_cast<double>(k) * pitch + shift + jitter * displacement(params.seed, site, 2) +
               diameter / 2});
    }
  };
  Offset size = 1;
  while (size < std::max({grid.x, grid.y, grid.z})) size *= 2;
  visit_cells(grid, 0, 0, 0, size, place);

  // Nearest neighbors only: with the largest jitter allowed their gaps stay below 0.11 diameters
  // and those of the next shell, at 1.155 diameters apart, are not searched.
  const auto capacity = static_cast<std::size_t>(1.02 * expected) + 1000;
  bed.body_a.reserve(capacity);
  bed.body_b.reserve(capacity);
  bed.normal.reserve(capacity);
  bed.gap.reserve(capacity);
  const auto add = [&](Offset a, Index b, const Vec3<double>& normal, double gap) {
    bed.body_a.push_back(static_cast<Index>(a));
    bed.body_b.push_back(b);
    bed.normal.push_back(Vec3<float>(normal));
    bed.gap.push_back(static_cast<float>(gap));
  };
  for (Offset a = 0; a < n; ++a) {
    const Offset site = site_of_body[static_cast<std::size_t>(a)];
    const Offset cell = site / 2, i = cell % grid.x, j = cell / grid.x % grid.y,
                 k = cell / grid.x / grid.y;
    const bool center = site % 2 != 0;
    Index neighbor[8];
    int count = 0;
    for (int corner = 0; corner < 8; ++corner) {
      // A corner's neighbors are the centers of this cell and of those before it; a center's are
      // the corners of this cell and of those after it.
      const Offset sign = center ? 1 : -1;
      const Offset i2 = i + (corner & 1 ? sign : 0), j2 = j + (corner & 2 ? sign : 0),
                   k2 = k + (corner & 4 ? sign : 0);
      if (i2 < 0 || j2 < 0 || k2 < 0 || i2 >= grid.x || j2 >= grid.y || k2 >= grid.z) continue;
      const Index b = body_of_site[static_cast<std::size_t>(2 * grid.cell(i2, j2, k2) + !center)];
      if (b <= a) continue;
      int place = count++;  // insertion keeps the few neighbors sorted
      for (; place > 0 && neighbor[place - 1] > b; --place) neighbor[place] = neighbor[place - 1];
      neighbor[place] = b;
    }
    const Vec3<double> from = bed.position[static_cast<std::size_t>(a)];
    for (int q = 0; q < count; ++q) {
      const Vec3<double> to = bed.position[static_cast<std::size_t>(neighbor[q])] - from;
      const double distance = norm(to);
      add(a, neighbor[q], to * (1 / distance), distance - diameter);
    }
    if (k == 0 && !center) add(a, params.sphere_count, {0, 0, -1}, from.z - diameter / 2);
  }
  return bed;
}

}  // namespace scree::bench
