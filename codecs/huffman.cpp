// ALGORITHM. Code lengths by Huffman's two queues over the frequencies in ascending order; where a length
// passes 15 the frequencies are halved (never to 0) and the code built again, which loses a few hundredths of
// a per cent and needs no package-merge. Codes are canonical, numbered by (length, symbol), so that lengths
// alone describe them. Decoding is one look-up of the next `width_` bits, the longest code in use: at most
// 128 kB, usually 16 kB.
#include "codecs/huffman.h"

#include <algorithm>
#include <array>

namespace vismat {
namespace {

// Depth of each leaf in Huffman's tree; `weights` ascend.
std::vector<unsigned> depths_of_sorted(const std::vector<std::uint64_t>& weights) {
  const std::size_t leaves = weights.size();
  std::vector<std::uint64_t> weight(weights);
  std::vector<std::size_t> parent(2 * leaves - 1);
  std::size_t leaf = 0, inner = leaves;
  for (std::size_t made = leaves; made < 2 * leaves - 1; ++made) {
    std::uint64_t sum = 0;
    for (int pick = 0; pick < 2; ++pick) {
      const bool take_leaf = leaf < leaves && (inner >= made || weight[leaf] <= weight[inner]);
      const std::size_t node = take_leaf ? leaf++ : inner++;
      sum += weight[node];
      parent[node] = made;
    }
    weight.push_back(sum);
  }
  std::vector<unsigned> depth(2 * leaves - 1, 0);
  for (std::size_t node = 2 * leaves - 2; node-- > 0;) depth[node] = depth[parent[node]] + 1;
  depth.resize(leaves);
  return depth;
}

std::uint16_t reversed(std::uint32_t code, unsigned length) {
  std::uint32_t out = 0;
  for (unsigned i = 0; i < length; ++i) out |= (code >> i & 1) << (length - 1 - i);
  return static_cast<std::uint16_t>(out);
}

}  // namespace

HuffmanCode HuffmanCode::from_frequencies(std::span<const std::uint64_t> frequencies) {
  std::vector<std::uint32_t> used;
  for (std::uint32_t s = 0; s < frequencies.size(); ++s) {
    if (frequencies[s] > 0) used.push_back(s);
  }
  HuffmanCode code;
  code.lengths_.assign(frequencies.size(), 0);
  std::vector<std::uint64_t> weight(frequencies.begin(), frequencies.end());
  std::stable_sort(used.begin(), used.end(), [&](auto a, auto b) { return weight[a] < weight[b]; });
  if (used.size() == 1) code.lengths_[used[0]] = 1;
  while (used.size() > 1) {
    std::vector<std::uint64_t> sorted;
    for (const std::uint32_t s : used) sorted.push_back(weight[s]);
    const auto depths = depths_of_sorted(sorted);
    if (*std::max_element(depths.begin(), depths.end()) <= longest) {
      for (std::size_t i = 0; i < used.size(); ++i)
        code.lengths_[used[i]] = static_cast<std::uint8_t>(depths[i]);
      break;
    }
    for (const std::uint32_t s : used) weight[s] = weight[s] / 2 + 1;
  }
  code.assign_codes();
  return code;
}

void HuffmanCode::assign_codes() {
  std::array<std::uint32_t, longest + 1> of_length = {}, next = {};
  for (const unsigned length : lengths_) ++of_length[length];
  of_length[0] = 0;  // symbols without a code take none
  for (unsigned length = 1; length <= longest; ++length)
    next[length] = (next[length - 1] + of_length[length - 1]) << 1;
  width_ = *std::max_element(lengths_.begin(), lengths_.end());
  codes_.assign(lengths_.size(), 0);
  table_.assign(std::size_t{1} << width_, 0);
  for (std::uint32_t s = 0; s < lengths_.size(); ++s) {
    const unsigned length = lengths_[s];
    if (length == 0) continue;
    codes_[s] = reversed(next[length]++, length);
    for (std::size_t i = codes_[s]; i < table_.size(); i += std::size_t{1} << length)
      table_[i] = s << 4 | length;
  }
}

std::uint32_t HuffmanCode::get(BitReader& in) const {
  const std::uint32_t entry = table_[in.peek() & ((std::uint32_t{1} << width_) - 1)];
  if (entry == 0) throw FormatError("bits that are no symbol's Huffman code");
  in.take(entry & 15);
  return entry >> 4;
}

void HuffmanCode::write(std::vector<std::byte>& out) const {
  for (std::size_t s = 0; s < lengths_.size();) {
    std::size_t run = 1;
    while (run < 16 && s + run < lengths_.size() && lengths_[s + run] == lengths_[s]) ++run;
    out.push_back(static_cast<std::byte>(lengths_[s] | (run - 1) << 4));
    s += run;
  }
}

HuffmanCode HuffmanCode::read(ByteReader& in, std::uint32_t symbols) {
  HuffmanCode code;
  std::uint32_t space = 0, used = 0;  // of 2^15 codes
  while (code.lengths_.size() < symbols) {
    const auto byte = in.number<std::uint8_t>();
    const unsigned length = byte & 15, run = (byte >> 4) + 1u;
    if (code.lengths_.size() + run > symbols) in.fail("more Huffman code lengths than symbols");
    code.lengths_.insert(code.lengths_.end(), run, static_cast<std::uint8_t>(length));
    if (length > 0) space += run << (longest - length), used += run;
    if (space > std::uint32_t{1} << longest) in.fail("Huffman code lengths claim more codes than there are");
  }
  if (used > 1 && space != std::uint32_t{1} << longest) in.fail("the Huffman code is incomplete");
  code.assign_codes();
  return code;
}

}  // namespace vismat
