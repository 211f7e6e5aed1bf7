// Studies rows-small and rows-quick on given matrices: what each part of the method buys, what the bits are spent on, and
// what a wrong order of columns or wrong entries cost them and other codecs.
//
// Three tables. ablation.csv: the bytes if one part is switched off, the others as they are. bits.csv: the bytes by the kind
// of decision. sensitivity.csv: the bytes of codecs on the matrix as it is and with a share of its entries flipped, in
// several orders: best, natural and random ones; the best order of the matrix before entries were flipped; that of every
// second row; and that of another given matrix of the same level with as many columns. Equal rows and columns are stored
// once before entries are flipped. All of it is deterministic; what is coded under wrong orders and entries is decoded
// again and compared.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/row_matrices.h"
#include "bench/verbs.h"
#include "codecs/baselines/baseline_codecs.h"
#include "codecs/modelled/row_encoder.h"
#include "codecs/modelled/row_references.h"
#include "codecs/vmat/parts.h"
#include "layout/best_order.h"
#include "layout/orders/greedy_order.h"
#include "layout/orders/random_order.h"
#include "matrix/base/random.h"
#include "matrix/files/dataset_file.h"
#include "matrix/partition.h"
#include "programs/csv.h"
#include "programs/names.h"
#include "programs/prepared_for.h"

namespace vismat::bench {
namespace {

struct StudyOptions {
  std::vector<std::filesystem::path> files;
  std::filesystem::path out;
  std::vector<std::string> codecs = {"rows-small",          "rows-fast-ids", "rows-fast-bits", "bv",
                                     "pair-huffman-shared", "quake-rle",     "roaring",        "xz"};
  std::vector<double> flipped = {.001, .01, .05};
};

// ---- where the bits are ----------------------------------------------------------------------------------------------

enum class Spent : std::size_t { which, how_many, part, where, common_runs, references, bitmaps };
constexpr std::array spent_on = {"which segments change",
                                 "how many segments change",
                                 "whole, front, back or inside",
                                 "where new ends are",
                                 "common runs",
                                 "references and groups",
                                 "rows as bitmaps"};

Spent spent_at(std::uint32_t place) {
  if (place < all_shape) return Spent::which;
  if (place < common_run) return Spent::part;
  if (place < octaves) return Spent::common_runs;
  if (place < raw_row) {
    const std::uint32_t number = place < halves ? (place - octaves) / (number_sizes * number_octaves)
                                                : (place - halves) / number_octaves;
    if (number >= static_cast<std::uint32_t>(NumberKind::runs)) return Spent::common_runs;
    if (number <= static_cast<std::uint32_t>(NumberKind::run)) return Spent::where;
    return number == static_cast<std::uint32_t>(NumberKind::changes) ? Spent::how_many : Spent::references;
  }
  return place == raw_row ? Spent::bitmaps : Spent::references;
}

// A coder that adds up what each kind of decision costs.
class SpentCounter {
 public:
  static constexpr bool reads = false;
  template <typename... Place>
  bool decide(bool bit, std::uint32_t first, Place... more) {
    last_ = spent_at(first);
    counter_.decide(bit, first, more...);
    count(last_);
    return bit;
  }
  // Numbers of even chances follow a decision of their kind; those that follow which part changes say where.
  std::uint32_t even(std::uint32_t of, std::uint32_t value) {
    counter_.even(of, value);
    count(last_ == Spent::part ? Spent::where : last_);
    return value;
  }
  void take(std::uint32_t count, std::uint32_t first, std::uint32_t octave) {
    counter_.take(count, first, octave);
    this->count(last_);
  }
  const std::array<std::uint64_t, spent_on.size()>& units() const { return units_; }

