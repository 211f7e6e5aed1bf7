// Lists of numbers as an integer code writes them: for tests of the codes.
#pragma once
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "matrix/base/byte_reader.h"

namespace vismat::test {

using Numbers = std::vector<std::uint32_t>;
using Bytes = std::vector<std::byte>;

template <typename Code>
constexpr bool has_model = requires(Code code, ByteReader& in) {
  code.read_model(in);
};

// What an encoder makes of lists, and a code that reads it.
template <typename Code>
struct Coded {
  Code reader;
  std::vector<Bytes> lists;
};

template <typename Code>
Coded<Code> code_lists(const std::vector<Numbers>& lists) {
  Code writer;
  Coded<Code> coded;
  if constexpr (has_model<Code>) {
    for (const Numbers& list : lists) writer.see(list);
    Bytes model;
    writer.write_model(model);
    ByteReader in(model, "model");
    coded.reader.read_model(in);
    EXPECT_EQ(in.left(), 0u);
  }
  for (const Numbers& list : lists) {
    Bytes bytes = {std::byte{0xee}};  // a list is appended to what is there
    writer.put(bytes, list);
    EXPECT_EQ(bytes[0], std::byte{0xee});
    coded.lists.emplace_back(bytes.begin() + 1, bytes.end());
  }
  return coded;
}

}  // namespace vismat::test
