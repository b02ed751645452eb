#pragma once
// The tuned programs of APGD in float on a GPU. They are large, and several units launch them: apgd_programs.cu compiles them
// for all, and hands out what cudaLaunchCooperativeKernel() takes.

#include "kernels/contact/contact_fields.h"

namespace scree::apgd_sweep {

/// What contacts obey.
enum class Law {
  convex,   ///< the cone program
  coulomb,  ///< exact friction, see ApgdContactStep
  impact    ///< cones cut off below a least normal impulse, see ImpactRows
};

/// run_resident_trials (apgd_resident.cuh). Impacts have no general layout.
/// @param has_own  contacts may have OwnValues
const void* resident_program(ContactLayout layout, Law law, bool has_own);

/// run_trials (apgd_sweep.cuh).
/// @param weights  of the metric that are stored for each contact: 0, 1 or 2
const void* sweep_program(int weights, Law law, bool is_mixed);
/// The same of ranks that meet in it, by the cone program. @param weights  1 or 2
const void* sweep_program_over_ranks(int weights, bool is_mixed);

}  // namespace scree::apgd_sweep
