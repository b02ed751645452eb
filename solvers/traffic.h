#pragma once
// Bytes each pass of a solver moves, in one place: what benchmarks compare measured times with.
// R = sizeof(Real), ids and list entries are 4 bytes.
//
//   least      each array element the pass needs crosses the memory bus once: what gathers read
//              again comes from cache. The floor of a pass is least bytes / copy bandwidth.
//   requested  every load and store the program executes: what the pass moves when no gather hits
//              the cache. A measured time between the two floors is a matter of cache hits.
//
// Radial layout, uniform friction, no adhesion (two arrays that are then not read). When a kernel
// changes what it reads or writes, change its function here and its docstring together.

#include "solvers/solver.h"

namespace scree {

/// Bytes of one pass over a bed.
struct Traffic {
  double contact_least = 0;
  double body_least = 0;
  double contact_requested = 0;
  double body_requested = 0;

  constexpr double least(double contacts, double bodies) const {
    return contact_least * contacts + body_least * bodies;
  }
  constexpr double requested(double contacts, double bodies) const {
    return contact_requested * contacts + body_requested * bodies;
  }
  friend constexpr Traffic operator+(const Traffic& a, const Traffic& b) {
    return {a.contact_least + b.contact_least, a.body_least + b.body_least,
            a.contact_requested + b.contact_requested, a.body_requested + b.body_requested};
  }
  friend constexpr Traffic operator*(double s, const Traffic& t) {
    return {s * t.contact_least, s * t.body_least, s * t.contact_requested, s * t.body_requested};
  }
};

/// ApgdContactPass. Contact: normal 3R, bias R, ids 8, two impulses 6R, diagonal metric 2R (none
/// when Euclidean) read, one impulse 3R written. Twists of the extrapolated point, 6R a body: once
/// each, or two per contact.
template <class Real>
constexpr Traffic apgd_contact_pass_traffic(ApgdMetricKind kind) {
  constexpr double r = sizeof(Real);
  const double streamed = (kind == ApgdMetricKind::diagonal ? 14 : 13) * r + 8;
  return {streamed, 6 * r, streamed + 12 * r, 0};
}

/// ApgdBodyPass. Body: v*, V, V_y 18R, inertia 2R, two list starts 8 read; V, V_y 12R written.
/// Solid spheres have v* from their rates, 6R and their radius, and one of mass and radius when all
/// are equal: then 2R less are read than counted here. Contact: impulse 3R and normal 3R, once each
/// or for both of its bodies; list entry 4.
template <class Real>
constexpr Traffic apgd_body_pass_traffic() {
  constexpr double r = sizeof(Real);
  constexpr double body = 32 * r + 8;
  return {6 * r + 4, body, 12 * r + 4, body};
}

/// One APGD iteration (one trial of the line search).
template <class Real>
constexpr Traffic apgd_iteration_traffic(ApgdMetricKind kind) {
  return apgd_contact_pass_traffic<Real>(kind) + apgd_body_pass_traffic<Real>();
}

/// One APGD iteration in float whose two passes are one, so that impulses and twists are read once
/// and V_y is worked out from two iterates: the least of any program here, for bodies and materials
/// alike. Doubles have no such program. Contact: normal, metric and A packed 8, bias R, B 4, two
/// impulses 6R, list entry 4 read, one impulse 3R written. Body: v* 6R, two V 12R, inertia 2R,
/// starts 8 read; V 6R written.
constexpr Traffic apgd_fused_iteration_traffic() {
  constexpr double r = sizeof(float);
  constexpr double contact = 10 * r + 16;
  constexpr double body = 26 * r + 8;
  return {contact, body, contact, body};
}

/// ApgdResidual (ContactResidual). Contact: normal 3R, bias R, ids 8, impulse 3R.
/// Twists 6R and inertia 2R a body: once each, or two per contact.
template <class Real>
constexpr Traffic residual_traffic() {
  constexpr double r = sizeof(Real);
  constexpr double streamed = 7 * r + 8;
  return {streamed, 8 * r, streamed + 16 * r, 0};
}

/// BodyVelocity. Body: v* 6R, inertia 2R, starts 8 read; V 6R written. Contact:
/// as in the body pass.
template <class Real>
constexpr Traffic body_velocity_traffic() {
  constexpr double r = sizeof(Real);
  constexpr double body = 14 * r + 8;
  return {6 * r + 4, body, 12 * r + 4, body};
}

/// One Jacobi iteration. Contact: normal 3R, bias R, ids 8, metric 3R, impulse 3R read, 3R written.
/// Twists 6R a body: once each, or two per contact. Bodies as in BodyVelocity.
template <class Real>
constexpr Traffic jacobi_iteration_traffic() {
  constexpr double r = sizeof(Real);
  constexpr double streamed = 13 * r + 8;
  return Traffic{streamed, 6 * r, streamed + 12 * r, 0} + body_velocity_traffic<Real>();
}

/// GaussSeidelPass over all contacts. Contact: as in the Jacobi pass. Body: twist 6R and inertia 2R
/// read, twist 6R written: once each, or for both bodies of each contact.
template <class Real>
constexpr Traffic gauss_seidel_sweep_traffic() {
  constexpr double r = sizeof(Real);
  constexpr double streamed = 13 * r + 8;
  return {streamed, 14 * r, streamed + 28 * r, 0};
}

/// A pass of Schwarz whose sweeps run in fast memory (the tuned twin). Contact: normal 3R, bias R,
/// link 8, two impulses 6R read, one 3R written. Body: two twists 12R read, one 6R written; 12R
/// more for each further tile that touches it, about half a tile.
template <class Real>
constexpr Traffic schwarz_pass_traffic() {
  constexpr double r = sizeof(Real);
  constexpr double contact = 13 * r + 8;
  return {contact, 18 * r, contact, 24 * r};
}

/// ContactVelocity. Contact: normal 3R, bias R, ids 8 read, one vector 3R written. Twists 6R a
/// body: once each, or two per contact.
template <class Real>
constexpr Traffic contact_velocity_traffic() {
  constexpr double r = sizeof(Real);
  constexpr double streamed = 7 * r + 8;
  return {streamed, 6 * r, streamed + 12 * r, 0};
}

/// Cone projection from one array to another: normal 3R and impulse 3R read, 3R written.
template <class Real>
constexpr Traffic cone_projection_traffic() {
  constexpr double contact = 9 * sizeof(Real);
  return {contact, 0, contact, 0};
}

/// Bits of one digit of the backends' radix sorts: cpu.h, and CUB's choice for 12-byte pairs.
constexpr int radix_digit_bits(bool is_device) { return is_device ? 8 : 11; }

/// sort_pairs, bytes per pair of 8-byte key and 4-byte value. Each digit reads and writes
/// the pair, 24. Counting reads the keys, 8: all digits in one go on the device (onesweep),
/// once a digit on the CPU. The copy back after an odd number of digits is not needed by
/// the method and not counted.
constexpr double sort_bytes(int bits, bool is_device) {
  const int digit = radix_digit_bits(is_device);
  const int passes = (bits + digit - 1) / digit;
  return 24.0 * passes + 8.0 * (is_device ? 1 : passes);
}

/// BodyContacts::build. Contact: id of A 4; id of B 4 to count, 4 to put, with 4 written; to order
/// 4 and id of B 4 read, the run of its body 4, 4 written. Body: count 4 cleared and 4 read, scan 8
/// written and 8 read, two starts 8 written.
constexpr Traffic body_contacts_traffic() {
  constexpr double contact = 32;
  constexpr double body = 32;
  return {contact, body, contact, body};
}

// The figures in the kernels' docstrings.
static_assert(contact_velocity_traffic<float>().contact_least == 36);
static_assert(contact_velocity_traffic<float>().contact_requested == 36 + 48);
static_assert(apgd_contact_pass_traffic<float>(ApgdMetricKind::diagonal).contact_least == 64);
static_assert(apgd_contact_pass_traffic<float>(ApgdMetricKind::diagonal).contact_requested == 112);
static_assert(apgd_body_pass_traffic<float>().contact_requested == 52);
static_assert(apgd_body_pass_traffic<float>().body_least == 136);
static_assert(apgd_fused_iteration_traffic().contact_least == 56);
static_assert(apgd_fused_iteration_traffic().body_least == 112);
static_assert(jacobi_iteration_traffic<float>().contact_requested == 108 + 52);
static_assert(jacobi_iteration_traffic<float>().body_requested == 64);
static_assert(gauss_seidel_sweep_traffic<float>().contact_least == 60);
static_assert(gauss_seidel_sweep_traffic<float>().contact_requested == 60 + 64 + 48);
static_assert(schwarz_pass_traffic<float>().contact_least == 16 + 8 + 24 + 12);
static_assert(schwarz_pass_traffic<float>().body_least == 48 + 24);

}  // namespace scree
