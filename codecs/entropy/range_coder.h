// A range coder with fixed frequencies: an arithmetic coder that outputs bytes [Martin 1979].
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "matrix/base/byte_reader.h"

namespace vismat {

/// Frequencies scaled so that they sum to 2^14, with at least 1 for each symbol that occurs.
class FrequencyTable {
 public:
  static constexpr unsigned bits = 14;

  FrequencyTable() = default;
  /// At most 2^12 symbols. The same frequencies give the same table. If all are zero the table is empty and codes
  /// nothing.
  static FrequencyTable from_frequencies(std::span<const std::uint64_t> frequencies);
  void write(std::vector<std::byte>& out) const;
  static FrequencyTable read(ByteReader& in,
                             std::uint32_t symbols);  // FormatError unless they sum to 2^14 or 0

  std::uint32_t start(std::uint32_t symbol) const { return start_[symbol]; }
  std::uint32_t frequency(std::uint32_t symbol) const { return start_[symbol + 1] - start_[symbol]; }
  bool empty() const { return start_.back() == 0; }
  std::uint32_t symbol_at(std::uint32_t place) const { return symbol_of_place_[place]; }

 private:
  static FrequencyTable from_scaled(std::span<const std::uint32_t> scaled);
  std::vector<std::uint32_t> start_ = {0};
  std::vector<std::uint16_t> symbol_of_place_;
};

/// Adds one to the number that a range coder wrote from byte `begin` on.
void carry_into(std::vector<std::byte>& out, std::size_t begin);
/// Removes the zeros at the end of what it wrote, which its reader supplies.
void drop_last_zeros(std::vector<std::byte>& out, std::size_t begin);

/// `low` is 40 bits of the code value that are not yet sent, plus a carry; `range` is at least 2^24 before each symbol.
class RangeEncoder {
 public:
  explicit RangeEncoder(std::vector<std::byte>& out) : out_(out), begin_(out.size()) {}
  void put(const FrequencyTable& table, std::uint32_t symbol) {
    narrow(table.start(symbol), table.frequency(symbol), FrequencyTable::bits);
  }
  void put_raw(std::uint32_t value, unsigned count);  // count <= 30
  /// A bit that is 1 with probability ones / 2^14, 0 < ones < 2^14.
  void put_bit(bool bit, std::uint32_t ones) {
    narrow(bit ? 0 : ones, bit ? ones : (1u << FrequencyTable::bits) - ones, FrequencyTable::bits);
  }
  /// The fewest bytes that identify the final range: zeros at the end are left out, and the decoder supplies them.
  void finish();

 private:
  void narrow(std::uint32_t start, std::uint32_t size, unsigned total_bits) {
    const std::uint32_t unit = range_ >> total_bits;
    low_ += std::uint64_t{unit} * start;
    range_ = unit * size;
    while (range_ < 1u << 24) {
      range_ <<= 8;
      shift();
    }
  }
  void shift();
  std::vector<std::byte>& out_;
  std::size_t begin_;
  std::uint64_t low_ = 0;
  std::uint32_t range_ = 0xffffffff;
};

class RangeDecoder {
 public:
  explicit RangeDecoder(std::span<const std::byte> bytes) : bytes_(bytes) {
    for (int i = 0; i < 4; ++i) code_ = code_ << 8 | byte();
  }
  std::uint32_t get(const FrequencyTable& table);  // FormatError where no symbol is possible
  std::uint32_t get_raw(unsigned count);
  bool get_bit(std::uint32_t ones) {
    const std::uint32_t unit = range_ >> FrequencyTable::bits;
    if (code_ < unit * ones) {
      narrow(unit, 0, ones);
      return true;
    }
    if (code_ >> FrequencyTable::bits >= unit) no_symbol();
    narrow(unit, ones, (1u << FrequencyTable::bits) - ones);
    return false;
  }
  /// Throws FormatError unless the bytes are those with which an encoder ends after what was read.
  void finish() const;

 private:
  std::uint32_t byte() {
    const std::uint32_t value = next_ < bytes_.size() ? std::to_integer<std::uint32_t>(bytes_[next_]) : 0;
    ++next_;
    return value;
  }
  [[noreturn]] static void no_symbol();
  void narrow(std::uint32_t unit, std::uint32_t start, std::uint32_t size) {
    code_ -= unit * start;
    range_ = unit * size;
    while (range_ < 1u << 24) {
      range_ <<= 8;
      code_ = code_ << 8 | byte();
    }
  }
  std::span<const std::byte> bytes_;
  std::size_t next_ = 0;
  std::uint32_t code_ = 0, range_ = 0xffffffff;
};

}  // namespace vismat
