#include "visibility/crew.h"

namespace vismat {

std::vector<Crew::Piece> ThreadCrew::run(const std::string&, std::uint64_t count,
                                         const std::function<Piece(std::uint64_t)>& piece,
                                         const Progress& progress) {
  std::vector<Piece> pieces(count);
  parallel_for(
      count, threads_, [&](std::uint64_t i) { pieces[i] = piece(i); }, progress);
  return pieces;
}

}  // namespace vismat
