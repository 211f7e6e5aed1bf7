// ALGORITHM. WebGraph's lists, for rows of a visibility matrix.
//
// The encoder takes, for each row in turn, the reference that costs the fewest bits among those that lie in the window
// and from which at most two more references lead on; every candidate is coded in full and its bits are counted, so the
// choice is exact for the row. It is not exact for the matrix: a row that ends a chain may be the better reference for
// later ones. As in the paper, everything that a row has in common with its reference is copied.
//
// What WebGraph [its Java class BVGraph] does differently: it fills bytes from the highest bit on; its rows begin at any
// bit, and a file of gamma codes tells where, which is read as a whole; ours begin at bytes, and the index of all our row
// codecs (part_index.h) tells where. It has no bitmap for a dense row. The codes of the numbers, the defaults (window 7,
// at most 3 references in a chain, intervals from 4 ids on, zeta with k = 3) and all else are the same, so that a row
// takes as many bits. Numbers that are relative to the row's own number stay so where rows and columns are no longer the
// same objects: there this costs up to some 20 bits a row.
//
// A decoder follows the references to a row without one, at most three steps, and comes back. Rows are kept as runs, so
// hostile bytes cannot ask for memory: copying cuts at most as many runs as there are blocks.
#include "codecs/rows/bv.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <string>
#include <utility>

#include "codecs/entropy/list_bits.h"

namespace vismat {
namespace {

constexpr unsigned zeta_k = BvRows::zeta;

// Numbers are coded as n + 1, below 2^34.
unsigned gamma_bits(std::uint64_t n) {
  return 2 * static_cast<unsigned>(std::bit_width(n + 1)) - 1;
}
unsigned zeta_bits(std::uint64_t n) {
  const unsigned h = (static_cast<unsigned>(std::bit_width(n + 1)) - 1) / zeta_k;
  return h + 1 + (h + 1) * zeta_k - ((n + 1) >> (h * zeta_k + 1) == 0);
}
std::uint64_t natural(std::int64_t n) {
  return n >= 0 ? 2 * static_cast<std::uint64_t>(n) : 2 * static_cast<std::uint64_t>(-n) - 1;
}
std::int64_t integer(std::uint64_t n) {
  return n % 2 == 0 ? static_cast<std::int64_t>(n / 2) : -static_cast<std::int64_t>(n / 2) - 1;
}

class Writer {
 public:
  explicit Writer(std::vector<std::byte>& out) : bits_(out) {}
  void unary(unsigned n) {
    put(0, n);
    put(1, 1);
  }
  void gamma(std::uint64_t n) {
    const auto below = static_cast<unsigned>(std::bit_width(n + 1)) - 1;
    unary(below);
    put(lowest_bits(n + 1, below), below);
  }
  // The h-th interval, from 2^(h k) to 2^((h + 1) k) - 1, in minimal binary code: its lower part takes a bit less.
  void zeta(std::uint64_t n) {
    const std::uint64_t x = n + 1;
    const unsigned h = (static_cast<unsigned>(std::bit_width(x)) - 1) / zeta_k, width = (h + 1) * zeta_k - 1;
    const std::uint64_t low = std::uint64_t{1} << (h * zeta_k);
    unary(h);
    if (x < 2 * low) return put(x - low, width);
    put(x / 2, width);
    put(x % 2, 1);
  }
  void finish() { bits_.flush(); }

