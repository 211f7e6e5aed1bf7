// The row codec `roaring`: rows as Roaring bitmaps [Lemire et al. 2016], by CRoaring, in the portable format.
//
// CRoaring 0.2.66 trusts what it reads except the ends of containers: ids out of order, runs past 65535 or a wrong
// cardinality make it read or write out of bounds later. So check() examines all bytes first; newer versions have a
// function for that, and whoever reads untrusted files pays for it too. A row's bitmap is built anew, container by
// container, since the library has no other way to read ids from this format.
#include <roaring/roaring.h>

#include <array>
#include <bit>
#include <memory>
#include <new>
#include <string>

#include "codecs/baselines/baseline_parts.h"
#include "codecs/rows/pairs.h"

namespace vismat {
namespace {

using Bytes = std::span<const std::byte>;

struct FreeBitmap {
  void operator()(roaring_bitmap_t* bitmap) const { roaring_bitmap_free(bitmap); }
};
using Bitmap = std::unique_ptr<roaring_bitmap_t, FreeBitmap>;

// A container holds 2^16 columns, in one of three forms.
constexpr std::uint32_t largest_array = 4096;
constexpr std::size_t bitset_bytes = 8192;

template <typename Number>
Number number(Bytes bytes, std::size_t i) {
  return number_at<Number>(bytes, i * sizeof(Number));
}

void check_array(ByteReader& in, std::uint32_t ones) {
  const Bytes ids = in.bytes(std::size_t{ones} * 2);
  bool ascend = true;
  for (std::size_t i = 1; i < ones; ++i)
    ascend &= number<std::uint16_t>(ids, i - 1) < number<std::uint16_t>(ids, i);
  if (!ascend) in.fail("ids do not ascend");
}

void check_count(const ByteReader& in, std::uint32_t found, std::uint32_t announced) {
  if (found != announced)
    in.fail(std::to_string(found) + " ones where " + std::to_string(announced) + " are announced");
}

void check_bitset(ByteReader& in, std::uint32_t ones) {
  const Bytes words = in.bytes(bitset_bytes);
  std::uint32_t found = 0;
  for (std::size_t i = 0; i < bitset_bytes / 8; ++i)
    found += static_cast<std::uint32_t>(std::popcount(number<std::uint64_t>(words, i)));
  check_count(in, found, ones);
}

void check_runs(ByteReader& in, std::uint32_t ones) {
  const std::size_t runs = in.number<std::uint16_t>();
  const Bytes pairs = in.bytes(runs * 4);
  std::uint32_t found = 0, free = 0;  // where the next run may begin
  bool apart = true;
  for (std::size_t i = 0; i < runs; ++i) {
    const std::uint32_t first = number<std::uint16_t>(pairs, 2 * i),
                        last = first + number<std::uint16_t>(pairs, 2 * i + 1);
    apart &= first >= free && last <= 65535;
    found += last - first + 1;
    free = last + 2;
  }
  if (!apart) in.fail("runs overlap, touch, or leave their container");
  check_count(in, found, ones);
}

// FormatError unless these are exactly one bitmap of github.com/RoaringBitmap/RoaringFormatSpec with non-empty containers.
void check(Bytes bytes) {
  constexpr std::uint32_t without_runs = 12346, with_runs = 12347;
  ByteReader in(bytes, "roaring row");
  const auto cookie = in.number<std::uint32_t>();
  const bool may_run = (cookie & 0xffff) == with_runs;
  if (!may_run && cookie != without_runs) in.fail("no Roaring bitmap");
  const std::uint32_t count = may_run ? (cookie >> 16) + 1 : in.number<std::uint32_t>();
  if (count > 65536) in.fail(std::to_string(count) + " containers");
  const Bytes run_flags = in.bytes(may_run ? (count + 7) / 8 : 0);
  const auto runs = [&](std::uint32_t i) {
    return may_run && (run_flags[i / 8] >> (i % 8) & std::byte{1}) != std::byte{0};
  };
  for (std::size_t i = count; i < 8 * run_flags.size(); ++i) {
    if (runs(static_cast<std::uint32_t>(i))) in.fail("runs in a container that is not there");
  }
  ByteReader heads(in.bytes(std::size_t{count} * 4), "roaring row's heads");
  ByteReader offsets(in.bytes(may_run && count < 4 ? 0 : std::size_t{count} * 4), "roaring row's offsets");
  int last_key = -1;
  for (std::uint32_t i = 0; i < count; ++i) {
    const int key = heads.number<std::uint16_t>();
    const std::uint32_t ones = heads.number<std::uint16_t>() + 1u;
    if (key <= last_key) heads.fail("containers do not ascend");
    last_key = key;
    if (offsets.left() > 0 && offsets.number<std::uint32_t>() != in.offset())
      offsets.fail("not where container " + std::to_string(i) + " begins");
    if (runs(i))
      check_runs(in, ones);
    else if (ones > largest_array)
      check_bitset(in, ones);
    else
      check_array(in, ones);
  }
  if (in.left() != 0) in.fail(std::to_string(in.left()) + " bytes after the bitmap");
}

struct RoaringRows {
  static constexpr bool escapes = false;
  static RoaringRows fit(const VisibilityMatrix&) { return {}; }
  void write_model(std::vector<std::byte>&) const {}
  static RoaringRows read_model(ByteReader&, Shape) { return {}; }
  void encode(std::span<const std::uint32_t> ids, std::vector<std::byte>& out) const {
    const Bitmap bitmap(roaring_bitmap_of_ptr(ids.size(), ids.data()));
    if (bitmap == nullptr) throw std::bad_alloc();
    roaring_bitmap_run_optimize(bitmap.get());
    const std::size_t begin = out.size();
    out.resize(begin + roaring_bitmap_portable_size_in_bytes(bitmap.get()));
    roaring_bitmap_portable_serialize(bitmap.get(), reinterpret_cast<char*>(out.data() + begin));
  }
  template <typename Sink>
  void decode(Bytes bytes, Sink& sink) const {
    check(bytes);
    const Bitmap bitmap(
        roaring_bitmap_portable_deserialize_safe(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    if (bitmap == nullptr) throw std::bad_alloc();
    roaring_uint32_iterator_t ids;
    roaring_init_iterator(bitmap.get(), &ids);
    std::array<std::uint32_t, 1024> some;
    while (const std::uint32_t count = roaring_read_uint32_iterator(&ids, some.data(), some.size())) {
      for_each_run(std::span(some).first(count),
                   [&](std::uint32_t first, std::uint32_t length) { sink.run(first - sink.next(), length); });
    }
  }
};

}  // namespace

Codec roaring_baseline() {
  return row_codec<RoaringRows>("roaring", "Roaring bitmaps after runOptimize, portable format",
                                Origin::baseline);
}

}  // namespace vismat
