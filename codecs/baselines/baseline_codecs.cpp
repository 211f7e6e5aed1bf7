#include "codecs/baselines/baseline_codecs.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "codecs/baselines/baseline_parts.h"

namespace vismat {

std::span<const Codec> baseline_codecs() {
  static const std::vector<Codec> table = [] {
    std::vector<Codec> codecs;
    for (const Codec& codec : whole_file_baselines()) codecs.push_back(codec);
    for (const Codec& codec : zlib_row_baselines()) codecs.push_back(codec);
    for (const Codec& codec : zstd_row_baselines()) codecs.push_back(codec);
    codecs.push_back(roaring_baseline());
    codecs.push_back(streamvbyte_baseline());
    return codecs;
  }();
  return table;
}

std::vector<Codec> all_codecs() {
  std::vector<Codec> all(own_codecs().begin(), own_codecs().end());
  const auto first_over_tree =
      std::find_if(all.begin(), all.end(), [](const Codec& c) { return c.needs.tree != TreeOver::nothing; });
  const auto baselines = baseline_codecs();
  all.insert(first_over_tree, baselines.begin(), baselines.end());
  return all;
}

const Codec& find_codec(std::string_view name) {
  static const std::vector<Codec> all = all_codecs();
  if (const Codec* codec = codec_named(name, all)) return *codec;
  std::string names;
  for (const Codec& codec : all) names += (names.empty() ? "" : ", ") + std::string(codec.name);
  throw std::invalid_argument("no codec '" + std::string(name) + "'; there are " + names);
}

}  // namespace vismat
