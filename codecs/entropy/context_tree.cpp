// ALGORITHM, after tree coding of bilevel images [Martins & Forchhammer, Tree coding of bilevel images, 1998]. Fixed
// templates of n pixels need 2^n probabilities, few of which are seen often enough to be worth storing. A tree asks a
// question only where the answer pays for itself. It is grown greedily: at each node comes the question that leaves the
// samples the fewest bits of entropy. Then it is cut back, from the leaves up, wherever code and description together
// are shorter without a subtree. So a question that saves little itself is kept for those that it leads to.
//
// Counting goes by words: 64 samples are transposed as a matrix of 64 x 64 bits. Then one population count for each
// question gives the number of samples whose answer is 1, and another the number of those whose outcome is 1 too. 8 M
// samples of 44 questions take 0.5 s.
//
// A probability is stored as that of the rarer outcome, in floating point with 3 bits below the leading one: half a
// step costs at most 0.1 % of the code.
#include "codecs/entropy/context_tree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>

#include "codecs/entropy/bit_stream.h"

namespace vismat {
namespace {

constexpr double leaf_bits = 9, question_bits = 7;
constexpr std::uint32_t half = 1u << (ContextTree::share_bits - 1);

// The rarer outcome's share in 7 bits, 1 to 88, and whether it is 0 in the eighth.
std::uint32_t magnitude(std::uint32_t code) {
  return code < 8 ? code : (8 + code % 8) << (code / 8 - 1);
}
std::uint32_t code_of_share(std::uint32_t share) {
  const bool zeros_rarer = share > half;
  const std::uint32_t rarer = zeros_rarer ? 2 * half - share : share;
  std::uint32_t code = 88;
  while (magnitude(code) > rarer) --code;
  return code | (zeros_rarer ? 128u : 0u);
}
std::uint32_t share_of_code(std::uint32_t code) {
  return code < 128 ? magnitude(code) : 2 * half - magnitude(code - 128);
}

// The nearest share that has a code, by the ratio of what is rarer.
std::uint32_t nearest_share(std::uint64_t ones, std::uint64_t count) {
  const bool zeros_rarer = 2 * ones > count;
  const double rarer =
      static_cast<double>(zeros_rarer ? count - ones : ones) / static_cast<double>(count) * 2 * half;
  std::uint32_t code = 1;
  while (code < 88 && rarer > std::sqrt(static_cast<double>(magnitude(code)) * magnitude(code + 1))) ++code;
  return share_of_code(code | (zeros_rarer && code < 88 ? 128u : 0u));
}

// Bits that `count` outcomes take by their own frequencies.
double entropy(std::uint64_t ones, std::uint64_t count) {
  if (ones == 0 || ones == count) return 0;
  const auto a = static_cast<double>(ones), b = static_cast<double>(count - ones),
             n = static_cast<double>(count);
  return a * std::log2(n / a) + b * std::log2(n / b);
}
// Bits that they take by a probability that can be stored.
double code_bits(std::uint64_t ones, std::uint64_t count) {
  const double share = nearest_share(ones, count);
  return static_cast<double>(ones) * std::log2(2 * half / share) +
         static_cast<double>(count - ones) * std::log2(2 * half / (2 * half - share));
}

using Words = std::array<std::uint64_t, 64>;

// Swaps the blocks of Size x Size bits beside the diagonal: one step of transposing 64 x 64 bits.
template <unsigned Size>
[[gnu::always_inline]] inline void swap_blocks(Words& words) {
  constexpr std::uint64_t low =
      ~std::uint64_t{0} / ((std::uint64_t{1} << Size) + 1);  // Size ones, Size zeros, ...
  for (unsigned begin = 0; begin < 64; begin += 2 * Size) {
    for (unsigned k = begin; k < begin + Size; ++k) {
      const std::uint64_t swapped = (words[k] >> Size ^ words[k + Size]) & low;
      words[k] ^= swapped << Size;
      words[k + Size] ^= swapped;
    }
  }
}

struct Counts {
  Words answers{}, both{};  // of each question: answered by 1; that, and the outcome is 1
};

[[gnu::always_inline]] inline void count_loop(std::span<const std::uint64_t> samples, Counts& counts) {
  for (std::size_t i = 0; i < samples.size(); i += 64) {
    Words words{};
    std::copy_n(samples.begin() + static_cast<std::ptrdiff_t>(i),
                std::min<std::size_t>(64, samples.size() - i), words.begin());
    swap_blocks<32>(words);  // [Warren, Hacker's Delight, 7-3]
    swap_blocks<16>(words);
    swap_blocks<8>(words);
    swap_blocks<4>(words);
    swap_blocks<2>(words);
    swap_blocks<1>(words);
    for (unsigned q = 0; q < 64; ++q) {
      counts.answers[q] += static_cast<std::uint64_t>(std::popcount(words[q]));
      counts.both[q] += static_cast<std::uint64_t>(std::popcount(words[q] & words[63]));
    }
  }
}
void count_plain(std::span<const std::uint64_t> samples, Counts& counts) {
  count_loop(samples, counts);
}
#if defined(__x86_64__)
[[gnu::target("avx2,popcnt")]] void count_avx2(std::span<const std::uint64_t> samples, Counts& counts) {
  count_loop(samples, counts);
}
#endif

const auto count_answers = [] {
#if defined(__x86_64__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("popcnt")) return &count_avx2;
#endif
  return &count_plain;
}();

}  // namespace

struct ContextTree::Grower {
  std::vector<Node>& nodes;
  unsigned questions;
  double weight;