 private:
  void count(Spent kind) {
    units_[static_cast<std::size_t>(kind)] += counter_.units() - std::exchange(counted_, counter_.units());
  }
  BitCounter counter_{row_weights};
  Spent last_ = Spent::references;
  std::uint64_t counted_ = 0;
  std::array<std::uint64_t, spent_on.size()> units_{};
};

std::string bits_of(const std::string& name, const VisibilityMatrix& matrix, const RowTier& tier) {
  const RowEncoder encoder(matrix, *tier.limits, {.rows_may_move = true});
  SpentCounter counter;
  encoder.code_model(counter);
  for (const Group& group : encoder.groups()) encoder.code_group(counter, group);
  const Encoded encoded = encode_modelled_rows(matrix, *tier.limits, {.rows_may_move = true});
  std::string lines;
  double counted = 0;
  const auto line = [&](const char* kind, double bytes) {
    lines += csv_line(csv_quoted(name), tier.codec, csv_quoted(kind), bytes);
  };
  for (std::size_t kind = 0; kind < spent_on.size(); ++kind) {
    const double bytes = static_cast<double>(counter.units()[kind]) / (8. * bit_unit);
    counted += bytes;
    line(spent_on[kind], bytes);
  }
  line("ends of groups", static_cast<double>(encoded.payload.size()) - counted);
  line("index", static_cast<double>(encoded.index.size()));
  return lines;
}

// ---- what each part buys ---------------------------------------------------------------------------------------------

VisibilityMatrix columns_ordered(const VisibilityMatrix& matrix, const Permutation& columns) {
  return permute(matrix, Permutation::identity(matrix.shape().rows), columns);
}

// The units that all rows take more if the second reference of each is the empty row; references stay as they are.
double bytes_of_second_references(const VisibilityMatrix& matrix, const RowLimits& limits) {
  const RowEnds ends(matrix);
  const RowPlan plan = plan_rows(ends, limits, {.rows_may_move = true});
  const auto row = [&](std::uint32_t place) {
    return ends[place == no_row ? ends.rows() : plan.order[place]];
  };
  double units = 0;
  for (std::uint32_t r = 0; r < ends.rows(); ++r) {
    const std::uint32_t a = plan.reference[r], b = a == no_row ? no_row : plan.reference[a];
    units += static_cast<double>(cost_of_row(row(a), row(no_row), row(r), ends.columns()).units) -
             static_cast<double>(cost_of_row(row(a), row(b), row(r), ends.columns()).units);
  }
  return units / (8. * bit_unit);
}

// `whole` has equal rows and columns as often as they come; `once` has them once, columns in the best order.
std::string ablation_of(const std::string& name, const VisibilityMatrix& whole, const VisibilityMatrix& once,
                        const RowTier& tier) {
  const RowLimits& limits = *tier.limits;
  std::string lines;
  const auto line = [&](const char* without, double bytes) {
    lines += csv_line(csv_quoted(name), tier.codec, without, bytes);
  };
  const auto changed = [&](const char* without, auto RowLimits::*limit, auto value) {
    RowLimits other = limits;
    other.*limit = value;
    line(without, static_cast<double>(bytes_within(once, other)));
  };
  const auto all = static_cast<double>(bytes_within(once, limits));
  line("nothing", all);
  line("second reference", all + bytes_of_second_references(once, limits));
  changed("named second references", &RowLimits::names_second, false);
  changed("common runs", &RowLimits::names_runs, false);
  changed("groups", &RowLimits::group, 1u);
  changed("kept rows", &RowLimits::kept, 0u);
  changed("references", &RowLimits::microseconds, 0.);
  changed("limit of time", &RowLimits::microseconds, 1e6);
  line("order of rows by references",
       static_cast<double>(
           encode_modelled_rows(rows_ordered(once, order_rows_greedily(once)), limits, {}).bytes()));
  line("duplicates once",
       static_cast<double>(bytes_within(columns_ordered(whole, best_order(whole)), limits)));
  return lines;
}

// ---- wrong orders and wrong entries ----------------------------------------------------------------------------------

// Each entry is inverted with this probability.
VisibilityMatrix with_flips(const VisibilityMatrix& matrix, double share) {
  const auto [rows, columns] = matrix.shape();
  std::vector<std::vector<std::uint32_t>> lists(rows);
  for (std::uint32_t r = 0; r < rows; ++r) {
    Random random(1, r);
    const auto row = matrix.row(r);
    auto next = row.begin();
    for (std::uint32_t c = 0; c < columns; ++c) {
      const bool visible = next != row.end() && *next == c;
      next += visible;
      if (visible != (random.fraction() < share)) lists[r].push_back(c);
    }
  }
  return VisibilityMatrix::from_rows(lists, columns);
}

VisibilityMatrix every_second_row(const VisibilityMatrix& matrix) {
  std::vector<std::vector<std::uint32_t>> lists;
  for (std::uint32_t r = 0; r < matrix.shape().rows; r += 2)
    lists.emplace_back(matrix.row(r).begin(), matrix.row(r).end());
  return VisibilityMatrix::from_rows(lists, matrix.shape().columns);
}

struct Sensitivity {
  const StudyOptions& options;
  std::string name;
  std::string lines = {};

