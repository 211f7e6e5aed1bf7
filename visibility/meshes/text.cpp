#include "visibility/meshes/text.h"

#include <charconv>
#include <cmath>
#include <limits>
#include <span>

#include "matrix/files/text.h"

namespace vismat {
namespace {

constexpr std::string_view utf8_mark = "\xEF\xBB\xBF";

/// Of a decimal number that no double holds: whether it is too small, not too large.
bool is_too_small(std::string_view number) {
  const std::size_t letter = std::min(number.find_first_of("eE"), number.size());
  std::string_view digits = number.substr(std::min(letter + 1, number.size()));
  const bool negative = digits.starts_with('-');
  if (negative || digits.starts_with('+')) digits.remove_prefix(1);
  std::int64_t exponent = 0;
  if (std::from_chars(digits.data(), digits.data() + digits.size(), exponent).ec ==
      std::errc::result_out_of_range) {
    return negative;
  }
  const std::string_view mantissa = number.substr(0, letter);
  const auto point = static_cast<std::int64_t>(std::min(mantissa.find('.'), mantissa.size()));
  const auto first =
      static_cast<std::int64_t>(std::min(mantissa.find_first_of("123456789"), mantissa.size()));
  return (negative ? -exponent : exponent) < first - point;
}

/// -1.#IND00, 1.#QNAN, 1.#INF and the like
bool is_windows_number(std::string_view word, std::size_t mark) {
  return mark > 0 && mark < word.size() - 1 && word[mark - 1] == '.' && word[mark + 1] >= 'A' &&
         word[mark + 1] <= 'Z';
}

}  // namespace

std::string shown(std::string_view word) {
  std::string result = "'";
  for (const char c : word.substr(0, 24)) result += c > ' ' && c <= '~' ? c : '?';
  return result + (word.size() > 24 ? "...'" : "'");
}

std::string_view without_end_mark(std::string_view text) {
  using namespace std::literals;
  const std::size_t tail = text.find_last_not_of("\0\x1A \t\r\n"sv) + 1;
  return text.substr(0, text.find_first_of("\0\x1A"sv, tail));
}

std::string_view plain_text(std::string_view bytes, std::string& storage) {
  std::string_view text = without_end_mark(as_utf8(std::as_bytes(std::span(bytes)), storage));
  if (text.find(utf8_mark) == std::string_view::npos) return text;
  std::string joined;
  for (std::size_t mark; (mark = text.find(utf8_mark)) != std::string_view::npos;) {
    joined += text.substr(0, mark);
    text.remove_prefix(mark + utf8_mark.size());
  }
  joined += text;
  storage = std::move(joined);
  return storage;
}

std::string_view Text::word_of_line() {
  for (;;) {
    if (at_ == text_.size() || is_line_end(text_[at_])) return {};
    if (text_[at_] == comment_) {
      at_ = end_of_line();
    } else if (const std::size_t next = after_line_joint(); next != at_) {
      at_ = next;
      ++line_;
    } else if (is_space(text_[at_])) {
      ++at_;
    } else {
      break;
    }
  }
  const std::size_t first = at_;
  while (at_ < text_.size() && !is_space(text_[at_]) &&
         (text_[at_] != comment_ || is_windows_number(text_, at_)) && after_line_joint() == at_) {
    ++at_;
  }
  return text_.substr(first, at_ - first);
}

std::size_t Text::after_backslash() const {
  const std::size_t end = text_.find_first_not_of(" \t", at_ + 1);
  return end != std::string_view::npos && is_line_end(text_[end]) ? after_line_end(end) : at_;
}

double Text::number(std::string_view word, const char* what) const {
  if (word.empty()) fail(std::string("ends where ") + what + " is due");
  std::string_view digits = word;
  if (digits.starts_with('+') && !digits.starts_with("+-")) digits.remove_prefix(1);
  double value = 0;
  const auto parse = [&] { return std::from_chars(digits.data(), digits.data() + digits.size(), value); };
  std::from_chars_result parsed = parse();
  if (parsed.ec == std::errc() && parsed.ptr == digits.data() + digits.size()) return value;
  if (is_windows_number(digits, digits.find('#'))) return std::numeric_limits<double>::quiet_NaN();

  std::string rewritten;  // Fortran's exponents as everybody's
  const std::string_view before(digits.data(), static_cast<std::size_t>(parsed.ptr - digits.data()));
  const std::string_view after = digits.substr(before.size());
  if (!before.empty() && (after.starts_with('D') || after.starts_with('d'))) {
    rewritten = std::string(before) + 'e' + std::string(after.substr(1));
  } else if (before.find('.') != std::string_view::npos &&
             (after.starts_with('+') || after.starts_with('-'))) {
    rewritten = std::string(before) + 'e' + std::string(after);
  }
  if (!rewritten.empty()) {
    digits = rewritten;
    parsed = parse();
  }
  if (parsed.ec == std::errc::invalid_argument || parsed.ptr != digits.data() + digits.size()) {
    const bool comma = after.starts_with(',');
    fail(shown(word) + " stands where " + what + " is due" +
         (comma ? "; write numbers with a point, not a comma" : ""));
  }
  if (parsed.ec == std::errc::result_out_of_range) {
    value = is_too_small(digits) ? 0 : std::numeric_limits<double>::infinity();
  }
  return value;
}

Coordinates coordinates(Text& text, bool of_line) {
  Coordinates result;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    result.words[axis] = of_line ? text.word_of_line() : text.word();
    result.at[axis] = text.number(result.words[axis], "a coordinate");
  }
  return result;
}

}  // namespace vismat
