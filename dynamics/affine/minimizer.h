#pragma once
// Makes the potential of a step of affine bodies least: Newton's method with semidefinite second derivatives, steps that no
// pair of features blocks, and a line search. docs/theory.md, "Barrier contact".
//
// Host reads of an iteration: on a device one where the first try of the step is lower, see find_step(). Else, and elsewhere: the
// number of blocks, the sums of the step, the free share of its way, and the energy of each try.

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "dynamics/affine/block_solver.h"
#include "dynamics/affine/linked_rows.h"
#include "dynamics/affine/near_list.h"
#include "dynamics/affine/slip_damping.h"
#include "dynamics/affine/step_damping.h"
#include "dynamics/affine/system_assembly.h"

namespace scree::affine {

struct MinimizerSettings {
  double tolerance = 0;     ///< largest way of a corner in a Newton step that ends it [m]
  int most_iterations = 0;  ///< of a minimization
  double least_gap = 0;     ///< below which the barrier becomes stiffer while gaps shrink [m]
  bool adapts = true;       ///< whether it may
};

struct MinimizerReport {
  int iterations = 0;         ///< Newton steps
  int linear_iterations = 0;  ///< of the solver of linear systems
  double residual = 0;        ///< way of a corner in the last Newton step [m]
  bool converged = true;
  Index contacts = 0;      ///< pairs that the barrier acts on
  double squared = 1e300;  ///< least squared distance of near pairs [m^2]
  double assembly_ms = 0;  ///< making linear systems
  double linear_ms = 0;    ///< solving them

  void note(const EnergySum& at) {
    contacts = at.contacts;
    squared = at.squared;
  }
};

template <class B>
class Minimizer {
 public:
  /// @param rows   of bodies
  /// @param links  of these to unknowns; without any, they are the unknowns
  Minimizer(B& b, Index bodies, Index rows, const LinkTable& links,
            const std::vector<NodeEquation>& equations)
      : b_(&b),
        solver_(b, links.empty() ? rows : static_cast<Index>(links.used.size()), equations),
        linked_(b, links),
        near_(b, bodies),
        begun_(b, bodies),
        full_(b, bodies),
        middle_(b, bodies),
        trial_(b, bodies),
        assembly_(b, rows, !links.empty()),
        step_(b, rows),
        squared_(b),
        elements_(b),
        share_(b, 1),
        marks_(b),
        mark_(b),
        marked_(b),
        active_(b),
        slips_(b),
        space_(b) {
    if (!equations.empty()) upload(b, row_spaces(rows, equations), space_);
  }

  /// Bodies that rest are where they are in all states.
  void keep_places(Span<const AffineVec> q) {
    copy(*b_, q, full_.view());
    copy(*b_, q, trial_.view());
    copy(*b_, q, middle_.view());
    near_.keep_places(q);
  }

  /// The list of near pairs, for who saves and restores it.
  NearList<B>& near() { return near_; }
  /// Lists near pairs before the first step.
  void begin_at_rest(const SurfaceTables<B>& surfaces, Potential& p) {
    near_.begin_at_rest(surfaces, p.barrier);
    p.near = near_.view();
    p.slips = slips_.view(0);
  }
  /// Near pairs of a step that begins.
  /// @param p     all but its near pairs is set
  /// @param v     by body  @param h  of the step [s]
  /// @param anew  whether bodies are not where the last step left them
  void begin(const SurfaceTables<B>& surfaces, Potential& p, Span<const AffineVec> v, double h,
             bool anew) {
    near_.begin(surfaces, p, v, h, anew);
    p.near = near_.view();
    p.slips = slips_.view(0);
    is_first_ = true;
  }

  /// Distance of the two nearest features of the list [m]; 1e150: it is empty.
  double least_distance(const Potential& p, Span<const AffineVec> q) {
    return std::sqrt(energy(p, q).squared);
  }

  /// First near pair that is no farther apart than a distance; -1: none.
  Index touching(const Potential& p, Span<const AffineVec> q, double distance) {
    const auto pairs = static_cast<Index>(p.near.pairs.size);
    if (pairs == 0) return -1;
    return reduce_to_host<FirstTouch>(*b_, pairs, TouchOfPair{p.near, q, distance * distance}).pair;
  }

