#pragma once
// Margins of bodies around impacts. Their memory, 16 bytes a body and 4 a contact, is taken at the
// first impact.

#include "collision/growth.h"
#include "kernels/impact_margins.h"

namespace scree {

template <class B, class Real>
class ImpactMargins {
 public:
  explicit ImpactMargins(B& b) : lists_(b), margin_(b), spread_(b), largest_(b, 1) {}

  /// How far contacts push bodies off their course at most [m]; one host read.
  /// @param graph  without lists
  double largest_push(B& b, const ImpactGraph<Real>& graph) {
    reduce<LargestPush>(b, graph.contacts.count, MeasurePushes<Real>{graph},
                        StoreResult<LargestPush>{largest_.data()});
    return fetch(b, largest_.data()).value;
  }

  /// @param graph    without lists
  /// @param scratch  [contact_count] out: of no use afterwards
  /// @return         [free_count] how far each body may be pushed [m]; valid until the next call
  Span<const float> compute(B& b, SortSpace<B>& sort, ImpactGraph<Real> graph,
                            Span<std::uint64_t> scratch) {
    const Index n = graph.bodies.free_count;
    const ContactView<Real>& contacts = graph.contacts;
    graph.lists = lists_.build(b, sort, n, contacts.body_a, contacts.body_b, scratch);
    Span<float> margin = sized(margin_, n);
    Span<float> spread = sized(spread_, n);
    for_each(b, n, StartMargins<Real>{graph, margin});
    for (int round = 0; round < kRounds; ++round) {
      for_each(b, n, SpreadMargins<Real>{graph, margin, spread});
      std::swap(margin, spread);
    }
    return margin;
  }

 private:
  /// Bodies one behind the other that an impact pushes within a step, besides the two that meet.
  static constexpr int kRounds = 4;

  BodyLists<B> lists_;
  Buffer<B, float> margin_;
  Buffer<B, float> spread_;
  Buffer<B, LargestPush> largest_;
};

}  // namespace scree
