#include "dynamics/rigid/joint_reach.h"

#include "host/disjoint_sets.h"
#include "host/scene/scene_summary.h"

namespace scree {

std::vector<double> joint_reaches(const Scene& scene, const std::vector<JointFrames>& frames) {
  if (frames.empty()) return {};
  const auto is_free = [&](Index id) {
    return id != kWorldId && scene.bodies[static_cast<std::size_t>(id)].kind == BodyKind::free;
  };
  DisjointSets sets(scene.bodies.size());
  std::vector<char> is_joined(scene.bodies.size());
  for (const JointFrames& joint : frames) {
    for (const Index id : joint.body)
      if (is_free(id)) is_joined[static_cast<std::size_t>(id)] = 1;
    if (is_free(joint.body[0]) && is_free(joint.body[1]))
      sets.join(static_cast<std::size_t>(joint.body[0]), static_cast<std::size_t>(joint.body[1]));
  }
  std::vector<double> sum(scene.bodies.size());
  for (std::size_t id = 0; id < sum.size(); ++id)
    if (is_joined[id] != 0) sum[sets.root(id)] += 2 * bounding_radius(scene, scene.bodies[id]);
  std::vector<double> out;
  out.reserve(frames.size());
  for (const JointFrames& joint : frames) {
    const Index id = is_free(joint.body[0]) ? joint.body[0] : joint.body[1];
    out.push_back(is_free(id) ? sum[sets.root(static_cast<std::size_t>(id))] : 0);
  }
  return out;
}

}  // namespace scree
