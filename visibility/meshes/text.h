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

/// The word in quotes, short and printable, for messages.
std::string shown(std::string_view word);

/// The text without what some systems put behind its end: the mark 0x1A of DOS, and padding by 0.
std::string_view without_end_mark(std::string_view text);
/// As as_utf8 gives it, without those, and without the byte order marks that stand inside files which were joined from several.
std::string_view plain_text(std::string_view bytes, std::string& storage);

/// The words and lines of a text; lines are counted from 1. A line ends with LF, CR LF or CR.
class Text {
 public:
  /// `comment` begins a comment that ends with the line, unless it is '\n'; a line may be continued after a backslash
  /// if `continued`. `line` is the number of the first line.
  Text(std::string_view text, char comment, bool continued, std::uint64_t line = 1)
      : text_(text), comment_(comment), continued_(continued), line_(line) {}

  /// The next word of this line; empty at its end.
  std::string_view word_of_line();
  /// Goes to the start of the next line; false at the end of the text.
  bool next_line() {
    at_ = end_of_line();
    if (at_ == text_.size()) return false;
    at_ = after_line_end(at_);
    ++line_;
    return true;
  }
  /// The other words of this line, with one blank between them.
  std::string rest_of_line() {
    std::string words;
    for (std::string_view word; !(word = word_of_line()).empty();) {
      words += (words.empty() ? "" : " ") + std::string(word);
    }
    return words;
  }
  /// The next word on any line; empty at the end.
  std::string_view word() {
    for (;;) {
      if (const std::string_view found = word_of_line(); !found.empty()) return found;
      if (!next_line()) return {};
    }
  }
  /// The word as a number; `what` says in messages what should be there ("a coordinate"). Exponents may be Fortran's
  /// (1.5D+02, 1.5+02). NaN and infinity are numbers here, also as Windows prints them (-1.#IND00).
  double number(std::string_view word, const char* what) const;
  [[noreturn]] void fail(const std::string& message) const {
    throw FormatError("line " + std::to_string(line_) + ": " + message);
  }
  std::uint64_t line() const { return line_; }
  std::size_t offset() const { return at_; }
  /// Where this line ends, before LF, CR LF or CR.
  std::size_t end_of_line() const {
    std::size_t end = at_;
    while (end < text_.size() && !is_line_end(text_[end])) ++end;
    return end;
  }

 private:
  // DOS's end mark stands inside of files that were joined from several.
  static bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r') || c == '\x1A'; }
  static bool is_line_end(char c) { return c == '\n' || c == '\r'; }
  std::size_t after_line_end(std::size_t at) const { return at + (text_.substr(at, 2) == "\r\n" ? 2 : 1); }
  /// Behind the backslash and the line end if the line is continued here, otherwise here.
  std::size_t after_line_joint() const { return continued_ && text_[at_] == '\\' ? after_backslash() : at_; }
  std::size_t after_backslash() const;
  std::string_view text_;
  char comment_;
  bool continued_;
  std::size_t at_ = 0;
  std::uint64_t line_;
};

struct Coordinates {
  std::array<double, 3> at{};
  std::array<std::string_view, 3> words;  // as they stand in the file; empty if it is binary
};
/// Reads three numbers, all on this line if `of_line`, otherwise on any lines.
Coordinates coordinates(Text& text, bool of_line);

}  // namespace vismat
