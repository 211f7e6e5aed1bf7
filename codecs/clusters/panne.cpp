// ALGORITHM. The codec `panne`. The paper [van de Panne & Stewart 1999] is not available to us. Its abstract and the
// accounts of Chhugani et al. 2005 (6.2) and Zach & Karner 2003 (2.3, 4.1, 5) say this. It compresses a table of view
// cells by polygons. Without loss, clusters of equal regions of the table are formed, which leaves fewer ones; then the
// lengths of the runs of zeros are stored. The ratio is 7 at best. The search is slow, as it goes through a very large
// space of states. (Its lossy half merges rows or columns into their union; layout/groups has that.) All else is our
// reconstruction:
//
//   what a cluster is     a set of objects and clusters that two lists or more have in common as a whole; clusters may hold clusters
//   what it costs         panne_table.h: the price of every list's numbers under the common code; each step of the search lowers it
//   the search            1. Equal columns become clusters, if that leads further in a trial of four rounds.
//                         2. Clusters over rows: two lists, rows or clusters, give what they have in common to a third.
//                         3. Clusters over columns: two members become one in the lists that hold both, if that saves.
//                         4. A cluster that only one list holds is dissolved into it.
//                         5. With time left, a third of the clusters are dissolved, and 2 to 4 continue from there; what does not
//                            save in the end is undone.
//                         Candidates are neighbours in orders by min-hash [Broder 1997], of the lists' members for 2 and
//                         of the members' lists for 3, and in the matrix. The search goes in rounds: pairs are taken from the one that
//                         saves most on, each list once, none that saves less than 15/16 of what either could save otherwise
//   the bits              members by where they begin, zeros counted from where the member before reaches, runs
//                         of objects coded as one; a Huffman code for each kind of number, so that any row is read alone
//
// Runs of objects are coded besides those of zeros: with zeros alone, columns in a good order cost a step for each
// object, so oa_thor's faces take 179 kB instead of 167 even at their entropy, and 514 kB in Huffman codes. A range
// coder in place of those, ended in each row, makes artificial 1 smaller by 0.7 % and oa_koth1's faces larger by 0.2 %.
//
// Tried and found worse: pairs of adjacent members, the most frequent first (as Re-Pair does), in place of 2 and 3:
// 1474 kB for oa_thor's faces in the natural order, where 2 alone left 291 kB, as no pair saves enough to begin with.
// Any pair that saves, not only those near the best for both: up to 14 % more there. More orders and wider windows in
// place of 5: nothing after 15 s on artificial 2.
#include "codecs/clusters/panne.h"

#include <string>
#include <utility>

namespace vismat {
// --- Encoder --------------------------------------------------------------------------------------------------------------

PanneRows::PanneRows(PanneTable table) : columns_(table.shape().columns), table_(std::move(table)) {
  table_->close_ranks();
  for (std::uint32_t v = 0; v < table_->clusters(); ++v) {
    const std::uint32_t member = columns_ + v;
    if (!table_->lists()[table_->list_of_member(member)].empty()) in_order_.push_back(member);
  }
  std::sort(in_order_.begin(), in_order_.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(table_->first(a), table_->rank(a)) < std::pair(table_->first(b), table_->rank(b));
  });
}

// visit(code, number, kind of step) for each number of a list.
template <typename Visit>
void PanneRows::for_each_number(std::uint32_t list, const Visit& visit) const {
  table_->for_each_number(list, [&](PanneNumber kind, std::uint32_t number) {
    switch (kind) {
      case PanneNumber::run:
        return visit(&PanneRows::run_lengths_, number, 0);
      case PanneNumber::rank:
        return visit(&PanneRows::ranks_, number, 0);
      case PanneNumber::lead:
        return visit(&PanneRows::leads_, number, 0);
      default:
        return visit(&PanneRows::steps_, number, static_cast<std::uint32_t>(kind));
    }
  });
}

void PanneRows::put_list(BitWriter& out, std::uint32_t list) const {
  for_each_number(list, [&](PanneCode PanneRows::*code, std::uint32_t number, std::uint32_t kind) {
    (this->*code).put(out, number, kind);
  });
}

void PanneRows::write_model(std::vector<std::byte>& out) {
  std::vector<std::uint32_t> heads(in_order_.empty() ? 0 : columns_, 0);
  for (const std::uint32_t member : in_order_) ++heads[table_->first(member)];
  for (const std::uint32_t clusters : heads) heads_.count(clusters + 1);
  const auto count = [this](PanneCode PanneRows::*code, std::uint32_t number, std::uint32_t kind) {
    (this->*code).count(number, kind);
  };
  for (std::uint32_t l = 0; l < table_->lists().size(); ++l) for_each_number(l, count);
  put_varint(out, in_order_.size());
  steps_.write(out);
  run_lengths_.write(out);
  if (in_order_.empty()) return;
  for (PanneCode* code : {&ranks_, &leads_, &heads_}) code->write(out);
  BitWriter bits(out);
  for (const std::uint32_t clusters : heads) heads_.put(bits, clusters + 1);
  for (const std::uint32_t member : in_order_) put_list(bits, table_->list_of_member(member));
  bits.flush();
}

