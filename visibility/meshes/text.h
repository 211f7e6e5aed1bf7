// Splits text files into lines and words, for the readers of meshes.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "matrix/base/byte_reader.h"

namespace vismat {

std::string lower_case(std::string_view text);
/// The word in quotes, short and printable, for messages.
std::string shown(std::string_view word);

/// The words and lines of a text; lines are counted from 1.
class Text {
 public:
  /// `comment` begins a comment that ends with the line, unless it is '\n'; a line may be continued after a backslash
  /// if `continued`.
  Text(std::string_view text, char comment, bool continued)
      : text_(text), comment_(comment), continued_(continued) {}

  /// The next word of this line; empty at its end.
  std::string_view word_of_line();
  /// Goes to the start of the next line; false at the end of the text.
  bool next_line() {
    at_ = std::min(text_.find('\n', at_), text_.size());
    if (at_ == text_.size()) return false;
    ++at_;
    ++line_;
    return true;
  }
  /// The next word on any line; empty at the end.
  std::string_view word() {
    for (;;) {
      if (const std::string_view found = word_of_line(); !found.empty()) return found;
      if (!next_line()) return {};
    }
  }
  /// The word as a number; `what` says in messages what should be there ("a coordinate").
  double number(std::string_view word, const char* what) const;
  [[noreturn]] void fail(const std::string& message) const {
    throw FormatError("line " + std::to_string(line_) + ": " + message);
  }
  std::uint64_t line() const { return line_; }
  std::size_t offset() const { return at_; }

 private:
  static bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
  std::size_t after_line_joint() const {
    if (text_[at_] != '\\') return at_;
    if (text_.substr(at_ + 1, 1) == "\n") return at_ + 2;
    return text_.substr(at_ + 1, 2) == "\r\n" ? at_ + 3 : at_;
  }
  std::string_view text_;
  char comment_;
  bool continued_;
  std::size_t at_ = 0;
  std::uint64_t line_ = 1;
};

/// Reads three numbers, all on this line if `of_line`, otherwise on any lines.
std::array<double, 3> coordinates(Text& text, bool of_line);

}  // namespace vismat
