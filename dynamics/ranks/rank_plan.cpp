#include "dynamics/ranks/rank_plan.h"

#include <algorithm>
#include <utility>

#include "dynamics/ranks/gather.h"

namespace scree {

RankPlan plan_for_ranks(std::shared_ptr<Ranks> ranks, const Scene& scene) {
  RankPlan plan;
  plan.decomposition = Decomposition::of(work_samples(scene), ranks->count());
  const std::int64_t first = count_free_bodies(scene.bodies, scene.particles, [&](const Vec3d& x) {
    return plan.decomposition.owner(x) == ranks->rank();
  });
  plan.places = static_cast<Index>(std::max<std::int64_t>(first, 1));
  plan.ranks = std::move(ranks);
  return plan;
}

}  // namespace scree
