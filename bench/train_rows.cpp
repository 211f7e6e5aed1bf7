// Trains the weights under which rows-small and rows-quick code, over matrices of all kinds, and writes the source file that
// holds them. With --leave-out it instead tells what each level would take under weights trained on the others alone.
//
// A decision's logarithm of the odds is the sum of a few weights, one from each table of its contexts: a logistic regression,
// fitted by stochastic gradient descent [Duchi et al. 2011, AdaGrad]. References depend on the weights and the other way
// round, so planning and fitting take turns. A matrix counts by the root of its decisions, so that large levels do not drown
// small ones.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bench/row_matrices.h"
#include "bench/verbs.h"
#include "codecs/baselines/baseline_codecs.h"
#include "codecs/modelled/row_encoder.h"
#include "matrix/base/atomic_file.h"
#include "matrix/files/dataset_file.h"
#include "programs/names.h"
#include "programs/prepared_for.h"

namespace vismat::bench {
namespace {

struct TrainOptions {
  std::vector<std::filesystem::path> files;
  std::filesystem::path out;
  bool as_is = false, leave_out = false;
  unsigned rounds = 3;
  std::vector<std::string> without;
};

// The contexts that --without may take away, each with the places of its weights.
struct Idea {
  const char* name;
  std::uint32_t begin, end;
};
constexpr std::array ideas = {
    Idea{"shape", copy_shape, copy_recent},  // what the references do in and around a segment
    Idea{"recent", copy_recent,
         copy_left},  // the last outcomes, and whether they were as in the second reference
    Idea{"left", copy_left, all_shape},  // how many of the segments left change
    Idea{"second", 0, 0},                // naming second references
    Idea{"runs", 0, 0},                  // naming common runs
};

struct Decision {
  std::array<std::uint16_t, 4> places;
  std::uint8_t count;
  bool bit;
};

// A coder that keeps the decisions.
class DecisionList {
 public:
  static constexpr bool reads = false;
  template <typename... Place>
  bool decide(bool bit, Place... places) {
    static_assert(sizeof...(places) <= 4);
    decisions_.push_back({{static_cast<std::uint16_t>(places)...}, sizeof...(places), bit});
    return bit;
  }
  std::uint32_t even(std::uint32_t, std::uint32_t value) { return value; }
  void take(std::uint32_t, std::uint32_t, std::uint32_t) {}
  const std::vector<Decision>& decisions() const { return decisions_; }

