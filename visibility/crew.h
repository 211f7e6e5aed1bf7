// Who does the work: the threads of one process, or those of many.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "matrix/parallel.h"

namespace vismat {

/// Runs stages of independent pieces. A piece's bytes depend on its number and on what earlier stages gave alone, so any
/// number of threads or processes, and any interruption, leaves the same bytes.
class Crew {
 public:
  using Piece = std::vector<std::byte>;
  virtual ~Crew() = default;

  /// piece(i) for each i in [0, count), in order, on every process. `stage` names the work, once a run.
  virtual std::vector<Piece> run(const std::string& stage, std::uint64_t count,
                                 const std::function<Piece(std::uint64_t)>& piece,
                                 const Progress& progress = {}) = 0;
};

/// Lists of ids as bytes: their number, then each as 4 bytes, in this machine's order of bytes.
void put_ids(Crew::Piece& piece, std::span<const std::uint32_t> ids);
/// Takes one off the front; throws FormatError if it is not whole.
std::vector<std::uint32_t> take_ids(std::span<const std::byte>& bytes);

/// The threads of this process (0: one a core); nothing is stored.
class ThreadCrew : public Crew {
 public:
  explicit ThreadCrew(unsigned threads = 0) : threads_(threads) {}
  std::vector<Piece> run(const std::string& stage, std::uint64_t count,
                         const std::function<Piece(std::uint64_t)>& piece,
                         const Progress& progress = {}) override;

 private:
  unsigned threads_;
};

}  // namespace vismat
