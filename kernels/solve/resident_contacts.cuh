#pragma once
// The data of a tile's contacts, as they are kept through many trials; see apgd_resident.cuh. Each kind is a TileLists with
//   place(room, ...), place_impulses(room, ...)  on the host: takes shared memory for what stays through a solve, for the rest
//   ends(k), set_ends(k, ends)                   the bodies of contact k
//   load(passes, k, c, number)                   contact c of the problem, of that number in its group: what stays
//   load_impulses(passes, k, c)                  its impulses
//   impulse(j, k)                                in buffer j of ApgdImpulses
//   step<kHasOwn, kLaw>(passes, trial, k, v_a, v_b)
//   pull(trial, k, side_b, to), add(pulled, side_b, wrench)   what it exerts on a body: what has to be read, then the rest

#include "kernels/solve/one_contact.h"
#include "kernels/solve/resident_tile.cuh"

namespace scree {
namespace apgd_sweep {

/// What contacts have of their own that others share.
struct OwnValues {
  bool tangential = false, friction = false, adhesion = false, drift = false;
  /// Whether a contact has to look for some of it.
  bool has_any(ContactLayout layout) const {
    return friction || adhesion || (layout != ContactLayout::general && (tangential || drift));
  }
};

/// What a trial needs to know.
struct ResidentTrial {
  /// Which of two buffers has the iterate; the other one has the iterate before, and gets the next.
  int now;
  float beta, length;
  __device__ explicit ResidentTrial(const ApgdState& s)
      : now(static_cast<int>(s.accepted % 2)),
        beta(shared_by_warp(s.beta)),
        length(shared_by_warp(s.step)) {}
  __device__ Twist<float> extrapolated(const Twist<float>& v, const Twist<float>& before) const {
    return v + beta * (v - before);
  }
};

/// One of two pointers: an index would move both to memory.
template <class T>
__device__ T* pick(T* const (&of)[2], int k) {
  return k == 0 ? of[0] : of[1];
}

/// Where the data of contacts lie in shared memory [bytes].
struct ContactsLayout {
  ListsLayout lists;
  unsigned fixed = 0, ends = 0, gamma[2] = {}, arm[2] = {}, drift = 0;
  unsigned tangential = 0, friction = 0, adhesion = 0;
};

/// Metric weight of contact c, from the stored ones.
__device__ inline float normal_weight(const RadialPasses<float>& a, bool has_tangential, Index c) {
  if (a.metric.values.empty()) return 1;
  return a.metric.values[has_tangential ? 2 * static_cast<Offset>(c) : c];
}
__device__ inline float tangential_weight(const RadialPasses<float>& a, Index c) {
  return a.metric.values[2 * static_cast<Offset>(c) + 1];
}

/// Arrays that hold what is one contact's own, each where there is such.
struct OwnArrays {
  float *tangential, *friction, *adhesion;
  __device__ OwnArrays(unsigned char* bytes, const ContactsLayout& at) {
    point(tangential, bytes, at.tangential);
    point(friction, bytes, at.friction);
    point(adhesion, bytes, at.adhesion);
  }
  static void place(SharedRoom& room, std::size_t n, const OwnValues& has, ContactsLayout& to) {
    to.tangential = room.take<float>(has.tangential ? n : 0);
    to.friction = room.take<float>(has.friction ? n : 0);
    to.adhesion = room.take<float>(has.adhesion ? n : 0);
  }
  __device__ void load(const RadialPasses<float>& a, const OwnValues& has, Index k, Index c) const {
    if (has.tangential) tangential[k] = tangential_weight(a, c);
    if (has.friction) friction[k] = a.p.friction[c];
    if (has.adhesion) adhesion[k] = a.p.adhesion[c];
  }
  /// @param to  with its normal weight; out: the rest
  template <bool kHasOwn>
  __device__ void give(const RadialPasses<float>& a, const OwnValues& has, Index k,
                       OneContact<float>& to) const {
    to.friction = kHasOwn && has.friction ? friction[k] : a.p.friction.uniform;
    to.adhesion = kHasOwn && has.adhesion ? adhesion[k] : a.p.adhesion.uniform;
    to.weights[1] =
        kHasOwn && has.tangential ? tangential[k] : a.metric.tangential_ratio * to.weights[0];
  }
};

/// Contacts of spheres, all of it in shared memory: 48 bytes each, and OwnValues.
struct RadialContacts : TileLists {
  using Pulled = float4[2];
  const OwnValues& has;
  OwnArrays own_values;
  float4* fixed;     ///< normal and Ends
  float4* gamma[2];  ///< by turns as in ApgdImpulses; with the normal weight, and with the bias

