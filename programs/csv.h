// Tables of comma-separated values, as text that grows line by line.
#pragma once
#include <concepts>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>

namespace vismat {

/// One value as a table has it: whole numbers as they are, other numbers with 12 digits, bool as 0 or 1, text as it is.
struct CsvValue {
  CsvValue(std::string_view value) : text(value) {}
  CsvValue(const std::string& value) : text(value) {}
  CsvValue(const char* value) : text(value) {}
  CsvValue(double value);
  CsvValue(bool value) : text(value ? "1" : "0") {}
  CsvValue(std::integral auto value) : text(std::to_string(value)) {}
  std::string text;
};

/// The values with commas between them, without an end of line.
std::string csv_values(std::initializer_list<CsvValue> values);
std::string csv_values(const auto&... values) {
  return csv_values({CsvValue(values)...});
}

/// The values with commas between them, and an end of line.
std::string csv_line(std::initializer_list<CsvValue> values);
std::string csv_line(const auto&... values) {
  return csv_line({CsvValue(values)...});
}

/// The text as one value, even if it holds commas or quotes.
std::string csv_quoted(std::string_view text);

/// What the table already holds if `append` and it exists, otherwise its first line.
std::string table_begin(const std::filesystem::path& path, std::string_view first_line, bool append);

/// Writes the whole table, as write_file does; does nothing if the path is empty.
void write_table(const std::filesystem::path& path, std::string_view table);

}  // namespace vismat
