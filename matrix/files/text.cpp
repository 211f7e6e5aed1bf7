#include "matrix/files/text.h"

#include <cstdint>

#include "matrix/base/byte_reader.h"

namespace vismat {
namespace {

constexpr std::string_view utf8_mark = "\xEF\xBB\xBF";

void append_utf8(std::string& text, std::uint32_t code) {
  const auto add = [&](std::uint32_t byte) { text += static_cast<char>(byte); };
  if (code < 0x80) {
    add(code);
  } else if (code < 0x800) {
    add(0xC0 | code >> 6);
    add(0x80 | (code & 0x3F));
  } else if (code < 0x10000) {
    add(0xE0 | code >> 12);
    add(0x80 | (code >> 6 & 0x3F));
    add(0x80 | (code & 0x3F));
  } else {
    add(0xF0 | code >> 18);
    add(0x80 | (code >> 12 & 0x3F));
    add(0x80 | (code >> 6 & 0x3F));
    add(0x80 | (code & 0x3F));
  }
}

std::string utf8_of_utf16(std::string_view bytes, bool big_endian) {
  if (bytes.size() % 2 != 0)
    throw FormatError("is UTF-16 of an odd number of bytes, so cut short; save it as UTF-8");
  const auto unit = [&](std::size_t at) {
    const auto first = static_cast<unsigned char>(bytes[at]),
               second = static_cast<unsigned char>(bytes[at + 1]);
    return static_cast<std::uint32_t>(big_endian ? first << 8 | second : second << 8 | first);
  };
  std::string text;
  text.reserve(bytes.size() / 2);
  for (std::size_t at = 0; at < bytes.size(); at += 2) {
    std::uint32_t code = unit(at);
    const bool high = code >= 0xD800 && code < 0xDC00;
    const std::uint32_t low = high && at + 2 < bytes.size() ? unit(at + 2) : 0;
    if (low >= 0xDC00 && low < 0xE000) {
      code = 0x10000 + ((code - 0xD800) << 10) + (low - 0xDC00);
      at += 2;
    } else if (high || (code >= 0xDC00 && code < 0xE000)) {
      code = 0xFFFD;  // half of a pair
    }
    append_utf8(text, code);
  }
  return text;
}

}  // namespace

std::string_view as_utf8(std::span<const std::byte> text, std::string& room) {
  using namespace std::literals;
  const std::string_view bytes(reinterpret_cast<const char*>(text.data()), text.size());
  if (bytes.starts_with(utf8_mark)) return bytes.substr(utf8_mark.size());
  if (bytes.starts_with("\xFF\xFE\0\0"sv) || bytes.starts_with("\0\0\xFE\xFF"sv)) {
    throw FormatError("is UTF-32; save it as UTF-8");
  }
  const bool little = bytes.starts_with("\xFF\xFE"), big = bytes.starts_with("\xFE\xFF");
  const auto ascii_at = [&](std::size_t at) { return bytes[at] > 0 && bytes[at] <= '~'; };
  if (little || big) {
    room = utf8_of_utf16(bytes.substr(2), big);
  } else if (bytes.size() >= 4 && ascii_at(0) && bytes[1] == 0 && ascii_at(2) && bytes[3] == 0) {
    room = utf8_of_utf16(bytes, false);
  } else if (bytes.size() >= 4 && bytes[0] == 0 && ascii_at(1) && bytes[2] == 0 && ascii_at(3)) {
    room = utf8_of_utf16(bytes, true);
  } else {
    return bytes;
  }
  return room;
}

}  // namespace vismat
