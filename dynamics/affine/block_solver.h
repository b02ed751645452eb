#pragma once
// Solves the linear system of a Newton step: on the CPU by a sparse factorization, on a device by conjugate gradients, or by the
// factorization too where equations hold two bodies together, or where gradients take long.

#include <algorithm>
#include <utility>

#include "dynamics/affine/direct_blocks.h"
#include "kernels/affine/gradient_iteration.h"

namespace scree::affine {

enum class LinearMethod : std::uint8_t { standard, direct, gradients };

template <class B>
class BlockSolver {
 public:
  struct Report {
    bool is_solved = true;
    int iterations = 1;  ///< of conjugate gradients; 1 of a factorization
  };

  /// @param equations  that all steps keep
  BlockSolver(B& b, Index rows, const std::vector<NodeEquation>& equations,
              LinearMethod method = LinearMethod::standard)
      : rows_(rows),
        method_(method),
        is_direct_(takes_factors(equations, method)),
        direct_(rows, equations),
        space_(b),
        diagonal_(b),
        right_(b),
        mixed_(b),
        inverse_(b),
        r_(b),
        z_(b),
        p_(b),
        next_p_(b),
        image_(b),
        key_(b),
        entry_(b),
        begin_(b),
        sort_(b),
        gradients_(b) {
    if (is_direct_) return;
    has_spaces_ = !equations.empty();
    if (has_spaces_) upload(b, row_spaces(rows, equations), space_);
    for (Buffer<B, AffineVec>* v : {&r_, &z_, &p_, &next_p_, &image_}) v->reserve_discard(rows);
    inverse_.reserve_discard(rows);
    begin_.reserve_discard(static_cast<Offset>(rows) + 1);
  }

  bool is_direct() const { return is_direct_; }

  /// @param step       out, by row
  /// @param tolerance  of conjugate gradients: of the residual in the norm of the preconditioner, over that of the right-hand side
  Report solve(B& b, const BlockSystemView& system, Span<AffineVec> step, double tolerance) {
    if (is_direct_) return factorize(b, system, step);
    begin(b, system, step, tolerance, result_place<GradientState>(b));
    return end(b, system, step, take_result<GradientState>(b));
  }

  /// The same in two parts, but for factors: work that needs no host may follow the first.
  /// @param state  how it ended, once the backend has been waited for: the host gives it to end()
  void begin(B& b, const BlockSystemView& system, Span<AffineVec> step, double tolerance,
             GradientState* state) {
    const Span<const RowSpace> space = space_.view(has_spaces_ ? rows_ : 0);
    const BlockSystemView own = has_spaces_ ? restrict_system(b, system) : system;
    if (gradients_.wants_inverse(rows_))
      for_each(b, 12 * rows_, InvertRow{own.diagonal, space, inverse_.view()});
    const GradientVectors v{
        step,          r_.view(),    z_.view(),       p_.view(),           next_p_.view(),
        image_.view(), own.diagonal, inverse_.view(), list_blocks(b, own), nullptr};
    gradients_.run(b, v, own.right, tolerance, may_factorize() ? kFewIterations : kMostIterations,
                   state);
    if (has_spaces_) for_each(b, rows_, ExpandRow{space, step});
  }
  /// Another step, where gradients took too long.
  Report end(B& b, const BlockSystemView& system, Span<AffineVec> step,
             const GradientState& state) {
    if (state.is_done || !may_factorize()) return {state.is_done, state.iterations};
    Report report = factorize(b, system, step);
    report.iterations += state.iterations;
    return report;
  }

 private:
  /// Iterations of conjugate gradients. Chains and arches of bodies take thousands, in which time the host factorizes systems of
  /// few rows several times.
  static constexpr int kMostIterations = 4000, kFewIterations = 400;
  static constexpr Index kMostFactorized = 4096;  ///< rows

  static bool takes_factors(const std::vector<NodeEquation>& equations, LinearMethod method) {
    if (method != LinearMethod::standard) return method == LinearMethod::direct;
    return !B::kIsDevice || std::any_of(equations.begin(), equations.end(),
                                        [](const NodeEquation& e) { return e.row[1] >= 0; });
  }

  Report factorize(B& b, const BlockSystemView& system, Span<AffineVec> step) {
    Report report;
    if constexpr (B::kIsDevice) {
      const std::vector<Dense<12>> diagonal = download(b, system.diagonal);
      const std::vector<MixedBlock> mixed = download(b, listed_blocks(b, system));
      const std::vector<AffineVec> right = download(b, system.right);
      std::vector<AffineVec> x(static_cast<std::size_t>(rows_));
      report.is_solved = direct_.solve(
          {{diagonal.data(), rows_}, {mixed.data(), std::ssize(mixed)}, {right.data(), rows_}},
          {x.data(), rows_});
      upload(b, x.data(), step);
    } else {
      report.is_solved = direct_.solve(system, step);
    }
    return report;
  }

  Span<const MixedBlock> listed_blocks(B& b, const BlockSystemView& system) {
    const BlockHalves& halves = system.halves;
    if (halves.begin.empty()) return system.mixed;
    return system.mixed.first(fetch(b, halves.begin.data + rows_) / 2);
  }

  bool may_factorize() const {
    return rows_ <= kMostFactorized && method_ == LinearMethod::standard;
  }

  /// The system in the numbers that equations leave to the rows.
  BlockSystemView restrict_system(B& b, const BlockSystemView& s) {
    const auto blocks = static_cast<Index>(s.mixed.size);
    diagonal_.reserve_discard(rows_), right_.reserve_discard(rows_);
    mixed_.reserve_discard(blocks);
    const Span<const RowSpace> space = space_.view(rows_);
    for_each(b, rows_,
             RestrictRow{space, s.diagonal, s.right, diagonal_.view(rows_), right_.view(rows_)});
    for_each(b, blocks, RestrictMixed{space, s.mixed, mixed_.view(blocks)});
    return {std::as_const(diagonal_).view(rows_), std::as_const(mixed_).view(blocks),
            std::as_const(right_).view(rows_), s.halves};
  }

  BlockLists list_blocks(B& b, const BlockSystemView& system) {
    if (const BlockHalves& halves = system.halves; !halves.begin.empty())
      return {system.mixed, halves.entry, halves.begin};
    const auto entries = static_cast<Index>(2 * system.mixed.size);
    const EntryKeys keys{static_cast<std::uint64_t>(rows_)};
    key_.reserve_discard(entries), entry_.reserve_discard(entries);
    for_each(b, entries, NameHalves{keys, system.mixed, key_.view(entries), entry_.view(entries)});
    sort_pairs(b, sort_, key_.view(entries), entry_.view(entries), bits_for(keys.none() + 1));
    for_each(b, rows_ + 1, FindRows{keys, key_.view(entries), begin_.view()});
    return {system.mixed, entry_.view(entries), begin_.view()};
  }

  Index rows_;
  LinearMethod method_;
  bool is_direct_;
  bool has_spaces_ = false;
  DirectBlocks direct_;
  Buffer<B, RowSpace> space_;
  Buffer<B, Dense<12>> diagonal_;  ///< this and the next two: of restrict_system
  Buffer<B, AffineVec> right_;
  Buffer<B, MixedBlock> mixed_;
  Buffer<B, Dense<12>> inverse_;
  Buffer<B, AffineVec> r_, z_, p_, next_p_, image_;
  Buffer<B, std::uint64_t> key_;
  Buffer<B, Index> entry_, begin_;
  SortSpace<B> sort_;
  GradientIteration<B> gradients_;
};

}  // namespace scree::affine
