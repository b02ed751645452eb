#pragma once
// The near pairs of a step, and how long their list serves: until bodies stray from the ways that it was made for. Bodies that
// fly or rest keep a list for several steps.

#include <algorithm>
#include <utility>
#include <vector>

#include "dynamics/affine/near_pairs.h"
#include "dynamics/model_errors.h"
#include "dynamics/model_on.h"
#include "kernels/affine/near_ways.h"

namespace scree::affine {

/// What a list was made from, but for its ways, and how far it has served: with that it can be made again, the same.
struct NearListState {
  double time = 0;    ///< on the ways, about where bodies are, from 0 to 1
  double room = 0;    ///< how far bodies may be from where the ways are at one time [m]
  double steps = 1;   ///< that the ways are for
  double served = 0;  ///< steps that used it from their start, that of its first way included
  double wanted = 1;  ///< steps that the next list is made for

  bool is_valid() const {
    return time >= 0 && time <= 1 && room > 0 && steps >= 1 && served >= 0 && wanted >= 1;
  }
  std::vector<double> numbers() const { return {time, room, steps, served, wanted}; }
  /// @param numbers  as numbers() gives them. @throws InputError for others
  static NearListState of(const std::vector<double>& numbers) {
    if (numbers.size() != 5) throw_bad_near_list();
    const NearListState s{numbers[0], numbers[1], numbers[2], numbers[3], numbers[4]};
    if (!s.is_valid()) throw_bad_near_list();
    return s;
  }
};

template <class B>
class NearList {
 public:
  NearList(B& b, Index bodies) : b_(&b), near_(b), from_(b, bodies), to_(b, bodies) {}

  /// Bodies that rest are where they are at all times.
  void keep_places(Span<const AffineVec> q) {
    copy(*b_, q, from_.view());
    copy(*b_, q, to_.view());
  }

  NearPairsView view() const { return near_.view(); }
  ListedWays ways() { return {from_.view(), to_.view(), state_.time, goal_}; }

  /// A list for where bodies are before the first step.
  void begin_at_rest(const SurfaceTables<B>& surfaces, const Barrier& barrier) {
    surfaces_ = &surfaces;
    state_ = {.room = barrier.reach};
    make(barrier);
  }

  /// A step begins. What the one before ended with serves until bodies go on, for their list holds what is near where they are.
  /// @param p     all but its near pairs is set, targets need not be
  /// @param v     by body  @param h  of the step [s]
  /// @param anew  whether bodies are not where the last step left them
  void begin(const SurfaceTables<B>& surfaces, const Potential& p, Span<const AffineVec> v,
             double h, bool anew) {
    surfaces_ = &surfaces;
    v_ = v, h_ = h;
    if (anew) {
      copy(*b_, p.start, from_.view());
      copy(*b_, p.start, to_.view());
      state_ = {.room = p.barrier.reach};
      make(p.barrier);
    }
    state_.served += 1;
    goal_ = std::min(1.0, state_.time + 1 / state_.steps);
  }

  /// Whether the list serves for a way to where bodies stray so far.
  bool serves(const Strays& strays) const { return strays.least() <= state_.room; }
  /// Bodies go a share of the way to there.
  void follow(const Strays& strays, double share) {
    const double goal = strays.from_goal < strays.here ? goal_ : state_.time;
    state_.time += share * (goal - state_.time);
  }

  /// Another list, for a way of a step and, if it is the first of that, for some steps more. @return how far its end strays
  /// @param size  largest way of a corner [m]
  Strays renew(const Potential& p, Span<const AffineVec> from, Span<const AffineVec> to,
               double size, bool is_first) {
    NearListState& s = state_;
    // Lists of more steps are longer: they pay where bodies fly, and where the search looks at much and finds little.
    const bool lasted = is_first && s.served > s.steps && near_.finds_few();
    s.wanted = lasted ? std::min(2 * s.wanted, kMostSteps) : std::max(0.5 * s.wanted, 1.0);
    s.time = 0;
    s.served = is_first ? 1 : 0;
    if (is_first && s.wanted > 1) {
      s.steps = s.wanted, goal_ = 1 / s.steps;
      s.room = kRoomOfSteps * p.barrier.reach;
      for_each(*b_, p.rows(),
               SetWaysAhead{p.body_of_row, from, to, v_, h_, s.steps, from_.view(), to_.view()});
      const auto strays =
          reduce_to_host<Strays>(*b_, p.rows(), StrayOfBody{p.bodies, p.body_of_row, to, ways()});
      if (serves(strays)) {
        make(p.barrier);
        return strays;
      }
      s.wanted = 1;
    }
    copy(*b_, from, from_.view());
    copy(*b_, to, to_.view());
    s.steps = 1, goal_ = 1;
    // The next Newton steps are shorter and begin on this way: a part of its length is room for them. On a processor wide lists pay
    // where the search looked at much and found little; a device searches as long whatever it finds.
    const bool is_wide = B::kIsDevice || near_.finds_few();
    const double reach = p.barrier.reach;
    s.room = std::clamp(kRoomOfWay * size, reach, (is_wide ? kMostRoom : 1) * reach);
    make(p.barrier);
    return {size, 0};
  }

  /// State and ways of the list that the next step goes on with, for a run that begins there.
  const NearListState& state() const { return state_; }
  Buffer<B, AffineVec>& from() { return from_; }
  Buffer<B, AffineVec>& to() { return to_; }
  /// The list that these were of.
  void restore(const SurfaceTables<B>& surfaces, const Barrier& barrier,
               const NearListState& state) {
    surfaces_ = &surfaces;
    state_ = state;
    make(barrier);
  }

  /// What making lists took since it was asked last [ms].
  double take_ms() { return std::exchange(ms_, 0); }

 private:
  /// Widest room about ways, and that about ways of several steps [reach].
  static constexpr double kMostRoom = 8, kRoomOfSteps = 4;
  static constexpr double kRoomOfWay =
      B::kIsDevice ? 1 : 0.5;  ///< room about a way, over its length
  static constexpr double kMostSteps = 8;

  void make(const Barrier& barrier) {
    StageClock<B> timer(*b_);
    near_.build(*b_, *surfaces_, from_.view(), to_.view(),
                barrier.reach + barrier.separation + 2 * state_.room);
    ms_ += timer.lap();
  }

  B* b_;
  const SurfaceTables<B>* surfaces_ = nullptr;
  NearPairs<B> near_;
  Buffer<B, AffineVec> from_, to_;  ///< by body
  Span<const AffineVec> v_;         ///< by body, as the step begins
  double h_ = 0;                    ///< of the step [s]
  NearListState state_;
  double goal_ = 1;  ///< time on the ways about which the step ends
  double ms_ = 0;
};

}  // namespace scree::affine
