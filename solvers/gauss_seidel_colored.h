#pragma once
// Projected block Gauss-Seidel in parallel: contacts of one color share no free body
// and are solved at once.
//
// Source: docs/theory.md, section "Gauss-Seidel and Jacobi". Once per solve: a coloring, in which
// contacts keep the color they had in the step before, and one pass that brings contact data into
// the order of colors, so that a sweep reads contacts as a stream. Memory passes per sweep: one
// over contacts (48 B read and 12 B written in float) and two bodies gathered and scattered at each
// (64 B read, 48 B written), in as many launches as there are colors; at each check one pass over
// bodies and two over contacts more. A sweep cannot be faster than the launches of its colors: a
// body with 2000 contacts makes 2000.

#include "kernels/contact/field_buffers.h"
#include "kernels/solve/gauss_seidel_pass.h"
#include "solvers/contact_coloring.h"
#include "solvers/relaxation.h"

namespace scree {

template <class B, class Real>
class GaussSeidelColored final : public RelaxationSolver<B, Real> {
 public:
  using RelaxationSolver<B, Real>::RelaxationSolver;

  SolveStats solve(B& b, const ContactProblem<Real>& p, Span<Vec3<Real>> gamma,
                   double tolerance) override {
    return with_rows<Real>(p.layout,
                           [&](auto rows) { return run<decltype(rows)>(b, p, gamma, tolerance); });
  }

  /// A contact's mark is its color. Where bodies move to other ranks, contacts come without.
  bool keeps_marks() const override { return !this->is_over_ranks(); }

 private:
  struct Workspace {
    Workspace(B& b, Index count, Offset vectors)
        : coloring(b), metric(b, count), contacts(b), gamma(b, vectors) {}
    ContactColoring<B> coloring;
    Buffer<B, ContactMetric<Real>> metric;
    ProblemContacts<B, Real> contacts;
    Buffer<B, Vec3<Real>> gamma;
  };

  /// The problem with its contacts in the order of colors; its body-to-contact
  /// lists are not usable.
  template <class R>
  static ContactProblem<Real> order_contacts(B& b, const ContactProblem<Real>& p, Workspace& w) {
    w.contacts.resize_discard(parts_of(p), p.contact_count);
    for_each(b, p.contact_count,
             GatherContacts<R, Real>{p, w.coloring.order(), w.contacts.spans(), w.metric.view()});
    ContactProblem<Real> ordered = p;
    point_to(ordered, w.contacts);
    ordered.a_start = ordered.b_start = ordered.b_contact = {};
    return ordered;
  }

  template <class R>
  SolveStats run(B& b, const ContactProblem<Real>& p, Span<Vec3<Real>> gamma, double tolerance) {
    const Span<Twist<Real>> velocity = this->template begin<R>(b, p, gamma);
    if (p.contacts_in_all() == 0) return {0, 0, true, {}};
    if (this->is_over_ranks()) return run_over_ranks<R>(b, p, gamma, tolerance, velocity);
    if constexpr (R::kHasLaterGroups) return run_in_place<R>(b, p, gamma, tolerance, velocity);
    Workspace w(b, p.contact_count, R::vector_count(p));
    ContactColoring<B>& coloring = w.coloring;
    coloring.compute(b, p);
    const ContactProblem<Real> ordered = order_contacts<R>(b, p, w);
    const Span<ContactMetric<Real>> metric = w.metric.view();
    const Span<Vec3<Real>> ordered_gamma = w.gamma.view();
    for_each(b, p.contact_count, GatherImpulses<R, Real>{coloring.order(), gamma, ordered_gamma});

    const std::vector<Index>& starts = coloring.starts();
    GaussSeidelPass<R, Real> pass{ordered, metric, velocity, ordered_gamma, this->relaxation()};
    const auto sweep = [&] {
      for (Index color = 0; color < coloring.color_count(); ++color) {
        pass.first = starts[color];
        for_each(b, starts[color + 1] - starts[color], pass);
      }
    };
    const auto collect = [&] {
      for_each(b, p.contact_count,
               ScatterImpulses<R, Real>{coloring.order(), ordered_gamma, gamma});
    };
    SolveStats stats = this->template iterate<R>(b, p, gamma, tolerance, velocity, sweep, collect);
    stats.colors = coloring.color_count();
    return stats;
  }

