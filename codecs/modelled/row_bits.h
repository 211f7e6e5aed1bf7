// What rows cost, in bits: for encoders that choose under which row to code another.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "codecs/modelled/row_model.h"
#include "matrix/visibility_matrix.h"

namespace vismat {

/// The run ends of all rows of a matrix. Row number `rows` is an empty one.
class RowEnds {
 public:
  explicit RowEnds(const VisibilityMatrix& matrix);
  std::uint32_t rows() const { return static_cast<std::uint32_t>(begin_.size() - 2); }
  std::uint32_t columns() const { return columns_; }
  /// Of all rows.
  std::uint64_t count() const { return ends_.size() - Ends::sentinels * (rows() + std::uint64_t{1}); }
  /// Row r lists its run ends.
  VisibilityMatrix as_matrix() const;
  Ends operator[](std::uint32_t row) const {
    return {ends_.data() + begin_[row],
            static_cast<std::uint32_t>(begin_[row + 1] - begin_[row]) - Ends::sentinels};
  }

 private:
  std::uint32_t columns_;
  std::vector<std::uint64_t> begin_;
  std::vector<std::uint32_t> ends_;
};

/// Bits are counted in units of 1/1024.
inline constexpr std::uint64_t bit_unit = 1024;

/// What decisions cost, by their probability's place in chance_of_sum, and choices among up to 255.
struct BitCosts {
  std::array<std::array<std::uint16_t, 1024>, 2> decision{};  // for 0 and 1
  std::array<std::uint16_t, 256> even{};
  static const BitCosts& table();

 private:
  BitCosts();
};

/// A coder that only adds up what its decisions cost. Deterministic.
class BitCounter {
 public:
  static constexpr bool reads = false;
  explicit BitCounter(const RowWeights& weights) : weights_(weights) {}
  template <typename... Place>
  bool decide(bool bit, Place... places) {
    units_ += costs_.decision[bit][static_cast<std::size_t>(512 + (weights_[places] + ...))];
    return bit;
  }
  std::uint32_t even(std::uint32_t count, std::uint32_t value) {
    units_ += of_even(count);
    return value;
  }
  void take(std::uint32_t count, std::uint32_t, std::uint32_t octave) {
    units_ += of_even(count) - octave * bit_unit;
  }
  std::uint64_t units() const { return units_; }

 private:
  std::uint64_t of_even(std::uint32_t count) const {
    std::uint64_t units = 0;
    for (; count > 255; count = count / 2 + count % 2) units += bit_unit;
    return units + costs_.even[count];
  }
  const RowWeights& weights_;
  const BitCosts& costs_ = BitCosts::table();
  std::uint64_t units_ = 0;
};

struct RowCost {
  std::uint64_t units;  // bits, in units of 1/1024
  double microseconds;  // of decoding, modelled
  bool raw;             // it is stored as its bitmap
};
/// The cost of a row under references a and b. O(run ends of the three).
RowCost cost_of_row(Ends a, Ends b, Ends row, std::uint32_t columns, const RowWeights& weights = row_weights);

}  // namespace vismat
