// What a reader of matrix files did beyond taking each entry as it stands.
#pragma once
#include <cstdint>
#include <string>

namespace vismat {

struct MatrixNotes {
  std::uint64_t repeated = 0;  // entries that had been listed before; visible twice is visible
  std::uint64_t mirrored = 0;  // entries that only the other triangle of a symmetric matrix lists
  std::uint64_t zeros = 0;     // listed entries whose value is zero, so that they are not visible

  /// "2 repeated entries merged, 3 entries mirrored"; empty if there is nothing to say.
  std::string text() const;
  bool operator==(const MatrixNotes&) const = default;
};

}  // namespace vismat
