// Files that appear under their final name completely or not at all.
#pragma once
#include <array>
#include <cstddef>
#include <filesystem>
#include <ostream>
#include <span>
#include <streambuf>
#include <vector>

namespace vismat {

/// What the name of an output leads to.
struct OutputTarget {
  enum class Kind { nothing, file, folder, device };  // device: a pipe, a socket or an open descriptor, too
  Kind kind = Kind::nothing;
  std::filesystem::path path;  // with symbolic links followed, also to what does not exist yet
  int descriptor = -1;         // of this process, where the name is one of it, such as /dev/stdout
};
/// Throws std::runtime_error if links lead in a circle.
OutputTarget output_target(const std::filesystem::path& path);

/// A file that is being written. After commit() the finished file stands under its final name, in one step. Without
/// commit (after an exception, or Ctrl-C, see remove_partial_files) the partial file is removed and what stood there
/// before stays. A symbolic link stays one, and its target is replaced; a file that is replaced gives its rights and
/// owner to the new one. Devices, pipes and descriptors are not replaced: bytes go straight into them. Any number of
/// processes may write the same file at once; the last to commit wins.
class AtomicFile {
 public:
  /// in_order: by write(). by_name: by whoever opens partial_path(), and seeks there, which a device cannot do.
  enum class Written { in_order, by_name };

  /// Throws std::runtime_error if the folder does not exist or may not be written to, or if what stands there is a
  /// folder, a file that may not be written, or a device while `written` is by_name.
  explicit AtomicFile(std::filesystem::path path, Written written = Written::in_order);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Throws std::runtime_error naming the file and the system's reason.
  void write(std::span<const std::byte> bytes);
  /// Empty while the partial file has no name, as files written in order have none where the disk can do that.
  const std::filesystem::path& partial_path() const { return partial_; }
  void commit();  // throws std::runtime_error if the file cannot be closed or take its final name

 private:
  void open_partial(Written written);
  bool open_nameless();
  void open_named();
  void take_rights_of_the_old();
  void new_partial_name();
  void release_slot();
  [[noreturn]] void fail(const char* what, int error) const;

  std::filesystem::path given_, final_, partial_;
  bool device_ = false;
  int file_ = -1;
  int slot_ = -1;  // in the list that remove_partial_files walks
};

/// A stream into an AtomicFile, which throws what write() throws. Flush it before commit().
class AtomicFileStream : public std::ostream {
 public:
  explicit AtomicFileStream(AtomicFile& file);

 private:
  class Buffer : public std::streambuf {
   public:
    explicit Buffer(AtomicFile& file);

   private:
    int_type overflow(int_type next) override;
    int sync() override;
    AtomicFile& file_;
    std::array<char, 1 << 16> bytes_;
  };
  Buffer buffer_;
};

/// Removes every partial file that is open now. It is async-signal-safe, so a handler of SIGINT may call it before
/// _exit.
void remove_partial_files() noexcept;

/// Reads the whole file. Throws std::runtime_error naming the path and the system's reason.
std::vector<std::byte> read_file(const std::filesystem::path& path);
/// Writes the whole file by way of an AtomicFile.
void write_file(const std::filesystem::path& path, std::span<const std::byte> bytes);

}  // namespace vismat
