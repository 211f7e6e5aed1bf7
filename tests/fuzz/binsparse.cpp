// An HDF5 file: read, or refused by a FormatError, whatever the HDF5 library does on the way. What is read
// survives being written and read again. Bytes that do not begin as HDF5 are taken apart into a descriptor
// and arrays instead, so that the fuzzer reaches the checks behind the library without having to write HDF5
// itself.
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include "matrix/base/byte_reader.h"
#include "matrix/files/binsparse.h"

namespace {

using namespace vismat;

// A file with these bytes, in memory where the system has a place for that.
class ScratchFile {
 public:
  explicit ScratchFile(std::span<const std::uint8_t> bytes) {
    const int descriptor = ::mkstemp(path_.data());
    if (descriptor < 0 ||
        ::write(descriptor, bytes.data(), bytes.size()) != static_cast<ssize_t>(bytes.size()))
      std::abort();
    ::close(descriptor);
  }
  ~ScratchFile() { ::unlink(path_.c_str()); }
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_ =
      ::access("/dev/shm", W_OK) == 0 ? "/dev/shm/vismat-fuzz-XXXXXX" : "/tmp/vismat-fuzz-XXXXXX";
};

// Text up to a NUL is the descriptor; then arrays: which one, of what type, how many bytes. Boundaries come in pairs.
void write_parts(const std::filesystem::path& path, std::span<const std::uint8_t> bytes) {
  constexpr const char* names[] = {"/pointers_to_1",
                                   "/indices_0",
                                   "/indices_1",
                                   "/values",
                                   "/fill_value",
                                   "/vismat/row_neighbours/pointers_to_1",
                                   "/vismat/row_neighbours/indices_1",
                                   "/vismat/tree/parent",
                                   "/vismat/tree/object",
                                   "/vismat/boundaries",
                                   "/vismat/row_groups",
                                   "/vismat/column_groups",
                                   "/vismat/row_tree/parent",
                                   "/vismat/row_tree/object"};
  Hdf5File file = Hdf5File::create(path);
  const auto end = std::find(bytes.begin(), bytes.end(), 0);
  file.write_attribute("/", "binsparse", std::string(bytes.begin(), end));
  bytes =
      bytes.subspan(std::min<std::size_t>(static_cast<std::size_t>(end - bytes.begin()) + 1, bytes.size()));
  while (bytes.size() >= 2) {
    const std::string name = names[bytes[0] % std::size(names)];
    const bool wide = bytes[0] >= 128;
    const std::size_t size = std::min<std::size_t>(bytes[1], bytes.size() - 2);
    const auto body = bytes.subspan(2, size);
    bytes = bytes.subspan(2 + size);
    const auto dimensions = [&](std::uint64_t length) {
      const bool pairs = name == "/vismat/boundaries" && length % 2 == 0;
      return pairs ? std::vector<std::uint64_t>{length / 2, 2} : std::vector{length};
    };
    try {
      if (wide) {
        std::vector<std::uint32_t> numbers(size / 4);
        if (!numbers.empty()) std::memcpy(numbers.data(), body.data(), numbers.size() * 4);
        file.write<std::uint32_t>(name, numbers, dimensions(numbers.size()));
      } else {
        file.write<std::uint8_t>(name, body, dimensions(size));
      }
      for (const std::string group : {"/vismat/tree", "/vismat/row_tree"}) {
        if (name == group + "/parent") file.write_attribute(group, "object_count", bytes.size());
      }
    } catch (const FormatError&) {  // named twice
    }
  }
  file.close();
}

}  // namespace

// Each file read costs a fork, and freed memory that the sanitizer keeps makes that dear.
extern "C" const char* __asan_default_options() {
  return "quarantine_size_mb=4";
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const bool raw = size >= 4 && std::memcmp(data, "\x89HDF", 4) == 0;
  const ScratchFile input(raw ? std::span(data, size) : std::span<const std::uint8_t>{});
  if (!raw) {
    if (std::find(data, data + size, 0) - data > 60'000) return 0;  // longer than an attribute may be
    write_parts(input.path(), {data, size});
  }
  Dataset dataset;
  try {
    dataset = read_binsparse(Hdf5File::open(input.path()));
  } catch (const FormatError& error) {
    if (std::strchr(error.what(), '\n') != nullptr) std::abort();
    return 0;
  }
  const ScratchFile again{{}};
  {
    Hdf5File file = Hdf5File::create(again.path());
    write_binsparse(file, dataset);
  }
  if (!(read_binsparse(Hdf5File::open(again.path())) == dataset)) std::abort();
  return 0;
}