  /// Bodies of which a pair of features is within reach in one of two states.
  std::vector<BodyPair> touching_bodies(const Potential& p, Span<const AffineVec> first,
                                        Span<const AffineVec> second) {
    B& b = *b_;
    const auto all = static_cast<Index>(p.near.bodies.size);
    mark_.reserve_discard(all);
    fill(b, mark_.view(all), Index{0});
    for (const Span<const AffineVec>& q : {first, second})
      for_each(b, static_cast<Index>(p.near.pairs.size),
               MarkBodies{p.barrier, p.near, q, mark_.view(all)});
    const std::vector<BodyPair> near = download(b, p.near.bodies);
    const std::vector<Index> mark = download(b, Span<const Index>(mark_.view(all)));
    std::vector<BodyPair> found;
    for (std::size_t k = 0; k < near.size(); ++k)
      if (mark[k] > 0) found.push_back(near[k]);
    return found;
  }

  /// Friction of the contacts of a state, from now on.
  void remember_friction(Potential& p, Span<const AffineVec> q) {
    const Index count = list_active(p, q);
    slips_.reserve_discard(count);
    for_each(*b_, count, RememberSlip{p, q, active_.view(count), slips_.view(count)});
    p.slips = slips_.view(count);
  }

  /// Whether a contact of the friction that is remembered slides, of those that move a body by more than that in the step [m].
  bool slides(const Potential& p, Span<const AffineVec> q, double least) {
    const auto count = static_cast<Index>(p.slips.size);
    if (count == 0) return false;
    return reduce_to_host<Largest<double>>(*b_, count, SpeedOfSlip{p, q, least}).value >= 1;
  }

  /// Moves q to the minimum. @param report  adds to it
  void minimize(Potential& p, Span<AffineVec> q, const MinimizerSettings& settings,
                MinimizerReport& report) {
    copy(*b_, Span<const AffineVec>(q), begun_.view());
    EnergySum at = energy(p, q);
    report.note(at);
    double last_gap = 0, last_size = 0;
    StepDamping damping;
    SlipDamping slip_damping;
    for (int iteration = 0;; ++iteration) {
      p.law.damping = slip_damping.value();
      const NewtonStep found = find_step(p, q, at, damping.value(), iteration, report);
      if (!found.is_there) break;
      const StepSums& sums = found.sums;
      report.residual = sums.size;
      // The last step is taken too: bodies slower than the tolerance move, and free ones exactly.
      // What sticks is stiff: however much a contact lacks to hold, the step of one that sticks is short. Steps out of a barrier, or
      // around in the valley of a stiff body, are short as well, but not shorter than those before. Where each is a share of the
      // one before, all that follow are together shorter than the tolerance.
      const double shrinks = iteration == 0 ? 0 : sums.size / last_size;
      // Steps that are lost in rounding shrink no more.
      const bool are_few = sums.size * shrinks < settings.tolerance * (1 - shrinks) ||
                           -0.5 * sums.slope <= lost_in(at, at);
      bool is_last =
          sums.size < settings.tolerance && sums.stick < kStick && are_few && damping.value() == 0;
      last_size = sums.size;
      if (is_last && sums.size == 0) return;
      if (!is_last && (iteration >= settings.most_iterations || !(sums.size < 1e300))) break;
      ++report.iterations;
      const Way way = go(p, q, at, found);
      if (!(way.share > 0)) {
        if (is_last) return;
        break;
      }
      damping.note(way.share);
      slip_damping.note(way.went_too_far);
      const EnergySum& next = way.end;
      is_last = is_last && is_foreseen(at, next, sums.slope, shrinks);
      copy(*b_, Span<const AffineVec>(trial_.view()), q);
      at = next;
      report.note(at);
      if (is_last) return;
      const double gap = std::sqrt(at.squared) - p.barrier.separation;
      if (settings.adapts && gap < settings.least_gap && last_gap > 0 && gap < last_gap) {
        p.barrier.stiffness *= 2;
        at = energy(p, q);
      }
      last_gap = gap < settings.least_gap ? gap : 0;
    }
    report.converged = false;
  }

  /// What listing near pairs took since it was asked last [ms].
  double take_near_ms() { return near_.take_ms(); }

