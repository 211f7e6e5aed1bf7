// A row as pairs of small numbers [Chhugani et al. 2005, section 6.2]: for each run of ones its gap, the number of
// zeros before it, and its length. Only the gap before the first run may be 0; one is added to it, so that every number
// is at least 1.
//
// PairRows<Code> is the row codec (row_codec.h) over a code for such numbers. Code has
//
//   void put(std::vector<std::byte>& out, std::span<const std::uint32_t> numbers)          appends one list
//   typename Code::Reader(const Code&, std::span<const std::byte> bytes)                   exactly the list's bytes
//   std::size_t Reader::read(std::span<std::uint32_t> out)   the next numbers, as many as fit or fewer; 0 at the end
//
// and, if lists share a model,
//
//   void see(std::span<const std::uint32_t> numbers)         called for every list once
//   void write_model(std::vector<std::byte>&)                after the last see(), before the first put()
//   void read_model(ByteReader&)
#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "codecs/entropy/bit_stream.h"
#include "codecs/rows/row_codec.h"

namespace vismat {

/// Bit j says that ids[j + 1] does not follow ids[j]; reads 65 ids. Written so that compilers vectorize it.
inline std::uint64_t breaks_in(const std::uint32_t* ids) {
  std::array<std::uint8_t, 64> breaks;
  for (std::size_t j = 0; j < 64; ++j) breaks[j] = ids[j + 1] - ids[j] != 1;
  std::uint64_t mask = 0;
  for (std::size_t j = 0; j < 64; j += 8) mask |= bits_of_eight(breaks.data() + j) << j;
  return mask;
}

/// Calls visit(first, count) for each run of consecutive ids.
template <typename Visit>
void for_each_run(std::span<const std::uint32_t> ids, const Visit& visit) {
  std::size_t begin = 0, i = 0;  // of the run; of what is looked at
  const auto end_at = [&](std::size_t end) {
    visit(ids[begin], static_cast<std::uint32_t>(end - begin));
    begin = end;
  };
  for (; i + 65 <= ids.size(); i += 64) {
    for (std::uint64_t mask = breaks_in(ids.data() + i); mask != 0; mask &= mask - 1)
      end_at(i + static_cast<std::size_t>(std::countr_zero(mask)) + 1);
  }
  for (; i + 1 < ids.size(); ++i) {
    if (ids[i + 1] - ids[i] != 1) end_at(i + 1);
  }
  if (!ids.empty()) end_at(ids.size());
}

/// The row's pairs, in `memory`, which grows to what a row may need and then stays.
inline std::span<const std::uint32_t> pairs_of_row(std::span<const std::uint32_t> ids,
                                                   std::vector<std::uint32_t>& memory) {
  if (memory.size() < 2 * ids.size()) memory.resize(2 * ids.size());
  std::uint32_t* next = memory.data();
  std::uint32_t counted = 0xffffffff;  // the last column that is coded; at first the one before the first
  for_each_run(ids, [&](std::uint32_t first, std::uint32_t count) {
    *next++ = first - counted;
    *next++ = count;
    counted = first + count;
  });
  return {memory.data(), next};
}

template <typename Code>
class PairRows {
 public:
  static constexpr bool escapes = true;
  static PairRows fit([[maybe_unused]] const VisibilityMatrix& matrix) {
    PairRows rows;
    if constexpr (has_model) {
      for (std::uint32_t r = 0; r < matrix.shape().rows; ++r) {
        rows.code_.see(pairs_of_row(matrix.row(r), rows.memory_));
      }
    }
    return rows;
  }
  void write_model([[maybe_unused]] std::vector<std::byte>& out) {
    if constexpr (has_model) code_.write_model(out);
  }
  static PairRows read_model([[maybe_unused]] ByteReader& in, Shape) {
    PairRows rows;
    if constexpr (has_model) rows.code_.read_model(in);
    return rows;
  }
  void encode(std::span<const std::uint32_t> ids, std::vector<std::byte>& out) {
    code_.put(out, pairs_of_row(ids, memory_));
  }
  template <typename Sink>
  void decode(std::span<const std::byte> bytes, Sink& sink) const {
    typename Code::Reader reader(code_, bytes);
    std::array<std::uint32_t, 256> buffer;
    std::size_t held = 0;  // 1 if a pair's first number waits for its second
    std::uint32_t before_first = 1;
    for (;;) {
      const std::size_t count = held + reader.read(std::span(buffer).subspan(held));
      if (count == held) break;
      for (std::size_t i = 0; i + 1 < count; i += 2) {
        sink.run(buffer[i] - before_first, buffer[i + 1]);
        before_first = 0;
      }
      held = count % 2;
      if (held != 0) buffer[0] = buffer[count - 1];
    }
    if (held != 0) throw FormatError("a gap without a run behind it");
  }

 private:
  static constexpr bool has_model = requires(Code code, ByteReader& in) { code.read_model(in); };
  Code code_;
  std::vector<std::uint32_t> memory_;
};

}  // namespace vismat
