// The delimiter code, slow and obvious: what tests and benchmarks judge codecs/integer_codes/delimiter.h by.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "matrix/base/byte_reader.h"

namespace vismat::reference {

/// The code of one number as the rules of the paper's Appendix A have it, one character for each bit. `literal`: as
/// printed, where the number 1 stays 1.
inline std::string delimited_by_rules(std::uint32_t number, bool literal = false) {
  std::string binary;
  for (; number > 0; number /= 2) binary.insert(binary.begin(), number % 2 == 0 ? '0' : '1');
  std::string code;
  for (std::size_t i = 0; i < binary.size(); ++i) {
    code += binary[i];
    if (binary[i] == '1' && i + 1 < binary.size() && binary[i + 1] == '1') {
      code += "10";
      ++i;
    }
  }
  if (code.ends_with("01") || (code == "1" && !literal)) code += '1';
  return code;
}

/// The code of a list, without its end.
inline std::string delimited_by_rules(std::span<const std::uint32_t> numbers, bool literal = false) {
  std::string code;
  for (const std::uint32_t number : numbers) {
    if (!code.empty()) code += "11";
    code += delimited_by_rules(number, literal);
  }
  return code;
}

/// Bits into bytes as put_delimited writes them, with the 1 that ends the list.
inline std::vector<std::byte> bytes_of_bits(const std::string& bits) {
  std::vector<std::byte> bytes;
  if (bits.empty()) return bytes;
  bytes.resize(bits.size() / 8 + 1);
  for (std::size_t i = 0; i <= bits.size(); ++i) {
    if (i == bits.size() || bits[i] == '1') bytes[i / 8] |= static_cast<std::byte>(1u << i % 8);
  }
  return bytes;
}

/// The one pass of Appendix A.2, bit by bit. Behind a number, five ones may be its last 1, the 1 that is appended after
/// a final 01, the delimiter and the first 1 of a number; or the delimiter and more. The pass takes the former for true
/// and marks the number; if the ones then end where no number can begin, with 1110 or 11110, it takes the marked
/// number's last bit back and has found one more number 1. Throws FormatError on bytes that put_delimited cannot have
/// made.
inline void read_delimited_by_bits(std::span<const std::byte> bytes, std::vector<std::uint64_t>& numbers) {
  numbers.clear();
  if (bytes.empty()) return;
  const auto last = std::to_integer<unsigned>(bytes.back());
  if (last == 0) throw FormatError("no bit ends the list");
  std::size_t stop = bytes.size() * 8 - 1;
  while ((last >> stop % 8 & 1) == 0) --stop;

  constexpr std::uint64_t too_large = std::uint64_t{1} << 32;
  constexpr std::size_t none = ~std::size_t{0};
  std::uint64_t number = 0;   // of the bits that are settled; 0 at a number's start
  unsigned ones = 0;          // behind them
  std::size_t marked = none;  // the number whose last bit is in doubt
  const auto end_number = [&](std::uint64_t value) { numbers.push_back(value); };
  const auto settle = [&](bool mistaken) {
    if (mistaken && marked == none) throw FormatError("ones at the list's start that no numbers make");
    if (mistaken) {
      numbers[marked] >>= 1;
      end_number(1);
    }
    if (marked != none && numbers[marked] >= too_large) throw FormatError("a number above 2^32 - 1");
    marked = none;
  };
  for (std::size_t i = 0; i < stop; ++i) {
    if ((std::to_integer<unsigned>(bytes[i / 8]) >> i % 8 & 1) != 0) {
      if (++ones < 5) continue;
      if (number != 0) marked = numbers.size();
      end_number(number << 1 | 1);
      number = 0;
      ones = 1;
      continue;
    }
    if (ones >= 3) {
      if (number == 0) {
        settle(true);
      } else {
        end_number(number);
        number = 0;
      }
      ones -= 2;
    }
    if (number == 0) {
      if (ones == 0) throw FormatError("a number that begins with 0");
      settle(false);
    }
    number = ones == 0 ? number << 1 : ones == 1 ? number << 2 | 2 : number << 2 | 3;
    ones = 0;
    if (number >= too_large) throw FormatError("a number above 2^32 - 1");
  }
  if (ones == 2) {
    end_number(number << 1 | 1);
    if (numbers.back() >= too_large) throw FormatError("a number above 2^32 - 1");
    settle(false);
  } else if (ones == 4) {
    if (number == 0)
      settle(true);
    else
      end_number(number);
    end_number(1);
  } else if (ones == 0 && number != 0) {
    end_number(number);
  } else {
    throw FormatError("ones at the list's end that no numbers make");
  }
}

}  // namespace vismat::reference
