#include "matrix/files/text.h"

#include <cstdint>

#include "matrix/base/byte_reader.h"

namespace vismat {
namespace {

void append_utf8(std::string& text, std::uint32_t character) {
  const auto put = [&](std::uint32_t byte) { text += static_cast<char>(byte); };
  const auto tail = [&](int shift) { put(0x80 | ((character >> shift) & 0x3f)); };
  if (character < 0x80) return put(character);
  if (character < 0x800) {
    put(0xc0 | (character >> 6));
  } else {
    if (character < 0x10000) {
      put(0xe0 | (character >> 12));
    } else {
      put(0xf0 | (character >> 18));
      tail(12);
    }
    tail(6);
  }
  tail(0);
}

std::string utf8_of_utf16(std::string_view bytes, bool big_endian) {
  if (bytes.size() % 2 != 0)
    throw FormatError("is UTF-16 of an odd number of bytes, so cut short; save it as UTF-8");
  const auto unit = [&](std::size_t i) {
    const auto first = static_cast<std::uint8_t>(bytes[i]), second = static_cast<std::uint8_t>(bytes[i + 1]);
    return static_cast<std::uint32_t>(big_endian ? first << 8 | second : second << 8 | first);
  };
  std::string text;
  text.reserve(bytes.size() / 2);
  for (std::size_t i = 0; i < bytes.size(); i += 2) {
    std::uint32_t character = unit(i);
    if (character >> 10 == 0x36 && i + 2 < bytes.size() && unit(i + 2) >> 10 == 0x37) {
      character = 0x10000 + ((character & 0x3ff) << 10 | (unit(i + 2) & 0x3ff));
      i += 2;
    }
    append_utf8(text, character);
  }
  return text;
}

}  // namespace

std::string_view as_utf8(std::span<const std::byte> bytes, std::string& room) {
  using namespace std::string_view_literals;
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with("\xef\xbb\xbf")) return text.substr(3);
  if (text.starts_with("\xff\xfe\0\0"sv) || text.starts_with("\0\0\xfe\xff"sv))
    throw FormatError("is UTF-32; save it as UTF-8");
  const bool little = text.starts_with("\xff\xfe"), big = text.starts_with("\xfe\xff");
  if (little || big) {
    text.remove_prefix(2);
  } else if (text.size() < 2 || (text[0] == 0) == (text[1] == 0)) {
    return text;
  }
  return room = utf8_of_utf16(text, big || (!little && text[0] == 0));
}

}  // namespace vismat
