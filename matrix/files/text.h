// Text as other systems write it.
#pragma once
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace vismat {

/// The text without its byte order mark; UTF-16, with a mark or begun by an ASCII character, is turned into UTF-8 in
/// `room`. Borrowed from `bytes` or `room`. Throws FormatError for UTF-32 and for UTF-16 of an odd number of bytes.
std::string_view as_utf8(std::span<const std::byte> bytes, std::string& room);

}  // namespace vismat
