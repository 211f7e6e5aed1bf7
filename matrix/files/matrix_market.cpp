// One scan over the bytes with a hand-written reader of numbers, then a counting sort by row, so that any order of
// entries takes linear time. Text streams and scanf are 5 to 10 times slower.
#include "matrix/files/matrix_market.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>

#include "matrix/base/byte_reader.h"
#include "matrix/claimed_shape.h"

namespace vismat {
namespace {

class Scanner {
 public:
  explicit Scanner(std::string_view text) : at_(text.data()), end_(at_ + text.size()) {}

  bool at_end() const { return at_ == end_; }
  std::size_t left() const { return static_cast<std::size_t>(end_ - at_); }
  char peek() const { return at_ == end_ ? '\n' : *at_; }
  void skip_blanks() {
    while (at_ != end_ && is_blank(*at_)) ++at_;
  }
  bool at_line_end() const { return at_ == end_ || *at_ == '\n'; }
  /// The rest of the line, and on to the next.
  std::string_view line() {
    const char* begin = at_;
    at_ = std::find(at_, end_, '\n');
    std::string_view text(begin, static_cast<std::size_t>(at_ - begin));
    if (at_ != end_) ++at_;
    ++line_;
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
  }
  std::uint64_t whole_number(const char* what) {
    skip_blanks();
    const char* begin = at_;
    std::uint64_t value = 0;
    while (at_ != end_ && *at_ >= '0' && *at_ <= '9') {
      const auto digit = static_cast<std::uint64_t>(*at_++ - '0');
      if (value > (UINT64_MAX - digit) / 10) fail(std::string(what) + " is larger than 64 bits hold");
      value = value * 10 + digit;
    }
    if (at_ == begin || !(at_line_end() || is_blank(*at_)))
      fail(std::string(what) + " is not a whole number");
    return value;
  }
  /// Whether a value is anything but zero; "1e-400" and "nan" are.
  bool truth() {
    skip_blanks();
    if (at_ != end_ && *at_ == '+') ++at_;
    const char* token_end = std::find_if(at_, end_, [](char c) { return c == '\n' || is_blank(c); });
    double value = 0;
    const auto [end, error] = std::from_chars(at_, token_end, value);
    if (end != token_end || error == std::errc::invalid_argument) fail("the value is not a number");
    at_ = token_end;
    return error == std::errc::result_out_of_range || value != 0;
  }
  void end_line() {
    skip_blanks();
    if (!at_line_end()) fail("has more than it should; one entry a line");
    line();
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw FormatError("line " + std::to_string(line_) + ": " + what);
  }

 private:
  static bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

