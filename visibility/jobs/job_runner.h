// Runs stages of independent pieces of work, on the threads of one process or of several, and keeps finished pieces.
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

/// Runs stages of independent pieces. A piece's bytes depend only on its number and on the results of earlier stages,
/// so any number of threads or processes, and any interruption, leads to the same bytes.
class JobRunner {
 public:
  using Piece = std::vector<std::byte>;
  virtual ~JobRunner() = default;

  /// Returns piece(i) for each i in [0, count), in order, on every process. `stage` names the work and is used once in
  /// a run. `progress`, on the process that leads, counts the pieces of all processes that were not stored before. An
  /// exception on any process ends the stage on all of them.
  virtual std::vector<Piece> run(const std::string& stage, std::uint64_t count,
                                 const std::function<Piece(std::uint64_t)>& piece,
                                 const Progress& progress = {}) = 0;
  /// Whether this is the one process that writes the output and prints messages.
  virtual bool leads() const { return true; }
  /// From now on the process that leads stores finished pieces there; the store must outlive the runs.
  void keep_in(PieceStore& store) { store_ = &store; }

 protected:
  PieceStore* store_ = nullptr;
};

/// Appends a list as bytes: the number of its items, in 8 bytes, then the items, all in this machine's byte order.
template <typename Item>
void put(JobRunner::Piece& piece, std::span<const Item> items) {
  static_assert(std::is_trivially_copyable_v<Item>);
  const std::uint64_t count = items.size();
  for (const std::span<const std::byte> bytes : {std::as_bytes(std::span(&count, 1)), std::as_bytes(items)}) {
    piece.insert(piece.end(), bytes.begin(), bytes.end());
  }
}
/// Removes a list from the front and returns it; throws FormatError if it is not complete.
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

/// A place where finished pieces outlive the run.
class PieceStore {
 public:
  virtual ~PieceStore() = default;
  /// Fills in the pieces of the stage that are stored, and returns the numbers of the others, ascending.
  virtual std::vector<std::uint64_t> restore(const std::string& stage,
                                             std::vector<JobRunner::Piece>& pieces) = 0;
  /// May be called by several threads at once.
  virtual void store(const std::string& stage, std::uint64_t number, const JobRunner::Piece& piece) = 0;
};

/// Like restore(); without a store it returns all numbers.
inline std::vector<std::uint64_t> missing_pieces(PieceStore* store, const std::string& stage,
                                                 std::vector<JobRunner::Piece>& pieces) {
  if (store != nullptr) return store->restore(stage, pieces);
  std::vector<std::uint64_t> all(pieces.size());
  std::iota(all.begin(), all.end(), std::uint64_t{0});
  return all;
}

/// The progress of at most `rounds` stages, one after another, of about as many pieces each.
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
  /// Reports that the last round is over, perhaps before all rounds were needed.
  void end() const {
    if (all_) all_(rounds_ * pieces_, rounds_ * pieces_);
  }

 private:
  Progress all_;
  std::uint32_t rounds_;
  std::uint64_t pieces_ = 0;  // of the longest stage so far
};

/// Runs pieces on the threads of this process (0: one for each core).
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
