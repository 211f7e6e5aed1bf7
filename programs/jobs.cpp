// Finds out whether mpirun started the program, and where its results are kept.
#include "programs/jobs.h"

#include <dlfcn.h>

#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include "visibility/jobs/mpi_job_runner.h"

namespace vismat::cli {
namespace {

// Global, since Open MPI loads its own parts, which look for it.
std::unique_ptr<JobRunner> mpi_job_runner(unsigned threads) {
  void* const library = ::dlopen("libvismat_mpi.so", RTLD_NOW | RTLD_GLOBAL);
  void* const function = library == nullptr ? nullptr : ::dlsym(library, "vismat_mpi_job_runner");
  if (function == nullptr) {
    const char* const reason = ::dlerror();
    throw std::runtime_error(
        std::string("mpirun started this vismat, which has no MPI; build it where CMake finds Open MPI (") +
        (reason == nullptr ? "" : reason) + ")");
  }
  return std::unique_ptr<JobRunner>(reinterpret_cast<decltype(&vismat_mpi_job_runner)>(function)(threads));
}

bool started_by_mpirun() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}) {
    if (std::getenv(name) != nullptr) return true;
  }
  return false;
}

}  // namespace

std::unique_ptr<JobRunner> make_job_runner(unsigned threads) {
  if (started_by_mpirun()) return mpi_job_runner(threads);
  return std::make_unique<ThreadJobRunner>(threads);
}

std::unique_ptr<Journal> keep_journal(JobRunner& runner, const std::string& output, const std::string& work) {
  if (!runner.leads()) return nullptr;
  auto journal = std::make_unique<Journal>(output + ".journal", work);
  runner.keep_in(*journal);
  if (journal->found() > 0) {
    std::fprintf(stderr, "%s.journal: going on after %llu pieces of work\n", output.c_str(),
                 static_cast<unsigned long long>(journal->found()));
  }
  return journal;
}

}  // namespace vismat::cli
