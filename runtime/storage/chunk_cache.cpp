// ALGORITHM. The cache is a simulation of discrete events: the only event is that a channel has read its run. What is done at a
// time is done in a fixed order: what completes, by the number of the read; then free channels take what is queued. Every chunk
// is in at most one list, so that two links a chunk are enough for all queues, for the order of use and for the runs under way.
// Nothing is allocated while the clock runs but chunks.
//
// A prefetch must not evict what it was itself asked for, so of the chunks in the order of use some are to be skipped. cursor_ is
// behind those that were found to be such; as chunks only join that order at its end, and the wishes only change in
// prefetch(), all before it stay such, and each is looked at once.
//
// With threads, a run is really read while the clock has not yet come to its end, and is waited for there. A thread that cannot
// read a chunk only marks it; the chunk is then read again where it would be read without threads, and fails there.
#include "runtime/storage/chunk_cache.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <utility>

namespace vismat {

ChunkSource source_of(const ChunkStore& store) {
  const ChunkStore* const chunks = &store;
  return {store.count(),
          [chunks](std::uint32_t chunk) {
            const std::uint32_t bytes = chunks->bytes(chunk);
            return ChunkPlace{chunks->offset(chunk), bytes, bytes};
          },
          [chunks](std::uint32_t chunk, std::span<std::byte> memory) { chunks->read(chunk, memory); }};
}

ChunkCache::ChunkCache(std::vector<ChunkSource> sources, const DiskModel& disk, ChunkCacheOptions options)
    : sources_(std::move(sources)),
      disk_(disk, options.seed),
      options_(std::move(options)),
      records_(options_.memory != nullptr ? options_.memory : std::pmr::new_delete_resource()),
      flights_(records_.get_allocator()) {
  if (options_.page_bytes == 0) throw std::invalid_argument("a page has at least one byte");
  if (options_.threads > most_threads)
    throw std::invalid_argument("a cache reads with at most " + std::to_string(most_threads) + " threads");
  first_.reserve(sources_.size() + 1);
  std::uint64_t chunks = 0, largest = 0;
  for (const ChunkSource& source : sources_) {
    first_.push_back(static_cast<std::uint32_t>(chunks));
    chunks += source.count;
    if (chunks >= none) throw std::invalid_argument("a cache holds fewer than 2^32 - 1 chunks");
    for (std::uint32_t i = 0; i < source.count; ++i) largest = std::max(largest, source.place(i).memory);
  }
  first_.push_back(static_cast<std::uint32_t>(chunks));
  const std::uint32_t channels = disk_.channels();
  used_ = sizeof *this + chunks * sizeof(Record) + channels * (sizeof(Flight) + sizeof(Nanoseconds)) +
          sources_.capacity() * sizeof(ChunkSource) + first_.capacity() * sizeof(std::uint32_t) +
          ReadThreads::bytes(most_threads, channels);  // however many there are: no result may depend on it
  if (options_.budget < used_ || options_.budget - used_ < largest) {
    throw std::invalid_argument("a cache of " + std::to_string(options_.budget) +
                                " bytes is too small: its table takes " + std::to_string(used_) +
                                " and the largest chunk " + std::to_string(largest));
  }
  counters_.peak_bytes = used_;
  records_.resize(chunks);
  flights_.resize(channels);
  for (std::size_t s = 0; s < sources_.size(); ++s) {
    List all;
    for (std::uint32_t chunk = first_[s]; chunk < first_[s + 1]; ++chunk) push_back(all, chunk);
    sort_by_disk(all);
  }
  for (std::uint32_t chunk = 0; chunk < count(); ++chunk) {
    Record& record = records_[chunk];
    record.next_on_disk = record.next;
    record.previous = record.next = none;
    if (is_empty(chunk)) record.stage = Stage::ready;
  }
  if (options_.threads > 1) {
    threads_ = std::make_unique<ReadThreads>(options_.threads, channels,
                                             [this](std::uint32_t channel) { read_flight(channel); });
  }
}

ChunkCache::~ChunkCache() {
  stop_ = true;
  threads_.reset();
  for (std::uint32_t chunk = 0; chunk < count(); ++chunk) {
    if (records_[chunk].memory != nullptr) release(records_[chunk].memory, place(chunk).memory);
  }
}

// ---- chunks and lists

std::uint32_t ChunkCache::source_of_chunk(std::uint32_t chunk) const {
  std::uint32_t source = 0;
  while (chunk >= first_[source + 1]) ++source;  // there are a few
  return source;
}

ChunkPlace ChunkCache::place(std::uint32_t chunk) const {
  const std::uint32_t source = source_of_chunk(chunk);
  return sources_[source].place(chunk - first_[source]);
}

void ChunkCache::read(std::uint32_t chunk, std::span<std::byte> memory) const {
  const std::uint32_t source = source_of_chunk(chunk);
  sources_[source].read(chunk - first_[source], memory);
}

bool ChunkCache::is_empty(std::uint32_t chunk) const {
  const ChunkPlace at = place(chunk);
  return at.bytes == 0 && at.memory == 0;
}

ChunkCache::Record& ChunkCache::checked(std::uint32_t chunk) {
  if (chunk >= count()) {
    throw std::logic_error("chunk " + std::to_string(chunk) + " of " + std::to_string(count()) +
                           " does not exist");
  }
  return records_[chunk];
}

void ChunkCache::push_back(List& list, std::uint32_t chunk) {
  Record& record = records_[chunk];
  record.previous = list.tail;
  record.next = none;
  (list.tail == none ? list.head : records_[list.tail].next) = chunk;
  list.tail = chunk;
  ++list.count;
}

void ChunkCache::unlink(List& list, std::uint32_t chunk) {
  Record& record = records_[chunk];
  (record.previous == none ? list.head : records_[record.previous].next) = record.next;
  (record.next == none ? list.tail : records_[record.next].previous) = record.previous;
  record.previous = record.next = none;
  --list.count;
}

bool ChunkCache::before_on_disk(std::uint32_t a, std::uint32_t b) const {
  const std::uint32_t source_a = source_of_chunk(a), source_b = source_of_chunk(b);
  if (source_a != source_b) return source_a < source_b;
  const std::uint64_t offset_a = place(a).offset, offset_b = place(b).offset;
  return offset_a != offset_b ? offset_a < offset_b : a < b;
}

// Merges ever longer sorted lists, as std::list::sort does: it needs no memory.
void ChunkCache::sort_by_disk(List& list) {
  std::array<std::uint32_t, 33> sorted;  // the i-th has 2^i chunks, or none
  sorted.fill(none);
  const auto merge = [this](std::uint32_t a, std::uint32_t b) {
    std::uint32_t head = none;
    std::uint32_t* end = &head;
    while (a != none && b != none) {
      std::uint32_t& least = before_on_disk(b, a) ? b : a;
      *end = least;
      end = &records_[least].next;
      least = *end;
    }
    *end = a != none ? a : b;
    return head;
  };
  for (std::uint32_t chunk = list.head; chunk != none;) {
    std::uint32_t merged = std::exchange(chunk, records_[chunk].next);
    records_[merged].next = none;
    std::size_t i = 0;
    for (; sorted[i] != none; ++i) merged = merge(std::exchange(sorted[i], none), merged);
    sorted[i] = merged;
  }
  std::uint32_t all = none;
  for (const std::uint32_t one : sorted) all = merge(one, all);
  list = {};
  while (all != none) {
    const std::uint32_t next = records_[all].next;
    push_back(list, all);
    all = next;
  }
}

void ChunkCache::tell(ChunkEvent::Kind kind, std::uint32_t chunk, std::uint64_t amount) const {
  if (options_.watch) options_.watch({kind, now_, chunk, amount});
}

// ---- memory

bool ChunkCache::fits(std::uint64_t bytes, bool prefetch) const {
  return used_ - evictable_ + (prefetch ? wished_ : 0) + bytes <= options_.budget;
}

std::byte* ChunkCache::reserve(std::uint64_t bytes, bool prefetch) {
  while (used_ + bytes > options_.budget) {
    if (prefetch) {
      while (records_[cursor_].wish == wish_) cursor_ = records_[cursor_].next;
    }
    evict(prefetch ? cursor_ : unused_.head);
  }
  if (bytes == 0) return nullptr;
  auto* const memory = static_cast<std::byte*>(records_.get_allocator().resource()->allocate(bytes));
  used_ += bytes;
  counters_.peak_bytes = std::max(counters_.peak_bytes, used_);
  return memory;
}

void ChunkCache::release(std::byte* memory, std::uint64_t bytes) {
  if (memory == nullptr) return;
  records_.get_allocator().resource()->deallocate(memory, bytes);
  used_ -= bytes;
}

void ChunkCache::make_evictable(std::uint32_t chunk) {
  if (is_empty(chunk)) return;
  push_back(unused_, chunk);
  if (cursor_ == none) cursor_ = chunk;
  const std::uint64_t bytes = place(chunk).memory;
  evictable_ += bytes;
  if (records_[chunk].wish == wish_) wished_ += bytes;
  retry_ = true;
}

void ChunkCache::make_unevictable(std::uint32_t chunk) {
  if (is_empty(chunk)) return;
  if (cursor_ == chunk) cursor_ = records_[chunk].next;
  unlink(unused_, chunk);
  const std::uint64_t bytes = place(chunk).memory;
  evictable_ -= bytes;
  if (records_[chunk].wish == wish_) wished_ -= bytes;
}

void ChunkCache::evict(std::uint32_t chunk) {
  make_unevictable(chunk);
  Record& record = records_[chunk];
  const std::uint64_t bytes = place(chunk).memory;
  release(std::exchange(record.memory, nullptr), bytes);
  record.stage = Stage::absent;
  record.by_prefetch = false;
  ++counters_.evicted;
  counters_.evicted_bytes += bytes;
  tell(ChunkEvent::Kind::evicted, chunk, bytes);
}

// ---- requests

void ChunkCache::count_as_used(Record& record) {
  if (std::exchange(record.by_prefetch, false)) ++counters_.prefetched_used;
}

void ChunkCache::pin(std::span<const std::uint32_t> ids) {
  for (const std::uint32_t chunk : ids) {
    Record& record = checked(chunk);
    ++counters_.requests;
    const bool newly = record.pins++ == 0;
    switch (record.stage) {
      case Stage::ready:
        ++counters_.hits;
        count_as_used(record);
        if (newly) make_unevictable(chunk);
        break;
      case Stage::reading:
        ++counters_.hits_in_flight;
        count_as_used(record);
        if (newly) ++fetches_;
        break;
      case Stage::prefetch:
        unlink(prefetch_, chunk);
        [[fallthrough]];
      case Stage::absent:
        push_back(fetch_, chunk);
        record.stage = Stage::fetch;
        ++fetches_;
        break;
      case Stage::fetch:
      case Stage::waiting:
      case Stage::failed:
        break;
    }
  }
}

void ChunkCache::unpin(std::span<const std::uint32_t> ids) {
  for (const std::uint32_t chunk : ids) {
    Record& record = checked(chunk);
    if (record.pins == 0) throw std::logic_error("chunk " + std::to_string(chunk) + " is not pinned");
    if (--record.pins > 0) continue;
    switch (record.stage) {
      case Stage::ready:
        make_evictable(chunk);
        break;
      case Stage::reading:
        --fetches_;
        break;
      case Stage::fetch:
        unlink(fetch_, chunk);
        record.stage = Stage::absent;
        --fetches_;
        break;
      case Stage::waiting:
        unlink(waiting_, chunk);
        record.stage = Stage::absent;
        break;
      case Stage::absent:
      case Stage::prefetch:
      case Stage::failed:
        break;
    }
  }
}

void ChunkCache::prefetch(std::span<const std::uint32_t> ids) {
  counters_.prefetch_replaced += prefetch_.count;
  while (prefetch_.head != none) {
    const std::uint32_t chunk = prefetch_.head;
    unlink(prefetch_, chunk);
    records_[chunk].stage = Stage::absent;
  }
  ++wish_;
  wished_ = 0;
  cursor_ = unused_.head;
  for (const std::uint32_t chunk : ids) {
    Record& record = checked(chunk);
    if (std::exchange(record.wish, wish_) == wish_) continue;
    if (record.stage == Stage::absent) {
      push_back(prefetch_, chunk);
      record.stage = Stage::prefetch;
    } else if (record.stage == Stage::ready && record.pins == 0) {
      wished_ += place(chunk).memory;
    }
  }
}

// ---- reads

ChunkCache::Run ChunkCache::run_of(std::uint32_t chunk) const {
  const ChunkPlace at = place(chunk);
  const std::uint64_t last = at.offset + std::max<std::uint64_t>(at.bytes, 1) - 1;
  return {source_of_chunk(chunk), at.offset / options_.page_bytes, last / options_.page_bytes + 1};
}

// Adds a chunk that lies behind the run's begin, if no whole page lies between and the run does not become too long.
bool ChunkCache::extend(Run& run, std::uint32_t chunk) const {
  const Run other = run_of(chunk);
  const std::uint64_t end = std::max(run.end, other.end);
  if (other.source != run.source || other.begin > run.end ||
      end - run.begin > options_.run_bytes / options_.page_bytes)
    return false;
  run.end = end;
  return true;
}

Nanoseconds ChunkCache::begin_on_disk(const Run& run, std::uint32_t chunk) {
  const std::uint64_t pages = run.end - run.begin, bytes = pages * options_.page_bytes;
  ++counters_.reads;
  counters_.pages += pages;
  counters_.bytes_read += bytes;
  tell(ChunkEvent::Kind::read, chunk, pages);
  return disk_.begin(now_, bytes);
}

void ChunkCache::dispatch() {
  while (in_flight_ < flights_.size()) {
    if (std::exchange(retry_, false) && waiting_.count > 0) {
      for (std::uint32_t chunk = waiting_.head; chunk != none; chunk = records_[chunk].next)
        records_[chunk].stage = Stage::fetch;
      fetches_ += waiting_.count;
      (fetch_.head == none ? fetch_.tail : records_[fetch_.head].previous) = waiting_.tail;
      records_[waiting_.tail].next = fetch_.head;
      fetch_.head = waiting_.head;
      fetch_.count += std::exchange(waiting_, {}).count;
    }
    if (fetch_.count > 0) {
      begin_read(fetch_, false);
    } else if (waiting_.count == 0 && prefetch_.count > 0) {
      begin_read(prefetch_, true);
    } else {
      return;
    }
  }
}

// Begins a read, or gives up the queue's first chunk because there is no room for it.
bool ChunkCache::begin_read(List& queue, bool prefetch) {
  const std::uint32_t first = queue.head;
  if (const std::uint64_t bytes = place(first).memory; !fits(bytes, prefetch)) {
    unlink(queue, first);
    if (prefetch) {
      records_[first].stage = Stage::absent;
      ++counters_.prefetch_dropped;
      tell(ChunkEvent::Kind::dropped, first, bytes);
    } else {
      push_back(waiting_, first);
      records_[first].stage = Stage::waiting;
      --fetches_;
    }
    return false;
  }
  const auto channel = static_cast<std::uint32_t>(
      std::ranges::find(flights_, 0u, [](const Flight& flight) { return flight.run.count; }) -
      flights_.begin());
  Flight& flight = flights_[channel];
  flight.number = disk_.reads();
  const Stage stage = records_[first].stage;
  Run run = run_of(first);
  take(queue, first, prefetch, flight);
  for (std::uint32_t chunk = records_[first].next_on_disk; chunk != none;
       chunk = records_[chunk].next_on_disk) {
    if (run_of(chunk).begin > run.end) break;
    if (records_[chunk].stage != stage) continue;
    if (!fits(place(chunk).memory, prefetch) || !extend(run, chunk)) break;
    take(queue, chunk, prefetch, flight);
  }
  flight.completion = begin_on_disk(run, first);
  ++in_flight_;
  if (threads_) threads_->begin(channel);
  return true;
}

void ChunkCache::take(List& queue, std::uint32_t chunk, bool prefetch, Flight& flight) {
  Record& record = records_[chunk];
  const ChunkPlace at = place(chunk);
  record.memory = reserve(at.memory, prefetch);
  unlink(queue, chunk);
  record.stage = Stage::reading;
  record.by_prefetch = prefetch;
  record.unread = false;
  push_back(flight.run, chunk);
  counters_.bytes_wanted += at.bytes;
  if (prefetch) ++counters_.prefetched;
}

// Runs in a thread of threads_. Of the records it touches what nobody else does while they are being read.
void ChunkCache::read_flight(std::uint32_t channel) {
  for (std::uint32_t chunk = flights_[channel].run.head; chunk != none; chunk = records_[chunk].next) {
    if (stop_) return;
    try {
      read(chunk, {records_[chunk].memory, place(chunk).memory});
    } catch (const std::exception&) {
      records_[chunk].unread = true;
    }
  }
}

// The channel whose read completes first; none if all are free.
std::uint32_t ChunkCache::next_channel() const {
  std::uint32_t next = none;
  for (std::uint32_t channel = 0; channel < flights_.size(); ++channel) {
    const Flight& flight = flights_[channel];
    if (flight.run.count == 0) continue;
    if (next == none || std::pair(flight.completion, flight.number) <
                            std::pair(flights_[next].completion, flights_[next].number))
      next = channel;
  }
  return next;
}

void ChunkCache::step() {
  const std::uint32_t channel = next_channel();
  now_ = flights_[channel].completion;
  if (threads_) threads_->finish(channel);
  List run = std::exchange(flights_[channel].run, {});
  --in_flight_;
  while (run.head != none) {
    const std::uint32_t chunk = run.head;
    unlink(run, chunk);
    complete(chunk, threads_ != nullptr && !records_[chunk].unread);
  }
}

void ChunkCache::complete(std::uint32_t chunk, bool read_already) {
  Record& record = records_[chunk];
  const std::uint64_t bytes = place(chunk).memory;
  if (record.pins > 0) --fetches_;
  if (!read_already) {
    try {
      read(chunk, {record.memory, bytes});
    } catch (const std::exception& error) {
      release(std::exchange(record.memory, nullptr), bytes);
      fail(chunk, error.what());
      retry_ = true;
      return;
    }
  }
  record.stage = Stage::ready;
  tell(ChunkEvent::Kind::ready, chunk, bytes);
  if (record.pins == 0) make_evictable(chunk);
}

void ChunkCache::fail(std::uint32_t chunk, std::string_view message) {
  records_[chunk].stage = Stage::failed;
  push_back(failed_, chunk);
  if (messages_kept_ < messages_.size()) {
    auto& kept = messages_[messages_kept_++];
    const std::size_t length = message.copy(kept.data(), kept.size() - 1);
    kept[length] = 0;
  }
  ++counters_.failed;
  tell(ChunkEvent::Kind::failed, chunk, place(chunk).memory);
}

// ---- the clock

void ChunkCache::advance(Nanoseconds time) {
  if (time < now_) throw std::logic_error("the clock cannot go back");
  dispatch();
  while (in_flight_ > 0 && flights_[next_channel()].completion <= time) {
    step();
    dispatch();
  }
  now_ = time;
}

Nanoseconds ChunkCache::wait(const Handle& handle) {
  dispatch();
  while (fetches_ > 0 || (waiting_.count > 0 && in_flight_ > 0)) {
    step();
    dispatch();
  }
  if (waiting_.count > 0) overflow(handle);
  return now_;
}

// The largest chunk that waits gets room besides the ready ones; the constructor saw to it that it has some if these are
// all taken back.
void ChunkCache::make_room_for_overflow() {
  std::uint64_t largest = 0;
  for (std::uint32_t chunk = waiting_.head; chunk != none; chunk = records_[chunk].next)
    largest = std::max(largest, place(chunk).memory);
  for (std::uint32_t chunk = count(); !fits(largest, false);) {
    Record& record = records_[--chunk];
    if (record.stage != Stage::ready || record.pins == 0 || record.memory == nullptr) continue;
    const std::uint64_t bytes = place(chunk).memory;
    release(std::exchange(record.memory, nullptr), bytes);
    record.stage = Stage::waiting;
    push_back(waiting_, chunk);  // it is no larger than the room that it leaves
    ++counters_.evicted;
    counters_.evicted_bytes += bytes;
    tell(ChunkEvent::Kind::evicted, chunk, bytes);
  }
}

void ChunkCache::overflow(const Handle& handle) {
  make_room_for_overflow();
  sort_by_disk(waiting_);
  for (std::uint32_t chunk = waiting_.head; chunk != none;) {
    Run run = run_of(chunk);
    std::uint32_t end = records_[chunk].next;
    while (end != none && extend(run, end)) end = records_[end].next;
    const Nanoseconds begin = now_;
    now_ = begin_on_disk(run, chunk);
    counters_.overflow_time += now_ - begin;
    while (chunk != end) {
      const std::uint32_t next = records_[chunk].next;
      hand_over(chunk, handle);
      chunk = next;
    }
  }
}

void ChunkCache::hand_over(std::uint32_t chunk, const Handle& handle) {
  const ChunkPlace at = place(chunk);
  struct Buffer {
    ChunkCache& cache;
    std::uint64_t bytes;
    std::byte* memory;
    ~Buffer() { cache.release(memory, bytes); }
  } buffer{*this, at.memory, reserve(at.memory, false)};
  ++counters_.overflow_chunks;
  counters_.overflow_bytes += at.bytes;
  counters_.bytes_wanted += at.bytes;
  try {
    read(chunk, {buffer.memory, at.memory});
  } catch (const std::exception& error) {
    unlink(waiting_, chunk);
    fail(chunk, error.what());
    return;
  }
  tell(ChunkEvent::Kind::overflow, chunk, at.memory);
  if (handle) handle(chunk, {buffer.memory, at.memory});
}

// ---- what there is

ChunkCache::State ChunkCache::state(std::uint32_t chunk) const {
  switch (records_[chunk].stage) {
    case Stage::absent:
      return State::absent;
    case Stage::fetch:
    case Stage::waiting:
    case Stage::prefetch:
      return State::queued;
    case Stage::reading:
      return State::reading;
    case Stage::ready:
      return State::ready;
    case Stage::failed:
      break;
  }
  return State::failed;
}

std::span<const std::byte> ChunkCache::data(std::uint32_t chunk) const {
  if (chunk >= count() || records_[chunk].stage != Stage::ready)
    throw std::logic_error("chunk " + std::to_string(chunk) + " is not ready");
  return {records_[chunk].memory, place(chunk).memory};
}

std::vector<ChunkCache::Failure> ChunkCache::failures() const {
  std::vector<Failure> failures;
  for (std::uint32_t chunk = failed_.head; chunk != none; chunk = records_[chunk].next) {
    const std::size_t i = failures.size();
    failures.push_back({chunk, i < messages_kept_ ? messages_[i].data() : std::string()});
  }
  return failures;
}

}  // namespace vismat
