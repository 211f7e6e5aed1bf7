#include "codecs/integer_codes/lzw.h"

#include "codecs/entropy/bit_stream.h"

namespace vismat {
namespace {

constexpr unsigned slot_bits = 13;
constexpr std::size_t slots = std::size_t{1} << slot_bits;
static_assert(slots >= 2 * LzwCode::entries);

}  // namespace

void LzwCode::put(std::vector<std::byte>& out, std::span<const std::uint32_t> numbers) {
  if (numbers.empty()) return;
  text_.clear();
  for (const std::uint32_t number : numbers) put_varint(text_, number);
  if (++list_ == 0 || slots_.empty()) {
    slots_.assign(slots, 0);
    list_ = 1;
  }
  unsigned made = 256;
  ListWriter bits(out);
  auto current = std::to_integer<std::uint32_t>(text_[0]);
  const auto send = [&] { bits.put(current, static_cast<unsigned>(std::bit_width(made - 1))); };
  for (std::size_t i = 1; i < text_.size(); ++i) {
    const auto byte = std::to_integer<std::uint32_t>(text_[i]);
    const std::uint64_t wanted = std::uint64_t{list_} << 20 | current << 8 | byte;
    std::size_t slot = (current << 8 | byte) * 0x9e3779b1u >> (32 - slot_bits);
    while (slots_[slot] >> 12 != wanted && slots_[slot] >> 32 == list_) slot = (slot + 1) % slots;
    if (slots_[slot] >> 12 == wanted) {
      current = slots_[slot] % entries;
      continue;
    }
    send();
    if (made < entries) slots_[slot] = wanted << 12 | made++;
    current = byte;
  }
  send();
  bits.finish();
}

// Writes the bytes of the next code to the end of text_.
void LzwCode::Reader::expand() {
  const auto width = static_cast<unsigned>(std::bit_width(made_ - 1));
  const auto code = static_cast<unsigned>(lowest_bits(bits_.peek(), width));
  if (code >= made_) bits_.fail("a code that no entry has");
  bits_.take(width);
  bits_.check();
  if (open_ != 0) last_[open_] = first_byte_;  // right where the code is the open entry itself
  unsigned rest = code;
  for (text_at_ = entries; rest >= 256; rest = before_[rest]) text_[--text_at_] = last_[rest];
  text_[--text_at_] = first_byte_ = static_cast<std::uint8_t>(rest);
  if (open_ != 0) last_[open_] = first_byte_;
  open_ = 0;
  if (made_ < entries) {
    open_ = made_++;
    before_[open_] = static_cast<std::uint16_t>(code);
  }
}

std::size_t LzwCode::Reader::read(std::span<std::uint32_t> out) {
  for (std::size_t count = 0;;) {
    for (; text_at_ < entries; ++text_at_) {
      if (count == out.size()) return count;
      const std::uint32_t byte = text_[text_at_];
      if (shift_ == 28 && byte > 15) bits_.fail("a number above 2^32 - 1");
      number_ |= (byte & 0x7f) << shift_;
      shift_ += 7;
      if (byte >= 0x80) continue;
      if (byte == 0) bits_.fail("a number that is 0, or written in more bytes than it needs");
      out[count++] = number_;
      number_ = 0;
      shift_ = 0;
    }
    if (bits_.ended()) {
      if (shift_ != 0) bits_.fail("the list ends within a number");
      return count;
    }
    if (count == out.size()) return count;
    expand();
  }
}

}  // namespace vismat
