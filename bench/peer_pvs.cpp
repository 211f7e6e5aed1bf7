// Measures our rays against q3map2's portals: what rays from inside a level's clusters reach must lie in the level's own potentially
// visible sets. From each cluster rays run until they meet drawn, opaque geometry; each cluster that they pass on the way
// makes a pair. Pairs outside of the level's table are exceptions, told apart by what the ray passed before:
//   far      farther apart than the level lets anything be seen (its key _farplanedist): the ray is longer
//   walls    solid leaves for more than a millimetre: nothing is drawn there, as on the outer side of a level, so that a ray runs
//            on where no eye gets; these are no fault of either
//   slits    the ray, moved by 0.2 of the level's units in one of eight directions, does not get there or only through
//            solid leaves: openings and corners that the compiler's tolerance closes (it drops portals whose edges are shorter)
//   others   neither: to be explained one by one; --examples prints the first of each level
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bench/verbs.h"
#include "matrix/base/parallel.h"
#include "matrix/base/random.h"
#include "programs/csv.h"
#include "programs/progress.h"
#include "visibility/levels/level_file.h"
#include "visibility/rays/ray_caster.h"

namespace vismat::bench {
namespace {

namespace fs = std::filesystem;

struct PeerPvsOptions {
  std::vector<std::string> wheres;
  std::uint32_t packets = 16;
  std::size_t examples = 0;
  double slit = 0.2;  // the compiler drops portals with shorter edges
  std::uint64_t seed = 1;
  unsigned threads = 0;
  std::filesystem::path csv;
};

constexpr double thin = 1e-3;  // metres of solid that count as none

enum Cause { inside, slits, others, farther, walls, causes };
constexpr const char* names[causes] = {"inside", "slits", "others", "far", "walls"};

struct Ray {
  glm::dvec3 from, to;
};
struct Counts {
  std::string level;
  std::uint64_t clusters = 0, listed = 0, of_cause[causes] = {}, rays = 0;
  std::vector<std::string> examples;
};

// The tree's outer leaves have no end; the level has.
double to_border(const Box& world, const glm::vec3& from, const glm::vec3& direction) {
  double least = INFINITY;
  for (int k = 0; k < 3; ++k) {
    if (direction[k] == 0) continue;
    least =
        std::min(least, (double{(direction[k] > 0 ? world.high : world.low)[k]} - from[k]) / direction[k]);
  }
  return least;
}

// Up to where nothing but thin solid lies in the way.
std::size_t open_stays(const std::vector<Stay>& stays, double length) {
  std::size_t end = 0;
  while (end < stays.size() && (stays[end].cell >= 0 || (stays[end].to - stays[end].from) * length <= thin))
    ++end;
  return end;
}

bool reaches(const LevelPlaces& places, const Ray& ray, std::int32_t from, std::int32_t to) {
  const std::vector<Stay> stays = stays_along(places, ray.from, ray.to);
  const std::size_t end = open_stays(stays, glm::distance(ray.from, ray.to));
  return end > 0 && stays[0].cell == from &&
         std::any_of(stays.begin(), stays.begin() + static_cast<std::ptrdiff_t>(end),
                     [&](const Stay& stay) { return stay.cell == to; });
}

bool moved_rays_reach(const LevelPlaces& places, double slit, const Ray& ray, std::int32_t from,
                      std::int32_t to) {
  const glm::dvec3 along = glm::normalize(ray.to - ray.from);
  const glm::dvec3 side =
      glm::normalize(glm::cross(along, std::abs(along.z) < 0.7 ? glm::dvec3(0, 0, 1) : glm::dvec3(1, 0, 0)));
  const glm::dvec3 up = glm::cross(along, side);
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      const glm::dvec3 move = slit * (double(x) * side + double(y) * up);
      if (!reaches(places, {ray.from + move, ray.to + move}, from, to)) return false;
    }
  }
  return true;
}

std::string text(const glm::dvec3& p) {
  char buffer[80];
  std::snprintf(buffer, sizeof buffer, "(%.4f %.4f %.4f)", p.x, p.y, p.z);
  return buffer;
}

