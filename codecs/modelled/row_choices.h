// The encoder's choices for rows whose first references are chosen: each row's second reference, and the runs that the file
// lists as common.
#pragma once
#include <cstdint>
#include <vector>

#include "codecs/modelled/row_groups.h"
#include "codecs/modelled/row_references.h"

namespace vismat {

/// Rows with their references and groups, and what is coded beside them.
struct CodedRows {
  RowEnds ends;
  RowPlan plan;
  std::vector<Group> groups = {};
  bool names_second = false;               // otherwise all second references are those of the first ones
  std::vector<std::uint32_t> second = {};  // of each row, as code_second() has it
  CommonRuns runs = {};

  /// References as numbers: row r has number r + 1.
  std::uint32_t reference(std::uint32_t r) const {
    return plan.reference[r] == no_row ? 0 : plan.reference[r] + 1;
  }
  std::uint32_t reference_of_number(std::uint32_t number) const {
    return number == 0 ? 0 : reference(number - 1);
  }
  /// The row at a place of the plan.
  Ends row(std::uint32_t r) const { return ends[plan.order[r]]; }
  Ends of_number(std::uint32_t number) const { return number == 0 ? ends[ends.rows()] : row(number - 1); }
  std::uint32_t second_number(std::uint32_t r, const std::vector<std::uint32_t>& way) const {
    if (second[r] == 0) return reference_of_number(reference(r));
    return second[r] <= way.size() ? way[second[r] - 1]
                                   : second[r] - static_cast<std::uint32_t>(way.size()) - 1;
  }
  /// The numbers of the rows decoded on the way to a row of a group, the last one first; no more than
  /// ModelledRowFormat::longest_way.
  std::vector<std::uint32_t> way_to(const Group& group, std::uint32_t r) const;
};

/// Chooses second references and common runs for rows in groups. The same for any number of threads.
void choose_rest(CodedRows& rows, const RowLimits& limits, unsigned threads);

}  // namespace vismat