 private:
  void put(std::uint64_t bits, unsigned count) {
    for (; count > 32; count -= 32, bits >>= 32) bits_.put(bits & 0xffffffff, 32);
    bits_.put(bits, count);
  }
  BitWriter bits_;
};

class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bits_(bytes) {}
  unsigned unary(unsigned most) {
    unsigned zeros = 0;
    for (std::uint32_t ahead; (ahead = bits_.peek()) == 0; zeros += 32, bits_.take(32)) {
      if (zeros > most) break;
    }
    const auto here = static_cast<unsigned>(std::countr_zero(bits_.peek()));
    zeros += here;
    if (zeros > most) refuse("a number that is too large");
    bits_.take(here + 1);
    return zeros;
  }
  std::uint64_t gamma() {
    const unsigned below = unary(33);
    return ((std::uint64_t{1} << below) | get(below)) - 1;
  }
  std::uint64_t zeta() {
    const unsigned h = unary(33 / zeta_k), width = (h + 1) * zeta_k - 1;
    const std::uint64_t low = std::uint64_t{1} << (h * zeta_k), read = get(width);
    return (read < low ? read + low : 2 * read + get(1)) - 1;
  }
  void check() const {
    if (bits_.overran()) refuse("it ends within a number");
  }
  void finish() const { bits_.finish(); }
  [[noreturn]] static void refuse(const std::string& what) { throw FormatError("row of bv: " + what); }

 private:
  std::uint64_t get(unsigned count) {
    std::uint64_t bits = 0;
    unsigned have = 0;
    for (; count - have > 16; have += 16) bits |= std::uint64_t{bits_.get(16)} << have;
    return bits | std::uint64_t{bits_.get(count - have)} << have;
  }
  BitReader bits_;
};

struct Head {
  std::uint64_t ids;
  std::uint32_t r;
};
Head head_of(Reader& in, std::uint32_t row, std::uint32_t columns) {
  const std::uint64_t ids = in.gamma();
  if (ids == 0 || ids > columns)
    Reader::refuse(std::to_string(ids) + " ids in a row of " + std::to_string(columns));
  const std::uint32_t r = in.unary(BvRows::window);
  if (r > row)
    Reader::refuse("a reference " + std::to_string(r) + " rows back from row " + std::to_string(row));
  in.check();
  return {ids, r};
}

// Runs in order; adjacent ones become one.
void append(std::vector<Run>& runs, Run run) {
  if (!runs.empty()) {
    Run& last = runs.back();
    const std::uint64_t end = std::uint64_t{last.first} + last.count;
    if (run.first < end) Reader::refuse("column " + std::to_string(run.first) + " twice");
    if (run.first == end) {
      last.count += run.count;
      return;
    }
  }
  runs.push_back(run);
}

// Copies blocks of the reference's ids, and returns their number.
std::uint64_t copy_blocks(Reader& in, std::span<const Run> reference, std::vector<Run>& copied) {
  std::uint64_t left = 0, ids = 0;  // of the reference; that are copied
  for (const Run run : reference) left += run.count;
  std::size_t at = 0;
  std::uint32_t used = 0;  // of reference[at]
  const auto pass = [&](std::uint64_t count, bool copy) {
    if (count > left) Reader::refuse("copy blocks of more ids than the reference has");
    left -= count;
    if (copy) ids += count;
    while (count > 0) {
      const Run run = reference[at];
      const auto here = static_cast<std::uint32_t>(std::min<std::uint64_t>(count, run.count - used));
      if (copy) append(copied, {run.first + used, here});
      count -= here;
      used += here;
      if (used == run.count) {
        ++at;
        used = 0;
      }
    }
  };
  const std::uint64_t blocks = in.gamma();
  bool copy = true;
  for (std::uint64_t b = 0; b < blocks; ++b, copy = !copy) {
    pass(in.gamma() + (b > 0), copy);
    in.check();
  }
  pass(left, copy);
  return ids;
}

std::uint32_t column(std::int64_t value, std::uint64_t count, std::uint32_t columns) {
  if (value < 0 || static_cast<std::uint64_t>(value) + count > columns)
    Reader::refuse("column " + std::to_string(value) + " in a row of " + std::to_string(columns));
  return static_cast<std::uint32_t>(value);
}

}  // namespace

