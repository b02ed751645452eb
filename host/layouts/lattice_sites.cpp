#include "host/layouts/lattice_sites.h"

#include <fmt/format.h>

#include <cmath>

namespace scree {
namespace {

/// Most cells along an axis: their numbers and those of the sites of a region stay exact.
constexpr double kMostCells = 1e15;
/// Rows that are searched beside those that are needed.
constexpr long long kSpareRows = 4'000'000;
/// Components of a direction below this are taken as zero where that moves no end by a cell.
constexpr double kParallel = 1e-9;
/// Most sites in the planes of a batch.
constexpr double kMostSites = 4e18;

}  // namespace

LatticeSites::LatticeSites(const LatticeLayout& layout, const SizeLaw& size)
    : region_(layout.region), spacing_(layout.spacing) {
  require_resolution(region_, size.smallest());
  Vec3d low;
  Vec3d high;
  region_.bounds(low, high);
  const double s = spacing_;
  for (int k = 0; k < 3; ++k) {
    // A region of exactly n spacings holds n cells in spite of rounding.
    cells_[k] = static_cast<long long>(
        std::min(kMostCells, std::floor((high[k] - low[k]) / s * (1 + 1e-12) + 1e-9)));
    first_[k] = low[k] + s / 2;
    if (k < 2)
      first_[k] += std::fma(-static_cast<double>(cells_[k]), s, high[k] - low[k]) / 2;  // centered
  }
  // In a box whole cells fit; in a cylinder every sphere must, anywhere in its jitter range. How
  // far it reaches from its site is linear in its radius, so the two ends are the worst cases.
  const double margin = size.largest();
  const double shift = std::sqrt(3.0) * layout.jitter;
  reach_ = std::max(margin + shift * (s / 2 - margin), shift * s / 2);
}

double LatticeSites::cell_count() const {
  return static_cast<double>(cells_[0]) * static_cast<double>(cells_[1]) *
         static_cast<double>(cells_[2]);
}

Vec3d LatticeSites::position(long long plane, long long row, long long x) const {
  return {std::fma(spacing_, static_cast<double>(x), first_.x),
          std::fma(spacing_, static_cast<double>(row), first_.y),
          std::fma(spacing_, static_cast<double>(plane), first_.z)};
}

long long LatticeSites::count_up_to(long long wanted) const {
  if (is_box()) return static_cast<long long>(std::min(cell_count(), static_cast<double>(wanted)));
  long long found = 0;
  for_each_run(wanted, [&](const SiteRun& run) {
    found += run.end - run.begin;
    return found < wanted;
  });
  return std::min(found, wanted);
}

LatticeSites::Range LatticeSites::around(int axis, double low, double high) const {
  const double last = static_cast<double>(cells_[axis]);
  const auto number = [&](double x, double beside) {
    return static_cast<long long>(std::clamp((x - first_[axis]) / spacing_ + beside, 0.0, last));
  };
  return {number(low, -1), number(high, 2)};
}

/// Rows run along x, at a distance of |(y - c_y) a_z - (z - c_z) a_y| / |(a_y, a_z)| from
/// the axis of a cylinder.
LatticeSites::Range LatticeSites::rows_of(long long plane) const {
  const Range all{0, cells_[1]};
  const Vec3d& axis = region_.axis;
  if (is_box() || std::abs(axis.z) < kParallel) return all;
  const double room = std::max(region_.radius - reach_, 0.0) * std::hypot(axis.y, axis.z);
  const double height = position(plane, 0, 0).z - region_.center.z;
  const double middle = region_.center.y + height * axis.y / axis.z;
  const double half = room / std::abs(axis.z);
  return around(1, middle - half, middle + half);
}

/// In a cylinder: the sites between two ends that are known to about one site and then tried.
LatticeSites::Range LatticeSites::sites_of(long long plane, long long row) const {
  Range sites{0, cells_[0]};
  if (is_box()) return sites;
  const Vec3d& a = region_.axis;
  const Vec3d start = position(plane, row, 0) - region_.center;
  const Vec3d origin{0, start.y, start.z};
  double low = -kMostCells * spacing_;
  double high = -low;
  const auto meet = [&](double from, double to) {
    low = std::max(low, from);
    high = std::min(high, to);
  };
  // |along + x a_x| <= half length
  const double along = dot(origin, a);
  const double half = region_.length / 2 - reach_;
  if (std::abs(a.x) > kParallel) {
    const double one = (-half - along) / a.x;
    const double other = (half - along) / a.x;
    meet(std::min(one, other), std::max(one, other));
  } else if (std::abs(along) > half + spacing_) {
    return {};
  }
  // |p + x q| <= radius, with p and q what of the origin and of the x axis is across the axis
  const Vec3d p = origin - along * a;
  const Vec3d q = Vec3d{1, 0, 0} - a.x * a;
  const double square = norm2(q);
  const double room = std::max(region_.radius - reach_, 0.0);
  if (square > kParallel) {
    const double middle = -dot(p, q) / square;
    const double distance2 = norm2(p + middle * q);
    const double width = std::sqrt(std::max(0.0, (room * room - distance2) / square));
    meet(middle - width, middle + width);
  } else if (norm(p) > room + spacing_) {
    return {};
  }
  if (low > high + spacing_) return {};
  sites = around(0, low + region_.center.x, high + region_.center.x);
  const auto lies_inside = [&](long long x) {
    return region_.contains(position(plane, row, x), reach_);
  };
  while (sites.begin < sites.end && !lies_inside(sites.begin)) ++sites.begin;
  while (sites.begin < sites.end && !lies_inside(sites.end - 1)) --sites.end;
  return sites;
}

LatticeSites::RowBudget::RowBudget(const LatticeSites& sites, long long wanted)
    : sites_(sites),
      most_(kSpareRows + 100 * std::min(wanted, 1'000'000'000'000ll)),
      left_(most_) {}

void LatticeSites::RowBudget::refuse() const {
  throw DoesNotFit(
      fmt::format("the region is too large or too thin for a spacing of {} m: so few of its {:.3g} "
                  "lattice cells hold a sphere that {} rows of them were searched in vain",
                  sites_.spacing_, sites_.cell_count(), most_));
}

LowestSites::LowestSites(const LatticeSites& sites, const LatticeLayout& layout, long long wanted)
    : sites_(sites), spacing_(layout.spacing) {
  sites.is_box() ? take_planes_of_box(wanted) : take_runs(wanted);
  if (count_ < wanted)
    throw DoesNotFit(
        fmt::format("the region holds {} spheres of one batch at a spacing of {} m, "
                    "a batch has {}",
                    count_, layout.spacing, wanted));
}

void LowestSites::take_planes_of_box(long long wanted) {
  const long long* cells = sites_.cells();
  const double in_plane = static_cast<double>(cells[0]) * static_cast<double>(cells[1]);
  if (in_plane == 0) return;
  planes_ = cells[2];
  const double needed = std::ceil(static_cast<double>(wanted) / in_plane);
  if (needed < static_cast<double>(cells[2])) planes_ = static_cast<long long>(needed);
  check_sum(static_cast<double>(planes_) * in_plane);
  count_ = planes_ * cells[0] * cells[1];
}

void LowestSites::take_runs(long long wanted) {
  sites_.for_each_run(wanted, [&](const SiteRun& run) {
    if (count_ >= wanted && run.plane >= planes_) return false;
    planes_ = run.plane + 1;
    runs_.push_back(run);
    first_.push_back(count_);
    check_sum(static_cast<double>(count_) + static_cast<double>(run.end - run.begin));
    count_ += run.end - run.begin;
    return true;
  });
}

void LowestSites::check_sum(double sites) const {
  if (sites > kMostSites)
    throw DoesNotFit(fmt::format(
        "one batch would choose among {:.3g} lattice sites at a spacing of {} m; use a smaller "
        "region",
        sites, spacing_));
}

Vec3d LowestSites::position(long long number) const {
  if (runs_.empty()) {
    const long long* cells = sites_.cells();
    const long long row = number / cells[0];
    return sites_.position(row / cells[1], row % cells[1], number % cells[0]);
  }
  const auto behind = std::upper_bound(first_.begin(), first_.end(), number);
  const auto k = static_cast<std::size_t>(behind - first_.begin()) - 1;
  const SiteRun& run = runs_[k];
  return sites_.position(run.plane, run.row, run.begin + (number - first_[k]));
}

}  // namespace scree
