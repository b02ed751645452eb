#pragma once
// The potential that a step makes least, as element programs: its value, the first contact on a way, and how far a way goes.
//   1/2 |q - target|_M^2 + scale (elastic + barrier + friction + drives of joints)
// docs/theory.md, "Affine bodies" and "Barrier contact".

#include "kernels/affine/bent_way.h"
#include "kernels/affine/contact_modes.h"
#include "kernels/affine/drive.h"
#include "kernels/affine/first_contact.h"
#include "kernels/affine/friction.h"
#include "kernels/affine/listed_ways.h"
#include "kernels/affine/near_pair.h"
#include "kernels/affine/neo_hookean.h"
#include "kernels/affine/row_space.h"
#include "kernels/backend/backend.h"

namespace scree::affine {

/// What does not change of a body.
struct BodyConstant {
  AffineMass mass;       ///< of a led body what holds it to its way
  Mobility mobility;     ///< inverse of the mass; zeros of a fixed body
  double stiffness = 0;  ///< kappa times the volume [J]
  Lame lame;             ///< of a tetrahedron of an elastic body, in place of the stiffness
  Vec3d force, torque;   ///< world axes [N], [N m]
  double radius = 0;     ///< distance of the farthest corner from the center of mass [m]
  Index row = -1;        ///< of the linear system; -1: the body is fixed
  Index material = 0;
  bool is_led = false;  ///< its target is prescribed
  /// Whether its Newton steps may be bent: those of led bodies, of parts of elastic ones and of bodies that equations hold to each other
  /// are straight.
  bool may_bend = false;
};

/// A pair that rubs, as it was when friction was last worked out.
struct Slip {
  Index body[2] = {};
  Index vertex[4] = {};
  PairKind kind = PairKind::point_triangle;
  FrictionContact contact;
};

struct Potential {
  Span<const BodyConstant> bodies;
  Span<const Index> body_of_row;
  Span<const AffineVec> start;   ///< by body, where the step began
  Span<const AffineVec> target;  ///< by row
  NearPairsView near;
  Span<const Slip> slips;
  Span<const DriveTerm> drives;
  Span<const double> friction;  ///< of two materials, at a * material_count + b
  Index material_count = 1;
  Barrier barrier;
  SlipLaw law;
  double scale = 0;  ///< [s^2]
  double lead = 1;   ///< factor of the mass of led bodies

  SCREE_HD Index rows() const { return static_cast<Index>(body_of_row.size); }
  SCREE_HD ContactPair contact_pair(PairKind kind, const Four& rest) const {
    ContactPair c;
    c.kind = kind;
    if (kind == PairKind::edge_edge)
      c.parallel_below = mollifier_threshold(rest[1] - rest[0], rest[3] - rest[2]);
    return c;
  }
  SCREE_HD double inertia_factor(const BodyConstant& body) const { return body.is_led ? lead : 1; }
  SCREE_HD Mobility mobility(Index body) const {
    return (1 / inertia_factor(bodies[body])) * bodies[body].mobility;
  }
  SCREE_HD Four rest_of(const Slip& slip) const {
    Four rest;
    for (int i = 0; i < 4; ++i) rest[i] = near.corners[slip.vertex[i]];
    return rest;
  }
  /// How the points of a slip moved since the step began [m].
  SCREE_HD Four moved(const Slip& slip, const Four& rest, Span<const AffineVec> q) const {
    const AffineVec first = q[slip.body[0]] - start[slip.body[0]];
    const AffineVec second = q[slip.body[1]] - start[slip.body[1]];
    Four m;
    for (int i = 0; i < 4; ++i)
      m[i] = point_of(i < first_points(slip.kind) ? first : second, rest[i]);
    return m;
  }
  /// Terms of the potential: rows, near pairs, slips, driven joints.
  SCREE_HD Index terms() const {
    return rows() + static_cast<Index>(near.pairs.size + slips.size + drives.size);
  }
};

/// Sums of the potential and of what rounding may make of it: A^T A - I is what is left of numbers near one, and gaps are what is
/// left of coordinates.
struct EnergySum {
  double energy = 0;
  double rounding = 0;
  double squared = 1e300;  ///< least squared distance of near pairs [m^2]
  Index contacts = 0;      ///< pairs that the barrier acts on
  Index elements = 0;      ///< that these have in the linear system
  SCREE_HD void combine(const EnergySum& o) {
    energy += o.energy;
    rounding += o.rounding;
    contacts += o.contacts;
    elements += o.elements;
    squared = o.squared < squared ? o.squared : squared;
  }
};

/// Largest coordinate of some points [m].
SCREE_HD inline double size_of(const Four& x) {
  double size = 0;
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 3; ++k) {
      const double far = std::abs(x[i][k]);
      size = far > size ? far : size;
    }
  }
  return size;
}

