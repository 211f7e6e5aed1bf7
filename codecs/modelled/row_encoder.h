// Codes a matrix with any coder: one that writes, or one that counts, as training does.
#pragma once
#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "codecs/modelled/row_choices.h"
#include "codecs/modelled/row_groups.h"
#include "codecs/modelled/row_references.h"

namespace vismat {

class RowEncoder {
 public:
  RowEncoder(const VisibilityMatrix& matrix, const RowLimits& limits, const EncodeOptions& options)
      : RowEncoder(planned(matrix, limits, options), limits, options.threads) {}
  /// Of rows with a plan.
  RowEncoder(CodedRows rows, const RowLimits& limits, unsigned threads) : rows_(std::move(rows)) {
    std::vector<std::uint32_t> group_of(rows_.ends.rows(), Group::none);
    std::uint32_t first = kept();
    for (const std::uint32_t size : rows_.plan.group_sizes) {
      Group group{first, size, rows_.reference(first)};
      if (group.outside > kept()) group.above = group_of[group.outside - 1];
      std::fill_n(group_of.begin() + first, size, static_cast<std::uint32_t>(groups().size()));
      rows_.groups.push_back(group);
      first += size;
    }
    choose_rest(rows_, limits, threads);
  }
  /// Which row of the matrix stands at each place; what follows is by places.
  const std::vector<std::uint32_t>& order() const { return rows_.plan.order; }
  std::uint32_t kept() const { return rows_.plan.kept; }
  const std::vector<Group>& groups() const { return rows_.groups; }

  /// What rows may name, where groups begin and what they are coded under, and the rows that readers keep.
  template <typename Coder>
  void code_model(Coder& coder) const {
    code_common_runs(coder, rows_.ends.columns(), rows_.runs);
    coder.decide(rows_.names_second, second_named);
    GroupCode code(rows_.ends.rows(), kept());
    for (std::size_t i = 0; i < groups().size(); ++i)
      code.code(coder, std::span(groups()).first(i), groups()[i]);
    for (std::uint32_t r = 0; r < kept(); ++r) {
      code_number(coder, NumberKind::distance, r + 1, r + 1 - rows_.reference(r));
      code_one(coder, r, Stands::kept, r, {});
    }
  }
  template <typename Coder>
  void code_group(Coder& coder, const Group& group) const {
    for (std::uint32_t place = 0; place < group.size; ++place) {
      const std::uint32_t r = group.first + place;
      if (place > 0) code_reference(coder, group, kept(), place, rows_.reference(r));
      code_one(coder, r, stands_at(place), kept(), rows_.way_to(group, r));
    }
  }

 private:
  static CodedRows planned(const VisibilityMatrix& matrix, const RowLimits& limits,
                           const EncodeOptions& options) {
    CodedRows rows{RowEnds(matrix), {}};
    rows.plan = plan_rows(rows.ends, limits, options);
    return rows;
  }
  template <typename Coder>
  void code_one(Coder& coder, std::uint32_t r, Stands stands, std::uint32_t kept,
                const std::vector<std::uint32_t>& way) const {
    const std::uint32_t columns = rows_.ends.columns();
    const Ends row = rows_.row(r);
    NoOut out;
    if (coder.decide(rows_.plan.raw[r], raw_row)) return code_raw(coder, columns, {row.at, false}, out);
    const Ends a = rows_.of_number(rows_.reference(r)), b = rows_.of_number(rows_.second_number(r, way));
    if (rows_.names_second)
      code_second(coder, second_context(stands, a.count), kept, static_cast<std::uint32_t>(way.size()),
                  rows_.second[r]);
    code_row(coder, a, b, rows_.runs, rows_.second[r] != 0, columns, {row.at, false},
             changed_segments(a, b, row, columns), out);
  }

  CodedRows rows_;
};

}  // namespace vismat