 private:
  std::vector<Decision> decisions_;
};

RowLimits limits_of(const RowLimits& built_in, const RowWeights& weights, const TrainOptions& options) {
  RowLimits limits = built_in;
  limits.weights = &weights;
  limits.names_second = std::ranges::find(options.without, "second") == options.without.end();
  limits.names_runs = std::ranges::find(options.without, "runs") == options.without.end();
  return limits;
}

std::vector<Decision> decisions_of(const RowMatrix& subject, const RowWeights& weights,
                                   const TrainOptions& options) {
  DecisionList list;
  for (const RowTier& tier : row_tiers) {
    const RowLimits limits = limits_of(*tier.limits, weights, options);
    const RowEncoder encoder(subject.matrix, limits, {.rows_may_move = true});
    encoder.code_model(list);
    for (const Group& group : encoder.groups()) encoder.code_group(list, group);
  }
  return list.decisions();
}

RowWeights rounded(const std::vector<float>& weights) {
  RowWeights result;
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i] = static_cast<std::int8_t>(std::lround(std::clamp(16 * weights[i], -127.f, 127.f)));
  return result;
}

void fit(std::vector<float>& weights, const std::vector<std::vector<Decision>>& lists,
         const std::vector<bool>& without) {
  constexpr int passes = 8;
  constexpr std::size_t chunk = 1000;  // decisions of a matrix before the next one's turn
  std::vector<float> squares(weights.size(), 1.f);
  double mean = 0;
  for (const auto& list : lists)
    mean += std::sqrt(static_cast<double>(list.size())) / static_cast<double>(lists.size());
  for (int pass = 0; pass < passes; ++pass) {
    const float rate = pass < passes * 2 / 3 ? .25f : .06f;
    bool more = true;
    for (std::size_t from = 0; more; from += chunk) {
      more = false;
      for (const auto& list : lists) {
        const auto share = static_cast<float>(mean / std::sqrt(1. + static_cast<double>(list.size())));
        const std::size_t end = std::min(list.size(), from + chunk);
        more |= end < list.size();
        for (std::size_t i = from; i < end; ++i) {
          const Decision& decision = list[i];
          float sum = 0;
          for (unsigned j = 0; j < decision.count; ++j) sum += weights[decision.places[j]];
          const float slope = share * ((decision.bit ? 1.f : 0.f) - 1 / (1 + std::exp(-sum)));
          for (unsigned j = 0; j < decision.count; ++j) {
            const std::uint16_t place = decision.places[j];
            if (without[place]) continue;
            squares[place] += slope * slope;
            weights[place] += rate * slope / std::sqrt(squares[place]);
          }
        }
      }
    }
  }
}

// Numbers beyond what was trained on take the probabilities of the largest kinds that were.
void fill_untrained(std::vector<float>& weights, const std::vector<std::vector<Decision>>& lists) {
  std::vector<bool> seen(weights.size());
  for (const auto& list : lists) {
    for (const Decision& decision : list) {
      for (unsigned j = 0; j < decision.count; ++j) seen[decision.places[j]] = true;
    }
  }
  for (std::uint32_t kind = 0; kind < number_kinds; ++kind) {
    for (std::uint32_t top = 1; top < number_sizes; ++top) {
      for (std::uint32_t octave = 0; octave < 16; ++octave) {
        const std::uint32_t place = octaves + (kind * number_sizes + top) * number_octaves + octave;
        if (seen[place]) continue;
        weights[place] = octave < top - 1 ? weights[place - 16] : octave > 0 ? weights[place - 1] : 0;
        seen[place] = seen[place - 16];
      }
    }
  }
}

RowWeights train(const std::vector<const RowMatrix*>& subjects, const TrainOptions& options) {
  if (options.rounds == 0) return row_weights;
  std::vector<bool> without(row_weight_count);
  for (const std::string& name : options.without) {
    const auto found =
        std::ranges::find(ideas, name, [](const Idea& idea) { return std::string(idea.name); });
    std::fill(without.begin() + found->begin, without.begin() + found->end, true);
  }
  std::vector<float> weights(row_weight_count);
  weights[raw_row] = -7.9f;
  for (std::uint32_t i = all_shape; i-- > copy_left;) weights[i] = without[i] ? 0.f : -1.5f;
  for (unsigned round = 0; round < options.rounds; ++round) {
    const RowWeights now = rounded(weights);
    std::vector<std::vector<Decision>> lists;
    for (const RowMatrix* subject : subjects) lists.push_back(decisions_of(*subject, now, options));
    fit(weights, lists, without);
    weights[raw_row] = -7.9f;
    if (round + 1 == options.rounds) fill_untrained(weights, lists);
  }
  return rounded(weights);
}

template <typename Numbers>
std::string lines_of(const Numbers& numbers) {
  std::string text, line;
  for (const auto number : numbers) {
    const std::string next = std::to_string(int{number}) + ",";
    if (line.size() + next.size() > 118) {
      text += line + "\n";
      line.clear();
    }
    line += next;
  }
  return text + line + "\n";
}

std::string source_of(const RowWeights& weights) {
  std::array<std::uint16_t, 161> chances;
  for (std::size_t sum = 0; sum < chances.size(); ++sum)
    chances[sum] = static_cast<std::uint16_t>(
        std::lround(std::min(65535., 65536 / (1 + std::exp(-static_cast<double>(sum) / 16)))));
  return R"(// Made by 'bench train-rows'. docs/vmat.md, "Modelled rows", says what the numbers mean.
#include "codecs/modelled/row_tables.h"

#include <algorithm>

namespace vismat {

// clang-format off
const RowWeights row_weights = {
)" + lines_of(weights) +
         R"(};

namespace {

// Of the sums from 0 to 160.
constexpr std::array<std::uint16_t, 161> upper_chances = {
)" + lines_of(chances) +
         R"(};
// clang-format on

}  // namespace

constinit const std::array<std::uint16_t, 1024> chance_of_sum = [] {
  std::array<std::uint16_t, 1024> chances{};
  for (int sum = -512; sum < 512; ++sum) {
    const std::uint16_t chance = upper_chances[static_cast<std::size_t>(std::min(sum < 0 ? -sum : sum, 160))];
    chances[static_cast<std::size_t>(512 + sum)] =
        sum < 0 ? static_cast<std::uint16_t>(65536 - chance) : chance;
  }
  return chances;
}();

}  // namespace vismat
)";
}

