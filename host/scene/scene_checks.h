#pragma once
// Checks shared by validate() and the scene reader, which name the same fault by different paths.

#include <optional>
#include <span>
#include <string>
#include <utility>

#include "host/scene.h"
#include "shapes/shape_card.h"

namespace scree {

/// "<path>: <value> is not allowed: <expected>", the one format of messages about a value.
std::string fault_text(const std::string& path, const std::string& value,
                       const std::string& expected);
/// @throws InputError  with that text
[[noreturn]] void refuse_value(const std::string& path, const std::string& value,
                               const std::string& expected);
/// A value as messages show it.
std::string value_text(double value);
std::string value_text(const Vec3d& value);

/// What joints call the world: no body has this name.
inline constexpr const char* kWorldName = "world";

/// First fault of one body: shape, pose, velocity, mass, indices and motion. The scene gives the
/// lists that its indices point into.
std::optional<Fault> body_fault(const Scene& scene, const BodyDescription& body);

/// What keeps a quaternion from being a turn.
std::optional<Fault> turn_fault(const std::string& field, const Quatd& q);
/// First fault of the motion of a body.
std::optional<Fault> motion_fault(const BodyDescription& body, double time_step);

/// First fault of one joint.
std::optional<Fault> joint_fault(const Scene& scene, const Joint& joint);

/// What of a scene with joints does not go with them; nothing where there are none.
std::optional<Fault> joints_fault(const Scene& scene);

/// First fault of what makes a body elastic; nothing for one that is not.
std::optional<Fault> elasticity_fault(const Scene& scene, const BodyDescription& body);

/// First fault of one attachment; of all of them, and of elastic bodies with one mesh. The field is the whole path.
std::optional<Fault> attachment_fault(const Scene& scene, const Attachment& attachment);
std::optional<Fault> attachments_fault(const Scene& scene);

/// Size, colors and camera of a picture. @throws InputError
void check_picture(const PictureSettings& picture);
/// Indices and numbers of all meshes. @throws InputError
void check_meshes(const Scene& scene);
/// Meshes of hulls must be convex, and in the principal frame where a body is free, as must those of free bodies that are
/// their surface; those of compounds have parts. @throws InputError
void check_hulls(const Scene& scene);

/// What of a wall does not fit the scene's periodic domain.
std::optional<Fault> periodic_wall_fault(const Scene& scene, const BodyDescription& body);

/// Refuses bodies that join later, naming the first entry of the scene file that has one. @throws InputError
/// @param why  behind what is expected
void require_no_insertions(const Scene& scene, const std::string& why);

/// Refuses values of pairs of materials that a model of dynamics does not have, which must be 0. @throws InputError
/// @param why  behind "must be 0: "
void require_no_values(const Scene& scene,
                       std::span<const std::pair<const char*, double Material::*>> values,
                       const std::string& why);

/// Whether free bodies may have a mesh as shape in the scene's dynamics.
bool meshes_may_be_free(const Scene& scene);

/// The mesh that a shape names; null: it has none.
const TriangleMesh* mesh_of(const Scene& scene, const Shape& shape);

/// The first room that partly overlaps another. The field is the whole path.
std::optional<Fault> room_fault(const Scene& scene);

/// More bodies and walls than contacts have names for.
std::optional<Fault> contact_elements_fault(const Scene& scene);

/// First value of a body that runs cannot compute with: single precision ends at 3e38, and values
/// are multiplied and squared on the way. Part of body_fault().
std::optional<Fault> range_fault(const Scene& scene, const BodyDescription& body);

/// The same for all else in a scene: settings, materials and meshes. The field is the whole path.
std::optional<Fault> range_fault(const Scene& scene);

}  // namespace scree