void PanneRows::encode_part(const VisibilityMatrix& matrix, std::uint32_t row, std::uint32_t,
                            std::vector<std::byte>& out) const {
  const std::size_t begin = out.size();
  BitWriter bits(out);
  put_list(bits, row);
  bits.flush();
  if (out.size() - begin < row_bytes_of(columns_)) return;
  out.resize(begin);
  put_bitmap_row(out, matrix.row(row), columns_);
}

Encoded encode_panne(const VisibilityMatrix& matrix, const PanneTable& table) {
  return detail::encode_rows_with(PanneRows(table), matrix);
}

// --- Decoder --------------------------------------------------------------------------------------------------------------

PanneRows PanneRows::read_model(ByteReader& in, Shape shape) {
  PanneRows rows;
  rows.columns_ = shape.columns;
  const std::uint64_t clusters = in.varint();
  rows.steps_.read(in);
  rows.run_lengths_.read(in);
  if (clusters == 0) return rows;
  if (shape.columns > PanneTable::most_columns)
    in.fail("clusters in rows of " + std::to_string(shape.columns) + " columns, of " +
            std::to_string(PanneTable::most_columns) + " at most");
  for (PanneCode* code : {&rows.ranks_, &rows.leads_, &rows.heads_}) code->read(in);
  if (clusters > 8 * in.left()) in.fail(std::to_string(clusters) + " clusters in fewer bits");
  rows.read_clusters(in, static_cast<std::uint32_t>(clusters));
  return rows;
}

inline std::uint32_t PanneRows::cluster_at(std::uint32_t first, std::uint32_t rank) const {
  if (rank > begin_at_[first + 1] - begin_at_[first]) [[unlikely]]
    throw FormatError("cluster " + std::to_string(rank) + " at column " + std::to_string(first) +
                      ", where fewer begin");
  return begin_at_[first] + rank - 1;
}

// A cluster's lists are kept as runs of its own objects and the clusters that it holds. How far it reaches and how many objects it
// has follow from the clusters within: those that begin behind it, and at most one that begins with it. From the last
// column to the first, and at each along the chain of those within, all that it takes is known.
void PanneRows::read_clusters(ByteReader& in, std::uint32_t count) {
  BitReader bits(in.bytes(in.left()));
  const auto check = [&] {
    if (bits.overran()) throw FormatError("the clusters' bits end early");
  };
  clusters_.resize(std::size_t{count} + 1);
  begin_at_.resize(std::size_t{columns_} + 1);
  std::uint32_t told = 0;
  for (std::uint32_t c = 0; c < columns_; ++c) {
    begin_at_[c] = told;
    const std::uint32_t here = heads_.get(bits).first - 1;
    if (here > count - told) throw FormatError("more clusters begin than there are");
    for (std::uint32_t i = 0; i < here; ++i) clusters_[told++].first = c;
    check();
  }
  begin_at_[columns_] = told;
  if (told != count) throw FormatError("fewer clusters begin than there are");
  // Steps as they are coded: a step's beginning depends on how far the clusters before it reach.
  struct Step {
    std::uint32_t zeros, count;
    bool is_cluster;
  };
  std::vector<Step> steps;
  std::vector<std::size_t> begin(std::size_t{count} + 1, 0);
  for (std::uint32_t v = 0; v < count; ++v) {
    begin[v] = steps.size();
    const std::uint32_t lead = leads_.get(bits).first - 1;
    steps.push_back({0, std::max(lead, 1u), lead > 0});
    for (;;) {
      const auto [number, kind] = steps_.get(bits);
      check();
      if (kind == PanneCode::end) break;
      const bool is_cluster = kind == PanneCode::cluster;
      const std::uint32_t size = is_cluster                  ? ranks_.get(bits).first
                                 : kind == PanneCode::object ? 1
                                                             : run_of_objects(bits);
      steps.push_back({number - 1, size, is_cluster});
    }
    if (steps.size() - begin[v] < 2) throw FormatError("a cluster of one member");
  }
  bits.finish();
  begin[count] = steps.size();

  struct Content {
    std::vector<Run> runs;
    std::vector<std::uint32_t> clusters;
  };
  std::vector<Content> contents(count);
  const auto build = [&](std::uint32_t v) {
    Cluster& it = clusters_[v];
    Content& content = contents[v];
    std::uint64_t objects = 0;
    std::uint32_t from = it.first;
    it.reach = it.first;
    for (std::size_t i = begin[v]; i < begin[v + 1]; ++i) {
      const auto [zeros, size, is_cluster] = steps[i];
      if (zeros >= columns_ - from) throw FormatError("a cluster goes on behind the last column");
      const std::uint32_t first = from + zeros;
      if (is_cluster) {
        const std::uint32_t inner = cluster_at(first, size);
        from = clusters_[inner].reach;
        objects += clusters_[inner].objects;
        content.clusters.push_back(inner);
      } else {
        if (size > columns_ - first) throw FormatError("a cluster goes on behind the last column");
        if (!content.runs.empty() && content.runs.back().first + content.runs.back().count == first)
          content.runs.back().count += size;
        else
          content.runs.push_back({first, size});
        from = first + size;
        objects += size;
      }
      if (first == it.reach) it.reach = from;
    }
    if (objects > columns_) throw FormatError("a cluster of more objects than columns");
    it.objects = static_cast<std::uint32_t>(objects);
  };
  std::vector<std::uint32_t> chain;
  for (std::uint32_t c = columns_; c-- > 0;) {
    for (std::uint32_t v = begin_at_[c]; v < begin_at_[c + 1]; ++v) {
      for (std::uint32_t next = v; clusters_[next].objects == 0;) {
        chain.push_back(next);
        if (chain.size() > begin_at_[c + 1] - begin_at_[c]) throw FormatError("a cluster holds itself");
        const Step& lead = steps[begin[next]];
        if (!lead.is_cluster) break;
        next = cluster_at(c, lead.count);
      }
      for (; !chain.empty(); chain.pop_back()) build(chain.back());
    }
  }
  for (std::uint32_t v = 0; v < count; ++v) {
    clusters_[v].runs = static_cast<std::uint32_t>(runs_.size());
    clusters_[v].clusters = static_cast<std::uint32_t>(inner_.size());
    runs_.insert(runs_.end(), contents[v].runs.begin(), contents[v].runs.end());
    inner_.insert(inner_.end(), contents[v].clusters.begin(), contents[v].clusters.end());
  }
  clusters_[count].runs = static_cast<std::uint32_t>(runs_.size());
  clusters_[count].clusters = static_cast<std::uint32_t>(inner_.size());
}

