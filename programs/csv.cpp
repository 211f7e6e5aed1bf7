#include "programs/csv.h"

#include <cstddef>
#include <cstdio>
#include <span>
#include <vector>

#include "matrix/base/atomic_file.h"

namespace vismat {

CsvValue::CsvValue(double value) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.12g", value);
  text = digits;
}

std::string csv_values(std::initializer_list<CsvValue> values) {
  std::string line;
  for (const CsvValue& value : values) (line += value.text) += ',';
  if (!line.empty()) line.pop_back();
  return line;
}

std::string csv_line(std::initializer_list<CsvValue> values) {
  return csv_values(values) + '\n';
}

std::string csv_quoted(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"') result += '"';
    result += c;
  }
  return result += '"';
}

std::string table_begin(const std::filesystem::path& path, std::string_view first_line, bool append) {
  if (!append || !std::filesystem::is_regular_file(path)) return std::string(first_line);
  const std::vector<std::byte> bytes = read_file(path);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void write_table(const std::filesystem::path& path, std::string_view table) {
  if (!path.empty()) write_file(path, std::as_bytes(std::span(table)));
}

}  // namespace vismat
