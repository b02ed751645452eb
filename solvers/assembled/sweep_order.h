#pragma once
// The order in which Gauss-Seidel methods visit contacts on a backend.

#include "solvers/assembled/backend_problem.h"
#include "solvers/assembled/block_coloring.h"

namespace scree {

enum class SweepKind {
  as_numbered,  ///< one after another, on the host only
  by_colors     ///< color after color, the contacts of one color at once
};

/// Element program over the contacts of one color.
template <class Visit>
struct VisitOfColor {
  static constexpr const char* name = Visit::name;
  Span<const Index> contact;
  Visit visit;
  SCREE_HD void operator()(Index k) const { visit(contact[k]); }
};

template <class B>
class SweepOrder {
 public:
  /// As the backend can: the numbering is the better order, as contacts near each other follow each
  /// other, but only colors keep a device busy.
  explicit SweepOrder(const BackendProblem<B>& p)
      : SweepOrder(p, B::kIsDevice ? SweepKind::by_colors : SweepKind::as_numbered) {}

  SweepOrder(const BackendProblem<B>& p, SweepKind kind)
      : p_(&p), kind_(kind), contact_(p.backend()) {
    if (kind == SweepKind::as_numbered) return;
    coloring_ = color_blocks(p.host());
    upload(p.backend(), coloring_.contact, contact_);
  }

  /// Runs visit(c) for all contacts.
  /// @param visit  element program that reads its row of W r and writes its own contact only
  template <class Visit>
  void run(Visit visit) const {
    if (kind_ == SweepKind::as_numbered) {
      if constexpr (!B::kIsDevice)
        for (Index c = 0; c < p_->contact_count(); ++c) visit(c);
      return;
    }
    const Span<const Index> all = contact_.view(p_->contact_count());
    for (int color = 0; color < coloring_.color_count(); ++color) {
      const Index first = coloring_.start[color], count = coloring_.start[color + 1] - first;
      for_each(p_->backend(), count, VisitOfColor<Visit>{{all.data + first, count}, visit});
    }
  }

 private:
  const BackendProblem<B>* p_;
  SweepKind kind_;
  BlockColoring coloring_;
  Buffer<B, Index> contact_;
};

}  // namespace scree
