#include "dynamics/affine/affine_card.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "host/error.h"
#include "host/scene/bodies_by_id.h"
#include "host/scene/body_name.h"
#include "host/scene/joint_cards.h"
#include "host/scene/motion.h"
#include "host/scene/scene_checks.h"
#include "host/scene/scene_summary.h"
#include "shapes/shape_card.h"

namespace scree {
namespace {

void check_locks(std::uint8_t locks, const std::string& path) {
  const int turns = std::popcount(static_cast<unsigned>(locks >> 3));
  if (turns == 1)
    refuse_value(
        path + ".lock", "one locked axis of rotation",
        "must be none, two or three: turning about two axes is no linear equation of an affine "
        "body");
}

/// The most that a kinematic body turns by in a step that is not made in parts.
void check_turn(const Scene& scene, std::size_t id, const BodyDescription& body) {
  if (body.kind != BodyKind::kinematic || kMaxTurn.of(scene.dynamics.parameters) > 0) return;
  const double h = scene.stepping.time_step;
  const MostTurn most = most_turn(body.motion, h);
  if (!(most.turn > kMostLedTurn)) return;
  const BodyConstants constants(scene);
  refuse_value(
      fmt::format("{}.{}", body_name(constants, static_cast<int>(id)), most.field), most.value,
      fmt::format(
          "must turn {} by {:g} rad at most in a time step of {:g} s, which turns it by "
          "{:.3g} rad: kinematic bodies of the dynamics \"affine\" go straight from pose to "
          "pose in their coordinates, and become flat by half a turn; take a time step of "
          "{:.3g} s at most, or \"max_turn\" of the dynamics, which makes steps in parts",
          body_name(constants, static_cast<int>(id), scene.body_names), kMostLedTurn, h, most.turn,
          0.99 * h * kMostLedTurn / most.turn));
}

constexpr std::array<std::pair<const char*, double Material::*>, 4> kNoValues{
    {{"restitution", &Material::restitution},
     {"cohesion", &Material::cohesion},
     {"rolling_friction", &Material::rolling_friction},
     {"spinning_friction", &Material::spinning_friction}}};

void check_joint(const Scene& scene, std::size_t j) {
  const Joint& joint = scene.joints[j];
  const std::string path = fmt::format("joints[{}]", j);
  const bool slides = joint.kind == JointKind::slider || joint.kind == JointKind::cylindrical;
  const bool is_known = slides || joint.kind == JointKind::ball || joint.kind == JointKind::hinge ||
                        joint.kind == JointKind::fixed;
  if (!is_known)
    refuse_value(
        path + ".type", fmt::format("\"{}\"", joint_card(joint.kind).name),
        "must be ball, hinge, fixed, slider or cylindrical: joints of the dynamics \"affine\" "
        "are linear equations");
  const bool has_resting = std::any_of(joint.bodies.begin(), joint.bodies.end(), [&](int body) {
    return body == kWorldBody ||
           scene.bodies[static_cast<std::size_t>(body)].kind == BodyKind::fixed;
  });
  if (joint.kind == JointKind::ball && (is_about_axis(joint) || has_drive(joint.drive())))
    refuse_value(path + ".type", "\"ball\" with a swing, limits, a motor or friction",
                 "must be without these: what turns in all directions has no angle that is linear "
                 "in affine bodies");
  if (slides && !has_resting)
    refuse_value(
        path + ".type", fmt::format("\"{}\"", joint_card(joint.kind).name),
        "must have the world or a fixed body as one of its bodies: along an axis that moves it "
        "is no linear equation of affine bodies");
  for (const int body : joint.bodies)
    if (body != kWorldBody && scene.bodies[static_cast<std::size_t>(body)].elastic->is_on())
      refuse_value(path + ".bodies", body_name(BodyConstants(scene), body, scene.body_names),
                   "must not be elastic: attachments hold elastic bodies");
  if (std::isfinite(joint.break_force) || std::isfinite(joint.break_moment))
    refuse_value(path, "a joint that breaks", "must hold with the dynamics \"affine\"");
}

}  // namespace

void check_affine(const Scene& scene) {
  require_no_insertions(scene, "all bodies of the dynamics \"affine\" are there from the start");
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (scene.periodicity.periodic[axis])
      refuse_value("periodic", fmt::format("an axis {}", "xyz"[axis]),
                   "must be without axes: the dynamics \"affine\" have no periods");
  require_no_values(scene, kNoValues, "contacts of the dynamics \"affine\" have friction alone");
  for_each_by_id(
      scene,
      [&](std::size_t id, const BodyDescription& body) {
        check_turn(scene, id, body);
        check_locks(body.locks, body.entry >= 0 ? fmt::format("bodies[{}]", body.entry)
                                                : fmt::format("body {}", id));
      },
      [](std::size_t, const ParticleSet& set) {
        check_locks(set.locks,
                    set.entry >= 0 ? fmt::format("particles[{}]", set.entry) : "particles");
      });
  for (std::size_t j = 0; j < scene.joints.size(); ++j) check_joint(scene, j);
}

double affine_bytes_per_body(const Scene& scene, const WorldOptions& options) {
  // States and constants, eight contacts with their elements and entries, forty near pairs, four blocks.
  constexpr double kState = 12 * 96 + 400 + 200, kRow = 3 * 1152 + 6 * 96;
  constexpr double kContacts = 8 * (784 + 200), kNear = 40 * 52, kBlocks = 4 * 2 * 1160;
  // A device adds up lines of pieces of entries, of rows and then of blocks.
  const double pieces = options.backend == BackendKind::cuda ? 5 * 12 * 104 : 0;
  // A tetrahedron has a row, three links on the average, eight pieces and a third of a row of unknowns with its blocks.
  constexpr double kTetrahedron = kState + kRow + 3 * 144 + 8 * 56 + kBlocks;
  double tetrahedra = 0;
  for (const BodyDescription& body : scene.bodies)
    if (body.elastic->is_on())
      tetrahedra += static_cast<double>(mesh_of(scene, body.shape)->tetrahedra.size());
  // Corners, edges, trees and near features of a mesh, which bodies of one shape share: of gears and of bolts.
  constexpr double kTriangle = 450;
  double triangles = 0;
  for (const TriangleMesh& mesh : scene.meshes)
    triangles += static_cast<double>(mesh.triangles.size());
  const auto bodies = static_cast<double>(count_bodies(scene).all());
  return kState + kRow + kContacts + kNear + kBlocks + pieces +
         (bodies > 0 ? (kTetrahedron * tetrahedra + kTriangle * triangles) / bodies : 0);
}

}  // namespace scree
