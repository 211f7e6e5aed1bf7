// One scan over the bytes with a hand-written reader of words, then a counting sort by row, so that any order of
// entries takes linear time. Text streams and scanf are 5 to 10 times slower.
#include "matrix/files/matrix_market.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <ostream>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "matrix/base/byte_reader.h"
#include "matrix/claimed_shape.h"
#include "matrix/files/entries.h"

namespace vismat {
namespace {

constexpr std::string_view matrix_market_mark = "%%matrixmarket";  // in any case

// Words of a hostile file, short and fit for one line.
std::string in_quotes(std::string_view word) {
  constexpr std::size_t longest = 24;
  std::string text(word.substr(0, longest));
  for (char& c : text) c = c >= ' ' && c <= '~' ? c : '?';
  return "'" + text + (word.size() > longest ? "...'" : "'");
}

class Scanner {
 public:
  explicit Scanner(std::string_view text) : at_(text.data()), end_(at_ + text.size()) {}

  std::size_t left() const { return static_cast<std::size_t>(end_ - at_); }
  bool at_end() const { return at_ == end_; }
  bool at_line_end() const { return at_ == end_ || is_line_end(*at_); }
  bool at_comment() const { return at_ != end_ && *at_ == '%'; }
  void skip_blanks() {
    while (at_ != end_ && is_blank(*at_)) ++at_;
    if (at_ != end_ && *at_ == dos_end_of_file) end_ = at_;
  }
  /// The rest of the line, and on to the next. Lines end with LF, CR LF, or CR alone.
  std::string_view line() {
    const char* begin = at_;
    at_ = std::find_if(at_, end_, is_line_end);
    std::string_view text(begin, static_cast<std::size_t>(at_ - begin));
    if (at_ != end_) at_ += *at_ == '\r' && at_ + 1 != end_ && at_[1] == '\n' ? 2 : 1;
    ++line_;
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
  }
  std::uint64_t whole_number(const char* what) {
    skip_blanks();
    const char* begin = at_;
    std::uint64_t value = 0;
    for (; at_ != end_ && is_digit(*at_); ++at_) {
      const auto digit = static_cast<std::uint64_t>(*at_ - '0');
      if (__builtin_mul_overflow(value, std::uint64_t{10}, &value) ||
          __builtin_add_overflow(value, digit, &value))
        fail(std::string(what) + " is larger than 64 bits hold");
    }
    if (at_ == begin || !(at_ == end_ || ends_word(*at_))) {
      at_ = begin;
      const std::string_view wrong = word(what);
      fail(std::string(what) + " is not a whole number: " + in_quotes(wrong));
    }
    return value;
  }
  /// Whether a value is anything but zero, which "1e-400" is. Exponents may be Fortran's, too: "1D+02", "1+02".
  bool truth() {
    const std::string_view number = word("the value");
    std::size_t i = number[0] == '+' || number[0] == '-' ? 1 : 0, digits = 0;
    bool point = false, zero = true;
    for (; i < number.size(); ++i) {
      const char c = number[i];
      if (c == '.' && !point) {
        point = true;
      } else if (is_digit(c)) {
        ++digits;
        zero &= c == '0';
      } else {
        break;
      }
    }
    bool good = digits > 0;
    if (good && i < number.size()) {
      const bool letter = std::string_view("eEdDqQ").find(number[i]) != std::string_view::npos;
      if (letter) ++i;
      const bool sign = i < number.size() && (number[i] == '+' || number[i] == '-');
      if (sign) ++i;
      good = (letter || sign) && i < number.size() && std::all_of(number.begin() + i, number.end(), is_digit);
    }
    if (!good) fail("the value " + in_quotes(number) + " is not a number");
    return !zero;
  }
  void end_line() {
    skip_blanks();
    if (!at_line_end() && !at_comment()) fail("has more than it should; one entry a line");
    line();
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw FormatError("line " + std::to_string(line_) + ": " + what);
  }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
  static bool is_line_end(char c) { return c == '\n' || c == '\r'; }
  static constexpr char dos_end_of_file = 0x1a;
  static bool ends_word(char c) { return is_line_end(c) || is_blank(c) || c == dos_end_of_file; }
  static bool is_digit(char c) { return c >= '0' && c <= '9'; }

  std::string_view word(const char* what) {
    skip_blanks();
    if (at_line_end() || at_comment()) fail(std::string(what) + " is missing");
    const char* begin = at_;
    at_ = std::find_if(at_, end_, ends_word);
    return {begin, static_cast<std::size_t>(at_ - begin)};
  }

