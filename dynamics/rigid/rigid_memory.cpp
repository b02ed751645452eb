#include "dynamics/rigid/rigid_memory.h"

#include <algorithm>

#include "dynamics/memory_room.h"
#include "dynamics/rigid/joint_frames.h"
#include "dynamics/rigid/shared_constants.h"
#include "dynamics/rigid/step_parts.h"
#include "host/scene/run_summary.h"
#include "kernels/step/joint_ends.h"
#include "kernels/step/joint_setup.h"
#include "solvers/coulomb.h"

namespace scree {
namespace {

/// Contacts of a sphere, listed ones that do not touch included: 3.3 in a bed that has settled,
/// less than 3 in one that has not.
constexpr double kContacts = 3.25;
/// Near pairs of a body there, at the default skin and stretched as lists are while a bed settles:
/// of spheres about alike, and of diameters that differ several times.
constexpr double kPairs = 5.5;
constexpr double kPairsOfMixed = 11;
/// Pairs of bodies that are no spheres whose contacts are computed in a step, of a body: 6 to 12 in heaps of boxes, hulls, and
/// boxes with capsules and cylinders while they fall.
constexpr double kComputedPairs = 9;
/// Largest over median diameter from which bodies count as mixed.
constexpr double kMixed = 2;

/// Sizes of what arrays hold, and what decides which arrays there are.
struct Sizes {
  Sizes(const Scene& scene_, const WorldOptions& options)
      : scene(scene_),
        summary(summarize_run(scene_, options)),
        shared(shared_constants(scene_)),
        real(options.precision == Precision::double_precision ? 8 : 4),
        vec(3 * real),
        twist(6 * real),
        impulse(vectors_per_contact(summary.layout) * vec),
        radial(summary.layout == ContactLayout::radial),
        mixed(summary.layout == ContactLayout::mixed),
        uniform(radial && summary.solid_spheres),
        own(real > 4 ? parts_of_step<double>(scene_, summary)
                     : parts_of_step<float>(scene_, summary)),
        card(solver_card(scene_.solver.name)),
        solver_case{.layout = summary.layout,
                    .real = real,
                    .on_device = options.backend == BackendKind::cuda,
                    .uniform = (radial || mixed) && summary.solid_spheres,
                    .parameters = scene_.solver.parameters},
        marks(card.keeps_marks ? 4 : 0),
        pairs(summary.largest_diameter > kMixed * summary.median_diameter ? kPairsOfMixed
                                                                          : kPairs) {}
  const Scene& scene;
  SceneSummary summary;
  SharedConstants shared;
  double real, vec, twist, impulse;
  bool radial;
  bool mixed;
  bool uniform;      ///< free velocities and inverse masses come from the state
  ContactParts own;  ///< what a step stores of contacts, beside what detection leaves
  SolverCard card;
  SolverCase solver_case;
  double marks;  ///< what the solver leaves at a contact
  double pairs;  ///< near pairs of a body
};

/// Position, orientation, rates, id, and the constants that are not shared.
double state_of_body(const Sizes& s) {
  double bytes = 24 + 4 * s.real + 2 * s.vec + 4;
  if (!s.summary.solid_spheres) bytes += s.vec;
  if (!s.shared.mass) bytes += s.real;
  if (!s.shared.radius) bytes += s.real;
  if (!s.shared.spheres) bytes += 4;
  if (!s.shared.group) bytes += 4;
  if (!s.shared.locks) bytes += 1;
  if (!s.shared.material) bytes += 1;
  return bytes;
}

/// Where all bodies are spheres, few contacts of the mixed layout have fields of general ones.
ContactParts without_few(const Sizes& s, ContactParts parts) {
  if (s.mixed && s.summary.radial_bodies) parts.arms = false;
  return parts;
}

/// Contacts as collision detection leaves them.
double contact_set(const Sizes& s) {
  return s.solver_case.bytes_of<FoundFields>(without_few(s, ContactParts(s.summary.layout)));
}

/// What is remembered of a contact of the last step: key, impulse and mark.
double warm_start(const Sizes& s) { return 8 + s.impulse + s.marks; }

/// List of near pairs, of a body.
double near_pair_list(const Sizes& s) { return 24 + 4.25 * s.pairs; }

/// Fields that joints share with contacts.
double fields_of_joint(const Sizes& s) {
  return s.solver_case.bytes_of<ProblemFields>(ContactParts());
}

/// Lists of the contacts of a body, and what the state cannot give.
HeldBytes problem(const Sizes& s) {
  HeldBytes bytes{8, 4};
  if (s.mixed) {
    bytes.body += 8 + s.twist + (s.summary.solid_spheres ? 0 : 2 * s.real) +
                  (s.summary.radial_bodies ? 0 : 16 * s.real);
  } else if (!s.uniform) {
    bytes.body += s.twist + (s.radial ? 2 : 16) * s.real;
  }
  bytes.contact += s.solver_case.bytes_of<ProblemFields>(without_few(s, s.own));
  if (s.summary.layout == ContactLayout::jointed) bytes.contact += fields_of_joint(s);  // a copy
  return bytes;
}

/// What is listed of a joint to be solved on the host: its ends, its impulse and its place. Beside a GPU not all are.
template <class Real>
constexpr std::size_t kListedJoint = sizeof(JointEnds<Real>) + sizeof(JointValues<Real>) +
                                     sizeof(Index);

/// Frames, rows, ids and axis, sort keys, lists and impulses of a joint; those of the solver and of the guess too.
double joint(const Sizes& s) {
  const std::size_t row = s.real > 4 ? sizeof(JointRow<double>) + kListedJoint<double>
                                     : sizeof(JointRow<float>) + kListedJoint<float>;
  return static_cast<double>(sizeof(JointFrames) + sizeof(JointState) + row) + fields_of_joint(s) +
         12 + 16 + 5 * s.impulse;
}

/// Velocities that a solver returns, and its working memory at the fullest.
HeldBytes solver(const Sizes& s) {
  const HeldBytes bytes = s.card.memory(s.solver_case);
  return s.scene.solver.exact_coulomb ? bytes + exact_memory(s.card, s.solver_case) : bytes;
}

/// Of a body of them all: pairs that are no two spheres, with notes of two searches, how they lie, and four contacts.
double computed_pairs(const Sizes& s) {
  const double share = static_cast<double>(s.summary.shaped_count) / s.summary.free_capacity;
  return s.summary.shaped_count == 0 ? 0 : share * kComputedPairs * (80 + 112 + 4 * 8 * s.real);
}

/// A body and its contacts while contacts are searched for: those of the last step are remembered,
/// and what is noted of pairs and margins are there too.
double in_collision(const Sizes& s) {
  return state_of_body(s) + near_pair_list(s) + 8 * s.pairs + 12 + computed_pairs(s) +
         kContacts * (warm_start(s) + contact_set(s) + 8);
}

/// The same when impulses of the last step go to the present contacts.
double in_warm_start(const Sizes& s, bool near_pairs) {
  return state_of_body(s) + (near_pairs ? near_pair_list(s) : 0) +
         kContacts * (warm_start(s) + contact_set(s) + s.impulse + s.marks);
}

/// Contacts of walls and between groups are searched for, beside the memory of the solver.
double force_sums(const Sizes& s) { return s.scene.output.force_interval > 0 ? 12 : 0; }

double in_solver(const Sizes& s, bool near_pairs) {
  const HeldBytes bytes = HeldBytes{state_of_body(s), contact_set(s) + 2 * s.impulse + s.marks} +
                          problem(s) + solver(s);
  return bytes.body + (near_pairs ? near_pair_list(s) : 0) +
         kContacts * (bytes.contact + force_sums(s));
}

double bytes_per_body(const Sizes& s, bool near_pairs) {
  const auto bodies =
      static_cast<double>(s.summary.free_capacity) + static_cast<double>(s.summary.fixed_count);
  const double joints = static_cast<double>(joint_frame_count(s.scene)) / bodies;
  return std::max({in_collision(s), in_warm_start(s, near_pairs), in_solver(s, near_pairs)}) +
         joints * joint(s);
}

}  // namespace

bool keeps_near_pairs(const Scene& scene, const WorldOptions& options) {
  const Sizes s(scene, options);
  if (!(s.summary.skin > 0)) return false;
  const MemoryRoom room(options);
  const double bodies =
      static_cast<double>(s.summary.free_capacity) + static_cast<double>(s.summary.fixed_count);
  return room.share * bodies * bytes_per_body(s, true) <= std::min(0.5 * room.all, room.free);
}

double rigid_bytes_per_body(const Scene& scene, const WorldOptions& options) {
  return bytes_per_body(Sizes(scene, options), keeps_near_pairs(scene, options));
}

double least_rigid_bytes_per_body(const Scene& scene, const WorldOptions& options) {
  return bytes_per_body(Sizes(scene, options), false);
}

}  // namespace scree
