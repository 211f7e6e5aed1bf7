#include "matrix/files/matrix_notes.h"

namespace vismat {

std::string MatrixNotes::text() const {
  std::string text;
  const auto say = [&](std::uint64_t count, const char* before, const char* after) {
    if (count == 0) return;
    if (!text.empty()) text += ", ";
    text += std::to_string(count) + before + (count == 1 ? "entry" : "entries") + after;
  };
  say(repeated, " repeated ", " merged");
  say(mirrored, " ", " mirrored");
  say(zeros, " ", " of value zero left out");
  return text;
}

}  // namespace vismat
