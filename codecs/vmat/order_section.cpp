// ALGORITHM. The section that stores an order. An order that a tour made is a path through the source's numbers on
// which the next number is often near: near if those that are visited already are not counted. So each step is coded by
// its direction and by the count of unvisited numbers between, under adaptive probabilities (docs/codecs.md has
// figures). A Fenwick tree counts the unvisited. The path goes through the source's numbers in the present order, or
// through the present numbers in the source's order, whichever is shorter.
#include <algorithm>

#include "codecs/entropy/bit_stream.h"
#include "codecs/entropy/steps.h"
#include "codecs/vmat/sections.h"

namespace vismat {
namespace {

std::vector<std::byte> way_bytes(std::span<const std::uint32_t> way, bool inverse) {
  std::vector<std::byte> out = {std::byte{inverse}};
  AdaptiveWriter coder(out);
  Steps steps(static_cast<std::uint32_t>(way.size()));
  for (const std::uint32_t place : way) steps.code(coder, place);
  coder.finish();
  return out;
}

}  // namespace

std::vector<std::byte> order_bytes(const Permutation& order) {
  auto visits = way_bytes(order.old_of_new(), false), places = way_bytes(order.new_of_old(), true);
  return places.size() < visits.size() ? places : visits;
}

std::optional<Permutation> order_from_bytes(std::span<const std::byte> bytes, std::uint32_t size) {
  if (bytes.empty()) return std::nullopt;
  ByteReader in(bytes, "order section");
  const auto inverse = in.number<std::uint8_t>();
  if (inverse > 1) in.fail("neither visits nor places");
  check_backed(size, bytes.size(), "places of an order");
  AdaptiveReader coder(bytes.subspan(1));
  Steps steps(size);
  std::vector<std::uint32_t> way(size);
  for (std::uint32_t& place : way) place = steps.code(coder, 0);
  auto order =
      inverse ? Permutation::from_new_of_old(std::move(way)) : Permutation::from_old_of_new(std::move(way));
  if (!std::ranges::equal(order_bytes(order), bytes)) in.fail("another code than the writer's");
  return order;
}

}  // namespace vismat