  const char *at_, *end_;
  std::uint64_t line_ = 1;
};

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return result;
}

struct Header {
  bool array = false;
  int values = 0;  // numbers of an entry, behind its indices
  enum class Stored { all, lower, strictly_lower } stored = Stored::all;
};

Header read_header(Scanner& scanner) {
  std::string line;
  do {  // blank lines may stand above
    if (scanner.at_end()) break;
    line = lower(scanner.line());
  } while (line.empty());
  std::array<std::string, 5> words;
  std::istringstream split(line);
  for (std::string& word : words) split >> word;
  const auto refuse = [](const std::string& what) { throw FormatError("line 1: " + what); };
  if (words[0] != matrix_market_mark) refuse("must begin with '%%MatrixMarket'");
  Header header;
  header.array = words[2] == "array";
  if (words[1] != "matrix" || (!header.array && words[2] != "coordinate")) {
    refuse("says " + in_quotes(words[1] + " " + words[2]) +
           "; only 'matrix coordinate' and 'matrix array' are read");
  }
  if (words[3] == "integer" || words[3] == "unsigned-integer" || words[3] == "real" || words[3] == "double") {
    header.values = 1;
  } else if (words[3] == "complex") {
    header.values = 2;
  } else if (words[3] != "pattern" || header.array) {
    refuse("the field must be " + std::string(header.array ? "" : "pattern, ") +
           "integer, unsigned-integer, real or complex, not " + in_quotes(words[3]));
  }
  if (words[4] == "skew-symmetric") {
    header.stored = Header::Stored::strictly_lower;
  } else if (words[4] == "symmetric" || words[4] == "hermitian") {
    header.stored = Header::Stored::lower;
  } else if (words[4] != "general") {
    refuse("the symmetry must be general, symmetric, skew-symmetric or hermitian, not " +
           in_quotes(words[4]));
  }
  return header;
}

constexpr std::string_view fact_mark = "%%vismat ";

void take_fact(Dataset& dataset, std::string_view fact, const Scanner& scanner) {
  const std::size_t colon = std::min(fact.find(':'), fact.size());
  const std::string_view key = fact.substr(0, colon);
  std::string_view value = fact.substr(std::min(colon + 1, fact.size()));
  if (value.starts_with(' ')) value.remove_prefix(1);
  if (key == "provenance") dataset.provenance = value;
  if (key == "rows_are") dataset.rows_are = value;
  if (key == "columns_are") dataset.columns_are = value;
  if (key == "guarantee") {
    try {
      dataset.guarantee = guarantee_from_string(value);
    } catch (const std::invalid_argument& error) {
      scanner.fail(std::string("guarantee: ") + error.what());
    }
  }
  if (key == "seed") {
    std::uint64_t seed = 0;
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), seed);
    if (error != std::errc{} || end != value.data() + value.size())
      scanner.fail("the seed is not a 64-bit number");
    dataset.seed = seed;
  }
}

// On to the next word; false at the end of the text.
bool next_content(Scanner& scanner, Dataset& dataset) {
  while (true) {
    scanner.skip_blanks();
    if (scanner.at_end()) return false;
    if (!scanner.at_comment() && !scanner.at_line_end()) return true;
    const Scanner before = scanner;
    const std::string_view line = scanner.line();
    if (line.starts_with(fact_mark)) take_fact(dataset, line.substr(fact_mark.size()), before);
  }
}

std::vector<Entry> read_entries(Scanner& scanner, Dataset& dataset, const Header& header, Shape shape,
                                std::uint64_t promised) {
  std::vector<Entry> entries;
  entries.reserve(promised);
  std::uint64_t read = 0;
  for (; next_content(scanner, dataset); ++read) {
    if (read == promised)
      scanner.fail("is one more than the " + std::to_string(promised) + " entries promised");
    const std::uint64_t row = scanner.whole_number("the row"), column = scanner.whole_number("the column");
    if (row == 0 || row > shape.rows || column == 0 || column > shape.columns) {
      scanner.fail("entry " + std::to_string(row) + " " + std::to_string(column) +
                   " lies outside a matrix of " + std::to_string(shape.rows) + " x " +
                   std::to_string(shape.columns) + "; indices count from 1");
    }
    bool visible = header.values == 0;
    for (int i = 0; i < header.values; ++i) visible |= scanner.truth();
    if (visible)
      entries.push_back({static_cast<std::uint32_t>(row - 1), static_cast<std::uint32_t>(column - 1)});
    scanner.end_line();
  }
  if (read < promised) {
    throw FormatError("promises " + std::to_string(promised) + " entries, but ends after " +
                      std::to_string(read));
  }
  return entries;
}