  /// Contacts that two ranks list take a step of Jacobi at the start of a sweep, from velocities that both know; then each rank
  /// sweeps over its own. Both lower the objective of all.
  template <class R>
  SolveStats run_over_ranks(B& b, const ContactProblem<Real>& p, Span<Vec3<Real>> gamma,
                            double tolerance, Span<Twist<Real>> velocity) {
    Buffer<B, Index> border_count(b, p.bodies.moving_count);
    for_each(b, p.bodies.owned_count, CountBorderContacts<Real>{p, border_count.view()});
    this->ghosts()->update(b, border_count.view());
    Buffer<B, ContactMetric<Real>> metric(b, p.contact_count);
    for_each(b, p.contact_count,
             StoreMetricOfRanks<R, Real>{p, std::as_const(border_count).view(p.bodies.moving_count),
                                         metric.view()});
    ContactColoring<B> coloring(b);
    coloring.compute(b, p);
    const std::vector<Index>& starts = coloring.starts();
    const BorderPass<R, Real> border{{p, metric.view(), velocity, gamma, this->relaxation()}};
    InnerGaussSeidelPass<R, Real> inner{{p, metric.view(), velocity, gamma, this->relaxation()},
                                        coloring.order()};
    const auto sweep = [&] {
      for_each(b, p.contact_count, border);
      ContactPasses<R, B, Real>::gather_velocities(b, p, gamma, velocity);
      for (Index color = 0; color < coloring.color_count(); ++color) {
        inner.first = starts[color];
        for_each(b, starts[color + 1] - starts[color], inner);
      }
      this->update_ghosts(b, velocity);
    };
    SolveStats stats = this->template iterate<R>(b, p, gamma, tolerance, velocity, sweep, [] {});
    stats.colors = coloring.color_count();
    return stats;
  }

  /// Contacts of several groups differ in what is stored of them: they stay where they are.
  template <class R>
  SolveStats run_in_place(B& b, const ContactProblem<Real>& p, Span<Vec3<Real>> gamma,
                          double tolerance, Span<Twist<Real>> velocity) {
    Buffer<B, ContactMetric<Real>> metric(b, p.contact_count);
    for_each(b, p.contact_count, StoreBlockMetric<R, Real>{p, metric.view()});
    ContactColoring<B> coloring(b);
    coloring.compute(b, p);
    const std::vector<Index>& starts = coloring.starts();
    GaussSeidelPass<R, Real> pass{p, metric.view(),   velocity, gamma, this->relaxation(),
                                  0, coloring.order()};
    const auto sweep = [&] {
      for (Index color = 0; color < coloring.color_count(); ++color) {
        pass.first = starts[color];
        for_each(b, starts[color + 1] - starts[color], pass);
      }
    };
    SolveStats stats = this->template iterate<R>(b, p, gamma, tolerance, velocity, sweep, [] {});
    stats.colors = coloring.color_count();
    return stats;
  }
};

template <class B, class Real>
std::unique_ptr<Solver<B, Real>> make_gauss_seidel_colored(const SolverParams& params) {
  return std::make_unique<GaussSeidelColored<B, Real>>(params);
}

/// Beside what all of the kind hold, contacts in the order of colors, and the memory
/// of their coloring.
inline HeldBytes gauss_seidel_colored_memory(const SolverCase& c) {
  ContactParts parts(c.layout);
  parts.bias = true;
  const double ordered = c.has_groups() ? 0 : c.bytes_of<ProblemFields>(parts) + c.impulse();
  return relaxation_memory(c) + HeldBytes{72, ordered + 36};
}

constexpr SolverCard gauss_seidel_colored_card() {
  return {.name = "gauss_seidel_colored",
          .description = "block Gauss-Seidel, contacts of one color at once: for low accuracy",
          .parameters = kRelaxationParameters,
          .layouts = kAllLayouts,
          .over_ranks = true,
          .keeps_marks = true,
          .memory = gauss_seidel_colored_memory,
          .traffic = [](const SolverCase& c) { return gauss_seidel_sweep_traffic(c.real); }};
}

}  // namespace scree
