// Reads HDF5 in the process that calls it: Hdf5File runs this inside its child process. Private to matrix/files/.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace vismat {

/// The type in which an array is wanted. `truth` gives a u8 for each entry: 1 if it is anything but zero (NaN is),
/// otherwise 0.
enum class Hdf5Number : std::uint32_t { u8, u32, u64, f32, truth };

/// Reads one file. Before it lets the HDF5 library follow a pointer it checks whatever the library can be asked: there
/// may be only hard links, simple dataspaces, integers and floats of at most 8 bytes, contiguous, compact or chunked
/// storage that is all there, and the filters deflate, shuffle and fletcher32. Throws FormatError naming the path
/// inside the file. The library itself may still crash or loop on a hostile file; the caller must be ready for that.
class Hdf5Reader {
 public:
  using Sink = std::function<void(std::span<const std::byte>)>;

  explicit Hdf5Reader(const std::string& path);
  Hdf5Reader(const Hdf5Reader&) = delete;
  Hdf5Reader& operator=(const Hdf5Reader&) = delete;
  ~Hdf5Reader();

  bool contains(const std::string& name) const;
  /// The groups that have this attribute, at most 100 and not deeper than 8, in the order of their names.
  std::vector<std::string> groups_with(const std::string& attribute) const;
  std::vector<std::uint64_t> dimensions(const std::string& name) const;
  /// Gives the array, row-major, to `sink` in consecutive pieces of bounded size. Before the first piece, `count` is
  /// told how many numbers will come: never more than 1032 bytes of them (deflate's limit) for each byte that the file
  /// stores.
  void read(const std::string& name, Hdf5Number number, const std::function<void(std::uint64_t)>& count,
            const Sink& sink) const;
  std::optional<std::string> string_attribute(const std::string& object, const std::string& name) const;
  std::optional<std::uint64_t> number_attribute(const std::string& object, const std::string& name) const;

 private:
  std::int64_t file_;
  std::uint64_t file_bytes_ = 0;
};

}  // namespace vismat
