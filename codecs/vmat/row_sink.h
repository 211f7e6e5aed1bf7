// Sinks, to which a row's decoder writes: as ids (column numbers), runs or bits. All three take the same calls, so a
// decoder is written once, as a template, and compiled for each.
#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include "matrix/base/byte_reader.h"

namespace vismat {

/// A run of `count` columns from `first` on.
struct Run {
  std::uint32_t first, count;
  bool operator==(const Run&) const = default;
};

/// Memory that a decoder needs besides the row itself. A caller keeps one for each thread, from row to row. Any reader
/// may use any scratch, and replaces what another one left there.
class RowScratch {
 public:
  /// The T that is kept here; made anew if the last one asked for was of another type.
  template <typename T>
  T& as() {
    if (held_ == nullptr || type_ != &type_of<T>) [[unlikely]] {
      held_ = std::make_unique<Held<T>>();
      type_ = &type_of<T>;
    }
    return static_cast<Held<T>&>(*held_).value;
  }

 private:
  struct Any {
    virtual ~Any() = default;
  };
  template <typename T>
  struct Held final : Any {
    T value{};
  };
  template <typename T>
  static inline char type_of = 0;  // its address identifies the type
  std::unique_ptr<Any> held_;
  const void* type_ = nullptr;
};

/// Memory for rows, which a caller keeps from row to row, one for each thread. It grows to the longest row and then
/// stays.
template <typename T>
class RowBuffer : public RowScratch {
 public:
  RowBuffer() = default;
  RowBuffer(RowBuffer&& other) noexcept
      : RowScratch(std::move(other)),
        data_(std::move(other.data_)),
        size_(std::exchange(other.size_, 0)),
        capacity_(std::exchange(other.capacity_, 0)) {}
  RowBuffer& operator=(RowBuffer&& other) noexcept {
    RowScratch::operator=(std::move(other));
    data_ = std::move(other.data_);
    size_ = std::exchange(other.size_, 0);
    capacity_ = std::exchange(other.capacity_, 0);
    return *this;
  }
  std::span<const T> content() const { return {data_.get(), size_}; }

 private:
  friend class IdSink;
  friend class RunSink;
  // Makes room for `count` more behind the `used` ones; new memory is not cleared.
  T* grow(std::size_t used, std::size_t count) {
    const std::size_t capacity = std::max(2 * capacity_, used + count);
    auto data = std::make_unique_for_overwrite<T[]>(capacity);
    std::copy_n(data_.get(), used, data.get());
    data_ = std::move(data);
    capacity_ = capacity;
    return data_.get();
  }
  std::unique_ptr<T[]> data_;
  std::size_t size_ = 0, capacity_ = 0;
};

/// What the three sinks have in common: the place in the row, and the check that nothing lies outside it. Throws
/// FormatError past the last column or past `most` ones in all.
class RowPlace {
 public:
  RowPlace(std::uint32_t columns, std::uint64_t most) : columns_(columns), left_(most) {}
  std::uint32_t columns() const { return columns_; }
  /// The column behind the last one.
  std::uint64_t next() const { return next_; }

 protected:
  // Passes `gap` zeros and `count` ones; returns the column of the first one.
  std::uint32_t pass(std::uint64_t gap, std::uint64_t count) {
    const std::uint64_t first = next_ + gap;
    next_ = first + count;
    if (next_ > columns_ || count > left_) [[unlikely]]
      refuse();
    left_ -= count;
    return static_cast<std::uint32_t>(first);
  }
  // Whether a whole row of ones is not too many.
  bool holds_any() const { return left_ >= columns_; }
  // To column `place`, behind `count` more ones.
  void jump(std::uint64_t count, std::uint64_t place) {
    next_ = place;
    if (count > left_) [[unlikely]]
      refuse();
    left_ -= count;
  }

