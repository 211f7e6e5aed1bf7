// A journal: finished pieces of work in a file beside the output, from which a run that was killed is continued.
#pragma once
#include <filesystem>
#include <map>
#include <mutex>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "visibility/jobs/job_runner.h"

namespace vismat {

/// A file to which pieces are appended as they are finished. Whatever ends the run (kill -9, a full disk), the next run
/// finds all pieces that were stored; an incomplete last one is cut off. A file whose work did not begin is removed
/// at the end, and one without pieces stands in the way of no other work. Only one process at a time may use it.
class Journal : public PieceStore {
 public:
  /// Begins the file, or continues it. `work` describes all that the pieces depend on: inputs with their checksums,
  /// options. Throws std::invalid_argument if the file holds pieces of other work (it tells what differs), is no
  /// regular file, or another process has it open, FormatError if
  /// it is no journal, std::runtime_error if it cannot be written; the file then stays as it is.
  Journal(std::filesystem::path path, const std::string& work);
  ~Journal() override;
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// Throws std::logic_error if a stage is asked for twice: its pieces would be mixed up.
  std::vector<std::uint64_t> restore(const std::string& stage,
                                     std::vector<JobRunner::Piece>& pieces) override;
  /// Throws std::runtime_error if the disk is full; what was stored before stays valid.
  void store(const std::string& stage, std::uint64_t number, const JobRunner::Piece& piece) override;
  /// The number of pieces that earlier runs left.
  std::uint64_t found() const { return found_; }
  /// Whether it holds no piece yet; not while others store.
  bool empty() const { return end_ == head_end_; }
  /// Deletes the file, when the work is done and written elsewhere.
  void remove();

 private:
  bool lock();
  void begin_or_read(const std::string& work);
  void append(std::span<const std::byte> bytes);
  void close();

  std::filesystem::path path_;
  int file_ = -1;
  bool removed_ = false;
  std::uint64_t end_ = 0, head_end_ = 0, found_ = 0;
  std::span<const std::byte> mapped_;  // what earlier runs left
  std::map<std::string, std::vector<std::pair<std::uint64_t, std::span<const std::byte>>>, std::less<>> left_;
  std::set<std::string> begun_;
  std::mutex mutex_;  // guards the file and end_
};

/// What a journal's bytes hold. Complete records from the start count; what follows the first incomplete or damaged one
/// does not.
struct JournalContents {
  struct Record {
    std::string_view stage;
    std::uint64_t number = 0;
    std::span<const std::byte> piece;
  };
  std::string_view work;
  std::vector<Record> records;  // all borrow from the bytes
  std::size_t end = 0;          // of the last complete record
};
/// Throws FormatError unless the bytes begin with a journal's head.
JournalContents read_journal(std::span<const std::byte> bytes);
std::vector<std::byte> journal_head(std::string_view work);
std::vector<std::byte> journal_record(const JournalContents::Record& record);

}  // namespace vismat