  // Rows are in the codec's own order for `rows_of`, whose columns are in order already; null: as they are.
  void add(double share, const char* order, const VisibilityMatrix& matrix, const VisibilityMatrix* rows_of) {
    for (const std::string& codec_name : options.codecs) {
      const Codec codec = find_codec(codec_name);
      VisibilityMatrix coded = matrix;
      const bool moves = rows_of == &matrix && codec.orders_rows;
      if (rows_of != nullptr && !moves)
        coded = rows_ordered(matrix, codec.orders_rows
                                         ? *codec.encode(*rows_of, {}, {.rows_may_move = true}).row_order
                                         : order_rows_greedily(*rows_of));
      const Encoded encoded = codec.encode(coded, {}, {.rows_may_move = moves});
      if (moves) coded = rows_ordered(matrix, *encoded.row_order);
      if (codec.decode(Parts(encoded), coded.shape(), {}, coded.ones()) != coded)
        throw std::logic_error(codec_name + " does not restore its matrix");
      lines += csv_line(csv_quoted(name), share, order, codec_name, encoded.bytes());
    }
  }
};

// The order in which the groups' first members stand.
Permutation of_groups(const Permutation& order, const Partition& groups) {
  std::vector<std::uint32_t> visits;
  std::vector<bool> visited(groups.groups());
  for (const std::uint32_t member : order.old_of_new()) {
    const std::uint32_t group = groups.group_of_member()[member];
    if (!visited[group]) visits.push_back(group);
    visited[group] = true;
  }
  return Permutation::from_old_of_new(std::move(visits));
}

// `once` has equal rows and columns once; `other` is null or has the columns that `subject` has.
std::string sensitivity_of(const RowMatrix& subject, const VisibilityMatrix& once, const RowMatrix* other,
                           const StudyOptions& options) {
  const auto [rows, columns] = once.shape();
  Sensitivity table{options, subject.name};
  const auto in_order_of = [&](double share, const char* order, const VisibilityMatrix& matrix,
                               const Permutation& by) {
    const VisibilityMatrix ordered = columns_ordered(matrix, by);
    table.add(share, order, ordered, &ordered);
  };
  const Permutation best = best_order(once);
  in_order_of(0, "best", once, best);
  table.add(0, "natural", once, nullptr);
  table.add(0, "random", permute(once, random_order(rows, 1), random_order(columns, 2)), nullptr);
  in_order_of(0, "of half the rows", once, best_order(every_second_row(once)));
  if (other != nullptr) {
    Permutation order = best_order(other->matrix);
    if (columns < order.size()) order = of_groups(order, equal_rows(transpose(subject.matrix)));
    in_order_of(0, "of another matrix", once, order);
  }
  const VisibilityMatrix before = columns_ordered(once, best);
  for (const double share : options.flipped) {
    const VisibilityMatrix noisy = with_flips(once, share);
    in_order_of(share, "best", noisy, best_order(noisy));
    table.add(share, "before", columns_ordered(noisy, best), &before);
  }
  return table.lines;
}

// ---- the verb --------------------------------------------------------------------------------------------------------

// The first of the others that is of the same level and has as many columns.
const RowMatrix* other_of(const RowMatrix& subject, const std::vector<RowMatrix>& all) {
  const auto found = std::ranges::find_if(all, [&](const RowMatrix& other) {
    return &other != &subject && level_of(other) == level_of(subject) &&
           other.matrix.shape().columns == subject.matrix.shape().columns;
  });
  return found == all.end() ? nullptr : &*found;
}

void run(const StudyOptions& options) {
  std::string ablation = "matrix,codec,without,bytes\n", bits = "matrix,codec,kind,bytes\n",
              sensitivity = "matrix,flipped,order,codec,bytes\n";
  std::vector<RowMatrix> subjects;
  for (const auto& file : options.files) {
    subjects.push_back({matrix_name(file), with_lists_in_place(read_dataset(file)).matrix});
  }
  for (const RowMatrix& subject : subjects) {
    std::printf("%s\n", subject.name.c_str());
    std::fflush(stdout);
    Dataset data;
    data.matrix = subject.matrix;
    const VisibilityMatrix once =
        prepared_for(find_codec("rows-small"), std::move(data), {.orders = false}).matrix;
    const VisibilityMatrix ordered = columns_ordered(once, best_order(once));
    for (const RowTier& tier : row_tiers) {
      ablation += ablation_of(subject.name, subject.matrix, ordered, tier);
      bits += bits_of(subject.name, ordered, tier);
    }
    sensitivity += sensitivity_of(subject, once, other_of(subject, subjects), options);
  }
  write_table(options.out / "ablation.csv", ablation);
  write_table(options.out / "bits.csv", bits);
  write_table(options.out / "sensitivity.csv", sensitivity);
}

}  // namespace

void add_row_study(const Verb& verb) {
  const auto options = std::make_shared<StudyOptions>();
  verb.input("MATRIX", options->files, "Matrix files").required();
  verb.output("--out", options->out, Written::folder,
              "The folder for ablation.csv, bits.csv and sensitivity.csv")
      .required();
  verb.option("--codecs", options->codecs, "The codecs of sensitivity.csv").comma_separated();
  verb.option("--flipped", options->flipped, "Shares of the entries to flip").comma_separated();
  verb.example("bench row-study koth1.cells.bsp.h5 --out out");
  verb.runs([options] { run(*options); });
}

}  // namespace vismat::bench
