#pragma once
// Methods for problems with rolling friction in the variables of scaled().

#include <vector>

#include "solvers/rolling/rolling_monitor.h"

namespace scree {

/// Block Gauss-Seidel until the phase ends. Each contact solves its own problem of five rows by
/// inner steps: projected on the cone for the convex model; for the exact one normal, friction and
/// rolling moment by turns, each within what the normal impulse allows, whose fixed points satisfy
/// the law without a lift. Memory passes over W: one a sweep.
/// Source: Jourdan, Alart & Jean, CMAME 155, 1998; the inner steps as Alart & Curnier,
/// CMAME 92, 1991.
/// @param x  in: any values; out: the last iterate
void run_rolling_sweeps(const RollingProblem& p, AssembledModel model, std::vector<double>& x,
                        RollingMonitor& monitor);

/// Accelerated projected gradient with backtracking and restarts until the phase ends;
/// for the exact model around it the De Saxce fixed point, whose lift follows when the inner
/// residual is a tenth of the outer one. One product with W an iteration.
/// Source: Mazhar et al., ACM TOG 34(3), 2015; O'Donoghue & Candes, Found. Comput. Math. 15, 2015.
void run_rolling_apgd(const RollingProblem& p, AssembledModel model, std::vector<double>& x,
                      RollingMonitor& monitor);

/// Proximal points around semi-smooth Newton steps with a line search and sparse factors, until the
/// phase ends or Newton's method fails at the largest weight. For the exact model the steps are
/// those of Alart & Curnier. An iteration is an outer one.
/// Source: Alart & Curnier, CMAME 92, 1991; proximal points as `proximal` of three rows.
void run_rolling_proximal(const RollingProblem& p, AssembledModel model, std::vector<double>& x,
                          RollingMonitor& monitor);

}  // namespace scree
