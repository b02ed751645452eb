#pragma once
// A scene as the model of affine bodies takes it: surfaces, masses, equations of locks and joints.

#include <array>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "dynamics/affine/solid_setup.h"
#include "dynamics/affine/surface.h"
#include "host/scene.h"
#include "host/scene/motion.h"
#include "kernels/affine/block_system.h"
#include "kernels/affine/drive.h"
#include "kernels/affine/potential.h"

namespace scree::affine {

/// What messages call a body, by its id.
using BodyNames = std::function<std::string(Index)>;

/// A body whose motion is prescribed.
struct LedBody {
  Index body = 0;
  BodyDescription description;
};

/// Bodies are numbered as they are stored: free ones by id, then fixed and kinematic ones by id, then the tetrahedra of elastic
/// ones. These have no row and no surface of their own. Rows are stiff free bodies, then kinematic ones, then tetrahedra.
struct AffineSetup {
  std::vector<std::shared_ptr<const Surface>> surfaces;  ///< bodies share them
  std::vector<int> surface_of_body;
  std::vector<BodyConstant> bodies;
  std::vector<AffineVec> position, velocity;  ///< by body, at time zero
  std::vector<Index> body_of_row;
  std::vector<Index> id_of_body;
  std::vector<int> collision_group;            ///< -1: none; all fixed bodies have one
  std::vector<std::array<int, 2>> held_pairs;  ///< bodies that joints hold, which do not touch
  std::vector<NodeEquation> equations;
  std::vector<DrivenJoint> drives;
  std::vector<std::size_t> joint_of_drive;  ///< its number in the scene
  std::vector<LedBody> led;
  Index first_led_row = 0;
  std::size_t scene_bodies = 0;  ///< those that are no tetrahedra
  SolidSetup solid;
  double size = 0;             ///< diagonal of the box about all bounded bodies [m]
  double farthest = 0;         ///< largest coordinate of that box [m]
  double free_size = 0;        ///< largest diagonal of the box about a free one, or else that [m]
  double least_free_size = 0;  ///< the least one, or else that [m]
  double mean_mass = 0;        ///< of free bodies [kg]
};

/// @throws InputError naming a body that has no volume or no moment about an axis
AffineSetup affine_setup(const Scene& scene);

/// The coordinates of a rigid pose.
AffineVec pose_coordinates(const Pose& pose);

/// Whether two bodies have contacts with each other.
bool may_touch(const AffineSetup& setup, Index a, Index b);

/// Whether a body is so stiff for a time step [s] that Newton's method makes but short steps around in the valley of states without
/// strain: it may stop turning.
bool is_too_stiff(const BodyConstant& body, double time_step);
std::string stiff_warning(const std::string& body);

/// Of a tolerance that lets steps end early [m/s]. @param gained  what gravity changes a velocity by in a step; 0: there is none
std::string tolerance_warning(double tolerance, double gained, double fitting);

/// Of stiff bodies that gave way, and of kinematic ones that what they press on slowed or stopped.
/// @param stayed  steps in which they stayed  @param slow  these, and those of which they went a part  @param delay  [s]
std::string strain_warning(double strain, std::int64_t step);
std::string blocked_warning(std::int64_t stayed, std::int64_t slow, double delay);

}  // namespace scree::affine
