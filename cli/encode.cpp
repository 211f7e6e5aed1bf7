// vismat encode: compresses a matrix into a .vmat file.
#include <cstdio>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

#include "cli/verbs.h"
#include "cli/vmat_files.h"
#include "codecs/baselines/baseline_codecs.h"
#include "codecs/rows/bitmap.h"
#include "codecs/vmat/container.h"
#include "matrix/base/atomic_file.h"
#include "programs/options.h"
#include "programs/prepared_for.h"
#include "programs/progress.h"

namespace vismat::cli {
namespace {

struct EncodeArguments {
  std::filesystem::path in, out;
  std::string codec = "delimiter", order = "greedy";
  EncodeOptions encode;
};

void print_sizes(const EncodeArguments& options, const Container& container,
                 std::span<const std::byte> file) {
  const std::size_t payload = container.encoded.payload.size(), index = container.encoded.index.size();
  const std::uint64_t bitmap = bitmap_size(container.shape);
  std::printf("%s: %zu bytes of payload, %.2fx smaller than the bitmap's %llu", options.out.c_str(), payload,
              static_cast<double>(bitmap) / static_cast<double>(payload),
              static_cast<unsigned long long>(bitmap));
  if (index > 0) std::printf("; index %zu bytes", index);
  const ContainerHead head(file);
  const auto tell = [&](const char* what, std::initializer_list<vmat::Section> sections) {
    std::size_t bytes = 0;
    for (const vmat::Section section : sections) bytes += head.section(section).size();
    if (bytes > 0) std::printf("; %s %zu bytes", what, bytes);
  };
  using S = vmat::Section;
  tell("trees", {S::tree, S::row_tree});
  tell("orders", {S::row_order, S::column_order, S::shared_order});
  tell("groups", {S::row_groups, S::column_groups, S::list_rows});
  tell("names", {S::row_names, S::column_names, S::column_levels});
  std::printf("\n");
}

void run_encode(EncodeArguments options) {
  const Codec& codec = find_codec(options.codec);
  if (options.encode.seconds > 0 && !codec.searches)
    throw std::invalid_argument("--seconds is for codecs that search; '" + options.codec + "' does not");
  if (options.encode.effort > codec.highest_effort) {
    throw std::invalid_argument(
        "--effort " + std::to_string(options.encode.effort) + ": '" + options.codec + "' has " +
        (codec.highest_effort == 0 ? "only 0" : "0 to " + std::to_string(codec.highest_effort)));
  }
  Dataset data = read_matrix(options.in);
  if (const std::string why = obstacle(codec, data); !why.empty())
    throw std::invalid_argument(options.in.string() + ": " + why);
  options.encode.rows_may_move = options.order == "greedy";
  data =
      prepared_for(codec, std::move(data), {.orders = options.encode.rows_may_move, .stages = show_progress});
  if (codec.slow_encode) options.encode.progress = show_progress("encoding");
  Container container = compress(data, codec, options.encode);
  container.facts = facts_of(data);
  const auto file = write_container(container);
  write_file(options.out, file);
  print_sizes(options, container, file);
}

std::string codec_names() {
  std::string names;
  for (const Codec& codec : all_codecs()) names += (names.empty() ? "" : ", ") + std::string(codec.name);
  return names;
}

}  // namespace

void add_encode(Program& program) {
  const auto options = std::make_shared<EncodeArguments>();
  const Verb verb = program.verb("encode", "Compress a matrix into a .vmat file");
  verb.input("MATRIX", options->in, "The matrix file to read (.bsp.h5, .mtx, .npy or .npz)").required();
  verb.output(options->out, Written::vmat, "The .vmat file to write");
  verb.option("--codec", options->codec, "One of " + codec_names());
  verb.option(
          "--rows", options->order,
          "zach3 and zach4 reorder the rows by the greedy method, even if the file was ordered before, and "
          "rows-small and rows-quick rows and columns for their own ends; natural keeps the order of the "
          "file, as every "
          "other codec does")
      .one_of({"greedy", "natural"});
  verb.option("--seconds", options->encode.seconds,
              "Time that codecs which search (panne) spend; the result then depends on the machine. 0: until "
              "little is gained, with the same result everywhere")
      .between(0, 1e7);
  verb.option(
      "--effort", options->encode.effort,
      "0 to 2: how much of the matrix the context model of gotsman3-context learns from; each step takes "
      "four times as much, is slower and gives smaller files");
  verb.threads(options->encode.threads);
  verb.option("--seed", options->encode.seed, "Random seed of the codecs that search");
  verb.example("vismat encode city32.bsp.h5 --codec zach3-range -o city32.vmat");
  verb.runs([options] { run_encode(*options); });
}

}  // namespace vismat::cli
