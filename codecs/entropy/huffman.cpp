// ALGORITHM. Canonical Huffman codes. Code lengths come from Huffman's two queues over the frequencies in ascending
// order. If a length exceeds 15 the frequencies are halved (never to 0) and the code is built again, which loses a few
// hundredths of a per cent and needs no package-merge. Codes are canonical, numbered by (length, symbol), so that
// lengths alone describe them. Decoding is one look-up of the next `width_` bits, the longest code in use: at most 128
// kB, usually 16 kB.
#include "codecs/entropy/huffman.h"

#include <algorithm>
#include <array>

namespace vismat {
// In place [Moffat, Katajainen 1995]. Inner
// nodes take the places that merged leaves free, first with their weights, once merged with their parents, then with their
// depths.
void huffman_depths(std::span<std::uint64_t> node) {
  const std::size_t leafs = node.size();
  std::size_t leaf = 0, inner = 0;
  for (std::size_t made = 0; made + 1 < leafs; ++made) {
    std::uint64_t weight = 0;
    for (int pick = 0; pick < 2; ++pick) {
      if (leaf < leafs && (inner >= made || node[leaf] <= node[inner])) {
        weight += node[leaf++];
      } else {
        weight += node[inner];
        node[inner++] = made;
      }
    }
    node[made] = weight;
  }
  node[leafs - 2] = 0;
  for (std::size_t i = leafs - 2; i-- > 0;) node[i] = node[node[i]] + 1;
  // Of the 2 i places at depth d, inner nodes take some; leaves, from the heaviest on, the others.
  std::size_t unread = leafs - 1, to = leafs, places = 1;
  for (std::uint64_t depth = 0; to > 0; ++depth) {
    std::size_t inner_here = 0;
    for (; unread > 0 && node[unread - 1] == depth; --unread) ++inner_here;
    for (std::size_t i = inner_here; i < places; ++i) node[--to] = depth;
    places = 2 * inner_here;
  }
}

void put_code_lengths(std::vector<std::byte>& out, std::span<const std::uint8_t> lengths) {
  for (std::size_t s = 0; s < lengths.size();) {
    std::size_t run = 1;
    while (run < 16 && s + run < lengths.size() && lengths[s + run] == lengths[s]) ++run;
    out.push_back(static_cast<std::byte>(lengths[s] | (run - 1) << 4));
    s += run;
  }
}

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
    huffman_depths(sorted);
    if (sorted[0] <= longest_huffman) {
      for (std::size_t i = 0; i < used.size(); ++i)
        code.lengths_[used[i]] = static_cast<std::uint8_t>(sorted[i]);
      break;
    }
    for (const std::uint32_t s : used) weight[s] = weight[s] / 2 + 1;
  }
  code.assign_codes();
  return code;
}

void HuffmanCode::assign_codes() {
  std::array<std::uint32_t, longest_huffman + 1> of_length = {}, next = {};
  for (const unsigned length : lengths_) ++of_length[length];
  of_length[0] = 0;  // symbols without a code take none
  for (unsigned length = 1; length <= longest_huffman; ++length)
    next[length] = (next[length - 1] + of_length[length - 1]) << 1;
  width_ = *std::max_element(lengths_.begin(), lengths_.end());
  codes_.assign(lengths_.size(), 0);
  table_.assign(std::size_t{1} << width_, 0);
  for (std::uint32_t s = 0; s < lengths_.size(); ++s) {
    const unsigned length = lengths_[s];
    if (length == 0) continue;
    codes_[s] = static_cast<std::uint16_t>(reversed_code(next[length]++, length));
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
  put_code_lengths(out, lengths_);
}

HuffmanCode HuffmanCode::read(ByteReader& in, std::uint32_t symbols) {
  HuffmanCode code;
  read_code_lengths(in, symbols, [&](std::uint32_t, unsigned run, unsigned length) {
    code.lengths_.insert(code.lengths_.end(), run, static_cast<std::uint8_t>(length));
  });
  code.assign_codes();
  return code;
}

}  // namespace vismat
