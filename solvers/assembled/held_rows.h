#pragma once
// Bilateral rows beside the contacts of an assembled problem, as joints have them.
//
//   u = W r + V l + q,   0 = V^T r + R l + s,   R symmetric positive semidefinite
//
// l may have any sign, so it follows from r: l = -R^-1 (V^T r + s). Solvers see the problem in r
// alone, with W' = W - V R^-1 V^T and q' = q - V R^-1 s, and W' is never formed, as it couples all
// contacts that rows connect: products take a solve with sparse factors of R, and what is
// factorized for W' is [W V; V^T R]. Both grow with the number of rows for chains and trees.
//
// Rows that depend on others are left out: their impulse is zero, and where they do not contradict
// the others they are fulfilled with them.

#include <memory>
#include <utility>
#include <vector>

#include "solvers/assembled/semidefinite_factor.h"

namespace scree {

struct AssembledProblem;

/// An entry of V.
struct HeldEntry {
  int row = 0;   ///< of the contacts, three each
  int held = 0;  ///< bilateral row
  double value = 0;
};

class HeldRows {
 public:
  /// @param contact_rows  three a contact
  /// @param loads         the largest |q|, which contradictions are measured against [m/s]
  HeldRows(int contact_rows, const std::vector<HeldEntry>& V, SymmetricRows R,
           std::vector<double> s, double loads);

  int row_count() const { return system_->R.size(); }
  /// Rows left out as they depend on others.
  int dependent_count() const {
    return row_count() - static_cast<int>(system_->factor.kept().size());
  }
  /// Whether R is positive semidefinite, and rows that depend on others in R do so in V, to rounding:
  /// else [W V; V^T R] is not semidefinite, and nothing else here means anything.
  bool is_semidefinite() const { return system_->is_semidefinite; }

  /// Whether no impulses fulfill all rows: some that depend on others ask for another velocity.
  bool contradict() const { return system_->left > 0; }
  /// Norm of the velocities that rows are left with then, zero otherwise [m/s].
  double left() const { return system_->left; }
  /// The row that is left with most of it.
  int worst_row() const { return system_->worst_row; }

  /// V R^-1 V^T x. @param x  [contact_rows]
  std::vector<double> change(const std::vector<double>& x) const;
  /// V R^-1 s [contact_rows]: q' = q - that
  std::vector<double> load() const;
  /// l of impulses at contacts [row_count].
  std::vector<double> impulses(const std::vector<double>& r) const;

  /// Entries of V, by contact row.
  template <class F>
  void each_entry(F f) const {
    for (std::size_t row = 0; row + 1 < start_.size(); ++row)
      for (int k = start_[row]; k < start_[row + 1]; ++k)
        f(static_cast<int>(row), held_[k], value_[k]);
  }
  const SymmetricRows& R() const { return system_->R; }
  const std::vector<int>& kept() const { return system_->factor.kept(); }

  /// The same rows with those of V multiplied by factors [contact_rows].
  std::shared_ptr<const HeldRows> scaled(const std::vector<double>& factor) const;

 private:
  /// What does not change when V is scaled.
  struct System {
    System(SymmetricRows rows, std::vector<double> loads)
        : R(std::move(rows)), s(std::move(loads)), factor(R) {}
    SymmetricRows R;
    std::vector<double> s;
    SemidefiniteFactor factor;
    bool is_semidefinite = true;
    double left = 0;
    int worst_row = -1;
  };

  /// V^T x. @return [row_count]
  std::vector<double> transposed(const std::vector<double>& x) const;
  /// sign R^-1 b of the rows that are kept, zero in others. @return [row_count]
  std::vector<double> solved(std::vector<double> b, double sign = 1) const;
  /// V l. @return [contact_rows]
  std::vector<double> times(const std::vector<double>& l) const;

  std::shared_ptr<const System> system_;
  std::vector<int> start_, held_;  ///< V in compressed rows
  std::vector<double> value_;
};

/// [W V; V^T R] of a problem with held rows as if these, in threes behind the contacts, were contacts
/// too. Rows left out are not there; what is missing to three has ones on the diagonal. Blocks of W
/// keep their order within a row. q is zero behind that of the contacts. Without held rows the
/// problem itself.
AssembledProblem bordered(const AssembledProblem& p);

}  // namespace scree