// The values of a dense matrix, column by column; of a symmetric one, from the diagonal down.
std::vector<Entry> read_array(Scanner& scanner, Dataset& dataset, const Header& header, Shape shape,
                              std::uint64_t promised) {
  Header::Stored stored = header.stored;
  const bool strict = stored == Header::Stored::strictly_lower;
  const std::uint64_t most = promised + (strict ? shape.rows : 0);
  std::vector<bool> visible;
  visible.reserve(promised);
  while (next_content(scanner, dataset)) {
    if (visible.size() == most)
      scanner.fail("has more than the " + std::to_string(promised) + " values of the matrix");
    bool any = false;
    for (int i = 0; i < header.values; ++i) {
      if (!next_content(scanner, dataset)) scanner.fail("ends within a complex value");
      any |= scanner.truth();
    }
    visible.push_back(any);
  }
  if (strict && visible.size() == most) {
    stored = Header::Stored::lower;  // SciPy writes the zeros of the diagonal if they are complex
  } else if (visible.size() != promised) {
    throw FormatError("needs " + std::to_string(promised) + " values, but has " +
                      std::to_string(visible.size()));
  }
  std::vector<Entry> entries;
  std::uint64_t at = 0;
  for (std::uint32_t column = 0; column < shape.columns; ++column) {
    const std::uint32_t first = stored == Header::Stored::all     ? 0
                                : stored == Header::Stored::lower ? column
                                                                  : column + 1;
    for (std::uint32_t row = first; row < shape.rows; ++row) {
      if (visible[at++]) entries.push_back({row, column});
    }
  }
  return entries;
}

std::uint64_t values_of_array(const Header& header, std::uint64_t rows, std::uint64_t columns) {
  std::uint64_t cells = 0;
  if (__builtin_mul_overflow(rows, columns, &cells)) return std::numeric_limits<std::uint64_t>::max();
  if (header.stored == Header::Stored::all) return cells;
  return header.stored == Header::Stored::lower ? (cells - rows) / 2 + rows : (cells - rows) / 2;
}

}  // namespace

bool is_matrix_market(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  return lower(text.substr(0, matrix_market_mark.size())) == matrix_market_mark;
}

Dataset read_matrix_market(std::string_view text, MatrixNotes* notes) {
  Scanner scanner(text);
  Dataset dataset;
  const Header header = read_header(scanner);
  if (!next_content(scanner, dataset)) {
    scanner.fail(std::string("ends before the line 'rows columns") + (header.array ? "'" : " entries'"));
  }
  const std::uint64_t rows = scanner.whole_number("the number of rows");
  const std::uint64_t columns = scanner.whole_number("the number of columns");
  const bool one_triangle = header.stored != Header::Stored::all;
  if (one_triangle && rows != columns) throw FormatError("line 1: symmetry needs as many rows as columns");
  const std::uint64_t promised =
      header.array ? values_of_array(header, rows, columns) : scanner.whole_number("the number of entries");
  scanner.end_line();
  const std::uint64_t shortest = header.array ? 2 : 4;  // "1\n", "1 1\n"
  if (promised > scanner.left() / shortest + 1) {
    throw FormatError("promises " + std::to_string(promised) + (header.array ? " values" : " entries") +
                      ", but only " + std::to_string(scanner.left()) + " bytes follow");
  }
  const Shape shape = claimed_shape(rows, columns, promised);
  std::vector<Entry> entries = header.array ? read_array(scanner, dataset, header, shape, promised)
                                            : read_entries(scanner, dataset, header, shape, promised);
  MatrixNotes here;
  if (one_triangle) {  // whichever triangle an entry stands in, it means both
    for (Entry& entry : entries) {
      if (entry.column > entry.row) std::swap(entry.row, entry.column);
    }
    const VisibilityMatrix half = matrix_of_entries(shape, entries, here.repeated);
    dataset.matrix = with_transpose(half);
    here.mirrored = dataset.matrix.ones() - half.ones();
  } else {
    dataset.matrix = matrix_of_entries(shape, entries, here.repeated);
  }
  if (!header.array) here.zeros = promised - entries.size();
  if (notes != nullptr) *notes = here;
  return dataset;
}

void write_matrix_market(std::ostream& out, const Dataset& dataset) {
  const auto fact = [&](std::string_view key, std::string value) {
    std::replace(value.begin(), value.end(), '\n', ' ');  // a fact has one line
    out << fact_mark << key << ": " << value << '\n';
  };
  const VisibilityMatrix& matrix = dataset.matrix;
  out << "%%MatrixMarket matrix coordinate pattern general\n";
  if (!dataset.provenance.empty()) fact("provenance", dataset.provenance);
  fact("guarantee", std::string(to_string(dataset.guarantee)));
  if (dataset.seed) fact("seed", std::to_string(*dataset.seed));
  fact("rows_are", dataset.rows_are);
  fact("columns_are", dataset.columns_are);
  out << matrix.shape().rows << ' ' << matrix.shape().columns << ' ' << matrix.ones() << '\n';
  std::array<char, 1 << 16> block;
  char* at = block.data();
  char* const full =
      block.data() + block.size() - 24;  // two numbers of ten digits, a blank and a newline fit behind
  for (std::uint32_t r = 0; r < matrix.shape().rows; ++r) {
    for (const std::uint32_t c : matrix.row(r)) {
      if (at > full) {
        out.write(block.data(), at - block.data());
        at = block.data();
      }
      at = std::to_chars(at, at + 10, std::uint64_t{r} + 1).ptr;
      *at++ = ' ';
      at = std::to_chars(at, at + 10, std::uint64_t{c} + 1).ptr;
      *at++ = '\n';
    }
  }
  out.write(block.data(), at - block.data());
}

}  // namespace vismat
