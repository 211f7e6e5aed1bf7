// Any bytes as a store of chunks: one that opens gives the same bytes when it is written again in the order on disk, and a chunk is
// read as it lies there or refused. The checksum of head and index, at which nearly every mutation would end, is made right first.
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "matrix/base/byte_reader.h"
#include "matrix/base/checksum.h"
#include "runtime/storage/chunk_store.h"

namespace {

void seal(std::vector<std::byte>& file) {
  if (file.size() < 32) return;
  const std::uint64_t count = vismat::number_at<std::uint32_t>(file, 20),
                      head = 28 + std::uint64_t{vismat::number_at<std::uint32_t>(file, 24)};
  if (file.size() < head + 16 * count + 4) return;
  std::vector<std::byte> sealed(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(head));
  sealed.insert(sealed.end(), file.end() - static_cast<std::ptrdiff_t>(4 + 16 * count), file.end() - 4);
  const std::uint32_t sum = vismat::crc32(sealed);
  std::memcpy(file.data() + file.size() - 4, &sum, 4);
}

// A file without a name, which is gone when the program ends.
struct MemoryFile {
  MemoryFile() : descriptor(::memfd_create("store", MFD_CLOEXEC)) {
    if (descriptor < 0) std::abort();
  }
  void fill(std::span<const std::byte> bytes) const {
    const auto size = static_cast<ssize_t>(bytes.size());
    if (::ftruncate(descriptor, 0) != 0 || ::pwrite(descriptor, bytes.data(), bytes.size(), 0) != size ||
        ::lseek(descriptor, 0, SEEK_SET) != 0)
      std::abort();
  }
  std::filesystem::path path() const { return "/proc/self/fd/" + std::to_string(descriptor); }
  int descriptor;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vismat;
  static const MemoryFile in, out;
  std::vector<std::byte> file(size);
  if (size > 0) std::memcpy(file.data(), data, size);
  seal(file);
  in.fill(file);
  try {
    const ChunkStore store(in.path());
    std::vector<std::uint32_t> order(store.count());
    std::iota(order.begin(), order.end(), 0u);
    std::ranges::sort(order, {}, [&](std::uint32_t c) { return std::pair(store.offset(c), store.bytes(c)); });
    bool whole = true;
    out.fill({});
    ChunkStoreWriter writer(out.path(), store.contents(), store.scene_checksum(), store.count());
    for (const std::uint32_t chunk : order) {
      std::vector<std::byte> bytes(store.bytes(chunk));
      try {
        store.read(chunk, bytes);
      } catch (const FormatError&) {
        whole = false;
      }
      if (!std::ranges::equal(bytes, std::span(file).subspan(store.offset(chunk), bytes.size())))
        std::abort();
      writer.append(chunk, bytes);
    }
    writer.finish();
    const std::vector<std::byte> again = read_file(out.path());
    if (whole && again != file) std::abort();
  } catch (const FormatError&) {
  }
  return 0;
}
