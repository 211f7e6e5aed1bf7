// The systems with visibility, vLOD and lists of whole cells: what is visible from the viewer's cell, at its levels of detail.
//
// ALGORITHM [Chhugani et al. 2005, section 7]. Crossing a boundary asks for its list, waits, applies it, pins the geometry that
// appears and lets go of what vanishes. The lists of a boundary are one chunk, as a viewer always needs both. Several cells in
// one frame are crossed one after another, along the segment that the viewer moved. Where cells do not follow one another so, as
// in a teleport, the cell's row is loaded whole, or the shortest chain of boundaries is walked if that reads less. After each
// change of cell, and as lists arrive, prefetches are asked for anew: lists of the boundaries around, and what they let appear.
#include <algorithm>
#include <cstring>
#include <functional>
#include <glm/geometric.hpp>
#include <iterator>
#include <limits>
#include <optional>
#include <queue>
#include <utility>

#include "runtime/camera/cell_finder.h"
#include "runtime/walks/systems.h"

namespace vismat {
namespace {

using Ids = std::vector<std::uint32_t>;

class CellSets : public WalkSystem {
 public:
  CellSets(const BakedScene& scene, ChunkCache& cache, const WalkOptions& options, bool differences)
      : scene_(scene),
        chunks_{scene},
        cache_(cache),
        pins_(chunks_, cache),
        finder_(scene.file().cells),
        prices_(options.prices),
        depth_(options.prefetch_depth),
        differences_(differences) {}

  void make(Frame& frame) override {
    if (frame.cell == FrameRecord::no_cell) {
      draw_without_cell(frame);
    } else {
      needed_.clear();
      if (frame.cell != cell_) go(frame);
      pin_set();
      frame.wait();
      if (depth_ > 0 && cell_ != none) prefetch();
    }
    last_ = frame.pose.position;
    if (cell_ == none && frame.cell != FrameRecord::no_cell) return;  // its row is late or damaged
    frame.versions.assign(geometry_.begin(), geometry_.end());
  }

  std::vector<std::uint32_t> reference(std::uint32_t cell) const override {
    if (cell != FrameRecord::no_cell) return scene_.versions_from(cell);
    std::vector<std::uint32_t> versions(scene_.object_bounds().size());
    for (std::uint32_t object = 0; object < versions.size(); ++object) {
      versions[object] = scene_.first_version(object);
    }
    return versions;
  }

  std::uint32_t triangles(const Frame& frame, std::size_t i) const override {
    return facing_.empty() ? scene_.versions()[frame.versions[i]].triangles : facing_[i];
  }

 private:
  static constexpr std::uint32_t none = 0xffffffff;

  /// In no cell: all in the frustum, in full detail.
  void draw_without_cell(Frame& frame) {
    leave();
    geometry_.clear();
    for (std::uint32_t object = 0; object < scene_.object_bounds().size(); ++object) {
      const std::uint32_t version = scene_.first_version(object);
      if (scene_.versions()[version].triangles > 0 && frame.frustum.meets(scene_.object_bounds()[object])) {
        geometry_.push_back(version);
      }
    }
    pin_set();
    frame.wait();
  }

  void leave() {
    cell_ = none;
    needed_.clear();
    visible_.clear();
    geometry_.clear();
    facing_.clear();
  }

  /// Pins the list or row that is needed, and the geometry of the cell.
  void pin_set() {
    pinned_.assign(needed_.begin(), needed_.end());
    for (const std::uint32_t version : geometry_) pinned_.push_back(chunks_.geometry(version));
    pins_.become(pinned_);
  }

  /// What the chunk holds, once it is there; nothing if it is late or damaged.
  std::optional<std::span<const std::uint32_t>> ids_of(std::uint32_t chunk, Frame& frame) {
    needed_.assign(1, chunk);
    pin_set();
    frame.wait();
    if (cache_.state(chunk) == ChunkCache::State::ready) {
      needed_.clear();
      const auto bytes = cache_.data(chunk);
      return std::span(reinterpret_cast<const std::uint32_t*>(bytes.data()), bytes.size() / 4);
    }
    if (const auto held = frame.overflow.find(chunk); held != frame.overflow.end()) {
      needed_.clear();
      return std::span<const std::uint32_t>(held->second);
    }
    if (is_damaged(chunk)) ++frame.record.failed;
    return {};
  }
  bool is_ready(std::uint32_t chunk) const { return cache_.state(chunk) == ChunkCache::State::ready; }
  bool is_damaged(std::uint32_t chunk) const { return cache_.state(chunk) == ChunkCache::State::failed; }

