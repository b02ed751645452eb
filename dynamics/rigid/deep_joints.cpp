#include "dynamics/rigid/deep_joints.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/disjoint_sets.h"

namespace scree {
namespace {

// Times [s]. Iterations as measured on an H200 for a net of 32 x 32 knots. One core of its host takes 2.6 us a link of a chain of
// 1,000 where steps are solved once, and they may be four times. That of loops is an estimate, by the multiplications that nested
// dissection takes of a plane net.
constexpr double kIterating = 6e-5;  // for each joint that an impulse has to cross
constexpr double kCrossing = 5e-4;   // to the host and back, in all solves of a step
constexpr double kSolving = 1e-5;    // for each joint
constexpr double kFilling = 2e-6;    // for each loop, times the root of their number

/// Bodies that joints connect, without those that do not move.
class JointGraph {
 public:
  JointGraph(const Scene& scene, const std::vector<JointFrames>& frames)
      : next_(scene.bodies.size()), distance_(scene.bodies.size(), -1), sets_(scene.bodies.size()) {
    const auto is_free = [&](Index id) {
      return id != kWorldId && scene.bodies[static_cast<std::size_t>(id)].kind == BodyKind::free;
    };
    for (const JointFrames& joint : frames) {
      const Index a = joint.body[0], b = joint.body[1];
      const bool both = is_free(a) && is_free(b);
      if (both) {
        const auto x = static_cast<std::size_t>(a), y = static_cast<std::size_t>(b);
        next_[x].push_back(b);
        next_[y].push_back(a);
        sets_.join(x, y);
      }
      body_.push_back(is_free(a) ? a : (is_free(b) ? b : kWorldId));
    }
  }

  /// Lowest body of the island of a joint; kWorldId: none moves.
  Index island(std::size_t joint) {
    const Index id = body_[joint];
    return id == kWorldId ? id : static_cast<Index>(sets_.root(static_cast<std::size_t>(id)));
  }

  struct Size {
    int depth =
        0;  ///< joints between the two bodies that are farthest from each other, or a little less
    int bodies = 0;
  };
  Size size(Index island) {
    const std::vector<Index> bodies = by_distance(island);
    const std::vector<Index> from_end = by_distance(bodies.back());
    return {distance_[static_cast<std::size_t>(from_end.back())], static_cast<int>(bodies.size())};
  }

 private:
  /// Bodies of an island, from one on.
  std::vector<Index> by_distance(Index from) {
    for (const Index id : seen_) distance_[static_cast<std::size_t>(id)] = -1;
    seen_.assign(1, from);
    distance_[static_cast<std::size_t>(from)] = 0;
    for (std::size_t at = 0; at < seen_.size(); ++at) {
      const auto id = static_cast<std::size_t>(seen_[at]);
      for (const Index other : next_[id]) {
        int& way = distance_[static_cast<std::size_t>(other)];
        if (way >= 0) continue;
        way = distance_[id] + 1;
        seen_.push_back(other);
      }
    }
    return seen_;
  }

  std::vector<std::vector<Index>> next_;
  std::vector<Index> body_;  ///< of each joint one that moves
  std::vector<int> distance_;
  std::vector<Index> seen_;
  DisjointSets sets_;
};

struct Island {
  int depth = 0;
  double time = 0;  ///< of a direct solve [s]
  std::vector<Index> joints;
};

}  // namespace

std::vector<Index> deep_joints(const Scene& scene, const std::vector<JointFrames>& frames) {
  if (frames.empty()) return {};
  JointGraph graph(scene, frames);
  std::vector<Index> place(scene.bodies.size(), -1);
  std::vector<Island> islands;
  std::vector<Index> first;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    const Index island = graph.island(k);
    if (island == kWorldId) continue;
    Index& at = place[static_cast<std::size_t>(island)];
    if (at < 0) {
      at = static_cast<Index>(islands.size());
      islands.emplace_back();
      first.push_back(island);
    }
    islands[static_cast<std::size_t>(at)].joints.push_back(static_cast<Index>(k));
  }
  for (std::size_t k = 0; k < islands.size(); ++k) {
    Island& island = islands[k];
    const JointGraph::Size size = graph.size(first[k]);
    const auto joints = static_cast<double>(island.joints.size());
    const double loops = std::max(0.0, joints - size.bodies);
    island.depth = size.depth;
    island.time = kSolving * joints + kFilling * loops * std::sqrt(loops);
  }
  std::stable_sort(islands.begin(), islands.end(),
                   [](const Island& a, const Island& b) { return a.depth > b.depth; });

  // Those of a problem iterate together, so that the deepest one counts; direct solves add up.
  std::size_t best = 0;
  double best_time = std::numeric_limits<double>::infinity(), direct = 0;
  for (std::size_t count = 0; count <= islands.size(); ++count) {
    const double iterating = count < islands.size() ? kIterating * islands[count].depth : 0;
    const double time = (count > 0 ? kCrossing : 0) + direct + iterating;
    if (time < best_time) best = count, best_time = time;
    if (count < islands.size()) direct += islands[count].time;
  }
  std::vector<Index> out;
  for (std::size_t k = 0; k < best; ++k)
    out.insert(out.end(), islands[k].joints.begin(), islands[k].joints.end());
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace scree