 private:
  /// Tolerance of conjugate gradients. With 1e-2 for the first system of a step Newton's method takes up to 1.7 times as
  /// many steps, with 1e-9 no fewer.
  static constexpr double kLinearTolerance = 1e-4;
  /// Change of a slip that may stick or slide, over that at which it slides, below which a step may be the last: a contact that is
  /// asked for more than it holds by a share x takes no shorter steps than sqrt(x).
  static constexpr double kStick = 0.05;
  /// Most that the energy may miss what was foreseen of its fall, over that: 0.39 where a step takes a body out of a barrier by its gap.
  static constexpr double kForeseen = 0.25;
  /// Where a bend pays: it is no less than that [reach], the energy falls by less than this part of what was foreseen, and not because
  /// a barrier is near, which leaves a small share of the step.
  static constexpr double kLeastBend = 0.01, kPoor = 0.7, kLeastBentShare = 0.25;
  /// Fall of the energy, over what its slope says, from which on a place is lower. Less would take steps nearly twice as far as the
  /// lowest place, to and fro.
  static constexpr double kLower = 0.1;
  /// Share of a Newton step below which there is no lower place on its way.
  static constexpr double kLeastShare = 1e-12;

  /// Part of the difference of two energies that rounding may be.
  static double lost_in(const EnergySum& before, const EnergySum& after) {
    return before.rounding + after.rounding + 1e-14 * std::abs(before.energy);
  }

  /// What was gone of a Newton step: a share, 0 where there is no lower place on its way, and what is there.
  struct Way {
    double share = 0;
    EnergySum end;
    bool went_too_far = false;  ///< the energy was not lower farther on
  };

  static bool is_lower(const EnergySum& at, const EnergySum& next, double share, double slope) {
    return next.energy <=
           at.energy + kLower * share * slope + 1e-14 * std::abs(at.energy) + at.rounding;
  }

  /// A Newton step, and on a device what is at the end of the share of it that the list of near pairs leaves free: to be thrown away
  /// where that list does not serve.
  struct NewtonStep {
    bool is_there = false;
    StepSums sums;
    std::optional<Way> tried;
  };
  /// What is known of it when the device has come to its end.
  struct StepNotes {
    GradientState linear;
    StepSums sums;
    LeastShare share;
    EnergySum end;
  };

  /// Takes trial_ along a Newton step until it is lower there. @param at  in and out: what is known of the pairs at q
  Way go(Potential& p, Span<const AffineVec> q, EnergySum& at, const NewtonStep& found) {
    const StepSums& sums = found.sums;
    bool may_bend = sums.bend > kLeastBend * p.barrier.reach;
    bool is_tried = found.tried.has_value() && near_.serves(sums.strays);
    Strays strays = list_way(p, q, at, sums.size, sums.strays);
    Way way;
    for (double share = is_tried ? found.tried->share : free_share(p, q); share > kLeastShare;
         share *= 0.5) {
      if (!is_tried) move(p, q, share, trial_.view());
      way.end = is_tried ? found.tried->end : energy(p, trial_.view());
      is_tried = false;
      const double expected = -sums.slope * share * (1 - 0.5 * share);
      const bool is_poor = at.energy - way.end.energy < kPoor * expected - lost_in(at, way.end);
      if (may_bend && is_poor && share > kLeastBentShare) {
        may_bend = false;
        near_.follow(strays, share);
        if (const auto end = bend(p, q, way.end, share, sums.bend);
            end && is_lower(at, *end, share, sums.slope))
          return {share, *end};
        // The list may be that of another way now.
        move(p, q, 1, full_.view());
        strays = renew(p, q, at, sums.size);
        move(p, q, share, trial_.view());
        way.end = energy(p, trial_.view());
      }
      if (is_lower(at, way.end, share, sums.slope)) {
        near_.follow(strays, share);
        way.share = share;
        break;
      }
      way.went_too_far = true;
    }
    return way;
  }

