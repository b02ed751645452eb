#pragma once
// Bytes that a pass moves, what benchmarks compare measured times with; the passes that solvers
// share are here, those of one solver in its file. R (r) is the size of a number, ids and list
// entries are 4 bytes.
//
//   least      each array element the pass needs crosses the memory bus once: what gathers read
//              again comes from cache. The floor of a pass is least bytes / copy bandwidth.
//   requested  every load and store the program executes: what the pass moves when no gather hits
//              the cache. A measured time between the two floors is a matter of cache hits.
//
// Radial layout, uniform friction, no adhesion (two arrays that are then not read). When a kernel
// changes what it reads or writes, change its function here and its docstring together.

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

/// ApgdResidual (ContactResidual). Contact: normal 3R, bias R, ids 8, impulse 3R.
/// Twists 6R and inertia 2R a body: once each, or two per contact.
/// @param r  size of a number [bytes], here and below
constexpr Traffic residual_traffic(double r) {
  const double streamed = 7 * r + 8;
  return {streamed, 8 * r, streamed + 16 * r, 0};
}

/// BodyVelocity. Body: v* 6R, inertia 2R, starts 8 read; V 6R written. Contact:
/// as in the body pass.
constexpr Traffic body_velocity_traffic(double r) {
  const double body = 14 * r + 8;
  return {6 * r + 4, body, 12 * r + 4, body};
}

/// ContactVelocity. Contact: normal 3R, bias R, ids 8 read, one vector 3R written. Twists 6R a
/// body: once each, or two per contact.
constexpr Traffic contact_velocity_traffic(double r) {
  const double streamed = 7 * r + 8;
  return {streamed, 6 * r, streamed + 12 * r, 0};
}

/// Cone projection from one array to another: normal 3R and impulse 3R read, 3R written.
constexpr Traffic cone_projection_traffic(double r) {
  const double contact = 9 * r;
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
static_assert(contact_velocity_traffic(4).contact_least == 36);
static_assert(contact_velocity_traffic(4).contact_requested == 36 + 48);

}  // namespace scree