// Which clusters rays from one cluster pass, and why where the level does not list them.
std::map<std::int32_t, std::pair<Cause, Ray>> look_from(const Level& level, const Box& world,
                                                        const RayCaster& caster, double slit,
                                                        std::uint32_t cluster, std::uint32_t packets,
                                                        Random random, std::uint64_t& rays) {
  std::map<std::int32_t, std::pair<Cause, Ray>> seen;
  const auto listed = level.cells.row(cluster);
  const Box& box = level.cell_bounds[cluster];
  const auto own = static_cast<std::int32_t>(cluster);
  std::uint32_t tries = 20 * packets;
  for (std::uint32_t packet = 0; packet < packets && tries > 0;) {
    --tries;
    glm::vec3 from;
    for (int k = 0; k < 3; ++k) from[k] = random.between(box.low[k], box.high[k]);
    if (cell_at(level.places, from) != own) continue;
    ++packet;
    std::array<glm::vec3, RayCaster::width> origins, directions;
    origins.fill(from);
    for (glm::vec3& d : directions) {
      do {
        for (int k = 0; k < 3; ++k) d[k] = random.between(-1, 1);
      } while (glm::dot(d, d) > 1 || glm::dot(d, d) < 0.01f);
      d = glm::normalize(d);
    }
    const auto hits = caster.hits(origins, directions, RayCaster::width, true);
    rays += RayCaster::width;
    for (unsigned i = 0; i < RayCaster::width; ++i) {
      const double length = std::min(double{hits[i].distance}, to_border(world, from, directions[i]));
      const Ray ray{from, glm::dvec3(from) + length * glm::dvec3(directions[i])};
      const std::vector<Stay> stays = stays_along(level.places, ray.from, ray.to);
      const std::size_t open = open_stays(stays, length);
      for (std::size_t s = 0; s < stays.size(); ++s) {
        const std::int32_t other = stays[s].cell;
        if (other < 0 || other == own) continue;
        const auto [known, is_new] = seen.try_emplace(other, inside, ray);
        if (std::binary_search(listed.begin(), listed.end(), static_cast<std::uint32_t>(other))) continue;
        const Cause before = known->second.first;
        if (!is_new && before == others) continue;
        const Ray up_to{ray.from, ray.from + stays[s].to * (ray.to - ray.from)};
        const Cause now = s >= open                                                       ? walls
                          : level.far_plane > 0 && stays[s].to * length > level.far_plane ? farther
                          : moved_rays_reach(level.places, slit, up_to, own, other)       ? others
                                                                                          : slits;
        if (is_new || now < before || now == others) known->second = {now, up_to};
      }
    }
  }
  return seen;
}

Counts compare(const std::string& where, const PeerPvsOptions& options) {
  const Level level = read_level(where);
  Counts counts;
  counts.level = level.name;
  if (level.places.nodes.empty()) throw std::runtime_error(level.name + ": no planes");
  const RayCaster caster(level.face_scene);
  counts.clusters = level.cells.shape().rows;
  counts.listed = level.cells.ones();
  for (std::uint32_t c = 0; c < counts.clusters; ++c) {  // a cluster's own entry is no pair
    const auto row = level.cells.row(c);
    counts.listed -= std::binary_search(row.begin(), row.end(), c);
  }
  Box world = empty_box;
  for (const Box& box : level.cell_bounds) {
    if (box != Box{}) world = box_around(world, box);
  }
  std::vector<std::map<std::int32_t, std::pair<Cause, Ray>>> seen(counts.clusters);
  std::vector<std::uint64_t> rays(counts.clusters);
  parallel_for(counts.clusters, options.threads, [&](std::uint64_t c) {
    const auto cluster = static_cast<std::uint32_t>(c);
    seen[c] = look_from(level, zero_if_empty(world), caster, options.slit * metres_per_level_unit, cluster,
                        options.packets, Random(options.seed, c), rays[c]);
  });
  for (std::uint32_t c = 0; c < counts.clusters; ++c) {
    counts.rays += rays[c];
    for (const auto& [other, found] : seen[c]) {
      ++counts.of_cause[found.first];
      if (found.first != others) continue;
      counts.examples.push_back("  " + std::to_string(c) + " -> " + std::to_string(other) + " by " +
                                text(found.second.from) + " to " + text(found.second.to));
    }
  }
  return counts;
}