  const char *at_, *end_;
  std::uint64_t line_ = 1;
};

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return result;
}

struct Header {
  int values = 0;  // numbers behind the two indices of an entry
  bool one_triangle = false;
};

Header read_header(Scanner& scanner) {
  const std::string line = lower(scanner.line());
  std::array<std::string, 5> words;
  std::size_t word = 0;
  for (std::size_t i = 0; i < line.size();) {
    const std::size_t begin = line.find_first_not_of(" \t\r\v\f", i);
    if (begin == std::string::npos || word == words.size()) break;
    i = std::min(line.find_first_of(" \t\r\v\f", begin), line.size());
    words[word++] = line.substr(begin, i - begin);
  }
  const auto refuse = [](const std::string& what) { throw FormatError("line 1: " + what); };
  if (words[0] != "%%matrixmarket") refuse("must begin with '%%MatrixMarket'");
  if (words[1] != "matrix" || words[2] != "coordinate") refuse("only 'matrix coordinate' is read");
  Header header;
  if (words[3] == "integer" || words[3] == "real" || words[3] == "double") {
    header.values = 1;
  } else if (words[3] == "complex") {
    header.values = 2;
  } else if (words[3] != "pattern") {
    refuse("the field must be pattern, integer, real or complex");
  }
  header.one_triangle = words[4] != "general";
  if (header.one_triangle && words[4] != "symmetric" && words[4] != "skew-symmetric" &&
      words[4] != "hermitian") {
    refuse("the symmetry must be general, symmetric, skew-symmetric or hermitian");
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

// On to the next line that says something; false at the end of the text.
bool next_content(Scanner& scanner, Dataset& dataset) {
  while (!scanner.at_end()) {
    scanner.skip_blanks();
    if (scanner.peek() != '%' && !scanner.at_line_end()) return true;
    if (scanner.at_end()) return false;
    const Scanner before = scanner;
    const std::string_view line = scanner.line();
    if (line.starts_with(fact_mark)) take_fact(dataset, line.substr(fact_mark.size()), before);
  }
  return false;
}

struct Entry {
  std::uint32_t row, column;
};

VisibilityMatrix by_rows(Shape shape, const std::vector<Entry>& entries) {
  std::vector<std::uint64_t> offsets(std::size_t{shape.rows} + 1, 0);
  for (const Entry& entry : entries) ++offsets[entry.row + std::size_t{1}];
  for (std::size_t r = 0; r < shape.rows; ++r) offsets[r + 1] += offsets[r];
  std::vector<std::uint64_t> next(offsets.begin(), offsets.end() - 1);
  std::vector<std::uint32_t> ids(entries.size());
  for (const Entry& entry : entries) ids[next[entry.row]++] = entry.column;
  for (std::size_t r = 0; r < shape.rows; ++r) {
    const auto begin = ids.begin() + static_cast<std::ptrdiff_t>(offsets[r]);
    const auto end = ids.begin() + static_cast<std::ptrdiff_t>(offsets[r + 1]);
    if (!std::is_sorted(begin, end)) std::sort(begin, end);
    const auto twice = std::adjacent_find(begin, end);
    if (twice != end) {
      throw FormatError("entry " + std::to_string(r + 1) + " " + std::to_string(std::uint64_t{*twice} + 1) +
                        " is there twice");
    }
  }
  return VisibilityMatrix::from_csr(shape, std::move(offsets), std::move(ids));
}

}  // namespace

Dataset read_matrix_market(std::span<const std::byte> text) {
  Scanner scanner({reinterpret_cast<const char*>(text.data()), text.size()});
  Dataset dataset;
  const Header header = read_header(scanner);
  if (!next_content(scanner, dataset)) scanner.fail("ends before the line 'rows columns entries'");
  const std::uint64_t rows = scanner.whole_number("the number of rows");
  const std::uint64_t columns = scanner.whole_number("the number of columns");
  const std::uint64_t promised = scanner.whole_number("the number of entries");
  scanner.end_line();
  constexpr std::uint64_t shortest_entry = 4;  // "1 1\n"
  if (promised > scanner.left() / shortest_entry + 1) {
    throw FormatError("promises " + std::to_string(promised) + " entries, but only " +
                      std::to_string(scanner.left()) + " bytes follow");
  }
  const Shape shape = claimed_shape(rows, columns, promised);
  if (header.one_triangle && rows != columns)
    throw FormatError("line 1: symmetry needs as many rows as columns");

  std::vector<Entry> entries;
  entries.reserve(promised * (header.one_triangle ? 2 : 1));
  std::uint64_t read = 0;
  for (; next_content(scanner, dataset); ++read) {
    if (read == promised)
      scanner.fail("is one more than the " + std::to_string(promised) + " entries promised");
    const std::uint64_t row = scanner.whole_number("the row"), column = scanner.whole_number("the column");
    if (row == 0 || row > rows || column == 0 || column > columns) {
      scanner.fail("entry " + std::to_string(row) + " " + std::to_string(column) +
                   " lies outside a matrix of " + std::to_string(rows) + " x " + std::to_string(columns) +
                   "; indices count from 1");
    }
    bool visible = header.values == 0;
    for (int i = 0; i < header.values; ++i) visible |= scanner.truth();
    if (header.one_triangle && column > row) scanner.fail("lies above the diagonal of a symmetric matrix");
    const Entry entry = {static_cast<std::uint32_t>(row - 1), static_cast<std::uint32_t>(column - 1)};
    if (visible) entries.push_back(entry);
    if (visible && header.one_triangle && row != column) entries.push_back({entry.column, entry.row});
    scanner.end_line();
  }
  if (read < promised) {
    throw FormatError("promises " + std::to_string(promised) + " entries, but ends after " +
                      std::to_string(read));
  }
  dataset.matrix = by_rows(shape, entries);
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