  /// A second way, from where a Newton step has stretched bodies that turn to where they are as large as before. One way instead of
  /// both would make them smaller in between, and what surrounds an axis would be blocked by it.
  /// @param there  what is known of the pairs at trial_, which is where the step has led  @param size  of the bend [m]
  /// @return what is at the end, in trial_, if that is lower
  std::optional<EnergySum> bend(Potential& p, Span<const AffineVec> q, EnergySum there,
                                double share, double size) {
    B& b = *b_;
    copy(b, Span<const AffineVec>(trial_.view()), middle_.view());
    const auto middle = Span<const AffineVec>(middle_.view());
    for_each(b, p.rows(),
             BendWays{p, q, step_.view(), share, space_.view(space_.capacity()), full_.view()});
    const Strays strays = list_way(p, middle, there, size, this->strays(p));
    const double back = free_share(p, middle);
    for_each(b, p.rows(), MovePart{p.body_of_row, middle, full_.view(), back, trial_.view()});
    const EnergySum end = energy(p, trial_.view());
    if (!(end.energy < there.energy)) return std::nullopt;
    near_.follow(strays, back);
    return end;
  }

  /// A list for the way to where full_ is, if that which there is does not serve. @param at  in and out: what is known of the pairs at q
  Strays list_way(Potential& p, Span<const AffineVec> q, EnergySum& at, double size,
                  const Strays& strays) {
    if (!near_.serves(strays)) return renew(p, q, at, size);
    is_first_ = false;
    return strays;
  }
  Strays renew(Potential& p, Span<const AffineVec> q, EnergySum& at, double size) {
    const Strays strays = near_.renew(p, q, full_.view(), size, is_first_);
    is_first_ = false;
    p.near = near_.view();
    at = energy(p, q);
    return strays;
  }
  Strays strays(const Potential& p) {
    return reduce_to_host<Strays>(*b_, p.rows(),
                                  StrayOfBody{p.bodies, p.body_of_row, full_.view(), near_.ways()});
  }

  /// Whether a Newton step lowered the energy by what its system foresaw, or by the more that goes with a curvature of which the
  /// system has too much: with 1 / (1 - x) of it, steps are x times as long as those before, and the energy falls by 1 + x times that.
  /// @param slope    of the energy along the step
  /// @param shrinks  x: length of the step over that of the one before
  static bool is_foreseen(const EnergySum& before, const EnergySum& after, double slope,
                          double shrinks) {
    const double expected = -0.5 * slope, fell = before.energy - after.energy;
    const double few = lost_in(before, after);
    return fell >= (1 - kForeseen) * expected - few &&
           fell <= (1 + shrinks + kForeseen) * expected + few;
  }

  /// Also what the next system and the next way need of the pairs at q.
  EnergySum energy(const Potential& p, Span<const AffineVec> q) {
    const auto pairs = static_cast<Index>(p.near.pairs.size);
    squared_.reserve_discard(pairs), elements_.reserve_discard(pairs);
    return reduce_to_host<EnergySum>(*b_, p.terms(), energy_of_term(p, q));
  }
  EnergyOfTerm energy_of_term(const Potential& p, Span<const AffineVec> q) {
    const Offset pairs = p.near.pairs.size;
    return {p, q, {squared_.view(pairs), elements_.view(pairs)}};
  }
  double free_share(const Potential& p, Span<const AffineVec> q) {
    const auto pairs = static_cast<Index>(p.near.pairs.size);
    if (pairs == 0) return 1;
    return reduce_to_host<LeastShare>(*b_, pairs, share_of_pair(p, q)).value;
  }
  FreeShare share_of_pair(const Potential& p, Span<const AffineVec> q) {
    return {p.near, q, full_.view(), std::as_const(squared_).view(p.near.pairs.size),
            p.barrier.separation};
  }
  MeasureStep measure(const Potential& p, Span<const AffineVec> q, const BlockSystemView& system) {
    return {p, q, step_.view(), system.right, near_.ways(), full_.view()};
  }
  MoveBody part_of_step(const Potential& p, Span<const AffineVec> q, double share,
                        Span<AffineVec> moved) {
    return {p.body_of_row, q, step_.view(), share, moved};
  }
  void move(const Potential& p, Span<const AffineVec> q, double share, Span<AffineVec> moved) {
    for_each(*b_, p.rows(), part_of_step(p, q, share, moved));
  }

