// A JobRunner of several processes, by Open MPI. It is a library of its own, loaded if mpirun started the program, so
// that nothing else needs MPI to run.
#pragma once
#include "visibility/jobs/job_runner.h"

/// The function that the library exports. It starts MPI and returns a runner that shares pieces among all ranks as
/// these become free. `threads` are those of this rank (0: this rank's share of its machine's cores). Rank 0 leads: it
/// alone stores, and it alone reports what went wrong. An exception in a piece ends the run on every rank. If a rank
/// dies, mpirun reports it and ends the others. A piece is below 2 GiB. The runner must be deleted by the thread that
/// made it, before the program ends; there is one in a run. Throws std::runtime_error if the ranks were started by
/// another kind of MPI.
extern "C" vismat::JobRunner* vismat_mpi_job_runner(unsigned threads);
