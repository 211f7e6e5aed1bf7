// ALGORITHM. Neighbouring view cells see nearly the same, so a row is coded under another one, its reference A, and
// under a second one, B: A's own reference, or any row that was decoded on the way. The run ends of both cut the columns
// into segments. For each, one decision says whether the row is there as A is; what has changed from B to A tells much
// about it. Where it is not, further decisions tell which part is flipped; runs of columns that many rows of the file
// flip are listed once, and named. Decisions have probabilities that depend on their contexts alone and were trained on
// many levels: adaptive ones would have to read other rows first. Rows stand in the order of a tree of references, depth
// first; up to 16 that follow one another share a range coder's stream, so that no row pays for the padding of its own.
// The encoder bounds the modelled time of a row with all that it takes rather than the length of the chain. The first
// rows, up to 255, are decoded when the file is opened: they are the top of the tree, and cost a row that hangs below
// them nothing.
//
// TRIED AND WORSE is in docs/codecs.md, "Rows under similar rows".
#include "codecs/modelled/modelled_rows.h"

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "codecs/modelled/binary_coder.h"
#include "codecs/modelled/row_encoder.h"
#include "codecs/modelled/row_groups.h"
#include "codecs/modelled/row_references.h"
#include "codecs/vmat/part_index.h"
#include "codecs/vmat/parts.h"
#include "codecs/vmat/row_sink.h"
#include "codecs/vmat/row_source.h"

namespace vismat {
namespace {

class Writer {
 public:
  static constexpr bool reads = false;
  explicit Writer(std::vector<std::byte>& out) : coder_(out) {}
  template <typename... Place>
  bool decide(bool bit, Place... places) {
    coder_.put_bit(bit, chance_of_sum[static_cast<std::size_t>(512 + (row_weights[places] + ...))]);
    return bit;
  }
  std::uint32_t even(std::uint32_t count, std::uint32_t value) {
    coder_.put_even(count, value);
    return value;
  }
  void take(std::uint32_t count, std::uint32_t first, std::uint32_t octave) {
    coder_.put_span(count, first, 1u << octave);
  }
  void finish() { coder_.finish(); }

 private:
  BinaryWriter coder_;
};

class Reader {
 public:
  static constexpr bool reads = true;
  Reader() = default;
  explicit Reader(std::span<const std::byte> bytes) : coder_(bytes) {}
  template <typename... Place>
  bool decide(bool, Place... places) {
    return coder_.bit(chance_of_sum[static_cast<std::size_t>(512 + (row_weights[places] + ...))]);
  }
  std::uint32_t even(std::uint32_t count, std::uint32_t) { return coder_.even(count); }
  std::uint32_t aim(std::uint32_t count) { return coder_.aim(count); }
  void take(std::uint32_t, std::uint32_t first, std::uint32_t octave) { coder_.take(first, 1u << octave); }
  void finish() const { coder_.finish(); }

 private:
  BinaryReader coder_;
};

struct DecodedRow {
  Ends ends;
  std::uint32_t above =
      0;  // its reference, by its place among the empty row, the kept ones and those on the stack
};

// Rows' run ends, one behind the other. What it gave stays where it is until it is taken back.
class EndsMemory {
 public:
  struct Mark {
    std::size_t chunk = 0, used = 0;
  };
  Mark mark() const { return {chunk_, used_}; }
  void back_to(Mark mark) { chunk_ = mark.chunk, used_ = mark.used; }

  // A row that is being decoded. One at a time; it is kept from finish() on.
  class Row {
   public:
    explicit Row(EndsMemory& memory) : memory_(memory) { set(0); }
    void room(std::uint32_t count) {
      if (static_cast<std::size_t>(limit_ - next_) < std::size_t{count} + Ends::sentinels) [[unlikely]]
        move_on(count);
    }
    void to(std::uint32_t column, std::uint32_t value) {
      *next_ = column;
      next_ += value != value_;
      value_ = value;
    }
    void copy(std::uint32_t at, std::uint32_t value, std::span<const std::uint32_t> ends) {
      if (!ends.empty() && ends[0] == at) {
        ends = ends.subspan(1);
        value ^= 1;
      }
      to(at, value);
      next_ = std::copy(ends.begin(), ends.end(), next_);
    }
    Ends finish(std::uint32_t columns) {
      const auto count = static_cast<std::uint32_t>(next_ - begin_);
      std::fill_n(next_, Ends::sentinels, columns);
      memory_.used_ += count + Ends::sentinels;
      return {begin_, count};
    }