  static void place(SharedRoom& room, std::size_t bodies, std::size_t n, std::size_t listed,
                    const OwnValues& has, ContactsLayout& to) {
    to.fixed = room.take<float4>(n);
    OwnArrays::place(room, n, has, to);
    to.lists = ListsLayout(room, bodies, listed);
  }
  static void place_impulses(SharedRoom& room, std::size_t n, ContactsLayout& to) {
    for (unsigned& offset : to.gamma) offset = room.take<float4>(n);
  }
  __device__ RadialContacts(unsigned char* bytes, const ContactsLayout& at, const OwnValues& own_)
      : TileLists(bytes, at.lists), has(own_), own_values(bytes, at) {
    point(fixed, bytes, at.fixed);
    point(gamma[0], bytes, at.gamma[0]);
    point(gamma[1], bytes, at.gamma[1]);
  }

  __device__ Ends ends(Index k) const { return Ends(fixed[k].w); }
  __device__ void set_ends(Index k, const Ends& e) const { fixed[k].w = e.as_float(); }
  __device__ void load(const RadialPasses<float>& a, Index k, Index c, Index) const {
    fixed[k] = widened(a.p.normal[c], fixed[k].w);
    own_values.load(a, has, k, c);
  }
  __device__ void load_impulses(const RadialPasses<float>& a, Index k, Index c) const {
    gamma[0][k] = widened(a.gamma.buffer[0][c], normal_weight(a, has.tangential, c));
    gamma[1][k] = widened(a.gamma.buffer[1][c], a.p.bias[c]);
  }
  __device__ Vec3<float> impulse(int j, Index k) const { return narrowed(gamma[j][k]); }

  template <bool kHasOwn, Law kLaw>
  __device__ Sums<2> step(const RadialPasses<float>& a, const ResidentTrial& trial, Index k,
                          const Twist<float>& v_a, const Twist<float>& v_b) const {
    using Rows = RadialRows<float>;
    OneContact<float> contact;
    return step_as<kHasOwn, kLaw, Rows>(a, trial, k, v_a, v_b, contact);
  }

  __device__ void pull(const ResidentTrial& trial, Index k, bool, Pulled& to) const {
    to[0] = pick(gamma, 1 - trial.now)[k];
    to[1] = fixed[k];
  }
  static __device__ void add(const Pulled& of, bool side_b, Wrench<float>& sum) {
    const Pull<float> pull(narrowed(of[0]), narrowed(of[1]));
    if (side_b) {
      sum.add_as_b(pull);
    } else {
      sum.add_as_a(pull);
    }
  }

 protected:
  /// @param contact  with what only its kind has
  template <bool kHasOwn, Law kLaw, class Rows, class Contact>
  __device__ Sums<2> step_as(const RadialPasses<float>& a, const ResidentTrial& trial, Index k,
                             const Twist<float>& v_a, const Twist<float>& v_b,
                             Contact& contact) const {
    using Stepped = std::conditional_t<kLaw == Law::impact, ImpactRows<Rows>, Rows>;
    float4* const next = pick(gamma, 1 - trial.now);
    const float4 x = pick(gamma, trial.now)[k], before = next[k];
    contact.gamma = narrowed(x);
    contact.previous = narrowed(before);
    contact.normal = narrowed(fixed[k]);
    contact.weights[0] = trial.now == 0 ? x.w : before.w;
    contact.bias = trial.now == 0 ? before.w : x.w;
    own_values.give<kHasOwn>(a, has, k, contact);
    Vec3<float> moved;
    const Sums<2> sums = contact.template step<Stepped>(trial.beta, trial.length, v_a, v_b, moved,
                                                        kLaw == Law::coulomb);
    next[k] = widened(moved, before.w);
    return sums;
  }
};

/// Contacts with lever arms beside those of spheres: 24 bytes more.
struct GeneralContacts : RadialContacts {
  Vec3<float>* arm[2];  ///< of A, of B
  Vec3<float>* drift;   ///< if there is any

