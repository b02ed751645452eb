#pragma once
// The contacts under bodies far heavier than those they rest on, solved at once.
//
// A light body between a heavy one and others transmits its load. Impulses on its two sides grow
// together and move the light body by nothing and the heavy one by little, so that steps which move
// each contact by itself, in whatever diagonal metric, take as many iterations as the root of the
// ratio of masses, or more. Few contacts carry such loads. They are solved exactly, with the
// impulses of all others kept, which lowers the objective; ordinary iterations do the rest.

#include <algorithm>
#include <vector>

#include "solvers/block_impulses.h"

namespace scree {

template <class B, class Real>
class LoadedBlock {
 public:
  explicit LoadedBlock(B& b) : loaded_(b), contact_(b) {}

  /// Whether the contacts of a problem are of the kind that can be solved so.
  template <class R>
  static bool takes(const ContactProblem<Real>& p) {
    return R::kVectors == 1 && p.adhesion.values.empty() && !(p.adhesion.uniform > 0);
  }
  /// Queues the comparison of the bodies in contact, which take_contrast() is to bring from there.
  /// @param contrast  on the backend, out
  template <class R>
  static void queue_contrast(B& b, const ContactProblem<Real>& p, Largest<double>* contrast) {
    reduce<Largest<double>>(b, p.contact_count, ContactContrast<R, Real>{p},
                            StoreResult<Largest<double>>{contrast});
  }
  void take_contrast(const Largest<double>& contrast) { contrast_ = contrast.value; }
  /// Whether bodies in contact differ so much that there may be loaded contacts.
  bool may_find() const { return contrast_ > kContrast; }

  /// Replaces the impulses of the loaded contacts of a problem, always the same one; two host reads where there are none.
  /// @param gamma      in and out, in their cones
  /// @param velocity   V = v* + M^-1 J^T gamma of these
  /// @param tolerance  of the whole problem, RMS [m/s], > 0
  /// @return  whether impulses changed
  template <class R>
  bool solve(B& b, const ContactProblem<Real>& p, Span<Vec3<Real>> gamma,
             Span<const Twist<Real>> velocity, double tolerance) {
    if (!may_find()) return false;
    const std::vector<Index> chosen = choose<R>(b, p, gamma, load_ * tolerance);
    load_ /= 10;
    if (chosen.empty()) return false;

    const auto n = static_cast<Index>(chosen.size());
    upload(b, chosen, contact_);
    const Span<const Index> contact = contact_.view(n);
    Buffer<B, BlockContact> block(b, n);
    for_each(b, n, ReadBlock<R, Real>{p, gamma, velocity, contact, block.view()});
    const std::vector<Vec3<double>> found =
        block_impulses(download(b, block.view()), contrast_, kShare * tolerance);
    if (found.empty()) return false;
    Buffer<B, Vec3<double>> impulse(b);
    upload(b, found, impulse);
    for_each(b, n, WriteBlock<Real>{contact, impulse.view(), gamma});
    return true;
  }

 private:
  /// Ratio of masses of two bodies in contact from which on loads are searched for. Beds of spheres
  /// of 1 : 10 have 1000.
  static constexpr double kContrast = 2000;
  /// Most contacts that are solved at once: the work grows with the cube of their number.
  static constexpr Index kMaxContacts = 600;
  /// Residual of the block over that of the whole problem.
  static constexpr double kShare = 0.1;

  /// Contacts of loaded bodies, ascending; none when they are too many.
  template <class R>
  std::vector<Index> choose(B& b, const ContactProblem<Real>& p, Span<const Vec3<Real>> gamma,
                            double speed) {
    const Span<std::uint8_t> loaded = loaded_.resize_discard(p.bodies.owned_count);
    const Span<Index> room = contact_.resize_discard(kMaxContacts + 1);
    fill(b, loaded, std::uint8_t(0));
    fill(b, room, Index(0));
    for_each(b, p.contact_count, MarkLoaded<R, Real>{p, gamma, speed, loaded});
    Index* const count = contact_.data();
    const Span<Index> list{count + 1, kMaxContacts};
    for_each(b, p.contact_count, PickLoaded<Real>{p, loaded, count, list});
    const Index n = fetch(b, static_cast<const Index*>(count));
    if (n > kMaxContacts) return {};
    std::vector<Index> chosen = download(b, list.first(n));
    std::sort(chosen.begin(), chosen.end());
    return chosen;
  }

  /// A contact is loaded when its impulse would give its body this multiple of the tolerance: for
  /// `quality` 100 v*, the impulse at the foot of a hundred layers. Less each time, as more
  /// contacts may count.
  double load_ = 1e4;
  double contrast_ = 0;  ///< of the problem
  Buffer<B, std::uint8_t> loaded_;
  Buffer<B, Index> contact_;
};

}  // namespace scree
