#include "visibility/meshes/text.h"

#include <charconv>
#include <limits>

namespace vismat {

std::string lower_case(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return result;
}

std::string shown(std::string_view word) {
  std::string result = "'";
  for (const char c : word.substr(0, 24)) result += c > ' ' && c <= '~' ? c : '?';
  return result + (word.size() > 24 ? "...'" : "'");
}

std::string_view Text::word_of_line() {
  for (;;) {
    if (at_ == text_.size() || text_[at_] == '\n') return {};
    if (text_[at_] == comment_) {
      at_ = std::min(text_.find('\n', at_), text_.size());
    } else if (const std::size_t next = continued_ ? after_line_joint() : at_; next != at_) {
      at_ = next;
      ++line_;
    } else if (is_space(text_[at_])) {
      ++at_;
    } else {
      break;
    }
  }
  const std::size_t first = at_;
  while (at_ < text_.size() && !is_space(text_[at_]) && text_[at_] != comment_ &&
         !(continued_ && after_line_joint() != at_)) {
    ++at_;
  }
  return text_.substr(first, at_ - first);
}

double Text::number(std::string_view word, const char* what) const {
  double value = 0;
  const std::string_view digits = word.substr(word.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range) {  // tells not whether too small or too large
    return lower_case(digits).find("e-") != std::string::npos ? 0 : std::numeric_limits<double>::infinity();
  }
  if (word.empty()) fail(std::string("ends where ") + what + " is due");
  if (error != std::errc() || end != digits.data() + digits.size()) {
    fail(shown(word) + " stands where " + what + " is due");
  }
  return value;
}

std::array<double, 3> coordinates(Text& text, bool of_line) {
  std::array<double, 3> at;
  for (double& x : at) x = text.number(of_line ? text.word_of_line() : text.word(), "a coordinate");
  return at;
}

}  // namespace vismat
