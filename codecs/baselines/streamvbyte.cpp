// The row codec `streamvbyte`: a row's pairs in Stream VByte [Lemire, Kurz, Rupp 2018], by libstreamvbyte.
//
//   varint count; ceil(count / 4) control bytes, two bits for each number from the lowest on: its length less one; the numbers' bytes
//
// The library neither checks sizes nor stops where its input ends: it reads up to 16 bytes beyond. So 256 numbers at a
// time are copied to a padded buffer, after their control bytes have been compared with the bytes that there are.
#include <streamvbyte.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string>

#include "codecs/baselines/baseline_parts.h"
#include "codecs/entropy/bit_stream.h"
#include "codecs/rows/pairs.h"

namespace vismat {
namespace {

using Bytes = std::span<const std::byte>;

class StreamVByte {
 public:
  void put(std::vector<std::byte>& out, std::span<const std::uint32_t> numbers) const {
    const auto count = static_cast<std::uint32_t>(numbers.size());
    put_varint(out, count);
    const std::size_t begin = out.size();
    out.resize(begin + std::size_t{count} * 4 + count / 4 + 1);
    auto* const to = reinterpret_cast<std::uint8_t*>(out.data() + begin);
    out.resize(begin + streamvbyte_encode(numbers.data(), count, to));
  }

  class Reader {
   public:
    Reader(const StreamVByte&, Bytes bytes) {
      ByteReader in(bytes, "Stream VByte row");
      const std::uint64_t count = in.varint();
      if (count > in.left()) in.fail(std::to_string(count) + " numbers are announced");
      left_ = count;
      control_ = in.bytes((left_ + 3) / 4);
      data_ = in.bytes(in.left());
      if (data_size(control_, left_) != data_.size())
        throw FormatError("Stream VByte row: " + std::to_string(data_.size()) +
                          " bytes of numbers, not the " + std::to_string(data_size(control_, left_)) +
                          " announced");
      if (left_ % 4 != 0 && std::to_integer<unsigned>(control_.back()) >> (left_ % 4 * 2) != 0)
        throw FormatError("Stream VByte row: control bits behind the last number");
    }

    std::size_t read(std::span<std::uint32_t> out) {
      const std::size_t count = std::min(left_, std::min(piece, out.size()) / 4 * 4),
                        controls = (count + 3) / 4;
      if (count == 0) return 0;
      const std::size_t size = data_size(control_.first(controls), count);
      std::array<std::byte, piece / 4 + piece * 4 + padding> buffer;
      std::memcpy(buffer.data(), control_.data(), controls);
      std::memcpy(buffer.data() + controls, data_.data(), size);
      std::memset(buffer.data() + controls + size, 0, padding);
      streamvbyte_decode(reinterpret_cast<const std::uint8_t*>(buffer.data()), out.data(),
                         static_cast<std::uint32_t>(count));
      for (const std::uint32_t number : out.first(count)) {
        if (number == 0) throw FormatError("Stream VByte row: a zero among the numbers");
      }
      control_ = control_.subspan(controls);
      data_ = data_.subspan(size);
      left_ -= count;
      return count;
    }

   private:
    static constexpr std::size_t piece = 256, padding = 16;
    // The length of `count` numbers; unused bits of the last control byte must be zero, which means one byte each.
    static std::size_t data_size(Bytes control, std::size_t count) {
      std::size_t size = count;
      for (const std::byte four : control) {
        const auto c = std::to_integer<unsigned>(four);
        size += (c & 3) + (c >> 2 & 3) + (c >> 4 & 3) + (c >> 6);
      }
      return size;
    }
    std::size_t left_ = 0;
    Bytes control_, data_;
  };
};

}  // namespace

Codec streamvbyte_baseline() {
  return row_codec<PairRows<StreamVByte>>("streamvbyte", "gaps and runs in Stream VByte", Origin::baseline);
}

}  // namespace vismat