   private:
    void set(std::size_t count) {
      if (memory_.chunks_.empty()) return;
      Chunk& chunk = memory_.chunks_[memory_.chunk_];
      begin_ = chunk.data.get() + memory_.used_;
      next_ = begin_ + count;
      limit_ = chunk.data.get() + chunk.size;
    }
    // Goes on in a chunk with room, and takes along what there is of the row.
    void move_on(std::size_t count) {
      const auto size = static_cast<std::size_t>(next_ - begin_);
      const std::uint32_t* const begun = begin_;
      memory_.add_chunk(2 * (size + count) + Ends::sentinels);
      set(size);
      std::copy_n(begun, size, begin_);
    }
    EndsMemory& memory_;
    std::uint32_t *begin_ = nullptr, *next_ = nullptr, *limit_ = nullptr;
    std::uint32_t value_ = 0;
  };

 private:
  struct Chunk {
    std::unique_ptr<std::uint32_t[]> data;
    std::size_t size;
  };
  void add_chunk(std::size_t need) {
    std::size_t next = chunks_.empty() ? 0 : chunk_ + 1;
    while (next < chunks_.size() && chunks_[next].size < need) ++next;
    if (next == chunks_.size()) {
      const std::size_t size = std::max(need, chunks_.empty() ? std::size_t{4096} : 2 * chunks_.back().size);
      chunks_.push_back({std::make_unique_for_overwrite<std::uint32_t[]>(size), size});
    }
    chunk_ = next;
    used_ = 0;
  }
  std::vector<Chunk> chunks_;
  std::size_t chunk_ = 0, used_ = 0;
};

// The parts on the way to the row that was read last, each as far as it was decoded. The next row often takes the same.
struct RowStack {
  struct Frame {
    std::uint32_t group = 0, done = 0;  // rows decoded
    Reader reader;
    std::size_t rows = 0;   // its place among the decoded rows
    std::uint32_t way = 0;  // rows on the way to its first one
    EndsMemory::Mark mark = {};
  };
  std::uint64_t owner = 0;
  std::vector<Frame> frames;
  std::vector<std::uint32_t> wanted;
  std::vector<DecodedRow> rows;
  EndsMemory memory;
};

std::uint64_t new_owner() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

class ModelledRows final : public RowSource {
 public:
  ModelledRows(Parts parts, Shape shape) : parts_(std::move(parts)), shape_(shape), owner_(new_owner()) {
    parts_.expect_no_sections();
    if (shape.rows > ModelledRowFormat::free_rows + 2048 * parts_.payload_bytes())
      throw FormatError(std::to_string(shape.rows) + " rows in " + std::to_string(parts_.payload_bytes()) +
                        " bytes");
    ByteReader in(parts_.model(), "model");
    const std::uint64_t kept = in.varint();
    if (kept > std::min(shape.rows, ModelledRowFormat::most_kept))
      in.fail(std::to_string(kept) + " kept rows of " + std::to_string(shape.rows));
    kept_count_ = static_cast<std::uint32_t>(kept);
    Reader reader(in.bytes(in.left()));
    runs_ = code_common_runs(reader, shape.columns, {});
    names_second_ = reader.decide(false, second_named);
    GroupCode code(shape.rows, kept_count_);
    for (std::uint64_t g = 0; g < parts_.count(); ++g) {
      if (code.left() == 0) throw FormatError("more parts than rows");
      groups_.push_back(code.code(reader, groups_, {}));
    }
    if (code.left() != 0) throw FormatError(std::to_string(code.left()) + " rows that are in no part");
    {
      EndsMemory::Row empty(kept_memory_);
      empty.room(0);
      kept_.push_back({empty.finish(shape.columns), 0});
    }
    for (std::uint32_t r = 0; r < kept_count_; ++r) {
      const std::uint32_t a = r + 1 - code_number(reader, NumberKind::distance, r + 1, 1);
      const auto find = [&](std::uint32_t second) {
        return kept_[second == 0 ? kept_[a].above : second - 1].ends;
      };
      kept_.push_back({get_row(reader, kept_[a].ends, Stands::kept, r, 0, find, kept_memory_), a});
    }
    reader.finish();
  }
  void read(std::uint32_t row, RowScratch& scratch, IdSink& sink) const override { give(row, scratch, sink); }
  void read(std::uint32_t row, RowScratch& scratch, RunSink& sink) const override {
    give(row, scratch, sink);
  }
  void read(std::uint32_t row, RowScratch& scratch, BitSink& sink) const override {
    give(row, scratch, sink);
  }
  Cost cost(std::uint32_t row) const override {
    Cost cost;
    if (row < kept_count_) return cost;
    for (std::uint32_t group = group_of(row);
         group != Group::none && cost.parts < ModelledRowFormat::longest_chain;
         group = groups_[group].above) {
      cost.bytes += parts_.part_bytes(group);
      ++cost.parts;
    }
    return cost;
  }

