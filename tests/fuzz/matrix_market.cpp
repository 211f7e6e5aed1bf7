// Matrix Market text: read, or refused in one line; what is read survives being written and read again.
#include <cstdint>
#include <cstdlib>
#include <sstream>
#include <string>

#include "matrix/base/byte_reader.h"
#include "matrix/files/matrix_market.h"
#include "matrix/files/text.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vismat;
  Dataset dataset;
  try {
    std::string room;
    dataset = read_matrix_market(as_utf8(std::as_bytes(std::span(data, size)), room));
  } catch (const FormatError&) {
    return 0;
  }
  std::ostringstream out;
  write_matrix_market(out, dataset);
  const std::string text = out.str();
  if (!(read_matrix_market(text) == dataset)) std::abort();
  return 0;
}
