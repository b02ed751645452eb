#pragma once
// Margins of bodies around impacts. Their memory, 12 bytes a body and 8 a contact, is taken at the
// first contact; that of contacts only until the margins are known.

#include <utility>

#include "kernels/bodies/ghosts.h"
#include "kernels/narrow_phase/impact_margins.h"

namespace scree {

template <class B, class Real>
class ImpactMargins {
 public:
  explicit ImpactMargins(B& b) : margin_(b), spread_(b), last_(b), room_(b), largest_(b, 1) {}

  /// Margins of the bodies in contact; one host read.
  /// @param ghosts  with several ranks: their margins are those that their owners know, here and in spread()
  /// @return  how far contacts push bodies off their course at most [m]
  double start(B& b, const ImpactGraph<Real>& graph, const Ghosts<B>* ghosts) {
    std::swap(margin_, last_);
    const Span<float> margin = margin_.resize_discard(graph.bodies.moving_count);
    fill(b, margin, 0.0f);
    reduce<Largest<double>>(
        b, graph.contacts.count,
        StartMargins<Real>{graph, margin, room_.resize_discard(graph.contacts.count)},
        StoreResult<Largest<double>>{largest_.data()});
    if (ghosts != nullptr) ghosts->send(b, margin);
    // When all have told theirs, all have sent.
    const double largest = fetch_over_ranks(b, std::as_const(largest_).data()).value;
    if (ghosts != nullptr) ghosts->receive(b, margin);
    return largest;
  }

  /// Passes the margins on through the contacts.
  /// @param graph  that of start()
  /// @return       [moving_count] how far each body may be pushed [m]; valid until the start() after
  ///               the next
  Span<const float> spread(B& b, const ImpactGraph<Real>& graph, const Ghosts<B>* ghosts) {
    const Index n = graph.bodies.moving_count;
    for (int round = 0; round < kRounds; ++round) {
      const Span<float> spread = spread_.resize_discard(n);
      copy(b, std::as_const(margin_).view(n), spread);
      for_each(b, graph.contacts.count,
               SpreadMargins<Real>{graph, std::as_const(room_).view(graph.contacts.count),
                                   std::as_const(margin_).view(n), spread});
      if (ghosts != nullptr) ghosts->update(b, spread);
      std::swap(margin_, spread_);
    }
    room_.release();
    return std::as_const(margin_).view(n);
  }

  /// How much the largest growth of a margin was from the start() before to this one [m];
  /// one host read.
  double growth(B& b, Index moving_count) {
    reduce<Largest<double>>(b, moving_count,
                            MarginGrowth{std::as_const(last_).view(moving_count),
                                         std::as_const(margin_).view(moving_count)},
                            StoreResult<Largest<double>>{largest_.data()});
    return fetch_over_ranks(b, std::as_const(largest_).data()).value;
  }

 private:
  /// Bodies one behind the other that an impact pushes within a step, besides the two that meet.
  static constexpr int kRounds = 4;

  Buffer<B, float> margin_;
  Buffer<B, float> spread_;
  Buffer<B, float> last_;
  Buffer<B, double> room_;
  Buffer<B, Largest<double>> largest_;
};

}  // namespace scree
