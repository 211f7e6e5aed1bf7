// Any bytes as a .vmat file, of today's version or of version 3, read whole and row by row. The checksums would stop nearly every mutation at the door, so
// they are made right first.
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include "codecs/baselines/baseline_codecs.h"
#include "codecs/vmat/container.h"
#include "codecs/vmat/row_reader.h"
#include "codecs/vmat/vmat3.h"

namespace {

// The three forms of a row agree, and with the whole if that can be decoded; damage shows by FormatError alone.
void read_rows(std::span<const std::byte> file, const vismat::Container& container,
               const vismat::Codec& codec) {
  using namespace vismat;
  const RowReader reader(file, std::span(&codec, 1));
  RowBuffer<std::uint32_t> ids_buffer;
  RowBuffer<Run> runs_buffer;
  std::vector<std::uint64_t> bits((std::size_t{container.shape.columns} + 63) / 64);
  for (std::uint32_t r = 0; r < container.shape.rows; ++r) {
    try {
      const auto ids = reader.ids(r, ids_buffer);
      const auto runs = reader.runs(r, runs_buffer);
      reader.bits(r, bits, ids_buffer);
      std::size_t from_runs = 0, from_bits = 0;
      for (const Run run : runs) {
        for (std::uint32_t i = 0; i < run.count; ++i, ++from_runs) {
          if (from_runs >= ids.size() || ids[from_runs] != run.first + i) std::abort();
        }
      }
      for (const std::uint32_t id : ids) from_bits += bits[id / 64] >> (id % 64) & 1;
      std::size_t ones = 0;
      for (const std::uint64_t word : bits) ones += static_cast<std::size_t>(std::popcount(word));
      if (from_runs != ids.size() || from_bits != ids.size() || ones != ids.size()) std::abort();
    } catch (const FormatError&) {
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vismat;
  std::vector<std::byte> file(size);
  if (size > 0) std::memcpy(file.data(), data, size);
  const bool old = is_vmat3(file);
  old ? seal_vmat3(file) : seal_container(file);
  try {
    static const std::vector<Codec> codecs = all_codecs();
    const Container container = old ? read_vmat3(file, codecs) : read_container(file);
    const auto again = write_container(container);
    if (old ? read_container(again) != container : again != file) std::abort();
    if (old) file = again;
    const auto [rows, columns] = container.shape;
    if (rows > 1 << 16 || std::uint64_t{rows} * columns > 1 << 20) return 0;  // honest, but slow to fuzz
    const Codec& codec = find_codec(container.codec);
    if (codec.open != nullptr) read_rows(file, container, codec);
    const VisibilityMatrix matrix = decompress(container, codec);
    if (matrix.ones() != container.ones) std::abort();
  } catch (const FormatError&) {
  } catch (
      const std::invalid_argument&) {  // a codec of another name; of version 3 what today's files do not hold
  }
  return 0;
}
