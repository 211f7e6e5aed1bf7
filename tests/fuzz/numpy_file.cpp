// A .npy or .npz file, perhaps gzipped: read, or refused by a FormatError of one line; what is read survives being written as .npz
// and as .npy and read again. The first byte tells how many columns of packed bits a .npy file may have.
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>
#include <vector>

#include "matrix/base/byte_reader.h"
#include "matrix/files/gzip.h"
#include "matrix/files/npy.h"
#include "matrix/files/npz.h"

namespace {

using namespace vismat;

VisibilityMatrix read(std::span<const std::byte> bytes, std::uint32_t columns) {
  std::vector<std::byte> unpacked;
  if (is_gzip(bytes)) bytes = unpacked = gunzip(bytes, 1 << 26);
  if (is_npz(bytes)) return read_npz(bytes, 1 << 26);
  return columns == 0 ? read_npy(bytes) : read_packed_npy(bytes, columns);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  VisibilityMatrix matrix;
  try {
    matrix = read(std::as_bytes(std::span(data + 1, size - 1)), data[0]);
  } catch (const FormatError& error) {
    if (std::strchr(error.what(), '\n') != nullptr) std::abort();
    return 0;
  }
  const Shape shape = matrix.shape();
  if (std::uint64_t{shape.rows} + shape.columns > 1 << 16) return 0;  // nothing but empty rows
  if (!(read_npz(npz_of(matrix), 1 << 26) == matrix)) std::abort();
  if (std::uint64_t{shape.rows} * shape.columns > 1 << 20) return 0;
  std::ostringstream out;
  write_npy(out, matrix);
  const std::string text = out.str();
  if (!(read_npy(std::as_bytes(std::span(text))) == matrix)) std::abort();
  return 0;
}