  void pay(Frame& frame, std::size_t lists, std::size_t ids) const {
    frame.record.decoding += static_cast<Nanoseconds>(static_cast<double>(lists) * prices_.list_ns +
                                                      static_cast<double>(ids) * prices_.id_ns);
  }

  /// To frame.cell, or as far towards it as the lists that are there lead.
  void go(Frame& frame) {
    if (cell_ == none || !differences_) {
      jump(frame);
      return;
    }
    std::optional<Ids> way = way_along(last_, frame.pose.position, cell_, frame.cell, 0);
    if (!way) {
      way = shortest_chain(cell_, frame.cell);
      if (!way) {
        jump(frame);
        return;
      }
    }
    for (const std::uint32_t to : *way) {
      if (!cross_to(to, frame)) break;
      ++frame.record.crossed;
    }
    set_geometry(frame);
    if (cell_ != frame.cell && is_damaged(needed_[0])) jump(frame);  // which reads no list
  }

  bool cross_to(std::uint32_t to, Frame& frame) {
    const std::optional<Crossing> crossing = scene_.map().crossing(cell_, to);
    const std::uint32_t boundary = crossing->boundary;
    const auto ids = ids_of(chunks_.lists(boundary), frame);
    if (!ids) return false;
    const std::size_t first = scene_.columns_of_list(2 * boundary);
    const auto there = ids->first(first), back = ids->subspan(first);
    next_.resize(visible_.size() + ids->size());
    next_.resize(cross(visible_, crossing->back ? back : there, crossing->back ? there : back, next_));
    visible_.swap(next_);
    pay(frame, 2, ids->size());
    cell_ = to;
    return true;
  }

  void jump(Frame& frame) {
    frame.record.jumped = true;
    const auto ids = ids_of(chunks_.row(frame.cell), frame);
    if (!ids) {
      if (is_damaged(needed_[0])) leave();
      return;
    }
    visible_.assign(ids->begin(), ids->end());
    pay(frame, 1, visible_.size());
    cell_ = frame.cell;
    set_geometry(frame);
  }

  /// The versions that are the visible columns of cell_, and their triangles that face it.
  void set_geometry(Frame& frame) {
    std::vector<std::uint32_t> counts(visible_.size());
    bool counted = true;
    try {
      counts = scene_.facing(cell_);
    } catch (const FormatError& error) {  // only the numbers of triangles depend on them
      frame.faults.push_back("frame " + std::to_string(frame.record.frame) +
                             ": back faces are counted as drawn: " + error.what());
      counted = false;
    }
    of_version_.clear();
    for (std::size_t i = 0; i < visible_.size(); ++i) {
      of_version_.emplace_back(scene_.version_of_column(visible_[i]), counts[i]);
    }
    std::sort(of_version_.begin(), of_version_.end());
    geometry_.clear();
    facing_.clear();
    for (const auto& [version, count] : of_version_) {
      geometry_.push_back(version);
      if (counted) facing_.push_back(count);
    }
  }

  /// The cells after `from` on the segment, each a neighbour of the one before; nothing if they do not follow one another.
  std::optional<Ids> way_along(const glm::dvec3& a, const glm::dvec3& b, std::uint32_t from, std::uint32_t to,
                               unsigned halvings) const {
    if (from == to) return Ids{};
    if (scene_.map().crossing(from, to)) return Ids{to};
    if (halvings == 24) return {};
    const glm::dvec3 middle = (a + b) * 0.5;
    const std::uint32_t between = finder_.find(middle, from);
    if (between == CellFinder::none) return {};
    auto first = way_along(a, middle, from, between, halvings + 1);
    if (!first) return {};
    const auto second = way_along(middle, b, between, to, halvings + 1);
    if (!second) return {};
    first->insert(first->end(), second->begin(), second->end());
    return first;
  }

  std::uint64_t bytes_of_lists(std::uint32_t boundary) const {
    return scene_.lists().cost(scene_.row_of_list(2 * boundary)).bytes +
           scene_.lists().cost(scene_.row_of_list(2 * boundary + 1)).bytes;
  }