/// What the other passes of an iteration need of near pairs where bodies are, an entry each.
struct PairStates {
  Span<double> squared;  ///< distances [m^2]
  Span<Index> elements;  ///< of the linear system: 0 where the barrier does not act
};

/// Value of a term. Bytes: 200 of a row; 32 of a pair, and its bodies and corners, 500, mostly from the caches.
struct EnergyOfTerm {
  static constexpr const char* name = "affine_energy";
  static constexpr int kBlockThreads = kWaitingThreads;
  Potential p;
  Span<const AffineVec> q;
  PairStates states;  ///< out

  SCREE_HD EnergySum operator()(Index i) const {
    EnergySum e;
    if (i < p.rows()) {
      const Index b = p.body_of_row[i];
      const BodyConstant& body = p.bodies[b];
      const AffineVec off = q[b] - p.target[i];
      e.energy = 0.5 * p.inertia_factor(body) * dot(off, body.mass.product(off));
      if (body.lame.is_elastic()) {
        e.energy += p.scale * neo_hookean_energy(body.lame, q[b]);
        e.rounding = 1e-15 * p.scale * body.lame.shear;
        return e;
      }
      const double strain = strain_norm(q[b]);
      e.energy += p.scale * body.stiffness * strain * strain;
      e.rounding = 1e-14 * p.scale * body.stiffness * (strain + 1e-14);
      return e;
    }
    i -= p.rows();
    if (i < p.near.pairs.size) {
      const NearPair& pair = p.near.pairs[i];
      const Four rest = p.near.rest_of(pair), x = points_of(p.near, pair, rest, q);
      e.squared = squared_distance(pair.kind, x);
      states.squared[i] = e.squared;
      states.elements[i] = 0;
      if (!p.barrier.acts(e.squared)) return e;
      const ContactPair contact = p.contact_pair(pair.kind, rest);
      const Mollifier m = mollifier(contact, x);
      e.energy = p.scale * contact_energy(contact, p.barrier, e.squared, m);
      e.rounding =
          p.scale * contact_rounding(contact, p.barrier, e.squared, m, size_of(rest) + size_of(x));
      e.contacts = 1;
      e.elements = mode_parts(m);
      states.elements[i] = e.elements;
      return e;
    }
    i -= static_cast<Index>(p.near.pairs.size);
    if (i < p.slips.size) {
      const Slip& slip = p.slips[i];
      e.energy = p.scale * friction_energy(slip.contact, p.law, p.moved(slip, p.rest_of(slip), q));
      return e;
    }
    const DriveTerm& drive = p.drives[i - static_cast<Index>(p.slips.size)];
    const double way = drive.way(p.start, q);
    e.energy = p.scale * drive.energy(way);
    e.rounding = p.scale * drive.rounding(q, way);
    return e;
  }
};

/// Least of many shares of a way.
struct LeastShare {
  double value = 1;
  SCREE_HD void combine(const LeastShare& o) { value = o.value < value ? o.value : value; }
};

/// Share of the way that a near pair leaves free.
struct FreeShare {
  static constexpr const char* name = "affine_free_share";
  static constexpr int kBlockThreads = kWaitingThreads;
  NearPairsView near;
  Span<const AffineVec> from, to;  ///< by body
  Span<const double> squared;      ///< distances at `from` [m^2]
  double separation = 0;

  SCREE_HD LeastShare operator()(Index i) const {
    const NearPair& pair = near.pairs[i];
    const Four rest = near.rest_of(pair);
    const Four start = points_of(near, pair, rest, from), end = points_of(near, pair, rest, to);
    FirstContactParameters parameters;
    parameters.separation = separation;
    if (stays_apart(pair.kind, start, end, squared[i], separation)) return {};
    return {first_contact(pair.kind, start, end, parameters).time};
  }
};

