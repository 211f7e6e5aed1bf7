// Codes a matrix with any coder: one that writes, or one that counts, as training does.
#pragma once
#include <algorithm>
#include <cstdint>
#include <vector>

#include "codecs/modelled/row_groups.h"
#include "codecs/modelled/row_references.h"

namespace vismat {

class RowEncoder {
 public:
  RowEncoder(const VisibilityMatrix& matrix, const RowLimits& limits, const EncodeOptions& options)
      : ends_(matrix), plan_(plan_rows(ends_, limits, options)) {
    std::vector<std::uint32_t> group_of(ends_.rows(), Group::none);
    std::uint32_t first = plan_.kept;
    for (const std::uint32_t size : plan_.group_sizes) {
      Group group{first, size, reference(first)};
      if (group.outside > plan_.kept) group.above = group_of[group.outside - 1];
      std::fill_n(group_of.begin() + first, size, static_cast<std::uint32_t>(groups_.size()));
      groups_.push_back(group);
      first += size;
    }
  }
  /// Which row of the matrix stands at each place; what follows is by places.
  const std::vector<std::uint32_t>& order() const { return plan_.order; }
  std::uint32_t kept() const { return plan_.kept; }
  const std::vector<Group>& groups() const { return groups_; }

  /// Where groups begin and what they are coded under, and the rows that readers keep.
  template <typename Coder>
  void code_model(Coder& coder) const {
    GroupCode code(ends_.rows(), plan_.kept);
    for (std::size_t i = 0; i < groups_.size(); ++i)
      code.code(coder, std::span(groups_).first(i), groups_[i]);
    for (std::uint32_t r = 0; r < plan_.kept; ++r) {
      code_number(coder, NumberKind::distance, r + 1, r + 1 - reference(r));
      code_one(coder, r);
    }
  }
  template <typename Coder>
  void code_group(Coder& coder, const Group& group) const {
    for (std::uint32_t place = 0; place < group.size; ++place) {
      const std::uint32_t r = group.first + place;
      if (place > 0) code_reference(coder, group, plan_.kept, place, reference(r));
      code_one(coder, r);
    }
  }

 private:
  // As numbers: row r has number r + 1.
  std::uint32_t reference(std::uint32_t r) const {
    return plan_.reference[r] == no_row ? 0 : plan_.reference[r] + 1;
  }
  Ends row(std::uint32_t number) const { return ends_[number == 0 ? ends_.rows() : plan_.order[number - 1]]; }
  template <typename Coder>
  void code_one(Coder& coder, std::uint32_t r) const {
    const std::uint32_t columns = ends_.columns(), a = reference(r);
    const RowCursor cursor{row(r + 1).at, false};
    NoOut out;
    if (coder.decide(plan_.raw[r], raw_row)) return code_raw(coder, columns, cursor, out);
    const Ends of_a = row(a), of_b = row(a == 0 ? 0 : reference(a - 1));
    code_row(coder, of_a, of_b, columns, cursor, changed_segments(of_a, of_b, row(r + 1), columns), out);
  }

  RowEnds ends_;
  RowPlan plan_;
  std::vector<Group> groups_;
};

}  // namespace vismat