  /// The cells after `from` on the chain of boundaries to `to` that reads the fewest bytes, if these are fewer than those of its row.
  std::optional<Ids> shortest_chain(std::uint32_t from, std::uint32_t to) const {
    const std::uint64_t most = scene_.rows().cost(scene_.row_of_cell(to)).bytes;
    struct Reached {
      std::uint64_t bytes = std::numeric_limits<std::uint64_t>::max();
      std::uint32_t before = none;
    };
    std::vector<Reached> reached(scene_.cell_bounds().size());
    using Item = std::pair<std::uint64_t, std::uint32_t>;
    std::priority_queue<Item, std::vector<Item>, std::greater<>> open;
    reached[from].bytes = 0;
    open.emplace(0, from);
    while (!open.empty()) {
      const auto [bytes, cell] = open.top();
      open.pop();
      if (bytes >= most) return {};
      if (cell == to) break;
      if (bytes > reached[cell].bytes) continue;
      for (const std::uint32_t next : scene_.map().neighbours(cell)) {
        if (next == Boundary::outside) continue;
        const std::uint64_t sum = bytes + bytes_of_lists(scene_.map().crossing(cell, next)->boundary);
        if (sum >= reached[next].bytes) continue;
        reached[next] = {sum, cell};
        open.emplace(sum, next);
      }
    }
    if (reached[to].before == none) return {};
    Ids way;
    for (std::uint32_t cell = to; cell != from; cell = reached[cell].before) way.push_back(cell);
    std::reverse(way.begin(), way.end());
    return way;
  }

  /// Asks for lists (or rows) of the cells up to depth_ boundaries away, and for the geometry that those which are there name.
  void prefetch() {
    if (cell_ != around_) find_around();
    const auto arrived = static_cast<std::size_t>(std::count_if(
        lists_around_.begin(), lists_around_.end(), [&](std::uint32_t chunk) { return is_ready(chunk); }));
    if (asked_for_ == cell_ && arrived == arrived_) return;
    asked_for_ = cell_;
    arrived_ = arrived;
    wanted_.assign(lists_around_.begin(), lists_around_.end());
    Ids versions;
    for (const std::uint32_t chunk : lists_around_) {
      if (!is_ready(chunk)) continue;
      const auto bytes = cache_.data(chunk);
      for (std::size_t at = 0; at < bytes.size(); at += 4) {
        std::uint32_t column;
        std::memcpy(&column, bytes.data() + at, 4);
        versions.push_back(scene_.version_of_column(column));
      }
    }
    std::sort(versions.begin(), versions.end());
    versions.erase(std::unique(versions.begin(), versions.end()), versions.end());
    // What vanishes on the way there is visible from here, and so is pinned.
    for (const std::uint32_t version : versions) {
      if (!std::binary_search(geometry_.begin(), geometry_.end(), version)) {
        wanted_.push_back(chunks_.geometry(version));
      }
    }
    chunks_.sort_for_disk(wanted_);
    cache_.prefetch(wanted_);
  }

  void find_around() {
    around_ = cell_;
    lists_around_.clear();
    Ids level = {cell_}, seen = {cell_};
    for (std::uint32_t step = 0; step < depth_; ++step) {
      Ids next;
      for (const std::uint32_t cell : level) {
        for (const std::uint32_t neighbour : scene_.map().neighbours(cell)) {
          if (neighbour == Boundary::outside) continue;
          if (differences_) {
            lists_around_.push_back(chunks_.lists(scene_.map().crossing(cell, neighbour)->boundary));
          }
          if (std::find(seen.begin(), seen.end(), neighbour) != seen.end()) continue;
          seen.push_back(neighbour);
          next.push_back(neighbour);
          if (!differences_) lists_around_.push_back(chunks_.row(neighbour));
        }
      }
      level.swap(next);
    }
    std::sort(lists_around_.begin(), lists_around_.end());
    lists_around_.erase(std::unique(lists_around_.begin(), lists_around_.end()), lists_around_.end());
  }

  const BakedScene& scene_;
  WalkChunks chunks_;
  ChunkCache& cache_;
  Pins pins_;
  CellFinder finder_;
  WalkPrices prices_;
  std::uint32_t depth_;
  bool differences_;

  std::uint32_t cell_ = none;  // whose set is known
  glm::dvec3 last_{};          // where the viewer was in the last frame
  Ids visible_, next_;         // columns, ascending
  Ids geometry_, facing_;      // their versions, ascending, and their triangles that face the cell
  std::vector<std::pair<std::uint32_t, std::uint32_t>> of_version_;
  Ids needed_;  // a list or row that the viewer waits for
  Ids pinned_, wanted_, lists_around_;
  std::uint32_t around_ = none, asked_for_ = none;
  std::size_t arrived_ = 0;
};

}  // namespace

std::unique_ptr<WalkSystem> make_cell_lists(const BakedScene& scene, ChunkCache& cache,
                                            const WalkOptions& options) {
  return std::make_unique<CellSets>(scene, cache, options, false);
}
std::unique_ptr<WalkSystem> make_vlod(const BakedScene& scene, ChunkCache& cache,
                                      const WalkOptions& options) {
  return std::make_unique<CellSets>(scene, cache, options, true);
}

}  // namespace vismat