  static void place(SharedRoom& room, std::size_t bodies, std::size_t n, std::size_t listed,
                    const OwnValues& has, ContactsLayout& to) {
    RadialContacts::place(room, bodies, n, listed, has, to);
    for (unsigned& offset : to.arm) offset = room.take<Vec3<float>>(n);
    to.drift = room.take<Vec3<float>>(has.drift ? n : 0);
  }
  __device__ GeneralContacts(unsigned char* bytes, const ContactsLayout& at, const OwnValues& own_)
      : RadialContacts(bytes, at, own_) {
    point(arm[0], bytes, at.arm[0]);
    point(arm[1], bytes, at.arm[1]);
    point(drift, bytes, at.drift);
  }

  __device__ void load(const RadialPasses<float>& a, Index k, Index c, Index number) const {
    RadialContacts::load(a, k, c, number);
    arm[0][k] = a.p.arm_a[number];
    arm[1][k] = a.p.arm_b[number];
    if (has.drift) drift[k] = a.p.drift[number];
  }
  template <bool kHasOwn, Law kLaw>
  __device__ Sums<2> step(const RadialPasses<float>& a, const ResidentTrial& trial, Index k,
                          const Twist<float>& v_a, const Twist<float>& v_b) const {
    using Rows = GeneralRows<float, true>;
    OneGeneralContact<float> contact;
    contact.arm_a = arm[0][k];
    contact.arm_b = arm[1][k];
    contact.drift = kHasOwn && has.drift ? drift[k] : Vec3<float>{};
    return step_as<kHasOwn, kLaw, Rows>(a, trial, k, v_a, v_b, contact);
  }
  __device__ void pull(const ResidentTrial& trial, Index k, bool side_b, Pulled& to) const {
    to[0] = pick(gamma, 1 - trial.now)[k];
    to[1] = widened(side_b ? arm[1][k] : arm[0][k]);
  }
  static __device__ void add(const Pulled& of, bool side_b, Wrench<float>& sum) {
    const Twist<float> w =
        GeneralRows<float, true>::wrench_at(narrowed(of[1]), side_b, narrowed(of[0]));
    sum.force += w.linear;
    sum.torque += w.angular;
  }
};

/// Contacts with lever arms alone: 28 bytes each in shared memory. What does not change within a solve does not fit beside it
/// and comes from the second-level cache in each trial, as records of the tile that lie in its own order: 48 bytes, and once
/// more 16 for each body. 8 of them are the normal, as in the sweep (packed_contact.h), and 12 the velocity that bias and drift
/// make together.
struct StreamedContacts : TileLists {
  using Pulled = float4[2];

  /// One record, with what is at hand where neither arm is needed.
  struct Rest {
    PackedContact normal;  ///< with the normal weight
    float tangential_weight, offset_z;
  };
  static_assert(sizeof(Rest) == sizeof(float4));

  const OwnValues& has;
  std::uint32_t* ends_word;
  Vec3<float>* gamma[2];
  float4* arm[2];  ///< of A, of B; with x and y of the offset
  Rest* rest;
  float2* values;  ///< friction and adhesion, if they are own ones

