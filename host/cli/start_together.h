#pragma once
// Commands that one launcher started several times: rank 0 speaks for all.

#include <functional>

#include "host/ranks/agreement.h"

namespace scree {

/// Prepares each rank, which may throw, and lets all of them start or none. Rank 0 says why not.
/// @param prepare  fills in what the report tells of the scene
/// @return the exit code that all end with, 0: they start
int start_together(Ranks& ranks, const std::function<void(RankReport& report)>& prepare);

/// The command line of this process is wrong, and maybe that of others in its launch: one of them says so.
/// @return exit code
int fail_together(const std::string& what);

}  // namespace scree