/// Keeps a share for what comes after it on the backend, and for the host.
struct KeepShare {
  LeastShare* here;
  LeastShare* for_host;
  SCREE_HD void operator()(const LeastShare& total) const { *here = *for_host = total; }
};

/// First pair of a list that is no farther apart than a distance.
struct FirstTouch {
  Index pair = -1;
  SCREE_HD void combine(const FirstTouch& o) { pair = pair < 0 ? o.pair : pair; }
};
struct TouchOfPair {
  static constexpr const char* name = "affine_touch";
  NearPairsView near;
  Span<const AffineVec> q;
  double squared = 0;  ///< of the distance [m^2]

  SCREE_HD FirstTouch operator()(Index i) const {
    const NearPair& pair = near.pairs[i];
    const Four x = points_of(near, pair, near.rest_of(pair), q);
    return {squared_distance(pair.kind, x) <= squared ? i : Index(-1)};
  }
};

/// How far a contact slipped over what counts as sliding; 0 where what it rubs with moves no body far.
struct SpeedOfSlip {
  static constexpr const char* name = "affine_speed_of_slip";
  Potential p;
  Span<const AffineVec> q;
  double least = 0;  ///< way that counts [m]

  SCREE_HD Largest<double> operator()(Index i) const {
    const Slip& slip = p.slips[i];
    const double first = mass(slip.body[0]), second = mass(slip.body[1]);
    if (!(p.scale * slip.contact.bound > least * (first < second ? first : second))) return {};
    double u[2];
    slip_of(slip.contact, p.moved(slip, p.rest_of(slip), q), u);
    return {std::sqrt(u[0] * u[0] + u[1] * u[1]) / p.law.slip};
  }

 private:
  SCREE_HD double mass(Index body) const {
    return p.bodies[body].row < 0 ? 1e300 : p.bodies[body].mass.mass;
  }
};

/// Marks pairs of bodies of which features are within reach.
struct MarkBodies {
  static constexpr const char* name = "affine_mark_bodies";
  static constexpr int kBlockThreads = kWaitingThreads;
  Barrier barrier;
  NearPairsView near;
  Span<const AffineVec> q;
  Span<Index> mark;  ///< out, by pair of bodies; all that write to one write the same

  SCREE_HD void operator()(Index i) const {
    const NearPair& pair = near.pairs[i];
    if (barrier.acts(squared_distance(pair.kind, points_of(near, pair, near.rest_of(pair), q))))
      mark[pair.bodies] = 1;
  }
};

/// Of a Newton step: its largest way of a corner, its slope, how far its end is from where the ways that the list of near pairs
/// was made for are at one time for all bodies, and by how much it changes what may stick or slide.
struct StepSums {
  double size = 0;   ///< [m]
  double bend = 0;   ///< largest bend_of() [m]
  double stick = 0;  ///< largest change of a slip that may stick or slide, over that limit
  double slope = 0;  ///< gradient times step
  Strays strays;     ///< of its end
  SCREE_HD void combine(const StepSums& o) {
    size = o.size > size ? o.size : size;
    bend = o.bend > bend ? o.bend : bend;
    slope += o.slope;
    strays.combine(o.strays);
    stick = o.stick > stick ? o.stick : stick;
  }
};
/// Also writes the ends of the ways. Items: rows, then slips, then driven joints. Bytes: 600 a row; 240 a slip and 500 of its bodies, mostly from the caches.
struct MeasureStep {
  static constexpr const char* name = "affine_measure_step";
  Potential p;
  Span<const AffineVec> q;            ///< by body
  Span<const AffineVec> step, right;  ///< by row
  ListedWays ways;
  Span<AffineVec> end;  ///< out, by body; fixed ones are not written

  static SCREE_HD Index items(const Potential& p) {
    return p.rows() + static_cast<Index>(p.slips.size + p.drives.size);
  }

  SCREE_HD StepSums operator()(Index i) const {
    if (i < p.rows()) return of_row(i);
    i -= p.rows();
    StepSums s;
    s.stick = i < p.slips.size ? stick(p.slips[i])
                               : stick(p.drives[i - static_cast<Index>(p.slips.size)]);
    return s;
  }

