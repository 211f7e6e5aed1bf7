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

/// What an array is wanted as; `truth` gives a u8 per entry, 0 or 1: is it anything but zero (NaN is)?
enum class Hdf5Number : std::uint32_t { u8, u32, u64, f32, truth };

/// Checks whatever the HDF5 library can be asked before it follows a pointer: only hard links, simple
/// dataspaces, integers and floats of at most 8 bytes, contiguous, compact or chunked storage that is all
/// there, the filters deflate, shuffle and fletcher32. Throws FormatError naming the path inside the file.
/// The library itself may still crash or loop on a hostile file; the caller must be ready for that.
class Hdf5Reader {
 public:
  using Sink = std::function<void(std::span<const std::byte>)>;

  explicit Hdf5Reader(const std::string& path);
  Hdf5Reader(const Hdf5Reader&) = delete;
  Hdf5Reader& operator=(const Hdf5Reader&) = delete;
  ~Hdf5Reader();

  bool contains(const std::string& name) const;
  std::vector<std::uint64_t> dimensions(const std::string& name) const;
  /// The array, row-major, in consecutive pieces of bounded size. Before the first, `count` hears how many
  /// numbers will come: never more than 1032 bytes of them (deflate's limit) for each byte that the file
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
