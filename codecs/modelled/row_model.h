// How a row is coded under two reference rows: the decisions in their order, and the contexts of each. A writer and a
// reader run the same code (code_row), so they cannot disagree. docs/vmat.md, "Modelled rows", says the same in words.
#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "codecs/modelled/common_runs.h"
#include "codecs/modelled/row_tables.h"

namespace vismat {

/// A row as its run ends: the columns where its value changes, ascending; before column 0 the value is 0. Behind the
/// last one stand `Ends::sentinels` numbers, each of them the number of columns.
struct Ends {
  static constexpr std::uint32_t sentinels = 4;
  const std::uint32_t* at = nullptr;
  std::uint32_t count = 0;
};

/// Numbers have weights by their kind, by the octave of the largest possible, and by an octave.
inline constexpr std::uint32_t number_kinds = 15, number_sizes = 12, number_octaves = 16;

/// Where each table of weights begins in row_weights. The contexts of a decision are one place in each of its tables;
/// the sum of the weights there gives its probability.
enum RowTable : std::uint32_t {
  copy_shape = 0,                   // a segment's values and what changes at its ends; its length
  copy_recent = copy_shape + 1024,  // the last outcomes where A is the same, and if B told them; its length
  copy_left = copy_recent + 1024,   // how many of the segments left change; its length
  all_shape = copy_left + 1024,
  all_recent = all_shape + 256,
  prefix_shape = all_recent + 64,
  suffix_shape = prefix_shape + 256,
  single_room = suffix_shape + 128,
  more_room = single_room + 8,
  common_run = more_room + 8,  // how many common runs fit; the room
  octaves = common_run + 80,   // of a number: kind, octave of the largest possible, octave
  halves = octaves + number_kinds * number_sizes * number_octaves,  // kind, octave
  raw_row = halves + number_kinds * number_octaves,
  reference_back = raw_row + 1,  // how many rows of the group were passed
  reference_kept = reference_back + 16,
  group_kept = reference_kept + 1,
  group_back = group_kept + 1,  // how many groups of the chain were passed
  second_other =
      group_back + 8,  // a kept row, the first of a group, any other; octave of the reference's run ends
  second_kept = second_other + 24,
  second_named = second_kept + 24,
  table_end = second_named + 1,
};

/// Throws FormatError: more segments change than there are.
[[noreturn]] void refuse_row();

static_assert(table_end == row_weight_count);

/// Each kind of number has probabilities of its own.
enum class NumberKind : std::uint32_t {
  prefix,
  suffix,
  middle,
  gap,
  run,
  changes,
  group,
  within,
  kept,
  distance,
  second,
  runs,
  run_gap,
  run_length,
  run_octave
};

/// Twice the logarithm to base 2, rounded down, of x > 0, plus 2.
inline std::uint32_t half_octaves(std::uint32_t x) {
  const auto bits = static_cast<std::uint32_t>(std::bit_width(x));
  return 2 * bits + (bits < 2 ? 0 : x >> (bits - 2) & 1);
}

/// 0 for length 1, then the number of bits of length - 1; at most 7.
inline std::uint32_t length_class(std::uint32_t length) {
  return std::min(static_cast<std::uint32_t>(std::bit_width(length - 1)), 7u);
}

/// Codes `value` in [1, most]: the place of its leading one in unary, the bit below it, the rest with even chances.
template <typename Coder>
[[gnu::always_inline]] inline std::uint32_t code_number(Coder& coder, NumberKind kind, std::uint32_t most,
                                                        std::uint32_t value) {
  const auto of_kind = static_cast<std::uint32_t>(kind);
  const auto top = static_cast<std::uint32_t>(std::bit_width(most)) - 1;
  const auto mine = static_cast<std::uint32_t>(std::bit_width(value)) - 1;
  const std::uint32_t table =
      octaves + (of_kind * number_sizes + std::min(top, number_sizes - 1)) * number_octaves;
  std::uint32_t octave = 0;
  while (octave < top && coder.decide(mine > octave, table + std::min(octave, number_octaves - 1))) ++octave;
  if (octave == 0) return 1;
  const std::uint32_t low = 1u << octave, middle = low + low / 2, high = octave == top ? most : 2 * low - 1;
  if (high < middle) return low + coder.even(high - low + 1, value - low);
  const bool upper =
      coder.decide(value >= middle, halves + of_kind * number_octaves + std::min(octave, number_octaves - 1));
  const std::uint32_t from = upper ? middle : low, to = upper ? high : middle - 1;
  return from == to ? from : from + coder.even(to - from + 1, value - from);
}

/// A place in a row that is written: `next` is the first run end behind it.
struct RowCursor {
  const std::uint32_t* next = nullptr;
  bool value = false;
  void pass(std::uint32_t column) {
    while (*next <= column) ++next, value = !value;
  }
};

/// The number of segments, between the run ends of the references a and b, in which the row differs from a somewhere.
std::uint32_t changed_segments(Ends a, Ends b, Ends row, std::uint32_t columns);

/// What code_row and code_raw (row_groups.h) give to a writer.
struct NoOut {
  void room(std::uint32_t) {}
  void to(std::uint32_t, std::uint32_t) {}
};

/// Codes a row of `columns` columns under the references a and b. A writer's coder takes the row from `row`, of which
/// `changes` segments differ from a; a reader's gives it to `out`, which has
///   room(n)          must be called before n calls of to()
///   to(column, v)    the value is v from this column on
///   copy(ends)       the rest of the row is as these run ends say; a reader's only
/// A writer's coder may have before_run(room, run), called where a row has a run that its references lack, with the columns
/// where that may be and those where it is, and after_run(), called when it is coded.
/// A reader throws FormatError where fewer segments change than the row says.
template <typename Coder, typename Out>
[[gnu::always_inline]] inline void code_row(Coder& coder, Ends a, Ends b, const CommonRuns& runs,
                                            std::uint32_t named, std::uint32_t columns, RowCursor row,
                                            std::uint32_t changes, Out& out) {
  constexpr bool reads = Coder::reads;
  const std::uint32_t *next_a = a.at, *next_b = b.at;
  std::uint32_t left = code_number(coder, NumberKind::changes, a.count + b.count + 2, changes + 1) - 1;
  std::uint32_t at = 0, value = 0, other = 0;
  std::uint32_t recent = 0, flipped = 0;
  std::uint32_t recent_of[2] = {}, agreed_of[2] = {};  // the same, of segments of either value
  std::uint32_t few = left > 0 ? half_octaves(left) : 0;
  out.room(a.count + b.count + 4);
  while (left > 0) {
    if constexpr (reads) {
      if (at >= columns) [[unlikely]]
        refuse_row();
    }
    // The segment [at, end), in which neither reference changes.
    const std::uint32_t at_a = *next_a == at, at_b = *next_b == at;
    next_a += at_a;
    next_b += at_b;
    value ^= at_a;
    other ^= at_b;
    const std::uint32_t end = std::min(*next_a, *next_b), length = end - at;
    const std::uint32_t end_a = *next_a == end, end_b = *next_b == end;
    if constexpr (!reads) row.pass(at);
    const std::uint32_t size = length_class(length), differ = value ^ other;
    const std::uint32_t shape = value | differ << 1 | at_a << 2 | at_b << 3 | flipped << 4;
    const auto segments =
        static_cast<std::uint32_t>((a.at + a.count - next_a) + (b.at + b.count - next_b)) + 1;
    const std::uint32_t many = half_octaves(segments);
    const std::uint32_t ratio = many > few ? std::min(many - few, 15u) : 0;
    const bool changed =
        coder.decide(reads || row.value != bool(value) || *row.next < end,
                     copy_shape + shape + end_a * 32 + end_b * 64 + size * 128,
                     copy_recent + differ + (agreed_of[value] & 7) * 2 + (recent_of[value] & 7) * 16 +
                         named * 128 + std::min(size, 3u) * 256,
                     copy_left + ratio + (std::min(left, 8u) - 1) * 16 + size * 128);
    // What follows from the decision stands in branches, which a processor predicts, rather than in sums, which wait.
    if (!changed) {
      recent <<= 1;
      recent_of[value] <<= 1;
      agreed_of[value] <<= differ;
      flipped = 0;
      out.to(at, value);
      at = end;
      continue;
    }
    recent = recent << 1 | 1;
    recent_of[value] = recent_of[value] << 1 | 1;
    agreed_of[value] = agreed_of[value] << 1 | differ;
    --left;
    if (left > 0) few = half_octaves(left);
    const std::uint32_t ends = end_a + 2 * end_b;
    if (length == 1 || coder.decide(!reads && row.value != bool(value) && *row.next >= end,
                                    all_shape + shape + size * 32, all_recent + (recent & 15) + ends * 16)) {
      out.to(at, value ^ 1);
      flipped = 1;
      at = end;
      continue;
    }
    // A part of it is flipped.
    std::uint32_t from = at;
    at = end;
    flipped = 0;
    if (coder.decide(!reads && row.value != bool(value), prefix_shape + shape + size * 32)) {
      const std::uint32_t part =
          code_number(coder, NumberKind::prefix, length - 1, reads ? 1 : *row.next - from);
      out.to(from, value ^ 1);
      from += part;
      out.to(from, value);
      if constexpr (!reads) row.pass(from);
      if (end - from < 2 || !coder.decide(!reads && *row.next < end, more_room + length_class(end - from)))
        continue;
    } else {
      out.to(from, value);
    }
    for (;;) {  // column `from` is not flipped, but a later one is
      const std::uint32_t room = end - from;
      std::uint32_t start = 0, part = 1;
      if constexpr (!reads) {
        start = *row.next;
        part = std::min(row.next[1], end) - start;
      }
      out.room(a.count + b.count + 8);
      if (room == 2 || coder.decide(!reads && start + part == end,
                                    suffix_shape + length_class(room) + ends * 8 + differ * 32)) {
        part = code_number(coder, NumberKind::suffix, room - 1, part);
        out.to(end - part, value ^ 1);
        flipped = 1;
        break;
      }
      const bool last =
          room == 3 || coder.decide(!reads && row.next[2] >= end, single_room + length_class(room));
      const CommonRuns::Slots slots = room == 3 ? CommonRuns::Slots{} : runs.starting(from + 1, end);
      std::uint32_t common = CommonRuns::none;
      if constexpr (!reads) {
        if (slots.count > 0) common = runs.find(start, start + part);
      }
      if constexpr (requires { coder.after_run(); }) coder.before_run({from + 1, end}, {start, start + part});
      if (slots.count > 0 &&
          coder.decide(common != CommonRuns::none,
                       common_run +
                           std::min(static_cast<std::uint32_t>(std::bit_width(slots.count)), 9u) * 8 +
                           length_class(room))) {
        if constexpr (reads) common = runs.of_slot(slots.first + coder.aim(slots.count));
        const CommonRuns::Run& run = runs[common];
        coder.take(slots.count, runs.first_slot(common) - slots.first, run.octave);
        if constexpr (reads) {
          if (run.end + (last ? 0u : 1u) >= end) [[unlikely]]
            refuse_row();
        }
        start = run.start;
        part = run.end - run.start;
      } else if (last) {
        part = code_number(coder, NumberKind::middle, room - 2, part);
        const std::uint32_t places = room - 1 - part;
        start = from + 1 + (places > 1 ? coder.even(places, start - from - 1) : 0);
      } else {
        start = from + code_number(coder, NumberKind::gap, room - 3, start - from);
        part = code_number(coder, NumberKind::run, end - start - 2, part);
      }
      if constexpr (requires { coder.after_run(); }) coder.after_run();
      out.to(start, value ^ 1);
      from = start + part;
      out.to(from, value);
      if (last) break;
      if constexpr (!reads) row.pass(from);
    }
  }
  if constexpr (reads) {
    if (at < columns) out.copy(at, value, std::span(next_a, a.at + a.count));
  }
}

}  // namespace vismat
