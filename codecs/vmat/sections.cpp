#include "codecs/vmat/sections.h"

#include <algorithm>
#include <array>
#include <functional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "codecs/entropy/bit_stream.h"
#include "codecs/entropy/huffman.h"
#include "codecs/entropy/run_length_symbols.h"
#include "matrix/base/byte_reader.h"

namespace vismat {
namespace {

// For each member the distance back to the previous one of its group, plus 1; 1 for the first of a group.
std::vector<std::uint32_t> steps_back(const Partition& groups) {
  constexpr std::uint32_t none = 0xffffffff;
  std::vector<std::uint32_t> last(groups.groups(), none), steps;
  steps.reserve(groups.size());
  for (std::uint32_t m = 0; m < groups.size(); ++m) {
    const std::uint32_t before = std::exchange(last[groups.group_of_member()[m]], m);
    steps.push_back(before == none ? 1 : m - before + 1);
  }
  return steps;
}

// Groups in the order of their first members.
std::vector<std::uint32_t> by_first_member(const Partition& groups) {
  std::vector<bool> met(groups.groups(), false);
  std::vector<std::uint32_t> order;
  for (const std::uint32_t g : groups.group_of_member()) {
    if (met[g]) continue;
    met[g] = true;
    order.push_back(g);
  }
  return order;
}

// A short entry may be a long name: together names may be as long as this.
std::uint64_t most_of_names(std::uint64_t section_bytes) {
  return (std::uint64_t{1} << 24) + 256 * section_bytes;
}

}  // namespace

std::uint32_t small_varint(ByteReader& in, const char* what) {
  const std::uint64_t value = in.varint();
  if (value > 0xffffffff) in.fail(std::string(what) + " " + std::to_string(value) + " does not fit 32 bits");
  return static_cast<std::uint32_t>(value);
}

std::vector<std::byte> group_bytes(const Partition& groups) {
  const auto steps = steps_back(groups), order = by_first_member(groups);
  const bool sorted = std::is_sorted(order.begin(), order.end());
  std::array<std::uint64_t, LengthSymbol::count> frequencies = {};
  for (const std::uint32_t step : steps) ++frequencies[symbol_of_length(step).symbol];
  const HuffmanCode code = HuffmanCode::from_frequencies(frequencies);
  std::vector<std::byte> out;
  put_varint(out, groups.size());
  const auto order_code =
      sorted ? std::vector<std::byte>{} : order_bytes(Permutation::from_old_of_new(order));
  put_varint(out, order_code.size());
  out.insert(out.end(), order_code.begin(), order_code.end());
  code.write(out);
  BitWriter bits(out);
  for (const std::uint32_t step : steps) {
    const LengthSymbol s = symbol_of_length(step);
    code.put(bits, s.symbol);
    bits.put(s.raw, s.raw_count);
  }
  bits.flush();
  return out;
}

std::size_t group_size(const std::optional<Partition>& groups) {
  return groups ? group_bytes(*groups).size() : 0;
}

CodedGroups read_coded_groups(ByteReader& in, std::uint32_t members, std::uint32_t groups) {
  const HuffmanCode code = HuffmanCode::read(in, LengthSymbol::count);
  if (members / 8 > in.left())
    in.fail(std::to_string(members) + " members in " + std::to_string(in.left()) + " bytes");
  BitReader bits(in.bytes(in.left()));
  std::vector<std::uint32_t> map;
  map.reserve(members);
  std::uint32_t met = 0;
  while (map.size() < members) {
    const std::uint32_t symbol = code.get(bits);
    const std::uint32_t step = length_of_symbol(symbol, bits.get(raw_bits_of_symbol(symbol)));
    if (step - 1 > map.size()) in.fail("a member's group begins before the first member");
    map.push_back(step == 1 ? met++ : map[map.size() - (step - 1)]);
  }
  if (met != groups)
    in.fail(std::to_string(met) + " groups; there are " + std::to_string(groups) + " rows or columns");
  return {std::move(map), bits};
}

std::optional<Partition> groups_from_bytes(std::span<const std::byte> bytes, std::uint32_t groups) {
  if (bytes.empty()) return std::nullopt;
  ByteReader in(bytes, "groups section");
  const std::uint32_t members = small_varint(in, "member count");
  const std::uint64_t order_size = in.varint();
  if (order_size > in.left()) in.fail("an order of " + std::to_string(order_size) + " bytes in fewer");
  const auto order = order_from_bytes(in.bytes(order_size), groups);
  auto coded = read_coded_groups(in, members, groups);
  coded.rest.finish();
  try {
    auto partition = Partition::from_group_of_member(std::move(coded.group_of_member));
    // The order leads from the present groups to those in the order of their first members.
    if (order) partition = renumbered(partition, order->inverse());
    if (!std::ranges::equal(group_bytes(partition), bytes)) in.fail("another code than the writer's");
    return partition;
  } catch (const std::invalid_argument& error) {
    in.fail(error.what());
  }
}

// Boundaries ascend, those from outside first: their number, and each step between their view cells; then for each of the others
// the step from the last one's first view cell, and the step to its second.
std::vector<std::byte> boundary_bytes(std::span<const Boundary> boundaries) {
  std::vector<std::byte> out;
  if (boundaries.empty()) return out;
  std::size_t outside = 0;
  while (outside < boundaries.size() && boundaries[outside].from == Boundary::outside) ++outside;
  put_varint(out, outside);
  std::uint32_t last = 0;
  for (const Boundary& b : boundaries.first(outside)) put_varint(out, b.to - std::exchange(last, b.to));
  last = 0;
  for (const Boundary& b : boundaries.subspan(outside)) {
    put_varint(out, b.from - std::exchange(last, b.from));
    put_varint(out, b.to - b.from);
  }
  return out;
}

std::vector<Boundary> boundaries_from_bytes(std::span<const std::byte> bytes, std::uint32_t lists) {
  std::vector<Boundary> boundaries;
  if (bytes.empty()) return boundaries;
  ByteReader in(bytes, "boundary section");
  const auto cell = [&](std::uint64_t from, std::uint64_t step) {
    if (step >= Boundary::outside - from) in.fail("a cell of more than 32 bits");
    return static_cast<std::uint32_t>(from + step);
  };
  const std::uint64_t outside = in.varint();
  if (in.left() == 0) in.fail("no boundary");
  if (outside > in.left())
    in.fail(std::to_string(outside) + " boundaries from outside in " + std::to_string(in.left()) + " bytes");
  std::uint32_t last = 0;
  for (std::uint64_t i = 0; i < outside; ++i) {
    last = cell(last, in.varint());
    boundaries.push_back({Boundary::outside, last});
  }
  last = 0;
  while (in.left() > 0) {
    last = cell(last, in.varint());
    boundaries.push_back({last, cell(last, in.varint())});
  }
  if (2 * std::uint64_t{boundaries.size()} != lists) {
    in.fail(std::to_string(boundaries.size()) + " boundaries for " + std::to_string(lists) +
            " lists; there are two lists a boundary");
  }
  try {
    BoundaryMap{boundaries};
  } catch (const std::invalid_argument& error) {
    in.fail(error.what());
  }
  return boundaries;
}

// For each name the number of bytes that it begins with like the one before, the number of further bytes, and these.
std::vector<std::byte> name_bytes(std::span<const std::string> names) {
  std::vector<std::byte> out;
  std::string_view last;
  for (const std::string& name : names) {
    const auto shared = static_cast<std::size_t>(
        std::mismatch(last.begin(), last.end(), name.begin(), name.end()).first - last.begin());
    put_varint(out, shared);
    put_varint(out, name.size() - shared);
    const auto rest = std::as_bytes(std::span(name)).subspan(shared);
    out.insert(out.end(), rest.begin(), rest.end());
    last = name;
  }
  std::uint64_t length = 0;
  for (const std::string& name : names) length += name.size();
  if (length > most_of_names(out.size()))
    throw std::invalid_argument("names of " + std::to_string(length) + " bytes, nearly all of them repeated");
  return out;
}

std::vector<std::string> names_from_bytes(std::span<const std::byte> bytes) {
  ByteReader in(bytes, "names section");
  std::vector<std::string> names;
  std::string name;
  std::uint64_t left = most_of_names(bytes.size());
  while (in.left() > 0) {
    const std::uint64_t shared = in.varint(), more = in.varint();
    if (shared > name.size()) in.fail("a name begins like a longer one than the last");
    const auto rest = in.bytes(more);
    const auto* text = reinterpret_cast<const char*>(rest.data());
    if (shared < name.size() && more > 0 && name[shared] == text[0])
      in.fail("another code than the writer's");
    name.resize(shared);
    name.append(text, more);
    if (name.size() > left) in.fail("names far longer than their bytes");
    left -= name.size();
    names.push_back(name);
  }
  return names;
}

// For each column the distance of its object's number from the last column's (twice, less 1 if downwards), and the level.
std::vector<std::byte> level_bytes(std::span<const ObjectLevel> levels) {
  std::vector<std::byte> out;
  std::int64_t last = 0;
  for (const auto [object, level] : levels) {
    const std::int64_t step = object - std::exchange(last, object);
    put_varint(out, static_cast<std::uint64_t>(step < 0 ? -2 * step - 1 : 2 * step));
    put_varint(out, level);
  }
  return out;
}

std::vector<ObjectLevel> levels_from_bytes(std::span<const std::byte> bytes) {
  ByteReader in(bytes, "levels section");
  std::vector<ObjectLevel> levels;
  std::int64_t object = 0;
  while (in.left() > 0) {
    const std::uint64_t step = in.varint();
    if (step >> 34 != 0) in.fail("a step of more than 32 bits");
    object += step % 2 != 0 ? -static_cast<std::int64_t>(step / 2) - 1 : static_cast<std::int64_t>(step / 2);
    if (object < 0 || object > 0xffffffff) in.fail("an object of more than 32 bits");
    levels.push_back({static_cast<std::uint32_t>(object), small_varint(in, "level")});
  }
  return levels;
}

// The number of bands, and the rows of each band but the last.
std::vector<std::byte> band_bytes(std::span<const std::uint32_t> bands, std::uint32_t rows) {
  std::vector<std::byte> out;
  if (bands.empty()) return out;
  if (bands[0] != 0 || bands.back() >= rows ||
      std::ranges::adjacent_find(bands, std::ranges::greater_equal()) != bands.end())
    throw std::invalid_argument("bands must begin at row 0, ascend, and begin at rows that there are");
  put_varint(out, bands.size());
  for (std::size_t i = 1; i < bands.size(); ++i) put_varint(out, bands[i] - bands[i - 1]);
  return out;
}

std::vector<std::uint32_t> bands_from_bytes(std::span<const std::byte> bytes, std::uint32_t rows) {
  std::vector<std::uint32_t> bands;
  if (bytes.empty()) return bands;
  ByteReader in(bytes, "bands section");
  const std::uint64_t count = in.varint();
  if (count == 0 || count > bytes.size() || rows == 0) in.fail("no bands, or more than bytes");
  bands.push_back(0);
  while (bands.size() < count) {
    const std::uint64_t step = in.varint();
    if (step == 0 || step >= rows - bands.back()) in.fail("a band that begins behind the last row");
    bands.push_back(bands.back() + static_cast<std::uint32_t>(step));
  }
  if (in.left() != 0) in.fail("bytes after the last band");
  return bands;
}

}  // namespace vismat