namespace {

[[noreturn]] void refuse_overlap() {
  throw FormatError("an object is in a row twice");
}

inline void set_run(std::uint64_t* words, std::uint32_t first, std::uint32_t count) {
  const std::uint32_t last = first + count - 1;
  const std::uint64_t from = ~std::uint64_t{0} << (first % 64), to = ~std::uint64_t{0} >> (63 - last % 64);
  std::uint64_t* word = words + first / 64;
  std::uint64_t* const end = words + last / 64;
  std::uint64_t twice = 0, mask = from;
  for (; word != end; mask = ~std::uint64_t{0}) {
    twice |= *word & mask;
    *word++ |= mask;
  }
  mask &= to;
  twice |= *word & mask;
  *word |= mask;
  if (twice != 0) [[unlikely]]
    refuse_overlap();
}

}  // namespace

void PanneRows::set_cluster(std::uint32_t from, std::uint64_t* words,
                            std::vector<std::uint32_t>& open) const {
  open.assign(1, from);
  while (!open.empty()) {
    const std::uint32_t v = open.back();
    open.pop_back();
    const Cluster& it = clusters_[v];
    const Cluster& behind = clusters_[std::size_t{v} + 1];
    for (std::uint32_t i = it.runs; i < behind.runs; ++i) set_run(words, runs_[i].first, runs_[i].count);
    for (std::uint32_t i = it.clusters; i < behind.clusters; ++i) open.push_back(inner_[i]);
  }
}

void PanneRows::set_row(std::span<const std::byte> part, std::uint64_t* words,
                        std::vector<std::uint32_t>& open) const {
  std::uint32_t from = 0;
  std::uint64_t objects = 0;
  for_each_step(part, [&](std::uint32_t zeros, std::uint32_t count, bool is_cluster) {
    if (zeros >= columns_ - from) [[unlikely]]
      throw FormatError("a row goes on behind the last column");
    const std::uint32_t first = from + zeros;
    if (!is_cluster) {
      if (count > columns_ - first) [[unlikely]]
        throw FormatError("a row goes on behind the last column");
      set_run(words, first, count);
      from = first + count;
      return;
    }
    const std::uint32_t v = cluster_at(first, count);
    objects += clusters_[v].objects;  // known before any is set: that bounds the work
    if (objects > columns_) [[unlikely]]
      refuse_overlap();
    set_cluster(v, words, open);
    from = clusters_[v].reach;
  });
}

PanneRows::SetBits::SetBits(const PanneRows& rows, std::span<const std::byte> part, Scratch& scratch) {
  auto& [words, open] = scratch;
  const std::size_t need = (std::size_t{rows.columns_} + 63) / 64;
  if (words.size() < need) words.resize(need, 0);
  row_ = std::as_writable_bytes(std::span(words).first(need));
  try {
    rows.set_row(part, words.data(), open);
  } catch (...) {
    clear();
    throw;
  }
}

void PanneRows::SetBits::clear() const {
  std::fill(row_.begin(), row_.end(), std::byte{0});
}

}  // namespace vismat
