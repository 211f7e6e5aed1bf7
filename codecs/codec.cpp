#include "codecs/codec.h"

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "codecs/ans.h"
#include "codecs/bitmap.h"
#include "codecs/delimiter.h"
#include "codecs/elias_fano_rows.h"
#include "codecs/interpolative.h"
#include "codecs/lzw.h"
#include "codecs/pair_huffman.h"
#include "codecs/pairs.h"
#include "codecs/panne.h"
#include "codecs/parts.h"
#include "codecs/quake_rle.h"
#include "codecs/rice.h"
#include "codecs/tree_coding.h"
#include "codecs/universal_codes.h"

namespace vismat {
namespace {

struct DelimiterCode {
  void put(std::vector<std::byte>& out, std::span<const std::uint32_t> numbers) const {
    put_delimited(out, numbers);
  }
  struct Reader : DelimitedReader {
    Reader(const DelimiterCode&, std::span<const std::byte> bytes) : DelimitedReader(bytes) {}
  };
};

template <typename Code>
constexpr Codec pairs(std::string_view name, std::string_view contents, Origin origin = Origin::ours) {
  return row_codec<PairRows<Code>>(name, contents, origin);
}

constexpr Codec panne() {
  Codec codec = row_codec<PanneRows>(
      "panne", "clusters of common subsets, runs of zeros, a Huffman code each for all rows", Origin::paper);
  codec.slow_encode = codec.searches = true;
  return codec;
}

constexpr std::array rows_alone = {
    row_codec<BitmapRows>("bitmap", "rows of bits, padded to bytes", Origin::baseline),
    row_codec<QuakeRows>("quake-rle", "bitmap, zero bytes run-length coded", Origin::baseline),
    pairs<DelimiterCode>("delimiter", "gaps and runs, a delimiter between numbers", Origin::paper),
    pairs<GammaCode>("pair-gamma", "gaps and runs, Elias' gamma code"),
    pairs<DeltaCode>("pair-delta", "gaps and runs, Elias' delta code"),
    pairs<RiceCode>("pair-rice", "gaps and runs, Rice's code, its parameters in each row"),
    pairs<InterpolativeCode>("pair-interpolative", "where runs begin and end, interpolative code"),
    pairs<OwnHuffmanCode>("pair-huffman", "gaps and runs, a Huffman code in each row"),
    pairs<SharedHuffmanCode>("pair-huffman-shared", "gaps and runs, a Huffman code each for all rows"),
    pairs<LzwCode>("pair-lzw", "gaps and runs as bytes, LZW"),
    pairs<AnsCode>("pair-ans", "gaps and runs, tANS, a table each for all rows"),
    row_codec<EliasFanoRows>("elias-fano", "ids, Elias-Fano", Origin::ours),
    panne(),
};

}  // namespace

std::string_view to_string(Origin origin) {
  return origin == Origin::ours ? "ours" : origin == Origin::paper ? "paper" : "baseline";
}

std::span<const Codec> own_codecs() {
  static const std::vector<Codec> table = [] {
    std::vector<Codec> codecs(rows_alone.begin(), rows_alone.end());
    for (const auto more : {zach_codecs(), gotsman_codecs()})
      codecs.insert(codecs.end(), more.begin(), more.end());
    return codecs;
  }();
  return table;
}

const Codec* codec_named(std::string_view name, std::span<const Codec> codecs) {
  const auto found = std::ranges::find(codecs, name, &Codec::name);
  return found == codecs.end() ? nullptr : &*found;
}

const Codec& codec_of_file(std::string_view name, std::span<const Codec> codecs) {
  const Codec* const found = codec_named(name, codecs);
  if (found == nullptr) throw FormatError("codec '" + std::string(name) + "' is unknown here");
  return *found;
}

const ObjectTree* tree_for(const Codec& codec, const SourceMap& source) {
  if (codec.needs.tree == TreeOver::nothing) return nullptr;
  const auto& tree = codec.needs.tree == TreeOver::rows ? source.row_tree : source.tree;
  return tree ? &*tree : nullptr;
}

VisibilityMatrix decode(const Codec& codec, const Encoded& encoded, Shape shape, const Side& side,
                        std::uint64_t most) {
  return codec.decode(Parts(encoded), shape, side, most);
}

}  // namespace vismat