  /// The Newton step at q, where energy() was asked last. @param at  what that said; in and out
  NewtonStep find_step(const Potential& p, Span<const AffineVec> q, EnergySum& at, double damping,
                       int iteration, MinimizerReport& report) {
    marks_.clear();
    marks_.mark();
    const BlockSystemView system =
        assembly_.assemble(*b_, p, q, elements_, at.elements, damping, begun_.view(),
                           ExpectedForces::in_step(iteration));
    marks_.mark();
    NewtonStep found;
    bool looks_ahead = false;
    if constexpr (B::kIsDevice) looks_ahead = !linked_.is_on() && !solver_.is_direct();
    if (looks_ahead) {
      found = look_ahead(p, q, system, report);
      if (!found.tried) at = energy(p, q);  // which are those of the try now
    } else {
      found.is_there = solve(system, report);
      reduce<StepSums>(*b_, MeasureStep::items(p), measure(p, q, system),
                       StoreResult<StepSums>{result_place<StepSums>(*b_)});
      marks_.mark();
      found.sums = take_result<StepSums>(*b_);
    }
    report.assembly_ms += marks_.ms(0);
    report.linear_ms += marks_.ms(1);
    return found;
  }

  /// The step, and without a word from the host what mostly comes next.
  NewtonStep look_ahead(const Potential& p, Span<const AffineVec> q, const BlockSystemView& system,
                        MinimizerReport& report) {
    B& b = *b_;
    const auto pairs = static_cast<Index>(p.near.pairs.size);
    auto* const notes = result_place<StepNotes>(b);
    solver_.begin(b, system, step_.view(), kLinearTolerance, &notes->linear);
    reduce<StepSums>(b, MeasureStep::items(p), measure(p, q, system),
                     StoreResult<StepSums>{&notes->sums});
    marks_.mark();
    notes->share = {};
    MoveBody move = part_of_step(p, q, 1, trial_.view());
    if (pairs > 0) {
      reduce<LeastShare>(b, pairs, share_of_pair(p, q), KeepShare{share_.data(), &notes->share});
      move.found = share_.data();
    }
    for_each(b, p.rows(), move);
    reduce<EnergySum>(b, p.terms(), energy_of_term(p, trial_.view()),
                      StoreResult<EnergySum>{&notes->end});
    const StepNotes known = take_result<StepNotes>(b);
    const auto solved = solver_.end(b, system, step_.view(), known.linear);
    report.linear_iterations += solved.iterations;
    if (known.linear.is_done) return {true, known.sums, Way{known.share.value, known.end}};
    return {true, reduce_to_host<StepSums>(b, MeasureStep::items(p), measure(p, q, system)), {}};
  }

  /// @return whether there is a Newton step
  bool solve(const BlockSystemView& system, MinimizerReport& report) {
    typename BlockSolver<B>::Report solved;
    if (linked_.is_on()) {
      solved = solver_.solve(*b_, linked_.carry(*b_, system), linked_.step(), kLinearTolerance);
      linked_.follow(*b_, step_.view());
    } else {
      solved = solver_.solve(*b_, system, step_.view(), kLinearTolerance);
    }
    report.linear_iterations += solved.iterations;
    return solved.is_solved || !solver_.is_direct();
  }

  /// Near pairs that the barrier acts on. @return how many
  Index list_active(const Potential& p, Span<const AffineVec> q) {
    const auto pairs = static_cast<Index>(p.near.pairs.size);
    if (pairs == 0) return 0;
    mark_.reserve_discard(pairs);
    for_each(*b_, pairs, MarkActive{p.barrier, p.near, q, mark_.view(pairs)});
    return marked_.list(*b_, mark_, pairs, active_);
  }

  B* b_;
  BlockSolver<B> solver_;
  LinkedRows<B> linked_;
  NearList<B> near_;
  bool is_first_ = false;  ///< whether the next Newton step is the first of a step
  Buffer<B, AffineVec> begun_, full_, middle_, trial_;  ///< by body
  SystemAssembly<B> assembly_;
  Buffer<B, AffineVec> step_;    ///< by row
  Buffer<B, double> squared_;    ///< of near pairs, as energy() found them
  Buffer<B, Index> elements_;    ///< these too
  Buffer<B, LeastShare> share_;  ///< see look_ahead()
  StageMarks<B> marks_;
  Buffer<B, Index> mark_;
  MarkedList<B> marked_;
  Buffer<B, Index> active_;  ///< near pairs, see remember_friction()
  Buffer<B, Slip> slips_;
  Buffer<B, RowSpace> space_;  ///< by row, see BendWays
};

}  // namespace scree::affine