 private:
  [[noreturn]] void refuse() const {
    throw FormatError(next_ > columns_
                          ? "column " + std::to_string(next_ - 1) + " in a row of " + std::to_string(columns_)
                          : "more ones than the file states");
  }
  std::uint32_t columns_;
  std::uint64_t left_, next_ = 0;
};

/// Each sink has
///   run(gap, count)  appends `gap` zeros behind the last one, then `count` >= 1 ones; both are below 2^33
///   id(column)       appends one more one, behind the last; FormatError unless it ascends
///   runs(next)       run(gap, count) for as long as next(gap, count) sets both and returns true; the fastest way
/// The content of an IdSink or a RunSink is in its buffer after finish().
class IdSink : public RowPlace {
 public:
  IdSink(RowBuffer<std::uint32_t>& buffer, std::uint32_t columns, std::uint64_t most)
      : RowPlace(columns, most),
        buffer_(buffer),
        at_(buffer.data_.get()),
        end_(buffer.data_.get() + buffer.capacity_) {}
  void run(std::uint64_t gap, std::uint64_t count) {
    const std::uint32_t first = pass(gap, count);
    if (static_cast<std::size_t>(end_ - at_) < count + step) [[unlikely]]
      make_room(count + step);
    // Most runs are short: whole steps are written whatever the count, and the surplus is overwritten.
    for (std::size_t i = 0; i < count; i += step) {
      for (std::size_t j = 0; j < step; ++j) at_[i + j] = first + static_cast<std::uint32_t>(i + j);
    }
    at_ += count;
  }
  void id(std::uint32_t column) {
    if (column < next()) throw FormatError("column " + std::to_string(column) + " does not ascend");
    pass(column - next(), 1);
    if (at_ == end_) [[unlikely]]
      make_room(1);
    *at_++ = column;
  }
  // The place is kept in registers. Room for an id of each column is room enough, and it bounds what is counted at the
  // end, so a run is looked at once.
  template <typename Next>
  [[gnu::always_inline]] void runs(const Next& next_run) {
    using Eight [[gnu::vector_size(32)]] = std::uint32_t;
    constexpr std::uint32_t at_once = 32;
    std::uint32_t *at = at_, *end = end_;
    const std::uint64_t columns = this->columns();
    std::uint64_t place = next(), gap = 0, count = 0;
    while (next_run(gap, count)) {
      const std::uint64_t first = place + gap;
      place = first + count;
      if (place > columns || static_cast<std::size_t>(end - at) < count + at_once) [[unlikely]] {
        jump(static_cast<std::uint64_t>(at - at_), first - gap);
        at_ = at;
        run(gap, count);
        at = at_;
        end = end_;
        continue;
      }
      Eight ids = Eight{0, 1, 2, 3, 4, 5, 6, 7} + static_cast<std::uint32_t>(first);
      std::uint32_t* to = at;
      at += count;
      for (;;) {
        for (std::uint32_t j = 0; j < at_once; j += 8) {
          const Eight these = ids + j;
          std::memcpy(to + j, &these, sizeof these);
        }
        to += at_once;
        if (to >= at) break;
        ids += at_once;
      }
    }
    jump(static_cast<std::uint64_t>(at - at_), place);
    at_ = at;
  }
  /// For decoders that write ids themselves: where the row's ids begin, with room for `count` more behind the first
  /// `written`, which stay. Then wrote() says how many there are, and the column behind the last; nothing else may come
  /// before or after it.
  std::uint32_t* room(std::size_t written, std::size_t count) {
    if (static_cast<std::size_t>(end_ - at_) < written + count) [[unlikely]] {
      const std::size_t before = size();
      at_ = buffer_.grow(before + written, count) + before;
      end_ = buffer_.data_.get() + buffer_.capacity_;
    }
    return at_;
  }
  const std::uint32_t* room_end() const { return end_; }
  void wrote(std::size_t count, std::uint64_t place) {
    jump(count, place);
    at_ += count;
  }
  void finish() { buffer_.size_ = size(); }

 private:
  static constexpr std::size_t step = 8;
  std::size_t size() const { return static_cast<std::size_t>(at_ - buffer_.data_.get()); }
  void make_room(std::size_t count) {
    const std::size_t used = size();
    at_ = buffer_.grow(used, count) + used;
    end_ = buffer_.data_.get() + buffer_.capacity_;
  }
  RowBuffer<std::uint32_t>& buffer_;
  std::uint32_t *at_, *end_;
};

/// Collects runs; adjacent runs become one.
class RunSink : public RowPlace {
 public:
  RunSink(RowBuffer<Run>& buffer, std::uint32_t columns, std::uint64_t most)
      : RowPlace(columns, most), buffer_(buffer) {}
  void run(std::uint64_t gap, std::uint64_t count) {
    const std::uint32_t first = pass(gap, count);
    if (gap == 0 && size_ > 0) {
      buffer_.data_[size_ - 1].count += static_cast<std::uint32_t>(count);
      return;
    }
    if (size_ == buffer_.capacity_) [[unlikely]]
      buffer_.grow(size_, 16);
    buffer_.data_[size_++] = {first, static_cast<std::uint32_t>(count)};
  }
  void id(std::uint32_t column) {
    if (column < next()) throw FormatError("column " + std::to_string(column) + " does not ascend");
    run(column - next(), 1);
  }
  template <typename Next>
  void runs(const Next& next_run) {
    for (std::uint64_t gap = 0, count = 0; next_run(gap, count);) run(gap, count);
  }
  void finish() { buffer_.size_ = size_; }

 private:
  RowBuffer<Run>& buffer_;
  std::size_t size_ = 0;
};

/// Sets bit c % 64 of word c / 64. The words must hold all columns, and be zero unless words() is called.
class BitSink : public RowPlace {
 public:
  BitSink(std::span<std::uint64_t> words, std::uint32_t columns, std::uint64_t most)
      : RowPlace(columns, most), words_(words.data()) {}
  void run(std::uint64_t gap, std::uint64_t count) {
    const std::uint32_t first = pass(gap, count), last = static_cast<std::uint32_t>(first + count - 1);
    const std::uint64_t from = ~std::uint64_t{0} << (first % 64), to = ~std::uint64_t{0} >> (63 - last % 64);
    std::uint64_t* word = words_ + first / 64;
    std::uint64_t* const end = words_ + last / 64;
    if (word == end) {
      *word |= from & to;
      return;
    }
    *word++ |= from;
    while (word != end) *word++ = ~std::uint64_t{0};
    *word |= to;
  }
  void id(std::uint32_t column) {
    if (column < next()) throw FormatError("column " + std::to_string(column) + " does not ascend");
    pass(column - next(), 1);
    words_[column / 64] |= std::uint64_t{1} << (column % 64);
  }
  /// For decoders of whole words: write(words) gets all words of the row and writes them, no ones behind the last
  /// column. Nothing may come before or after it.
  template <typename Write>
  void words(const Write& write) {
    const std::span<std::uint64_t> all(words_, (std::size_t{columns()} + 63) / 64);
    write(all);
    if (holds_any()) [[likely]]
      return;
    std::uint64_t ones = 0;
    for (const std::uint64_t word : all) ones += static_cast<std::uint64_t>(std::popcount(word));
    jump(ones, columns());
  }
  template <typename Next>
  void runs(const Next& next_run) {
    for (std::uint64_t gap = 0, count = 0; next_run(gap, count);) run(gap, count);
  }
  void finish() {}

 private:
  std::uint64_t* words_;
};

}  // namespace vismat
