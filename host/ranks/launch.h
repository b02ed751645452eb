#pragma once
// What a launcher of MPI programs (mpirun, mpiexec, srun) tells each process before MPI is asked.

namespace scree {

struct Launch {
  int rank = 0;
  int count = 1;  ///< processes of the launch; 0: the launcher does not say
};

/// By the environment variables of Open MPI, MPICH and Slurm; a process that none of them started is alone.
Launch launch_of_environment();

}  // namespace scree
