#include "dynamics/ranks/decomposition.h"

#include <algorithm>
#include <span>

namespace scree {
namespace {

/// Appends the cuts among samples for ranks [first, first + count). @return number of the first cut, or -1 - rank
int bisect(std::span<WorkSample> samples, int first, int count, std::vector<SpaceCut>& cuts) {
  if (count == 1) return -1 - first;
  Vec3<double> lower, upper;
  double total = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const Vec3<double>& x = samples[i].position;
    for (int k = 0; k < 3; ++k) {
      if (i == 0 || x[k] < lower[k]) lower[k] = x[k];
      if (i == 0 || x[k] > upper[k]) upper[k] = x[k];
    }
    total += samples[i].weight;
  }
  SpaceCut cut;
  for (int k = 1; k < 3; ++k)
    if (upper[k] - lower[k] > upper[cut.axis] - lower[cut.axis]) cut.axis = k;
  std::stable_sort(samples.begin(), samples.end(), [&](const WorkSample& a, const WorkSample& b) {
    return a.position[cut.axis] < b.position[cut.axis];
  });
  const int below = count / 2;
  const double wanted = total * below / count;
  std::size_t middle = 0;
  for (double sum = 0; middle < samples.size() && sum + samples[middle].weight / 2 < wanted;)
    sum += samples[middle++].weight;
  if (!samples.empty()) {
    const double above = samples[std::min(middle, samples.size() - 1)].position[cut.axis];
    cut.position = middle == 0 ? above : (samples[middle - 1].position[cut.axis] + above) / 2;
  }
  const auto number = cuts.size();
  cuts.push_back(cut);
  const int low = bisect(samples.first(middle), first, below, cuts);
  const int high = bisect(samples.subspan(middle), first + below, count - below, cuts);
  cuts[number].lower = low;
  cuts[number].upper = high;
  return static_cast<int>(number);
}

}  // namespace

Decomposition Decomposition::of(std::vector<WorkSample> samples, int ranks) {
  Decomposition d;
  bisect(samples, 0, ranks, d.cuts_);
  return d;
}

}  // namespace scree
