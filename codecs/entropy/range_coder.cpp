// ALGORITHM. The classic range coder with carries: the encoder keeps `low` below 2^32 after each byte sent and, when an
// addition carries past it, adds one to the bytes already written (a run of 0xff becomes 0x00). No byte is held back,
// so at the end only the few bytes are written that distinguish the final range from its neighbours: 1 or 2 for a
// node's part instead of the usual 4.
#include "codecs/entropy/range_coder.h"

#include <algorithm>
#include <numeric>

#include "codecs/entropy/bit_stream.h"

namespace vismat {

FrequencyTable FrequencyTable::from_scaled(std::span<const std::uint32_t> scaled) {
  FrequencyTable table;
  table.start_.assign(scaled.size() + 1, 0);
  std::partial_sum(scaled.begin(), scaled.end(), table.start_.begin() + 1);
  table.symbol_of_place_.reserve(table.start_.back());
  for (std::size_t s = 0; s < scaled.size(); ++s) {
    table.symbol_of_place_.insert(table.symbol_of_place_.end(), scaled[s], static_cast<std::uint16_t>(s));
  }
  return table;
}

FrequencyTable FrequencyTable::from_frequencies(std::span<const std::uint64_t> frequencies) {
  const double sum =
      static_cast<double>(std::accumulate(frequencies.begin(), frequencies.end(), std::uint64_t{0}));
  std::vector<std::uint32_t> scaled(frequencies.size(), 0);
  constexpr std::int64_t total = std::int64_t{1} << bits;
  std::int64_t left = sum == 0 ? 0 : total;
  for (std::size_t s = 0; s < scaled.size(); ++s) {
    if (frequencies[s] == 0) continue;
    scaled[s] = std::max(1u, static_cast<std::uint32_t>(static_cast<double>(frequencies[s]) / sum * total));
    left -= scaled[s];
  }
  // Rounding leaves a few places over or, with many rare symbols, too few: the most frequent symbols settle
  // it, where a place more or less matters least.
  while (left != 0) {
    const auto top = std::max_element(scaled.begin(), scaled.end());
    const std::int64_t step = left > 0 ? left : -std::min<std::int64_t>(-left, (*top + 1) / 2);
    *top = static_cast<std::uint32_t>(*top + step);
    left -= step;
  }
  return from_scaled(scaled);
}

void FrequencyTable::write(std::vector<std::byte>& out) const {
  std::uint32_t symbols = static_cast<std::uint32_t>(start_.size() - 1), last = symbols;
  while (last > 0 && frequency(last - 1) == 0) --last;
  put_varint(out, last);
  for (std::uint32_t s = 0; s < last; ++s) put_varint(out, frequency(s));
}

FrequencyTable FrequencyTable::read(ByteReader& in, std::uint32_t symbols) {
  const std::uint64_t last = in.varint();
  if (last > symbols)
    in.fail("frequencies of " + std::to_string(last) + " symbols; there are " + std::to_string(symbols));
  std::vector<std::uint32_t> scaled(symbols, 0);
  std::uint64_t sum = 0;
  for (std::uint64_t s = 0; s < last; ++s) {
    const std::uint64_t frequency = in.varint();
    sum += std::min<std::uint64_t>(frequency, 1u << 20);
    if (sum > 1u << bits) in.fail("the frequencies sum to more than 2^14");
    scaled[s] = static_cast<std::uint32_t>(frequency);
  }
  if (sum != 0 && sum != 1u << bits)
    in.fail("the frequencies sum to " + std::to_string(sum) + ", not to 2^14");
  return from_scaled(scaled);
}

void carry_into(std::vector<std::byte>& out, std::size_t begin) {
  std::size_t i = out.size();
  while (i > begin && out[--i] == std::byte{0xff}) out[i] = std::byte{0};
  out[i] = static_cast<std::byte>(std::to_integer<unsigned>(out[i]) + 1);
}

void drop_last_zeros(std::vector<std::byte>& out, std::size_t begin) {
  while (out.size() > begin && out.back() == std::byte{0}) out.pop_back();
}

void RangeEncoder::shift() {
  if (low_ >> 32 != 0) {
    carry_into(out_, begin_);
    low_ &= 0xffffffff;
  }
  out_.push_back(static_cast<std::byte>(low_ >> 24));
  low_ = low_ << 8 & 0xffffffff;
}

void RangeEncoder::put_raw(std::uint32_t value, unsigned count) {
  for (; count > 14; count -= 14) narrow(value >> (count - 14) & 0x3fff, 1, 14);
  if (count > 0) narrow(value & ((1u << count) - 1), 1, count);
}

void RangeEncoder::finish() {
  for (unsigned keep = 0; keep <= 32; keep += 8) {  // the shortest value in [low, low + range)
    const std::uint64_t mask = keep == 32 ? 0 : (std::uint64_t{0xffffffff} >> keep);
    const std::uint64_t value = (low_ + mask) & ~mask;
    if (value < low_ + range_) {
      low_ = value;
      break;
    }
  }
  for (int i = 0; i < 4; ++i) shift();
  drop_last_zeros(out_, begin_);
}

void RangeDecoder::no_symbol() {
  throw FormatError("range coder: no symbol stands here");
}

// What remains of the code value is the distance of the encoder's last value from its low. So the value that it chose is known
// without low's higher bytes.
void RangeDecoder::finish() const {
  std::uint32_t value = 0;
  for (std::size_t i = next_ - 4; i < next_; ++i)
    value = value << 8 | (i < bytes_.size() ? std::to_integer<std::uint32_t>(bytes_[i]) : 0);
  const std::uint32_t low = value - code_;
  std::uint32_t above = 0;
  for (unsigned keep = 0; keep <= 32; keep += 8) {
    above = (0 - low) & (keep == 32 ? 0 : 0xffffffffu >> keep);
    if (above < range_) break;
  }
  if (above != code_ || bytes_.size() > next_ || (!bytes_.empty() && bytes_.back() == std::byte{0}))
    throw FormatError("range coder: an encoder ends with other bytes");
}

std::uint32_t RangeDecoder::get(const FrequencyTable& table) {
  const std::uint32_t unit = range_ >> FrequencyTable::bits;
  const std::uint32_t place = code_ / unit;
  if (place >= 1u << FrequencyTable::bits || table.empty()) no_symbol();
  const std::uint32_t symbol = table.symbol_at(place);
  narrow(unit, table.start(symbol), table.frequency(symbol));
  return symbol;
}

std::uint32_t RangeDecoder::get_raw(unsigned count) {
  std::uint32_t value = 0;
  while (count > 0) {
    const unsigned now = count > 14 ? 14 : count;
    const std::uint32_t unit = range_ >> now, part = code_ / unit;
    if (part >= 1u << now) throw FormatError("range coder: no raw bits stand here");
    narrow(unit, part, 1);
    value = value << now | part;
    count -= now;
  }
  return value;
}

}  // namespace vismat
