// What a verb that may take hours runs on: threads or the ranks of mpirun, and a journal beside the output.
#pragma once
#include <memory>
#include <string>

#include "visibility/jobs/job_runner.h"
#include "visibility/jobs/journal.h"

namespace vismat::cli {

/// Under Open MPI's mpirun its ranks, else this process; `threads` each, 0: all cores shared out. Call it before anything
/// that may fail, since an error that all ranks meet while they have a JobRunner is told once. Throws std::runtime_error where
/// mpirun started a vismat that was built without MPI.
std::unique_ptr<JobRunner> make_job_runner(unsigned threads);

/// Keeps what the runner does in OUTPUT.journal, bound to `work` (see Journal, which throws), and says on stderr if an earlier
/// run left something there. Null on a process that does not lead. The caller removes it once the output is written.
std::unique_ptr<Journal> keep_journal(JobRunner& runner, const std::string& output, const std::string& work);

}  // namespace vismat::cli
