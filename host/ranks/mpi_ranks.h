#pragma once
// Ranks that are processes of one launch by MPI: mpirun -n 4 scree run SCENE. The only part of scree that knows MPI.

#include <functional>
#include <memory>
#include <string>

#include "kernels/backend/ranks.h"

namespace scree {

/// The ranks of this launch, a collective call that each process makes once. MPI is started unless the program has done so,
/// and ended with the last copy. Null when no launcher started this process, or it alone.
/// @throws InputError when a launcher started several, and this build has no MPI or another one than the launcher
/// @throws RunError naming the call of MPI that failed
std::shared_ptr<Ranks> mpi_ranks();

/// Of the ranks on the host of this one.
struct LocalRank {
  int rank = 0;   ///< number of this one among them, from 0
  int count = 1;  ///< how many they are
};
/// Ranks that MPI does not connect are on one host.
LocalRank local_rank(const Ranks& ranks);

/// What this rank does when it ends all, see Ranks::abort(), before they end: the text is the one that is told. What it throws is
/// lost. Empty: nothing. Ranks that MPI does not connect do not call it.
void set_before_abort(Ranks& ranks, std::function<void(const std::string& text)> act);

/// Name and version of the library, "Open MPI 4.1.4"; empty: built without.
std::string mpi_version();

}  // namespace scree