 private:
  /// The Newton step of a body; zero where it rests.
  SCREE_HD AffineVec step_of(Index body) const {
    const Index row = p.bodies[body].row;
    return row >= 0 ? step[row] : AffineVec{};
  }
  SCREE_HD double stick(const Slip& slip) const {
    const Four rest = p.rest_of(slip);
    const AffineVec first = step_of(slip.body[0]), second = step_of(slip.body[1]);
    Four change;
    for (int k = 0; k < 4; ++k)
      change[k] = point_of(k < first_points(slip.kind) ? first : second, rest[k]);
    double u[2], d[2];
    slip_of(slip.contact, p.moved(slip, rest, q), u);
    slip_of(slip.contact, change, d);
    const double before = u[0] * u[0] + u[1] * u[1];
    const double after = (u[0] + d[0]) * (u[0] + d[0]) + (u[1] + d[1]) * (u[1] + d[1]);
    return p.law.undecided(std::sqrt(before), std::sqrt(after),
                           std::sqrt(d[0] * d[0] + d[1] * d[1]));
  }
  SCREE_HD double stick(const DriveTerm& drive) const {
    const double way = drive.way(p.start, q);
    double change = 0;
    for (int side = 0; side < 2; ++side)
      change += dot(drive.slope[side], step_of(drive.body[side]));
    const double motor = drive.motor.undecided(way, change);
    const double friction = drive.friction.undecided(way, change);
    return motor > friction ? motor : friction;
  }

  SCREE_HD StepSums of_row(Index row) const {
    const Index b = p.body_of_row[row];
    const double radius = p.bodies[b].radius;
    StepSums s;
    s.size = corner_way(step[row], radius);
    s.bend = p.bodies[b].may_bend ? bend_of(step[row], radius) : 0;
    s.slope = -dot(right[row], step[row]);
    end[b] = q[b] + step[row];
    s.strays = ways.strays(b, radius, end[b]);
    // A step that is not a number must be seen, whatever maxima make of it.
    if (!(s.size < 1e300)) s.size = s.strays.here = s.strays.from_goal = 1e300;
    return s;
  }
};

/// Ends of the Newton steps of all bodies, bent where they may be. Bytes: 700 a row.
struct BendWays {
  static constexpr const char* name = "affine_bend_ways";
  Potential p;
  Span<const AffineVec> q;     ///< by body
  Span<const AffineVec> step;  ///< by row
  double share = 1;
  Span<const RowSpace> space;  ///< by row, what equations leave to it; empty: all
  Span<AffineVec> end;         ///< out, by body; fixed ones are not written

  SCREE_HD void operator()(Index row) const {
    const Index b = p.body_of_row[row];
    const BodyConstant& body = p.bodies[b];
    const AffineVec way = share * step[row];
    if (!body.may_bend) {
      end[b] = q[b] + way;
      return;
    }
    const AffineVec bent = bent_end(body.mass, q[b], way, p.target[row].node[0]);
    const bool is_held = !space.empty() && !space[row].is_whole();
    end[b] = is_held ? q[b] + expanded(space[row], restricted(space[row], bent - q[b])) : bent;
  }
};

/// q + share (to - q).
struct MovePart {
  static constexpr const char* name = "affine_move_part";
  Span<const Index> body_of_row;
  Span<const AffineVec> q, to;  ///< by body
  double share = 1;
  Span<AffineVec> moved;  ///< out, by body; fixed ones are not written

  SCREE_HD void operator()(Index row) const {
    const Index b = body_of_row[row];
    moved[b] = q[b] + share * (to[b] - q[b]);
  }
};

/// q + share step.
struct MoveBody {
  static constexpr const char* name = "affine_move";
  Span<const Index> body_of_row;
  Span<const AffineVec> q;     ///< by body
  Span<const AffineVec> step;  ///< by row
  double share = 1;
  Span<AffineVec> moved;              ///< out, by body; fixed ones are not written
  const LeastShare* found = nullptr;  ///< in place of the share

  SCREE_HD void operator()(Index row) const {
    const Index b = body_of_row[row];
    moved[b] = q[b] + (found != nullptr ? found->value : share) * step[row];
  }
};

}  // namespace scree::affine
