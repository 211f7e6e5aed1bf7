// vismat row: decodes one row of a .vmat file without the rest.
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "cli/summary.h"
#include "cli/verbs.h"
#include "cli/vmat_files.h"
#include "codecs/baselines/baseline_codecs.h"
#include "codecs/rows/pairs.h"
#include "codecs/vmat/row_reader.h"
#include "programs/options.h"

namespace vismat::cli {
namespace {

struct RowOptions {
  std::filesystem::path in;
  std::uint32_t row = 0;
  bool as_stored = false, runs = false, names = false;
};

bool is_plain_vmat(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return false;
  std::array<char, vmat::magic.size()> begin = {};
  std::ifstream(path, std::ios::binary).read(begin.data(), begin.size());
  return vmat::begins_vmat(std::as_bytes(std::span(begin)));
}

/// The name of a column, by its number in the source or as it is stored; a merged column has those of all its members.
std::string name_of(const SourceMap& source, std::uint32_t id, bool as_stored) {
  if (as_stored && source.column_order) id = source.column_order->old_of_new()[id];
  if (!as_stored || !source.column_groups) return source.column_names[id];
  std::string names;
  for (std::uint32_t member = 0; member < source.column_groups->size(); ++member) {
    if (source.column_groups->group_of_member()[member] != id) continue;
    names += (names.empty() ? "" : ", ") + source.column_names[member];
  }
  return names;
}

void run_row(const RowOptions& options) {
  // Rows are read from the mapped file, unless the whole has to be unpacked or comes from a pipe.
  const std::vector<std::byte> bytes =
      is_plain_vmat(options.in) ? std::vector<std::byte>{} : bytes_of_vmat(options.in);
  const RowReader reader = bytes.empty() ? RowReader(options.in, all_codecs())
                                         : naming(options.in, [&] { return RowReader(bytes, all_codecs()); });
  const Shape shape = reader.shape();
  SourceMap source = reader.source();
  if (options.as_stored) source = {};
  if (!source.boundaries.empty()) {  // its rows are lists; order and groups are of the view cells
    source.row_order.reset();
    source.row_groups = source.list_rows;
  }
  std::uint32_t row = options.row;
  if (const std::uint32_t rows = source.row_groups ? source.row_groups->size() : shape.rows; row >= rows) {
    throw std::invalid_argument(options.in.string() + ": no row " + std::to_string(row) + "; it has " +
                                std::to_string(rows));
  }
  if (source.row_order) row = source.row_order->new_of_old()[row];
  if (source.row_groups) row = source.row_groups->group_of_member()[row];
  RowBuffer<std::uint32_t> buffer;
  const auto stored = reader.ids(row, buffer);
  std::vector<std::uint32_t> ids(stored.begin(), stored.end());
  if (source.column_order) {
    const auto source_of = source.column_order->old_of_new();
    for (std::uint32_t& id : ids) id = source_of[id];
  }
  if (source.column_groups) {
    const VisibilityMatrix members = source.column_groups->members();
    for (const std::uint32_t id : std::exchange(ids, {}))
      ids.insert(ids.end(), members.row(id).begin(), members.row(id).end());
  }
  std::sort(ids.begin(), ids.end());
  if (options.runs) {
    for_each_run(ids, [](std::uint32_t first, std::uint32_t count) {
      std::printf("%u %u\n", first, first + count - 1);
    });
  } else {
    const std::vector<std::string>& names = reader.source().column_names;
    if (options.names && names.empty()) {
      throw std::invalid_argument(options.in.string() + ": its columns have no names");
    }
    for (const std::uint32_t id : ids) {
      if (options.names) {
        std::printf("%u %s\n", id, printable(name_of(reader.source(), id, options.as_stored)).c_str());
      } else {
        std::printf("%u\n", id);
      }
    }
  }
  const RowSource::Cost cost = reader.cost(row);
  std::fprintf(stderr, "row %u: %zu of %u visible, %llu bytes", options.row, ids.size(),
               source.source_shape(shape).columns, static_cast<unsigned long long>(cost.bytes));
  if (cost.parts != 1) std::fprintf(stderr, " of %llu parts", static_cast<unsigned long long>(cost.parts));
  std::fprintf(stderr, "\n");
}

}  // namespace

void add_row(Program& program) {
  const auto options = std::make_shared<RowOptions>();
  const Verb verb = program.verb("row", "Decode one row of a .vmat file without the rest");
  verb.input("FILE", options->in, "A .vmat file of a codec that decodes single rows").required();
  verb.option("ROW", options->row, "The number of the row; 0 is the first").required();
  verb.flag("--as-stored", options->as_stored,
            "Number rows and columns as in the .vmat file, not as in its source");
  const Option runs = verb.flag(
      "--runs", options->runs,
      "Print one line for each run of column numbers, the first and the last, not one for each number");
  verb.flag("--names", options->names, "Print the name of each column behind its number").excludes(runs);
  verb.example("vismat row city32.vmat 17");
  verb.runs([options] { run_row(*options); });
}

}  // namespace vismat::cli
