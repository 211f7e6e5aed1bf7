// A JobRunner of many processes, by Open MPI: a library of its own, loaded where mpirun started the program, so that nothing
// else needs an MPI to run.
#pragma once
#include "visibility/jobs/job_runner.h"

/// What the library exports: begins MPI, and shares pieces over all ranks as these come free. `threads` on this rank (0:
/// this rank's part of its machine's cores). Rank 0 leads: it alone stores, and it alone tells what went wrong. An
/// exception in a piece ends the run on every rank; a rank that dies is mpirun's to tell, which then ends the others.
/// A piece is below 2 GiB. Must be deleted by the thread that made it, before the program ends; there is one in a run.
/// Throws std::runtime_error if the ranks were started by an MPI of another kind.
extern "C" vismat::JobRunner* vismat_mpi_job_runner(unsigned threads);