void BvRows::Plan::make(std::span<const std::uint32_t> ids, std::span<const std::uint32_t> reference,
                        std::uint32_t row, std::uint32_t r) {
  blocks.clear();
  intervals.clear();
  residuals.clear();
  bits = gamma_bits(ids.size()) + r + 1;
  std::size_t own = 0, copied = 0;
  std::uint32_t length = 0;  // of the block
  bool copy = true;
  Run run{0, 0};  // of ids that are not copied
  const auto end_run = [&] {
    if (run.count >= least_interval) {
      intervals.push_back(run);
    } else {
      for (std::uint32_t i = 0; i < run.count; ++i) residuals.push_back(run.first + i);
    }
    run.count = 0;
  };
  const auto add_extra = [&](std::uint32_t id) {
    if (run.count > 0 && run.first + run.count != id) end_run();
    if (run.count == 0) run.first = id;
    ++run.count;
  };
  for (const std::uint32_t id : reference) {
    while (own < ids.size() && ids[own] < id) add_extra(ids[own++]);
    const bool common = own < ids.size() && ids[own] == id;
    own += common;
    copied += common;
    if (common != copy) {
      blocks.push_back(length);
      length = 0;
      copy = common;
    }
    ++length;
  }
  while (own < ids.size()) add_extra(ids[own++]);
  end_run();
  if (r > 0) {
    bits += gamma_bits(blocks.size());
    for (std::size_t b = 0; b < blocks.size(); ++b) bits += gamma_bits(blocks[b] - (b > 0));
  }
  if (copied == ids.size()) return;
  bits += gamma_bits(intervals.size());
  std::int64_t before = row;
  for (std::size_t i = 0; i < intervals.size(); ++i) {
    const std::int64_t first = intervals[i].first;
    bits += gamma_bits(i == 0 ? natural(first - before) : static_cast<std::uint64_t>(first - before - 1));
    bits += gamma_bits(intervals[i].count - least_interval);
    before = first + intervals[i].count;
  }
  before = row;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const std::int64_t id = residuals[i];
    bits += zeta_bits(i == 0 ? natural(id - before) : static_cast<std::uint64_t>(id - before - 1));
    before = id;
  }
}

void BvRows::encode_part(const VisibilityMatrix& matrix, std::uint32_t row, std::uint32_t,
                         std::vector<std::byte>& out) {
  const auto ids = matrix.row(row);
  chain_.push_back(0);
  if (ids.empty()) return;
  best_.make(ids, {}, row, 0);
  std::uint32_t best_r = 0;
  for (std::uint32_t r = 1; r <= std::min(window, row); ++r) {
    if (chain_[row - r] == longest_chain || matrix.row(row - r).empty()) continue;
    plan_.make(ids, matrix.row(row - r), row, r);
    if (plan_.bits >= best_.bits) continue;
    std::swap(plan_, best_);
    best_r = r;
  }
  if ((best_.bits + 7) / 8 >= row_bytes_of(matrix.shape().columns))
    return put_bitmap_row(out, ids, matrix.shape().columns);
  chain_.back() = best_r == 0 ? 0 : static_cast<std::uint8_t>(chain_[row - best_r] + 1);
  Writer bits(out);
  bits.gamma(ids.size());
  bits.unary(best_r);
  if (best_r > 0) {
    bits.gamma(best_.blocks.size());
    for (std::size_t b = 0; b < best_.blocks.size(); ++b) bits.gamma(best_.blocks[b] - (b > 0));
  }
  if (!best_.intervals.empty() || !best_.residuals.empty()) {
    bits.gamma(best_.intervals.size());
    std::int64_t before = row;
    for (std::size_t i = 0; i < best_.intervals.size(); ++i) {
      const auto [first, count] = best_.intervals[i];
      bits.gamma(i == 0 ? natural(first - before) : static_cast<std::uint64_t>(first - before - 1));
      bits.gamma(count - least_interval);
      before = std::int64_t{first} + count;
    }
    before = row;
    for (std::size_t i = 0; i < best_.residuals.size(); ++i) {
      const std::int64_t id = best_.residuals[i];
      bits.zeta(i == 0 ? natural(id - before) : static_cast<std::uint64_t>(id - before - 1));
      before = id;
    }
  }
  bits.finish();
}

std::uint32_t BvRows::reference_of(std::uint32_t row, std::span<const std::byte> part) const {
  if (part.empty() || part.size() == row_bytes_of(columns_)) return 0;
  Reader in(part);
  return head_of(in, row, columns_).r;
}