 private:
  // find(x) gives the second reference that code_second() calls x, of `kept` kept rows and `way` on the way.
  template <typename Find>
  Ends get_row(Reader& reader, Ends a, Stands stands, std::uint32_t kept, std::uint32_t way, const Find& find,
               EndsMemory& memory) const {
    EndsMemory::Row row(memory);
    Reader here = reader;  // in registers
    if (here.decide(false, raw_row)) {
      code_raw(here, shape_.columns, {}, row);
    } else {
      const std::uint32_t second =
          names_second_ ? code_second(here, second_context(stands, a.count), kept, way, 0) : 0;
      code_row(here, a, find(second), runs_, second != 0, shape_.columns, {}, 0, row);
    }
    reader = here;
    row.room(0);
    return row.finish(shape_.columns);
  }
  // The last group that begins at or before a row that is not kept.
  std::uint32_t group_of(std::uint32_t row) const {
    return static_cast<std::uint32_t>(std::ranges::upper_bound(groups_, row, {}, &Group::first) -
                                      groups_.begin()) -
           1;
  }
  const DecodedRow& at(const RowStack& stack, std::uint32_t place) const {
    return place <= kept_count_ ? kept_[place] : stack.rows[place - kept_count_ - 1];
  }
  // What code_second() calls x for the next row of the last frame.
  Ends second_of(const RowStack& stack, const DecodedRow& a, std::uint32_t way, std::uint32_t value) const {
    if (value == 0) return at(stack, a.above).ends;
    if (value > way) return kept_[value - way - 1].ends;
    if (value <= stack.frames.back().done) return stack.rows[stack.rows.size() - value].ends;
    value -= stack.frames.back().done;
    for (std::size_t frame = stack.frames.size() - 1;; --frame) {
      const RowStack::Frame& above = stack.frames[frame - 1];
      const std::uint32_t rows = stack.frames[frame].way - above.way;
      if (value <= rows) return stack.rows[above.rows + rows - value].ends;
      value -= rows;
    }
  }
  static void drop_frames(RowStack& stack, std::size_t count) {
    if (count == stack.frames.size()) return;
    stack.rows.resize(stack.frames[count].rows);
    stack.memory.back_to(stack.frames[count].mark);
    stack.frames.resize(count);
  }
  // Decodes the last frame up to the row.
  void decode_to(RowStack& stack, std::uint32_t row) const try {
    RowStack::Frame& frame = stack.frames.back();
    const Group& group = groups_[frame.group];
    // Places of rows: numbers of rows less these.
    const std::uint32_t inside = group.first - static_cast<std::uint32_t>(frame.rows) - kept_count_;
    std::uint32_t outside = group.outside;
    if (group.above != Group::none)
      outside -= groups_[group.above].first -
                 static_cast<std::uint32_t>(stack.frames[stack.frames.size() - 2].rows) - kept_count_;
    while (group.first + frame.done <= row) {
      std::uint32_t a = outside;
      if (frame.done > 0) {
        const std::uint32_t number = code_reference(frame.reader, group, kept_count_, frame.done, 0);
        a = number == group.outside ? outside : number <= kept_count_ ? number : number - inside;
      }
      const DecodedRow& row_a = at(stack, a);
      const std::uint32_t way = std::min(frame.way + frame.done, ModelledRowFormat::longest_way);
      const auto find = [&](std::uint32_t second) { return second_of(stack, row_a, way, second); };
      stack.rows.push_back(
          {get_row(frame.reader, row_a.ends, stands_at(frame.done), kept_count_, way, find, stack.memory),
           a});
      if (++frame.done == group.size) frame.reader.finish();
    }
  } catch (const FormatError&) {
    drop_frames(stack, 0);  // the last one is in no state to go on
    throw;
  }
  Ends find(std::uint32_t row, RowStack& stack) const {
    if (stack.owner != owner_) {
      drop_frames(stack, 0);
      stack.owner = owner_;
    }
    const std::uint32_t own = group_of(row);
    const auto frame_of = [&](std::uint32_t group) {
      return std::ranges::find(stack.frames, group, &RowStack::Frame::group);
    };
    // The parts that the row takes and that are not on the stack, its own first.
    stack.wanted.clear();
    std::size_t under = 0;     // frames that stay
    std::uint32_t last = row;  // to be decoded in the last of these
    for (std::uint32_t group = own; group != Group::none; group = groups_[group].above) {
      if (const auto found = frame_of(group); found != stack.frames.end()) {
        under = static_cast<std::size_t>(found - stack.frames.begin()) + 1;
        if (last < groups_[group].first + found->done) last = Group::none;
        break;
      }
      if (stack.wanted.size() == ModelledRowFormat::longest_chain)
        throw FormatError("a row that takes too many others");
      stack.wanted.push_back(group);
      last = groups_[group].outside - 1;
    }
    if (!stack.wanted.empty() || last != Group::none) drop_frames(stack, under);
    if (under > 0 && last != Group::none) decode_to(stack, last);
    if (stack.frames.size() + stack.wanted.size() > ModelledRowFormat::longest_chain)
      throw FormatError("a row that takes too many others");
    while (!stack.wanted.empty()) {
      const std::uint32_t group = stack.wanted.back();
      stack.wanted.pop_back();
      const std::uint32_t way = stack.frames.empty() ? 0
                                                     : stack.frames.back().way + groups_[group].outside -
                                                           groups_[stack.frames.back().group].first;
      stack.frames.push_back(
          {group, 0, Reader(parts_.part(group)), stack.rows.size(), way, stack.memory.mark()});
      decode_to(stack, stack.wanted.empty() ? row : groups_[stack.wanted.back()].outside - 1);
    }
    return stack.rows[frame_of(own)->rows + (row - groups_[own].first)].ends;
  }
  template <typename Sink>
  void give(std::uint32_t row, RowScratch& scratch, Sink& sink) const {
    const Ends ends = row < kept_count_ ? kept_[row + 1].ends : find(row, scratch.as<RowStack>());
    std::uint32_t behind = 0;
    for (std::uint32_t i = 0; i < ends.count; i += 2) {  // the row's end is a sentinel
      sink.run(ends.at[i] - behind, ends.at[i + 1] - ends.at[i]);
      behind = ends.at[i + 1];
    }
  }

