#include "codecs/sections.h"

#include <algorithm>
#include <array>
#include <bit>
#include <stdexcept>
#include <string>
#include <utility>

#include "codecs/bit_stream.h"
#include "codecs/huffman.h"
#include "codecs/run_length_symbols.h"
#include "matrix/byte_reader.h"

namespace vismat {
namespace {

std::uint32_t small_varint(ByteReader& in, const char* what) {
  const std::uint64_t value = in.varint();
  if (value > 0xffffffff) in.fail(std::string(what) + " " + std::to_string(value) + " does not fit 32 bits");
  return static_cast<std::uint32_t>(value);
}

// As many bits a place as the largest one needs.
unsigned place_bits(std::uint32_t size) {
  return size < 2 ? 0 : static_cast<unsigned>(std::bit_width(size - 1));
}

// Of each member how many members back the last one of its group stands, plus 1; 1 for the first of a group.
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

// Groups in the order in which their first members stand.
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

}  // namespace

// Parents as the step back from each node, objects as 0 for none or 1 + object: small numbers, one byte
// mostly.
std::vector<std::byte> tree_bytes(const std::optional<ObjectTree>& tree) {
  std::vector<std::byte> out;
  if (!tree) return out;
  put_varint(out, tree->object_count());
  put_varint(out, tree->size());
  for (std::uint32_t n = 1; n < tree->size(); ++n) put_varint(out, n - tree->parent_of_node()[n]);
  for (const std::uint32_t object : tree->object_of_node())
    put_varint(out, object == ObjectTree::none ? 0 : std::uint64_t{object} + 1);
  return out;
}

std::optional<ObjectTree> tree_from_bytes(std::span<const std::byte> bytes) {
  if (bytes.empty()) return std::nullopt;
  ByteReader in(bytes, "tree section");
  const std::uint32_t objects = small_varint(in, "object count");
  const std::uint64_t size = in.varint();
  if (size > in.left()) in.fail(std::to_string(size) + " nodes in " + std::to_string(in.left()) + " bytes");
  std::vector<std::uint32_t> parents, objects_of_node;
  for (std::uint32_t n = 0; n < size; ++n) {
    const std::uint32_t back = n == 0 ? 0 : small_varint(in, "step to a parent");
    if (n > 0 && (back == 0 || back > n))
      in.fail("node " + std::to_string(n) + " has its parent " + std::to_string(back) + " back");
    parents.push_back(n == 0 ? ObjectTree::none : n - back);
  }
  for (std::uint32_t n = 0; n < size; ++n)
    objects_of_node.push_back(small_varint(in, "object") - 1);  // 0 becomes none
  if (in.left() != 0) in.fail("bytes after the last node");
  try {
    return ObjectTree::from_parents(std::move(parents), std::move(objects_of_node), objects);
  } catch (const std::invalid_argument& error) {
    throw FormatError(std::string("tree section: ") + error.what());
  }
}

std::vector<std::byte> order_bytes(const std::optional<Permutation>& order) {
  std::vector<std::byte> out;
  if (!order) return out;
  BitWriter bits(out);
  for (const std::uint32_t place : order->new_of_old()) bits.put(place, place_bits(order->size()));
  bits.flush();
  return out;
}

std::optional<Permutation> order_from_bytes(std::span<const std::byte> bytes, std::uint32_t size) {
  if (bytes.empty()) return std::nullopt;
  const std::uint64_t need = (std::uint64_t{size} * place_bits(size) + 7) / 8;
  if (bytes.size() != need) {
    throw FormatError("an order of " + std::to_string(bytes.size()) + " bytes; " + std::to_string(size) +
                      " places take " + std::to_string(need));
  }
  BitReader bits(bytes);
  std::vector<std::uint32_t> map(size);
  for (std::uint32_t& place : map) place = bits.get(place_bits(size));
  bits.finish();
  try {
    return Permutation::from_new_of_old(std::move(map));
  } catch (const std::invalid_argument& error) {
    throw FormatError(std::string("order section: ") + error.what());
  }
}

std::vector<std::byte> group_bytes(const std::optional<Partition>& groups) {
  std::vector<std::byte> out;
  if (!groups) return out;
  const auto steps = steps_back(*groups), order = by_first_member(*groups);
  const bool sorted = std::is_sorted(order.begin(), order.end());
  std::array<std::uint64_t, LengthSymbol::count> frequencies = {};
  for (const std::uint32_t step : steps) ++frequencies[symbol_of_length(step).symbol];
  const HuffmanCode code = HuffmanCode::from_frequencies(frequencies);
  put_varint(out, groups->size());
  out.push_back(static_cast<std::byte>(!sorted));
  code.write(out);
  BitWriter bits(out);
  for (const std::uint32_t step : steps) {
    const LengthSymbol s = symbol_of_length(step);
    code.put(bits, s.symbol);
    bits.put(s.raw, s.raw_count);
  }
  if (!sorted) {
    for (const std::uint32_t g : order) bits.put(g, place_bits(groups->groups()));
  }
  bits.flush();
  return out;
}

std::optional<Partition> groups_from_bytes(std::span<const std::byte> bytes, std::uint32_t groups) {
  if (bytes.empty()) return std::nullopt;
  ByteReader in(bytes, "groups section");
  const std::uint32_t members = small_varint(in, "member count");
  const auto sorted = in.number<std::uint8_t>() == 0;
  const HuffmanCode code = HuffmanCode::read(in, LengthSymbol::count);
  if (members / 8 > in.left())
    in.fail(std::to_string(members) + " members in " + std::to_string(in.left()) + " bytes");
  BitReader bits(bytes.subspan(in.offset()));
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
  try {
    auto partition = Partition::from_group_of_member(std::move(map));
    if (!sorted) {
      std::vector<std::uint32_t> order(groups);
      for (std::uint32_t& g : order) g = bits.get(place_bits(groups));
      if (!bits.overran()) partition = renumbered(partition, Permutation::from_new_of_old(std::move(order)));
    }
    bits.finish();
    if (!std::ranges::equal(group_bytes(partition), bytes)) in.fail("another code than the writer's");
    return partition;
  } catch (const std::invalid_argument& error) {
    in.fail(error.what());
  }
}

// Boundaries ascend, those from outside first: how many these are, each step between their cells; then of each of the others
// the step from the last one's first cell and the step to its second.
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

std::vector<Boundary> boundaries_from_bytes(std::span<const std::byte> bytes, std::uint32_t rows) {
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
  if (2 * std::uint64_t{boundaries.size()} != rows) {
    in.fail(std::to_string(boundaries.size()) + " boundaries for " + std::to_string(rows) +
            " rows; there are two rows a boundary");
  }
  try {
    BoundaryMap{boundaries};
  } catch (const std::invalid_argument& error) {
    in.fail(error.what());
  }
  return boundaries;
}

}  // namespace vismat
