#include "codecs/integer_codes/pair_huffman.h"

#include <algorithm>
#include <utility>

namespace vismat {
void HuffmanTable::write(std::vector<std::byte>& out, std::span<const std::uint64_t> counts) {
  std::array<std::uint64_t, LengthSymbol::count> sorted, depths;  // sorted: count << 8 | symbol
  std::size_t used = 0;
  for (std::size_t s = 0; s < counts.size(); ++s) {
    if (counts[s] > 0) sorted[used++] = counts[s] << 8 | s;
  }
  std::sort(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(used));
  std::array<std::uint8_t, LengthSymbol::count> lengths{};
  if (used == 1) lengths[sorted[0] & 0xff] = 1;
  for (unsigned halvings = 0; used > 1; ++halvings) {  // until no code is too long
    for (std::size_t i = 0; i < used; ++i) depths[i] = (((sorted[i] >> 8) - 1) >> halvings) + 1;
    huffman_depths(std::span(depths).first(used));
    if (depths[0] > longest_huffman) continue;
    for (std::size_t i = 0; i < used; ++i) lengths[sorted[i] & 0xff] = static_cast<std::uint8_t>(depths[i]);
    break;
  }
  put_code_lengths(out, std::span(lengths).first(counts.size()));
}

HuffmanTable HuffmanTable::read(ByteReader& in, std::uint32_t symbols) {
  HuffmanTable table;
  std::array<Used, LengthSymbol::count> used;
  std::uint32_t count = 0;
  read_code_lengths(in, symbols, [&](std::uint32_t first, unsigned run, unsigned length) {
    if (length == 0) return;
    table.count_[length] = static_cast<std::uint16_t>(table.count_[length] + run);
    for (std::uint32_t s = first; s < first + run; ++s)
      used[count++] = {static_cast<std::uint8_t>(s), static_cast<std::uint8_t>(length), 0};
  });
  table.assign_codes(std::span(used).first(count));
  return table;
}

void HuffmanTable::assign_codes(std::span<Used> used) {
  unsigned most = 0;
  for (unsigned length = 1; length <= longest_huffman; ++length) {
    first_[length] = static_cast<std::uint16_t>((first_[length - 1] + count_[length - 1]) << 1);
    begin_[length] = static_cast<std::uint16_t>(begin_[length - 1] + count_[length - 1]);
    if (count_[length] > 0) most = length;
  }
  width_ = std::min(most, table_bits);
  const std::size_t size = std::size_t{1} << width_;
  if (most > table_bits || used.size() <= 1) std::fill_n(table_.begin(), size, Entry{0, 0});
  auto end = begin_;
  for (Used& one : used) {
    const unsigned length = one.length, place = end[length]++;
    by_code_[place] = one.symbol;
    one.code = static_cast<std::uint16_t>(reversed_code(first_[length] + place - begin_[length], length));
    of_symbol_[one.symbol] = one;
    if (length > width_) continue;
    for (std::size_t i = one.code; i < size; i += std::size_t{1} << length)
      table_[i] = {one.symbol, one.length};
  }
}

HuffmanTable::Entry HuffmanTable::find_long(std::uint64_t ahead) const {
  unsigned code = 0;
  for (unsigned length = 1; length <= longest_huffman; ++length, ahead >>= 1) {
    code = code << 1 | static_cast<unsigned>(ahead & 1);
    if (code >= first_[length] && code - first_[length] < count_[length])
      return {by_code_[begin_[length] + code - first_[length]], static_cast<std::uint8_t>(length)};
  }
  return {0, 0};
}

inline std::uint32_t HuffmanTable::next(ListBits& bits) const {
  std::uint64_t ahead = bits.peek();
  Entry entry = table_[lowest_bits(ahead, width_)];
  if (entry.length == 0) [[unlikely]] {
    entry = find_long(ahead);
    if (entry.length == 0) bits.fail("bits that are no symbol's Huffman code");
  }
  if (entry.symbol < 64) [[likely]] {
    bits.take(entry.length);
    return entry.symbol + 1u;
  }
  const unsigned raw = raw_bits_of_symbol(entry.symbol);
  bits.take(entry.length + raw);
  return length_of_symbol(entry.symbol, static_cast<std::uint32_t>(lowest_bits(ahead >> entry.length, raw)));
}

inline void HuffmanTable::put(ListWriter& out, std::uint32_t number) const {
  const LengthSymbol s = symbol_of_length(number);
  const Used& code = of_symbol_[s.symbol];
  out.put(code.code | std::uint64_t{s.raw} << code.length, code.length + s.raw_count);
}

void OwnHuffmanCode::put(std::vector<std::byte>& out, std::span<const std::uint32_t> numbers) {
  if (numbers.empty()) return;
  std::array<std::uint64_t, LengthSymbol::count> counts{};
  std::uint32_t symbols = 0;
  for (const std::uint32_t number : numbers) {
    const std::uint32_t symbol = symbol_of_length(number).symbol;
    ++counts[symbol];
    symbols = std::max(symbols, symbol + 1);
  }
  out.push_back(static_cast<std::byte>(symbols));
  const std::size_t begin = out.size();
  HuffmanTable::write(out, std::span(counts).first(symbols));
  ByteReader lengths(std::span<const std::byte>(out).subspan(begin), "Huffman code");
  const HuffmanTable table = HuffmanTable::read(lengths, symbols);
  ListWriter bits(out);
  for (const std::uint32_t number : numbers) table.put(bits, number);
  bits.finish();
}

OwnHuffmanCode::Reader::Reader(const OwnHuffmanCode&, std::span<const std::byte> bytes)
    : bits_({}, "Huffman code", 1) {
  if (bytes.empty()) return;
  ByteReader in(bytes, "Huffman code");
  const auto symbols = in.number<std::uint8_t>();
  if (symbols == 0 || symbols > LengthSymbol::count)
    in.fail("lengths of " + std::to_string(symbols) + " symbols, of 1 to " +
            std::to_string(LengthSymbol::count));
  table_ = HuffmanTable::read(in, symbols);
  if (in.left() == 0) in.fail("a table without numbers");
  bits_ = ListBits(bytes.subspan(in.offset()), "Huffman code", 1);
}

std::size_t OwnHuffmanCode::Reader::read(std::span<std::uint32_t> out) {
  return bits_.read(out, [this](ListBits& bits) { return table_.next(bits); });
}

void SharedHuffmanCode::write_model(std::vector<std::byte>& out) {
  const std::size_t begin = out.size();
  for (const auto& counts : counts_) HuffmanTable::write(out, counts);
  ByteReader in(std::span<const std::byte>(out).subspan(begin), "model");
  read_model(in);
}

void SharedHuffmanCode::read_model(ByteReader& in) {
  for (HuffmanTable& table : tables_) table = HuffmanTable::read(in, LengthSymbol::count);
}

void SharedHuffmanCode::put(std::vector<std::byte>& out, std::span<const std::uint32_t> numbers) const {
  if (numbers.empty()) return;
  ListWriter bits(out);
  for (std::size_t i = 0; i < numbers.size(); ++i) tables_[i % 2].put(bits, numbers[i]);
  bits.finish();
}

SharedHuffmanCode::Reader::Reader(const SharedHuffmanCode& code, std::span<const std::byte> bytes)
    : bits_(bytes, "Huffman code", 1), tables_{&code.tables_[0], &code.tables_[1]} {}

std::size_t SharedHuffmanCode::Reader::read(std::span<std::uint32_t> out) {
  const HuffmanTable *now = tables_[0], *other = tables_[1];
  const std::size_t count = bits_.read(out, [&](ListBits& bits) {
    const std::uint32_t number = now->next(bits);
    std::swap(now, other);
    return number;
  });
  tables_ = {now, other};
  return count;
}

}  // namespace vismat
