// Any bytes as a .vmat file. The checksum would stop nearly every mutation at the door, so it is made right
// first.
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <stdexcept>

#include "codecs/baseline_codecs.h"
#include "codecs/container.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vismat;
  std::vector<std::byte> file(size);
  if (size > 0) std::memcpy(file.data(), data, size);
  if (size >= 8) {
    const std::uint64_t sum = container_checksum(std::span(file).first(size - 8));
    std::memcpy(file.data() + size - 8, &sum, 8);
  }
  try {
    const Container container = read_container(file);
    if (write_container(container) != file) std::abort();
    const auto [rows, columns] = container.shape;
    if (rows > 1 << 16 || std::uint64_t{rows} * columns > 1 << 20) return 0;  // honest, but slow to fuzz
    const VisibilityMatrix matrix = decompress(container, find_codec(container.codec));
    if (matrix.ones() != container.ones) std::abort();
  } catch (const FormatError&) {
  } catch (const std::invalid_argument&) {  // a codec of another name
  }
  return 0;
}