  Parts parts_;
  Shape shape_;
  std::uint64_t owner_;
  std::uint32_t kept_count_ = 0;
  CommonRuns runs_;
  bool names_second_ = false;
  std::vector<Group> groups_;
  std::vector<DecodedRow> kept_;  // the empty row, then the kept ones
  EndsMemory kept_memory_;
};

std::unique_ptr<const RowSource> open_modelled(Parts parts, Shape shape, const Side&) {
  return std::make_unique<ModelledRows>(std::move(parts), shape);
}

VisibilityMatrix decode_modelled(const Parts& parts, Shape shape, const Side&, std::uint64_t most) {
  return read_all_rows(ModelledRows(parts, shape), parts, shape, most);
}

template <const RowLimits& limits>
Codec modelled(std::string_view name, std::string_view contents) {
  Codec codec{.name = name, .contents = contents};
  codec.needs = {.column_order = true, .distinct = true};
  codec.encode = [](const VisibilityMatrix& matrix, const Side&, const EncodeOptions& options) {
    return encode_modelled_rows(matrix, limits, options);
  };
  codec.slow_encode = codec.orders_rows = true;
  codec.decode = decode_modelled;
  codec.open = open_modelled;
  return codec;
}

}  // namespace

Encoded encode_modelled_rows(const VisibilityMatrix& matrix, const RowLimits& limits,
                             const EncodeOptions& options) {
  const RowEncoder encoder(matrix, limits, options);
  Encoded out;
  put_varint(out.payload, encoder.kept());
  const auto put = [&](const auto& code) {
    Writer writer(out.payload);
    code(writer);
    writer.finish();
  };
  put([&](Writer& writer) { encoder.code_model(writer); });
  std::vector<std::uint64_t> starts;
  for (const Group& group : encoder.groups()) {
    starts.push_back(out.payload.size());
    put([&](Writer& writer) { encoder.code_group(writer, group); });
  }
  out.index = part_index_bytes(starts, out.payload.size());
  if (options.rows_may_move) out.row_order = Permutation::from_old_of_new(encoder.order());
  return out;
}

std::vector<Codec> modelled_codecs() {
  return {
      modelled<small_limits>("rows-small", "rows under similar rows, trained probabilities; smallest"),
      modelled<quick_limits>("rows-quick", "the same, fewer rows for each row"),
  };
}

}  // namespace vismat