  // The bits that the best subtree for these samples takes as node `at`, its own description included.
  double grow(std::span<std::uint64_t> samples, std::uint32_t at) {
    Counts counts;
    count_answers(samples, counts);
    const auto& [answers, both] = counts;
    const std::uint64_t count = samples.size(), ones = answers[63];
    const double alone = entropy(ones, count);
    double most = 0;
    unsigned question = 0;
    for (unsigned q = 0; q < questions; ++q) {
      if (answers[q] == 0 || answers[q] == count) continue;
      const double saved = alone - entropy(both[q], answers[q]) - entropy(ones - both[q], count - answers[q]);
      if (saved > most) {
        most = saved;
        question = q;
      }
    }
    nodes[at] = {};
    if (count > 0) nodes[at].share = static_cast<std::uint16_t>(nearest_share(ones, count));
    const double as_leaf = leaf_bits + (count > 0 ? weight * code_bits(ones, count) : 0);
    if (weight * most < question_bits) return as_leaf;

    const auto middle = std::partition(samples.begin(), samples.end(),
                                       [&](std::uint64_t sample) { return (sample >> question & 1) == 0; });
    const auto first = static_cast<std::uint32_t>(nodes.size()),
               zeros = static_cast<std::uint32_t>(middle - samples.begin());
    nodes.resize(nodes.size() + 2);
    const double asked =
        question_bits + grow(samples.first(zeros), first) + grow(samples.subspan(zeros), first + 1);
    if (asked >= as_leaf) {
      nodes.resize(first);
      return as_leaf;
    }
    nodes[at].question = static_cast<std::uint16_t>(question);
    nodes[at].share = 0;
    nodes[at].first = first;
    return asked;
  }
};

ContextTree ContextTree::grow(std::vector<std::uint64_t>& samples, unsigned questions, double weight) {
  ContextTree tree;
  Grower{tree.nodes_, questions, weight}.grow(samples, 0);
  return tree;
}

void ContextTree::write(std::vector<std::byte>& out) const {
  BitWriter bits(out);
  std::vector<std::uint32_t> waiting = {0};
  while (!waiting.empty()) {
    const Node& node = nodes_[waiting.back()];
    waiting.pop_back();
    bits.put(node.question != leaf, 1);
    if (node.question == leaf) {
      bits.put(code_of_share(node.share), 8);
    } else {
      bits.put(node.question, 6);
      waiting.push_back(node.first + 1);
      waiting.push_back(node.first);
    }
  }
  bits.flush();
}

ContextTree ContextTree::read(ByteReader& in, unsigned questions) {
  unsigned byte = 0, left = 0;  // bits of the last byte not yet read
  const auto number = [&](unsigned count) {
    unsigned value = 0;
    for (unsigned i = 0; i < count; ++i, byte >>= 1, --left) {
      if (left == 0) {
        byte = in.number<std::uint8_t>();
        left = 8;
      }
      value |= (byte & 1) << i;
    }
    return value;
  };
  struct Place {
    std::uint32_t node;
    std::uint64_t asked;  // on the path to it
  };
  ContextTree tree;
  std::vector<Place> waiting = {{0, 0}};
  while (!waiting.empty()) {
    const auto [at, asked] = waiting.back();
    waiting.pop_back();
    if (number(1) == 0) {
      const unsigned code = number(8);
      if (code % 128 == 0 || code % 128 > 88 || code == 128 + 88)
        in.fail("no probability has code " + std::to_string(code));
      tree.nodes_[at].share = static_cast<std::uint16_t>(share_of_code(code));
      continue;
    }
    const unsigned question = number(6);
    if (question >= questions || (asked >> question & 1) != 0)
      in.fail("question " + std::to_string(question) + " cannot be asked here");
    const auto first = static_cast<std::uint32_t>(tree.nodes_.size());
    tree.nodes_.resize(first + std::size_t{2});
    tree.nodes_[at] = {static_cast<std::uint16_t>(question), 0, first};
    const std::uint64_t now = asked | std::uint64_t{1} << question;
    waiting.push_back({first + 1, now});
    waiting.push_back({first, now});
  }
  if (byte != 0) in.fail("the padding bits are not zero");
  return tree;
}

}  // namespace vismat
