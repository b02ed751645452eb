#include "dynamics/dynamics.h"

#include <string>
#include <type_traits>
#include <utility>
#include <vector>

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
  BodyStates all = states();
  OwnBodies own;
  for (int id = 0; id < static_cast<int>(all.position.size()); ++id)
    if (has_body(id)) own.id.push_back(id);
  const auto take_rows = [&](auto& rows) {
    std::remove_reference_t<decltype(rows)> taken;
    taken.reserve(own.id.size());
    for (const std::int32_t id : own.id) taken.push_back(rows[static_cast<std::size_t>(id)]);
    rows = std::move(taken);
  };
  if (own.id.size() < all.position.size()) {
    take_rows(all.position), take_rows(all.orientation);
    take_rows(all.velocity), take_rows(all.angular_velocity);
    for (std::vector<double>& quantity : all.own) take_rows(quantity);
    if (!all.axes.empty()) take_rows(all.axes);
  }
  own.states = std::move(all);
  sink.take(time(), own, constants());
  return {std::ssize(own.id)};
}
void Dynamics::track_forces() { refuse("track_forces()"); }
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
