// A file of named arrays and attributes in HDF5. Nothing of the library's C interface shows.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace vismat {

/// An HDF5 file that is written, or read. Paths inside the file are absolute ("/vismat/tree/parent"); missing groups
/// are made on writing. Number is one of u8, u32, u64, f32. Every failure throws FormatError naming the path inside the
/// file, but not the file: whoever opened it puts its name in front. HDF5 itself prints nothing. The same calls write
/// the same bytes.
///
/// A file is read in a child process, so that a file which makes the library crash or loop is refused like any other
/// bad file: open() forks, and the child ends with the Hdf5File. Do not open a file while another thread writes one.
class Hdf5File {
 public:
  static Hdf5File create(const std::filesystem::path& path);  // truncates
  /// Read only. With a group, all paths are meant below it: "/values" is that of the group, and "/" is the group.
  static Hdf5File open(const std::filesystem::path& path, const std::string& group = "");
  Hdf5File(Hdf5File&&) noexcept;
  Hdf5File& operator=(Hdf5File&&) noexcept;
  ~Hdf5File();

  /// Row-major; dimensions multiply to values.size(). Arrays of 64 numbers or more are shuffled and deflated.
  template <typename Number>
  void write(const std::string& name, std::span<const Number> values, std::vector<std::uint64_t> dimensions);
  bool contains(const std::string& name) const;
  /// The groups of the whole file that have this attribute; where there are very many, some of them.
  std::vector<std::string> groups_with(const std::string& attribute) const;
  std::vector<std::uint64_t> dimensions(const std::string& name) const;
  /// Converts from the stored integer or float type. Refuses a value that does not fit (floats if Number is an
  /// integer), and an array that is larger than the file could hold. Takes no memory beyond the result but a few
  /// chunks.
  template <typename Number>
  std::vector<Number> read(const std::string& name) const;
  /// For each entry, of any integer or float type: 1 if it is not zero, otherwise 0. NaN gives 1.
  std::vector<std::uint8_t> read_truth(const std::string& name) const;

  void write_attribute(const std::string& object, const std::string& name, const std::string& value);
  void write_attribute(const std::string& object, const std::string& name, std::uint64_t value);
  std::optional<std::string> string_attribute(const std::string& object, const std::string& name) const;
  std::optional<std::uint64_t> number_attribute(const std::string& object, const std::string& name) const;

  /// Ends writing and says whether everything reached the disk; the destructor closes too, but cannot say.
  void close();

 private:
  struct Handle;
  explicit Hdf5File(std::unique_ptr<Handle> handle);
  std::unique_ptr<Handle> handle_;
};

/// Lets `contents` write a file that appears under its name when it is complete (AtomicFile). Throws std::runtime_error
/// naming the file if it cannot be written, on a full disk too.
void write_hdf5(const std::filesystem::path& path, const std::function<void(Hdf5File&)>& contents);

/// Whether a regular file has HDF5's signature at its beginning or behind a block of the user, which takes 512 bytes, or
/// twice that, and so on; false for what cannot be opened.
bool is_hdf5(const std::filesystem::path& path);

}  // namespace vismat
