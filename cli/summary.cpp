#include "cli/summary.h"

#include <algorithm>

namespace vismat::cli {

std::string printable(std::string_view text) {
  std::string result(text);
  std::replace_if(
      result.begin(), result.end(), [](unsigned char c) { return c < 32 || c == 127; }, '?');
  return result;
}

void line(const char* what, const std::string& value) {
  std::printf("%-16s %s\n", what, printable(value).c_str());
}

std::string grouped(std::uint64_t number) {
  std::string digits = std::to_string(number);
  for (std::size_t i = digits.size(); i > 3; i -= 3) digits.insert(i - 3, " ");
  return digits;
}

std::string summary_of(std::span<const Boundary> boundaries) {
  const BoundaryMap map(boundaries);
  const std::size_t from_outside = map.neighbours(Boundary::outside).size();
  return grouped(boundaries.size() - from_outside) + " between " + grouped(map.cells()) + " cells, " +
         grouped(from_outside) + " from outside";
}

}  // namespace vismat::cli