RowMatrix subject_of(const std::filesystem::path& file, bool as_is) {
  Dataset data = read_dataset(file);
  RowMatrix subject{matrix_name(file), {}};
  if (!as_is) data = prepared_for(find_codec("rows-small"), std::move(data));
  subject.matrix = std::move(data.matrix);
  return subject;
}

void run(const TrainOptions& options) {
  std::vector<RowMatrix> subjects;
  for (const auto& file : options.files) subjects.push_back(subject_of(file, options.as_is));
  const auto report = [&](const RowMatrix& subject, const RowWeights& weights) {
    std::printf("%-40s %9u x %-9u", subject.name.c_str(), subject.matrix.shape().rows,
                subject.matrix.shape().columns);
    for (const RowTier& tier : row_tiers)
      std::printf(" %10llu", static_cast<unsigned long long>(
                                 bytes_within(subject.matrix, limits_of(*tier.limits, weights, options))));
    std::printf("\n");
    std::fflush(stdout);
  };
  std::printf("%-40s %9s   %-9s %10s %10s\n", "matrix", "rows", "columns", "small", "quick");
  if (!options.leave_out) {
    std::vector<const RowMatrix*> all;
    for (const RowMatrix& subject : subjects) all.push_back(&subject);
    const RowWeights weights = train(all, options);
    for (const RowMatrix& subject : subjects) report(subject, weights);
    const std::string source = source_of(weights);
    if (!options.out.empty()) write_file(options.out, std::as_bytes(std::span(source)));
    return;
  }
  std::vector<std::string> levels;
  for (const RowMatrix& subject : subjects) levels.push_back(level_of(subject));
  std::ranges::sort(levels);
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
  for (const std::string& level : levels) {
    std::vector<const RowMatrix*> others;
    for (const RowMatrix& subject : subjects) {
      if (level_of(subject) != level) others.push_back(&subject);
    }
    const RowWeights weights = train(others, options);
    for (const RowMatrix& subject : subjects) {
      if (level_of(subject) == level) report(subject, weights);
    }
  }
}

}  // namespace

void add_train_rows(const Verb& verb) {
  const auto options = std::make_shared<TrainOptions>();
  verb.input("MATRIX", options->files, "Matrix files of all kinds that are to be coded").required();
  verb.output("--out", options->out, Written::text,
              "The source file to write: codecs/modelled/row_tables.cpp");
  verb.flag("--as-is", options->as_is, "The columns are in order, and rows and columns are distinct");
  verb.flag(
      "--leave-out", options->leave_out,
      "Report each level's bytes under weights that were trained on the other levels; a level is what stands "
      "before the first dot of a file's name");
  verb.option("--rounds", options->rounds,
              "How often to plan and to fit; 0 reports what rows take under the codecs' own weights");
  std::vector<std::string> names;
  for (const Idea& idea : ideas) names.emplace_back(idea.name);
  verb.option("--without", options->without, "Contexts to leave out").comma_separated().one_of(names);
  verb.example("bench train-rows *.bsp.h5 --out codecs/modelled/row_tables.cpp");
  verb.runs([options] { run(*options); });
}

}  // namespace vismat::bench
