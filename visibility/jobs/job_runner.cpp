// Pieces of work on the threads of this process.
#include "visibility/jobs/job_runner.h"

namespace vismat {

std::vector<JobRunner::Piece> ThreadJobRunner::run(const std::string& stage, std::uint64_t count,
                                                   const std::function<Piece(std::uint64_t)>& piece,
                                                   const Progress& progress) {
  std::vector<Piece> pieces(count);
  const std::vector<std::uint64_t> missing = missing_pieces(store_, stage, pieces);
  const auto work = [&](std::uint64_t i) {
    const std::uint64_t number = missing[i];
    pieces[number] = piece(number);
    if (store_ != nullptr) store_->store(stage, number, pieces[number]);
  };
  parallel_for(missing.size(), threads_, work, progress);
  return pieces;
}

}  // namespace vismat