  /// Records of 16 bytes that n contacts take.
  static Offset records(const OwnValues& has, Offset n) {
    return 3 * n + (has_values(has) ? (n + 1) / 2 : 0);
  }
  static SCREE_HD bool has_values(const OwnValues& has) { return has.friction || has.adhesion; }
  static void place(SharedRoom& room, std::size_t bodies, std::size_t n, std::size_t listed,
                    const OwnValues&, ContactsLayout& to) {
    to.ends = room.take<std::uint32_t>(n);
    to.lists = ListsLayout(room, bodies, listed);
  }
  static void place_impulses(SharedRoom& room, std::size_t n, ContactsLayout& to) {
    for (unsigned& offset : to.gamma) offset = room.take<Vec3<float>>(n);
  }
  /// @param records  of this tile
  /// @param room     contacts for which there is room
  __device__ StreamedContacts(unsigned char* bytes, const ContactsLayout& at, const OwnValues& own_,
                              float4* records, Index room)
      : TileLists(bytes, at.lists),
        has(own_),
        arm{records, records + room},
        rest(reinterpret_cast<Rest*>(records + 2 * room)),
        values(reinterpret_cast<float2*>(records + 3 * room)) {
    point(ends_word, bytes, at.ends);
    point(gamma[0], bytes, at.gamma[0]);
    point(gamma[1], bytes, at.gamma[1]);
  }

  __device__ Ends ends(Index k) const { return Ends(std::bit_cast<float>(ends_word[k])); }
  __device__ void set_ends(Index k, const Ends& e) const { ends_word[k] = e.word; }
  __device__ void load(const RadialPasses<float>& a, Index k, Index c, Index number) const {
    const Vec3<float> n = a.p.normal[c];
    const float weight = normal_weight(a, has.tangential, c);
    Vec3<float> offset = a.p.bias[c] * n;
    if (has.drift) offset += a.p.drift[number];
    arm[0][k] = widened(a.p.arm_a[number], offset.x);
    arm[1][k] = widened(a.p.arm_b[number], offset.y);
    rest[k] = {PackedContact(n, weight, 0),
               has.tangential ? tangential_weight(a, c) : a.metric.tangential_ratio * weight,
               offset.z};
    if (has_values(has)) values[k] = make_float2(a.p.friction[c], a.p.adhesion[c]);
  }
  __device__ void load_impulses(const RadialPasses<float>& a, Index k, Index c) const {
#pragma unroll
    for (int j = 0; j < 2; ++j) gamma[j][k] = a.gamma.buffer[j][c];
  }
  __device__ Vec3<float> impulse(int j, Index k) const { return gamma[j][k]; }

  template <bool kHasOwn, Law kLaw>
  __device__ Sums<2> step(const RadialPasses<float>& a, const ResidentTrial& trial, Index k,
                          const Twist<float>& v_a, const Twist<float>& v_b) const {
    static_assert(kLaw != Law::impact);
    const float4 r_a = arm[0][k], r_b = arm[1][k];
    const auto of_rest = load_by<float4>(rest + k);
    float2 own_of{a.p.friction.uniform, a.p.adhesion.uniform};
    if (kHasOwn) own_of = values[k];
    Vec3<float>* const next = pick(gamma, 1 - trial.now);
    OneGeneralContact<float> contact;
    contact.gamma = pick(gamma, trial.now)[k];
    contact.previous = next[k];
    contact.normal = of_rest.normal.normal();
    contact.bias = 0;
    contact.friction = own_of.x;
    contact.adhesion = own_of.y;
    contact.weights[0] = of_rest.normal.weight();
    contact.weights[1] = of_rest.tangential_weight;
    contact.arm_a = narrowed(r_a);
    contact.arm_b = narrowed(r_b);
    contact.drift = {r_a.w, r_b.w, of_rest.offset_z};
    Vec3<float> moved;
    const Sums<2> sums = contact.template step<GeneralRows<float, true>>(
        trial.beta, trial.length, v_a, v_b, moved, kLaw == Law::coulomb);
    next[k] = moved;
    return sums;
  }
  __device__ void pull(const ResidentTrial& trial, Index k, bool side_b, Pulled& to) const {
    to[0] = widened(pick(gamma, 1 - trial.now)[k]);
    to[1] = pick(arm, side_b ? 1 : 0)[k];
  }
  static __device__ void add(const Pulled& of, bool side_b, Wrench<float>& sum) {
    GeneralContacts::add(of, side_b, sum);
  }
};

}  // namespace apgd_sweep
}  // namespace scree