// Of levels, .pk3 files and folders of them.
std::vector<std::string> levels_in(const std::vector<std::string>& wheres) {
  std::vector<std::string> levels;
  for (const std::string& where : wheres) {
    std::vector<fs::path> files;
    if (fs::is_directory(where)) {
      for (const auto& entry : fs::recursive_directory_iterator(where)) {
        if (entry.is_regular_file() && !entry.is_symlink() && entry.path().extension() == ".pk3")
          files.push_back(entry.path());
      }
      std::sort(files.begin(), files.end());
    } else if (fs::is_regular_file(where)) {
      files.push_back(where);
    } else {
      levels.push_back(where);
    }
    for (const fs::path& file : files) {
      for (const LevelListing& level : list_levels(file)) levels.push_back(level.where);
    }
  }
  return levels;
}

void run_peer_pvs(const PeerPvsOptions& options) {
  const std::vector<std::string> levels = levels_in(options.wheres);
  std::string csv = "level,clusters,listed,rays,inside,slits,others,far,walls\n";
  write_table(options.csv, csv);
  std::printf("%-48s %8s %9s %9s %9s", "level", "clusters", "listed", "sampled", "inside %");
  for (int cause = slits; cause < causes; ++cause) std::printf(" %7s", names[cause]);
  std::printf("\n");
  const Progress progress = cli::show_progress("levels");
  std::uint64_t unexplained = 0;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    progress(i, levels.size());
    Counts c;
    try {
      c = compare(levels[i], options);
    } catch (const std::exception& error) {
      std::fprintf(stderr, "left out: %s\n", error.what());
      continue;
    }
    const std::uint64_t sampled =
        c.of_cause[inside] + c.of_cause[slits] + c.of_cause[others] + c.of_cause[farther];
    std::printf("%-48s %8ju %9ju %9ju %9.4f", c.level.c_str(), std::uintmax_t{c.clusters},
                std::uintmax_t{c.listed}, std::uintmax_t{sampled},
                100 * static_cast<double>(c.of_cause[inside]) /
                    static_cast<double>(std::max<std::uint64_t>(1, sampled)));
    for (int cause = slits; cause < causes; ++cause) std::printf(" %7ju", std::uintmax_t{c.of_cause[cause]});
    std::printf("\n");
    for (std::size_t k = 0; k < std::min(options.examples, c.examples.size()); ++k)
      std::printf("%s\n", c.examples[k].c_str());
    std::fflush(stdout);
    csv += csv_line(c.level, c.clusters, c.listed, c.rays, c.of_cause[inside], c.of_cause[slits],
                    c.of_cause[others], c.of_cause[farther], c.of_cause[walls]);
    write_table(options.csv, csv);
    unexplained += c.of_cause[others];
  }
  progress(levels.size(), levels.size());
  std::printf("%ju pairs without a known cause\n", std::uintmax_t{unexplained});
}

}  // namespace

void add_peer_pvs(const Verb& verb) {
  const auto o = std::make_shared<PeerPvsOptions>();
  verb.input("LEVEL", o->wheres, "Quake 3 levels, .pk3 files, or folders of them").required();
  verb.option("--packets", o->packets, "Number of viewpoints in each cluster; 16 rays start from each");
  verb.option("--slit", o->slit,
              "How far a ray is moved to find out whether it passed a slit, in the level's units");
  verb.option("--examples", o->examples, "Number of unexplained rays that are printed for each level");
  verb.option("--seed", o->seed, "Seed of the rays");
  verb.threads(o->threads);
  verb.output("--csv", o->csv, Written::text, "File for the table as CSV");
  verb.example("bench peer-pvs cache/levels --csv peer_pvs.csv");
  verb.runs([o] { run_peer_pvs(*o); });
}

}  // namespace vismat::bench
