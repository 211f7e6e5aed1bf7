#include "codecs/codec.h"

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "codecs/clusters/panne.h"
#include "codecs/entropy/ans.h"
#include "codecs/integer_codes/delimiter.h"
#include "codecs/integer_codes/interpolative.h"
#include "codecs/integer_codes/lzw.h"
#include "codecs/integer_codes/pair_huffman.h"
#include "codecs/integer_codes/rice.h"
#include "codecs/integer_codes/universal_codes.h"
#include "codecs/modelled/modelled_rows.h"
#include "codecs/rows/bitmap.h"
#include "codecs/rows/bv.h"
#include "codecs/rows/elias_fano_rows.h"
#include "codecs/rows/fast_bits.h"
#include "codecs/rows/fast_ids.h"
#include "codecs/rows/pairs.h"
#include "codecs/rows/quake_rle.h"
#include "codecs/tree/tree_coding.h"
#include "codecs/vmat/parts.h"

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
    row_codec<BvRows>("bv", "a reference row, copy blocks, intervals, residual gaps in zeta code",
                      Origin::paper),
    row_codec<FastIdRows>("rows-fast-ids", "gaps and runs as half bytes, bytes for the rarer ones",
                          Origin::ours),
    row_codec<FastBitRows>("rows-fast-bits", "bytes that differ from what four rows share", Origin::ours),
};

}  // namespace

std::span<const Codec> own_codecs() {
  static const std::vector<Codec> table = [] {
    std::vector<Codec> codecs(rows_alone.begin(), rows_alone.end());
    const auto modelled = modelled_codecs();
    codecs.insert(codecs.end(), modelled.begin(), modelled.end());
    for (const auto more : {zach_codecs(), gotsman_codecs()})
      codecs.insert(codecs.end(), more.begin(), more.end());
    return codecs;
  }();
  return table;
}

}  // namespace vismat
