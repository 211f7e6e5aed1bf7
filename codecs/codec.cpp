#include "codecs/codec.h"

#include <array>
#include <span>
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
#include "codecs/quake_rle.h"
#include "codecs/rice.h"
#include "codecs/tree_coding.h"
#include "codecs/universal_codes.h"

namespace vismat {
namespace {

using Bytes = std::span<const std::byte>;

// The table wants plain functions; each codec over a tree is known to the rest by its name alone.
template <std::size_t N>
struct Name {
  constexpr Name(const char (&text)[N]) {
    for (std::size_t i = 0; i < N; ++i) value[i] = text[i];
  }
  char value[N];
};

template <Name name>
constexpr Codec over_tree(std::string_view contents, TreeOver side, bool wants_row_order = false) {
  Codec codec{};
  codec.name = name.value;
  codec.contents = contents;
  codec.over_tree = side;
  codec.wants_row_order = wants_row_order;
  codec.encode = [](const VisibilityMatrix& matrix, const ObjectTree* tree) {
    return encode_over_tree(*make_node_coder(name.value), matrix, tree);
  };
  codec.decode = [](Bytes payload, Bytes index, Shape shape, const ObjectTree* tree) {
    return decode_over_tree(name.value, payload, index, shape, tree);
  };
  return codec;
}

struct DelimiterCode {
  void put(std::vector<std::byte>& out, std::span<const std::uint32_t> numbers) const {
    put_delimited(out, numbers);
  }
  struct Reader : DelimitedReader {
    Reader(const DelimiterCode&, std::span<const std::byte> bytes) : DelimitedReader(bytes) {}
  };
};

constexpr std::array table = {
    row_codec<BitmapRows>("bitmap", "rows of bits, padded to bytes"),
    row_codec<QuakeRows>("quake-rle", "bitmap, zero bytes run-length coded"),
    row_codec<PairRows<DelimiterCode>>("delimiter", "gaps and runs, a delimiter between numbers"),
    row_codec<PairRows<GammaCode>>("pair-gamma", "gaps and runs, Elias' gamma code"),
    row_codec<PairRows<DeltaCode>>("pair-delta", "gaps and runs, Elias' delta code"),
    row_codec<PairRows<RiceCode>>("pair-rice", "gaps and runs, Rice's code, its parameters in each row"),
    row_codec<PairRows<InterpolativeCode>>("pair-interpolative",
                                           "where runs begin and end, interpolative code"),
    row_codec<PairRows<OwnHuffmanCode>>("pair-huffman", "gaps and runs, a Huffman code in each row"),
    row_codec<PairRows<SharedHuffmanCode>>("pair-huffman-shared",
                                           "gaps and runs, a Huffman code each for all rows"),
    row_codec<PairRows<LzwCode>>("pair-lzw", "gaps and runs as bytes, LZW"),
    row_codec<PairRows<AnsCode>>("pair-ans", "gaps and runs, tANS, a table each for all rows"),
    row_codec<EliasFanoRows>("elias-fano", "ids, Elias-Fano"),
    row_codec<PanneRows>("panne", "clusters of common subsets, runs of zeros, a Huffman code each for all rows"),
    over_tree<"zach0">("children's bits in the parent's cells", TreeOver::columns),
    over_tree<"zach1">("intersection of all children, bits outside it", TreeOver::columns),
    over_tree<"zach2">("intersection of a chosen subset, subset masks, bits outside it", TreeOver::columns),
    over_tree<"zach3-huffman">("run lengths, a Huffman code each for runs of zeros and of ones",
                               TreeOver::columns, true),
    over_tree<"zach3-range">("run lengths, range coded, frequencies each for runs of zeros and of ones",
                             TreeOver::columns, true),
    over_tree<"zach4-huffman">("ones before each zero, one Huffman code", TreeOver::columns, true),
    over_tree<"zach4-range">("ones before each zero, range coded", TreeOver::columns, true),
    over_tree<"gotsman1">("both children's objects", TreeOver::rows),
    over_tree<"gotsman2">("both children's objects, of the node's", TreeOver::rows),
    over_tree<"gotsman3">("the first child's objects, of the node's; the second's, of the first's", TreeOver::rows),
    over_tree<"gotsman3-context">("of each of the node's objects which child sees it, range coded under contexts",
                                  TreeOver::rows),
};

}  // namespace

std::span<const Codec> own_codecs() {
  return table;
}

}  // namespace vismat
