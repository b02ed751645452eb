// In place of mpi_ranks.cpp in builds without MPI.
#include "host/error.h"
#include "host/ranks/launch.h"
#include "host/ranks/mpi_ranks.h"

namespace scree {

std::shared_ptr<Ranks> mpi_ranks() {
  const Launch launch = launch_of_environment();
  if (launch.count == 1) return nullptr;
  const std::string count = launch.count > 0 ? std::to_string(launch.count) : "several";
  throw InputError("started as " + count +
                   " processes, but this scree was built without MPI and runs as one; build it "
                   "with MPI (Debian and Ubuntu packages libopenmpi-dev and openmpi-bin)");
}

LocalRank local_rank(const Ranks& ranks) { return {ranks.rank(), ranks.count()}; }

void set_before_abort(Ranks&, std::function<void(const std::string&)>) {}

std::string mpi_version() { return {}; }

}  // namespace scree
