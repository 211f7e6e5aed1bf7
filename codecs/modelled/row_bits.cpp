#include "codecs/modelled/row_bits.h"

#include <array>
#include <cmath>

#include "matrix/base/byte_reader.h"

namespace vismat {

RowEnds::RowEnds(const VisibilityMatrix& matrix) : columns_(matrix.shape().columns), begin_{0} {
  const std::uint32_t rows = matrix.shape().rows;
  for (std::uint32_t r = 0; r <= rows; ++r) {
    constexpr std::uint64_t nowhere = ~std::uint64_t{0};
    std::uint64_t behind = nowhere;  // the last run
    const auto end_run = [&] {
      if (behind < columns_) ends_.push_back(static_cast<std::uint32_t>(behind));
    };
    if (r < rows) {
      for (const std::uint32_t id : matrix.row(r)) {
        if (id != behind) {
          end_run();
          ends_.push_back(id);
        }
        behind = std::uint64_t{id} + 1;
      }
      end_run();
    }
    ends_.insert(ends_.end(), Ends::sentinels, columns_);
    begin_.push_back(ends_.size());
  }
}

namespace {

struct Costs {
  std::array<std::uint16_t, 1024> one{}, zero{};
  std::array<std::uint16_t, 256> even{};
  Costs() {
    for (std::size_t i = 0; i < one.size(); ++i) {
      const double chance = chance_of_sum[i] / 65536.;
      one[i] = static_cast<std::uint16_t>(std::lround(-std::log2(chance) * bit_unit));
      zero[i] = static_cast<std::uint16_t>(std::lround(-std::log2(1 - chance) * bit_unit));
    }
    for (std::size_t i = 1; i < even.size(); ++i)
      even[i] = static_cast<std::uint16_t>(std::lround(std::log2(static_cast<double>(i)) * bit_unit));
  }
};
const Costs& costs() {
  static const Costs made;
  return made;
}

}  // namespace

std::uint64_t BitCounter::of_decision(bool bit, int sum) {
  const auto place = static_cast<std::size_t>(512 + sum);
  return bit ? costs().one[place] : costs().zero[place];
}

std::uint64_t BitCounter::of_even(std::uint32_t count) {
  std::uint64_t whole = 0;
  for (; count > 255; count = count / 2 + count % 2) whole += bit_unit;
  return whole + costs().even[count];
}

void refuse_row() {
  throw FormatError("more segments change than the row has");
}

std::uint32_t changed_segments(Ends a, Ends b, Ends row, std::uint32_t columns) {
  const std::uint32_t *next_a = a.at, *next_b = b.at;
  RowCursor cursor{row.at, false};
  bool value = false;
  std::uint32_t changed = 0;
  for (std::uint32_t at = 0; at < columns;) {
    if (*next_a == at) ++next_a, value = !value;
    next_b += *next_b == at;
    cursor.pass(at);
    at = std::min(*next_a, *next_b);
    changed += cursor.value != value || *cursor.next < at;
  }
  return changed;
}

RowCost cost_of_row(Ends a, Ends b, Ends row, std::uint32_t columns, const RowWeights& weights) {
  const std::uint32_t changes = changed_segments(a, b, row, columns);
  BitCounter counter(weights);
  counter.decide(false, raw_row);
  NoOut out;
  code_row(counter, a, b, columns, {row.at, false}, changes, out);
  // Measured by 'bench row-speed' on levels' view cells and faces.
  RowCost cost{counter.units(), .1 + .011 * (a.count + b.count) + .07 * changes, false};
  BitCounter raw(weights);
  raw.decide(true, raw_row);
  if (const std::uint64_t units = raw.units() + columns * bit_unit; units < cost.units)
    cost = {units, .1 + .004 * columns, true};
  return cost;
}

}  // namespace vismat
