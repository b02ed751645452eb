#pragma once
// Before ranks start: whether all of them can, and have the same program and scene.

#include <string>

#include "kernels/backend/ranks.h"

namespace scree {

/// What a rank has to say.
struct RankReport {
  int code = 0;            ///< exit code that it would end with; 0: it can start
  std::string error;       ///< why it cannot
  std::string program;     ///< version and commit
  std::string scene;       ///< text of the scene, overrides applied; empty when it cannot start
  std::string arithmetic;  ///< backend, precision and transport; empty when it cannot start
  std::string folder;      ///< where it writes; empty: nowhere
};

/// What all do, the same on all.
struct Agreement {
  int code = 0;         ///< exit code that all end with; 0: they start
  std::string message;  ///< the one thing to tell
};

/// A collective call. Told is the lowest rank that has another program than rank 0, else that cannot start, else that has
/// another scene, arithmetic or folder. It is named unless all ranks have the same error. What differs is bad input, code 2.
Agreement agree(Ranks& ranks, const RankReport& own);

}  // namespace scree
