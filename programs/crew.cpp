#include "programs/crew.h"

#include <dlfcn.h>

#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include "visibility/jobs/mpi_crew.h"

namespace vismat::cli {
namespace {

// Global, since Open MPI loads its own parts, which look for it.
std::unique_ptr<Crew> mpi_crew(unsigned threads) {
  void* const library = ::dlopen("libvismat_mpi.so", RTLD_NOW | RTLD_GLOBAL);
  void* const function = library == nullptr ? nullptr : ::dlsym(library, "vismat_mpi_crew");
  if (function == nullptr) {
    const char* const reason = ::dlerror();
    throw std::runtime_error(
        std::string("mpirun started this vismat, which has no MPI; build it where CMake finds Open MPI (") +
        (reason == nullptr ? "" : reason) + ")");
  }
  return std::unique_ptr<Crew>(reinterpret_cast<decltype(&vismat_mpi_crew)>(function)(threads));
}

bool started_by_mpirun() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}) {
    if (std::getenv(name) != nullptr) return true;
  }
  return false;
}

}  // namespace

std::unique_ptr<Crew> make_crew(unsigned threads) {
  if (started_by_mpirun()) return mpi_crew(threads);
  return std::make_unique<ThreadCrew>(threads);
}

std::unique_ptr<Journal> keep_journal(Crew& crew, const std::string& output, const std::string& work) {
  if (!crew.leads()) return nullptr;
  auto journal = std::make_unique<Journal>(output + ".journal", work);
  crew.keep_in(*journal);
  if (journal->found() > 0) {
    std::fprintf(stderr, "%s.journal: going on after %llu pieces of work\n", output.c_str(),
                 static_cast<unsigned long long>(journal->found()));
  }
  return journal;
}

}  // namespace vismat::cli
