#pragma once
// With what share of a scene a rank starts.

#include <memory>

#include "dynamics/ranks/decomposition.h"
#include "host/scene.h"
#include "kernels/backend/ranks.h"
#include "kernels/types.h"

namespace scree {

struct RankPlan {
  std::shared_ptr<Ranks> ranks;  ///< null: this process alone
  Decomposition decomposition;
  /// In storage, for free bodies. For more of them, and for ghosts, storage grows.
  Index places = 0;
};

/// The plan of a run of one process.
inline RankPlan plan_for_one(Index free_bodies) { return {nullptr, {}, free_bodies}; }
/// Places for the bodies that this rank has first.
RankPlan plan_for_ranks(std::shared_ptr<Ranks> ranks, const Scene& scene);

}  // namespace scree