RowSource::Cost BvRows::cost(std::uint32_t row, const Parts& parts) const {
  RowSource::Cost cost;
  for (std::uint32_t r = 1; r > 0 && cost.parts <= longest_chain; row -= r) {
    const auto part = parts.part(row);
    cost.bytes += part.size();
    ++cost.parts;
    r = reference_of(row, part);
  }
  return cost;
}

std::span<const Run> BvRows::runs_of(std::uint32_t row, const Parts& parts, Scratch& scratch) const {
  std::array<std::uint32_t, longest_chain + 1> chain;
  std::size_t length = 0;
  for (std::uint32_t r = 1; r > 0; row -= r) {
    if (length == chain.size()) Reader::refuse("more than 3 references in a row");
    chain[length++] = row;
    r = reference_of(row, parts.part(row));
  }
  std::vector<Run>&reference = scratch.reference, &runs = scratch.row, &copied = scratch.copied,
  &intervals = scratch.intervals;
  runs.clear();
  while (length > 0) {
    row = chain[--length];
    reference.swap(runs);
    runs.clear();
    copied.clear();
    intervals.clear();
    const auto part = parts.part(row);
    if (part.empty()) continue;
    if (part.size() > row_bytes_of(columns_))
      Reader::refuse(std::to_string(part.size()) + " bytes; its bitmap has " +
                     std::to_string(row_bytes_of(columns_)));
    if (part.size() == row_bytes_of(columns_)) {
      struct {  // a sink
        std::vector<Run>& runs;
        std::uint32_t columns;
        std::uint64_t next = 0;
        void run(std::uint64_t gap, std::uint64_t count) {
          const std::uint64_t first = next + gap;
          next = first + count;
          if (next > columns) Reader::refuse("column " + std::to_string(next - 1) + " of its bitmap");
          append(runs, {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count)});
        }
      } sink{runs, columns_};
      get_bitmap_row(part, sink);
      continue;
    }
    Reader in(part);
    const Head head = head_of(in, row, columns_);
    std::uint64_t left = head.ids;
    const auto take = [&](std::uint64_t count) {
      if (count > left) Reader::refuse("more than its " + std::to_string(head.ids) + " ids");
      left -= count;
    };
    if (head.r > 0) take(copy_blocks(in, reference, copied));
    if (left > 0) {
      const std::uint64_t count = in.gamma();
      std::int64_t before = row;
      for (std::uint64_t i = 0; i < count; ++i) {
        const std::uint64_t n = in.gamma();
        const std::int64_t first = i == 0 ? before + integer(n) : before + 1 + static_cast<std::int64_t>(n);
        const std::uint64_t size = in.gamma() + least_interval;
        in.check();
        take(size);
        append(intervals, {column(first, size, columns_), static_cast<std::uint32_t>(size)});
        before = first + static_cast<std::int64_t>(size);
      }
    }
    // The three lists are merged as the residuals come.
    std::size_t next_copied = 0, next_interval = 0;
    const auto append_before = [&](std::uint64_t column) {
      for (;;) {
        const bool is_copied =
            next_copied < copied.size() &&
            (next_interval == intervals.size() || copied[next_copied].first < intervals[next_interval].first);
        if (!is_copied && next_interval == intervals.size()) return;
        const Run run = is_copied ? copied[next_copied] : intervals[next_interval];
        if (run.first > column) return;
        append(runs, run);
        ++(is_copied ? next_copied : next_interval);
      }
    };
    std::int64_t before = row;
    for (bool first = true; left > 0; first = false) {
      const std::uint64_t n = in.zeta();
      in.check();
      --left;
      const std::int64_t id = first ? before + integer(n) : before + 1 + static_cast<std::int64_t>(n);
      const std::uint32_t c = column(id, 1, columns_);
      append_before(c);
      append(runs, {c, 1});
      before = id;
    }
    append_before(std::numeric_limits<std::uint64_t>::max());
    in.finish();
  }
  return runs;
}

}  // namespace vismat
