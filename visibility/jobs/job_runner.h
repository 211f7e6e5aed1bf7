// Runs stages of independent pieces of work, on the threads of one process or of many, and keeps what is done.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <numeric>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "matrix/base/byte_reader.h"
#include "matrix/base/parallel.h"

namespace vismat {

class PieceStore;

/// Runs stages of independent pieces. A piece's bytes depend on its number and on what earlier stages gave alone, so any
/// number of threads or processes, and any interruption, leaves the same bytes.
class JobRunner {
 public:
  using Piece = std::vector<std::byte>;
  virtual ~JobRunner() = default;

  /// piece(i) for each i in [0, count), in order, on every process. `stage` names the work, once a run. `progress` counts
  /// the pieces that were not stored, over all processes, on the one that leads. An exception on any process ends the
  /// stage on all of them.
  virtual std::vector<Piece> run(const std::string& stage, std::uint64_t count,
                                 const std::function<Piece(std::uint64_t)>& piece,
                                 const Progress& progress = {}) = 0;
  /// The one process that writes the output and talks.
  virtual bool leads() const { return true; }
  /// From now on finished pieces go there, on the process that leads; it must outlive the runs.
  void keep_in(PieceStore& store) { store_ = &store; }

 protected:
  PieceStore* store_ = nullptr;
};

/// A list as bytes: how many items, in 8 bytes, then the items, all in this machine's order of bytes.
template <typename Item>
void put(JobRunner::Piece& piece, std::span<const Item> items) {
  static_assert(std::is_trivially_copyable_v<Item>);
  const std::uint64_t count = items.size();
  for (const std::span<const std::byte> bytes : {std::as_bytes(std::span(&count, 1)), std::as_bytes(items)}) {
    piece.insert(piece.end(), bytes.begin(), bytes.end());
  }
}
/// Takes a list off the front; throws FormatError if it is not whole.
template <typename Item>
std::vector<Item> take(std::span<const std::byte>& bytes) {
  std::uint64_t count = 0;
  if (bytes.size() >= sizeof count) std::memcpy(&count, bytes.data(), sizeof count);
  if (bytes.size() < sizeof count || (bytes.size() - sizeof count) / sizeof(Item) < count) {
    throw FormatError("a piece of work ends too early");
  }
  std::vector<Item> items(count);
  if (count > 0) std::memcpy(items.data(), bytes.data() + sizeof count, count * sizeof(Item));
  bytes = bytes.subspan(sizeof count + count * sizeof(Item));
  return items;
}

/// Where finished pieces outlive the run.
class PieceStore {
 public:
  virtual ~PieceStore() = default;
  /// Puts what is stored of a stage in its places, and returns the numbers of the other pieces, ascending.
  virtual std::vector<std::uint64_t> restore(const std::string& stage,
                                             std::vector<JobRunner::Piece>& pieces) = 0;
  /// May be called by several threads at once.
  virtual void store(const std::string& stage, std::uint64_t number, const JobRunner::Piece& piece) = 0;
};

/// As restore; with no store (null), all the numbers.
inline std::vector<std::uint64_t> missing_pieces(PieceStore* store, const std::string& stage,
                                                 std::vector<JobRunner::Piece>& pieces) {
  if (store != nullptr) return store->restore(stage, pieces);
  std::vector<std::uint64_t> all(pieces.size());
  std::iota(all.begin(), all.end(), std::uint64_t{0});
  return all;
}

/// Progress of at most so many stages one after another, of about as many pieces each.
class ProgressOfRounds {
 public:
  ProgressOfRounds(Progress all, std::uint32_t rounds) : all_(std::move(all)), rounds_(rounds) {}
  Progress round(std::uint32_t round) {
    if (!all_) return {};
    return [this, round](std::uint64_t done, std::uint64_t total) {
      pieces_ = std::max(pieces_, total);
      all_(std::min(round * pieces_ + done, rounds_ * pieces_), rounds_ * pieces_);
    };
  }
  /// The last round is over, perhaps before its time.
  void end() const {
    if (all_) all_(rounds_ * pieces_, rounds_ * pieces_);
  }

 private:
  Progress all_;
  std::uint32_t rounds_;
  std::uint64_t pieces_ = 0;  // of the longest stage so far
};

/// The threads of this process (0: one a core).
class ThreadJobRunner : public JobRunner {
 public:
  explicit ThreadJobRunner(unsigned threads = 0) : threads_(threads) {}
  std::vector<Piece> run(const std::string& stage, std::uint64_t count,
                         const std::function<Piece(std::uint64_t)>& piece,
                         const Progress& progress = {}) override;

 private:
  unsigned threads_;
};

}  // namespace vismat
