// Reads lists of numbers, as options have them.
#pragma once
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

namespace vismat {

/// The whole word as a number; nothing if it is none.
template <typename Number>
std::optional<Number> number_of(std::string_view word) {
  Number value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size()) return std::nullopt;
  return value;
}

inline std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t end; (end = text.find(separator)) != std::string_view::npos; text.remove_prefix(end + 1)) {
    parts.push_back(text.substr(0, end));
  }
  parts.push_back(text);
  return parts;
}

/// Numbers within 1e9 of zero with commas between them; none if some part is not.
inline std::vector<double> number_list(std::string_view text) {
  std::vector<double> values;
  for (const std::string_view part : split(text, ',')) {
    const std::optional<double> value = number_of<double>(part);
    if (!value || !(std::abs(*value) <= 1e9)) return {};
    values.push_back(*value);
  }
  return values;
}

}  // namespace vismat
