#include "dynamics/dynamics.h"

#include <string>

#include "host/error.h"

namespace scree {
namespace {

[[noreturn]] void refuse(const char* call) {
  throw InputError(std::string("the dynamics of this scene have no ") + call);
}

}  // namespace

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
