// Refuses files that claim far more rows or columns than their size supports.
#pragma once
#include <cstdint>
#include <limits>
#include <string>

#include "matrix/base/byte_reader.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// Returns the shape that a file claims. Rows and columns for which the file holds no byte, such as empty rows in a
/// coordinate list, still cost memory. So this refuses, with a FormatError, more than 2^32 - 1 rows or columns, and
/// more than 2^22 plus 64 for each entry that the file really has (34 MB of row offsets for an empty file).
inline Shape claimed_shape(std::uint64_t rows, std::uint64_t columns, std::uint64_t entries) {
  const auto check = [&](std::uint64_t claimed, const char* what) {
    constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();
    if (claimed > most)
      throw FormatError("has " + std::to_string(claimed) + what + "; at most 2^32 - 1 are read");
    if (claimed > (std::uint64_t{1} << 22) + 64 * entries) {
      throw FormatError("claims " + std::to_string(claimed) + what + " for " + std::to_string(entries) +
                        " entries; that is absurdly empty, at most 2^22 and 64 an entry are read");
    }
    return static_cast<std::uint32_t>(claimed);
  };
  return {check(rows, " rows"), check(columns, " columns")};
}

}  // namespace vismat
