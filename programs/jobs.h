// The job runner and the journal of verbs that may take hours.
#pragma once
#include <memory>
#include <string>

#include "visibility/jobs/job_runner.h"
#include "visibility/jobs/journal.h"

namespace vismat::cli {

/// Makes a runner that uses the ranks of Open MPI's mpirun if there are any, otherwise this process alone. Each process
/// runs `threads` threads; 0 divides all cores among the processes. Call it before anything that may fail, since an
/// error that all ranks meet while they have a JobRunner is reported once. Throws std::runtime_error if mpirun started
/// a vismat that was built without MPI.
std::unique_ptr<JobRunner> make_job_runner(unsigned threads);

/// Makes the runner keep finished work in OUTPUT.journal, which belongs to `work` alone (see Journal, which throws),
/// and says on stderr if an earlier run left something there. Null on a process that does not lead. The caller removes
/// the journal once the output is written.
std::unique_ptr<Journal> keep_journal(JobRunner& runner, const std::string& output, const std::string& work);

}  // namespace vismat::cli
