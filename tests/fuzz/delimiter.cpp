// Any bytes as a delimiter code: the decoder and the plain pass bit by bit both refuse them or read the same numbers,
// and these have no other code.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <optional>

#include "codecs/integer_codes/delimiter.h"
#include "codecs/integer_codes/delimiter_reference.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vismat;
  const auto bytes = std::as_bytes(std::span(data, size));
  std::optional<std::vector<std::uint64_t>> plain(std::in_place);
  try {
    reference::read_delimited_by_bits(bytes, *plain);
  } catch (const FormatError&) {
    plain.reset();
  }
  for (const bool by_extraction : {false, true}) {
    if (by_extraction && !DelimitedReader::has_fast_extraction()) continue;
    try {
      DelimitedReader reader(bytes, by_extraction);
      std::vector<std::uint32_t> numbers;
      std::array<std::uint32_t, DelimitedReader::least_room> piece;
      while (const std::size_t count = reader.read(piece))
        numbers.insert(numbers.end(), piece.begin(), piece.begin() + count);
      if (!plain || !std::ranges::equal(numbers, *plain)) std::abort();
      std::vector<std::byte> again;
      put_delimited(again, numbers);
      if (!std::ranges::equal(again, bytes)) std::abort();
    } catch (const FormatError&) {
      if (plain) std::abort();
    }
  }
  return 0;
}
