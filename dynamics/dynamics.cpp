#include "dynamics/dynamics.h"

#include <numeric>
#include <string>
#include <utility>

#include "host/error.h"

namespace scree {
namespace {

[[noreturn]] void refuse(const char* call) {
  throw InputError(std::string("the dynamics of this scene have no ") + call);
}

}  // namespace

void Dynamics::begin_own_bodies(OwnBodiesSink& sink, std::optional<double> resumed_time) {
  sink.begin(constants(), resumed_time);
}
std::vector<std::int64_t> Dynamics::give_own_bodies(OwnBodiesSink& sink) {
  OwnBodies all;
  all.states = states();
  all.id.resize(all.states.position.size());
  std::iota(all.id.begin(), all.id.end(), 0);
  sink.take(time(), all, constants());
  return {std::ssize(all.id)};
}
ForceRecord Dynamics::force_on_body(int /*body*/) { refuse("force_on()"); }
ForceRecord Dynamics::force_on_group(int /*group*/) { refuse("force_on_group()"); }
void Dynamics::set_gravity(const Vec3d& /*gravity*/) { refuse("set_gravity()"); }
void Dynamics::set_velocity(int /*body*/, const Vec3d& /*velocity*/,
                            const Vec3d& /*angular_velocity*/) {
  refuse("set_velocity()");
}
void Dynamics::set_motion(int /*body*/, const Motion& /*motion*/) { refuse("set_motion()"); }
void Dynamics::apply_force(int /*body*/, const Vec3d& /*force*/, const Vec3d& /*torque*/) {
  refuse("apply_force()");
}
void Dynamics::change_bodies(const std::vector<int>& /*removed*/) { refuse("add() and remove()"); }

}  // namespace scree
