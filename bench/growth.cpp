// Measures how the verbs of vismat grow: processor time and peak memory on matrices and scenes of growing size, each verb
// in a process of its own, reading and writing of its files included.
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "bench/verbs.h"
#include "matrix/base/atomic_file.h"
#include "matrix/files/dataset_file.h"
#include "matrix/generate.h"
#include "programs/csv.h"
#include "programs/measuring.h"
#include "visibility/scene_file.h"

namespace vismat::bench {
namespace {

struct GrowthOptions {
  std::string vismat, folder = "growth";  // no vismat: the one beside bench
  std::filesystem::path csv;
  std::vector<double> scales = {1. / 128, 1. / 64, 1. / 32};
  std::vector<std::uint32_t> bays = {1, 2, 3}, boxes = {8, 16, 32};
  std::vector<std::string> levels, verbs;
};

// A command, {} being the size. Those of a family run in this order, as later ones read what earlier ones wrote.
struct Step {
  const char *name, *command;  // no name: bench does it itself, and it is not measured
};

constexpr std::array of_matrices = {
    Step{"generate", "generate power-plant --scale {} -o plant.bsp.h5"},
    Step{"info", "info plant.bsp.h5"},
    Step{"convert to text", "convert plant.bsp.h5 -o plant.mtx"},
    Step{"convert from text", "convert plant.mtx -o converted.bsp.h5"},
    Step{"merge --lost 0.05", "merge plant.bsp.h5 --lost 0.05 -o merged.bsp.h5"},
    Step{"merge --side objects", "merge plant.bsp.h5 --lost 0.05 --side objects -o objects.bsp.h5"},
    Step{"merge --side both", "merge plant.bsp.h5 --lost 0.05 --side both -o both.bsp.h5"},
    Step{"merge --method seeds", "merge plant.bsp.h5 --lost 0.05 --method seeds -o seeds.bsp.h5"},
    Step{"merge --expand", "merge --expand merged.bsp.h5 -o expanded.bsp.h5"},
    Step{"verify a merge", "verify merged.bsp.h5 plant.bsp.h5"},
    Step{"deltas --neighbours tree", "deltas plant.bsp.h5 --neighbours tree -o deltas.bsp.h5"},
    Step{"deltas --undo", "deltas --undo deltas.bsp.h5 -o undone.bsp.h5"},
    Step{"tree --by sets", "tree plant.bsp.h5 --side rows --by sets -o tree.bsp.h5"},
    Step{"order --columns best", "order plant.bsp.h5 --columns best --bound none -o ordered.bsp.h5"},
    Step{"order --rows best", "order plant.bsp.h5 --rows best --bound none -o rows.bsp.h5"},
    Step{"order --bound quick", "order plant.bsp.h5 --columns random --bound quick -o random.bsp.h5"},
    Step{"encode delimiter", "encode plant.bsp.h5 --codec delimiter -o plant.vmat"},
    Step{"encode rows-fast-ids", "encode plant.bsp.h5 --codec rows-fast-ids -o fast.vmat"},
    Step{"encode rows-quick", "encode plant.bsp.h5 --codec rows-quick -o quick.vmat"},
    Step{"encode rows-small", "encode plant.bsp.h5 --codec rows-small -o small.vmat"},
    Step{"decode delimiter", "decode plant.vmat -o decoded.bsp.h5"},
    Step{"decode rows-quick", "decode quick.vmat -o of_quick.bsp.h5"},
    Step{"decode rows-small", "decode small.vmat -o of_small.bsp.h5"},
    Step{"row delimiter", "row plant.vmat 17"},
    Step{"row rows-small", "row small.vmat 17"},
    Step{"compare 2 codecs", "compare plant.bsp.h5 --codecs delimiter,roaring --seconds 0"},
};

constexpr std::array of_plants = {
    Step{"plant", "plant --size {} -o plant.scene.h5"},
    Step{nullptr, "mesh plant.scene.h5 -o plant.off"},
    Step{"scene", "scene plant.off -o mesh.scene.h5"},
    Step{"info of a scene", "info plant.scene.h5"},
    Step{"cells grid:2", "cells plant.scene.h5 --cells grid:2 -o fine.scene.h5"},
    Step{"see --producer sampled", "see plant.scene.h5 --producer sampled -o sampled.bsp.h5"},
    Step{"see --producer sandwich", "see plant.scene.h5 --producer sandwich -o bounds.bsp.h5"},
    Step{"verify --witness", "verify bounds.bsp.h5 --witness plant.scene.h5"},
    Step{"triangles", "triangles plant.scene.h5 sampled.bsp.h5"},
    Step{"tree --nodes", "tree sampled.bsp.h5 --nodes -o nodes.bsp.h5"},
    Step{"encode over the tree", "encode nodes.bsp.h5 --codec zach3-range -o nodes.vmat"},
    Step{"node", "node nodes.vmat 0"},
    Step{"dense-city", "dense-city --size {} -o dense.scene.h5"},
};

constexpr std::array of_cities = {
    Step{"city", "city --size {} -o city.scene.h5"},
    Step{"see --producer climbing", "see city.scene.h5 --producer climbing -o city.bsp.h5"},
};

constexpr std::array of_levels = {
    Step{"import", "import {} -o level.bsp.h5"},
    Step{"import --matrix faces", "import {} --matrix faces --tree level -o faces.bsp.h5"},
};

struct Cost {
  double processor_seconds = 0, wall_seconds = 0;
  std::uint64_t peak_bytes = 0;
  double others = 0;  // share of the machine's processor time that other programs took meanwhile
};

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

// The processor time of all programs, and that in which none ran, since the machine began [proc(5)].
struct Machine {
  double busy = 0, idle = 0;
};
Machine machine() {
  Machine now;
  std::ifstream file("/proc/stat");
  std::string name;
  file >> name;
  double ticks = 0;
  for (unsigned column = 0; column < 8 && file >> ticks; ++column)
    (column == 3 || column == 4 ? now.idle : now.busy) += ticks / static_cast<double>(::sysconf(_SC_CLK_TCK));
  return now;
}

// Runs vismat in `folder`; what it prints goes to a file there.
Cost run(const std::filesystem::path& program, const std::filesystem::path& folder,
         std::vector<std::string> words) {
  words.insert(words.begin(), program.string());
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  std::fflush(stdout);
  const Machine before = machine();
  const double start = wall_seconds();
  const pid_t child = ::fork();
  if (child == 0) {
    const int printed =
        ::chdir(folder.c_str()) == 0 ? ::open("printed", O_WRONLY | O_CREAT | O_TRUNC, 0600) : -1;
    if (printed >= 0) {
      ::dup2(printed, STDOUT_FILENO);
      ::dup2(printed, STDERR_FILENO);
      ::execv(arguments[0], arguments.data());
    }
    ::_exit(127);
  }
  int status = 0;
  struct rusage used {};
  if (child < 0 || ::wait4(child, &status, 0, &used) != child || !WIFEXITED(status) ||
      WEXITSTATUS(status) != 0)
    throw std::runtime_error("'" + program.string() + " " + words.at(1) + "' failed; " +
                             (folder / "printed").string() + " has what it printed");
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
  };
  Cost cost = {seconds(used.ru_utime) + seconds(used.ru_stime), wall_seconds() - start,
               static_cast<std::uint64_t>(used.ru_maxrss) * 1024};
  const Machine after = machine();
  const double busy = after.busy - before.busy, all = busy + after.idle - before.idle;
  if (all > 0) cost.others = std::clamp((busy - cost.processor_seconds) / all, 0., 1.);
  return cost;
}

// How much a file holds: the ones of a matrix, or the triangles and view cells of a scene. It is read in a process of its
// own, as a child would begin with the peak memory of its parent.
double items_in(const std::filesystem::path& path) {
  return apart<double>([&]() -> std::vector<double> {
           if (path.string().ends_with(".bsp.h5"))
             return {static_cast<double>(read_dataset(path).matrix.ones())};
           const SceneFile file = read_scene(path);
           return {static_cast<double>(file.scene.object_of_triangle.size() + file.cells.count())};
         })
      .at(0);
}

// Writes a scene's triangles as a mesh in the format OFF.
void write_mesh(const std::filesystem::path& from, const std::filesystem::path& to) {
  apart<char>([&]() -> std::vector<char> {
    const Scene scene = read_scene(from).scene;
    std::ostringstream text;
    text.precision(9);
    text << "OFF\n" << scene.vertices.size() << ' ' << scene.indices.size() / 3 << " 0\n";
    for (const auto& v : scene.vertices) text << v.x << ' ' << v.y << ' ' << v.z << '\n';
    for (std::size_t i = 0; i < scene.indices.size(); i += 3)
      text << "3 " << scene.indices[i] << ' ' << scene.indices[i + 1] << ' ' << scene.indices[i + 2] << '\n';
    write_file(to, std::as_bytes(std::span(text.view())));
    return {};
  });
}

class Table {
 public:
  Table() {
    std::printf("%-26s %9s %12s %10s %10s %8s %10s %7s %7s %7s\n", "verb", "size", "items", "cpu s", "wall s",
                "others", "peak MB", "cpu ^", "peak ^", "cpu ^i");
  }
  void add(const std::string& verb, double size, double items, const Cost& cost) {
    std::printf("%-26s %9.0f %12.0f %10.2f %10.2f %6.0f %% %10.0f", verb.c_str(), size, items,
                cost.processor_seconds, cost.wall_seconds, 100 * cost.others,
                static_cast<double>(cost.peak_bytes) / 1e6);
    double of_time = 0, of_peak = 0, by_items = 0;
    if (last_.contains(verb)) {
      const Last& before = last_[verb];
      const auto exponent = [](double now, double then, double larger, double smaller) {
        return std::log(now / then) / std::log(larger / smaller);
      };
      of_time = exponent(cost.processor_seconds, before.cost.processor_seconds, size, before.size);
      of_peak = exponent(static_cast<double>(cost.peak_bytes), static_cast<double>(before.cost.peak_bytes),
                         size, before.size);
      by_items = exponent(cost.processor_seconds, before.cost.processor_seconds, items, before.items);
      std::printf(" %7.2f %7.2f %7.2f", of_time, of_peak, by_items);
    }
    std::printf("\n");
    std::fflush(stdout);
    csv_ += csv_line(verb, size, items, cost.processor_seconds, cost.wall_seconds, cost.others,
                     cost.peak_bytes, of_time, of_peak, by_items);
    last_[verb] = {size, items, cost};
  }
  const std::string& csv() const { return csv_; }

 private:
  struct Last {
    double size, items;
    Cost cost;
  };
  std::map<std::string, Last> last_;
  std::string csv_ =
      "verb,size,items,processor_seconds,wall_seconds,share_of_others,peak_bytes,exponent_of_time,"
      "exponent_of_peak,exponent_of_time_by_items\n";
};

std::filesystem::path vismat_of(const GrowthOptions& options) {
  if (!options.vismat.empty()) return std::filesystem::absolute(options.vismat);
  return std::filesystem::read_symlink("/proc/self/exe").replace_filename("vismat");
}

struct Files {
  std::vector<std::string> read;
  std::string written;  // empty: none
};
Files files_of(const Step& step) {
  Files files;
  const std::vector<std::string> words = words_of(step.command);
  for (std::size_t i = 1; i < words.size(); ++i) {
    if (words[i - 1] == "-o")
      files.written = words[i];
    else
      files.read.push_back(words[i]);  // and words that are no files, which no step writes
  }
  return files;
}

// Which steps are asked for, and which are needed, as a later one that is reads what they write.
struct Choice {
  std::vector<bool> asked, needed;
};
Choice choose(const GrowthOptions& options, std::span<const Step> steps) {
  std::vector<bool> asked(steps.size(), false), needed(steps.size(), false);
  std::vector<std::string> wanted;
  for (std::size_t i = steps.size(); i-- > 0;) {
    const Step& step = steps[i];
    asked[i] = step.name != nullptr &&
               (options.verbs.empty() || std::ranges::any_of(options.verbs, [&](const std::string& verb) {
                  return std::string_view(step.name).starts_with(verb);
                }));
    const Files files = files_of(step);
    needed[i] = asked[i] || std::ranges::find(wanted, files.written) != wanted.end();
    if (needed[i]) wanted.insert(wanted.end(), files.read.begin(), files.read.end());
  }
  return {asked, needed};
}

// `size` is what grows, or 0 for what has none but the items that are made.
void run_steps(const GrowthOptions& options, std::span<const Step> steps, const std::string& word,
               double size, Table& table) {
  const Choice choice = choose(options, steps);
  const std::filesystem::path folder = options.folder;
  std::map<std::string, double> items_of;  // by file; a compressed matrix has those of the matrix
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (!choice.needed[i]) continue;
    const Step& step = steps[i];
    const Files files = files_of(step);
    double items = 0;
    for (const std::string& file : files.read) {
      if (items_of.contains(file)) items = std::max(items, items_of[file]);
    }
    if (step.name == nullptr) {
      write_mesh(folder / files.read.at(0), folder / files.written);
      items_of[files.written] = items;
      continue;
    }
    std::vector<std::string> command = words_of(step.command);
    std::ranges::replace(command, std::string("{}"), word);
    const Cost cost = run(vismat_of(options), folder, command);
    if (files.written.ends_with(".bsp.h5") || files.written.ends_with(".scene.h5"))
      items_of[files.written] = items_in(folder / files.written);
    else if (!files.written.empty())
      items_of[files.written] = items;
    if (!files.written.empty()) items = std::max(items, items_of[files.written]);
    if (choice.asked[i]) table.add(step.name, size > 0 ? size : items, items, cost);
  }
}

void run_growth(const GrowthOptions& options) {
  std::filesystem::create_directories(options.folder);
  Table table;
  for (const double scale : options.scales)
    run_steps(options, of_matrices, csv_values(scale), power_plant_scene(scale).shape.rows, table);
  for (const std::uint32_t bays : options.bays)
    run_steps(options, of_plants, std::to_string(bays), bays, table);
  for (const std::uint32_t boxes : options.boxes)
    run_steps(options, of_cities, std::to_string(boxes), boxes, table);
  for (const std::string& level : options.levels)
    run_steps(options, of_levels, std::filesystem::absolute(level).string(), 0, table);
  write_table(options.csv, table.csv());
}

}  // namespace

void add_growth(const Verb& verb) {
  const auto o = std::make_shared<GrowthOptions>();
  verb.option("--scale", o->scales,
              "Sizes of the matrix that 'vismat generate power-plant' makes, from small to large")
      .between(1e-4, 1.);
  verb.option("--bays", o->bays, "Sizes of the scene that 'vismat plant' makes, from small to large");
  verb.option("--boxes", o->boxes,
              "Sizes of the scene that 'vismat city' makes, powers of two, from small to large");
  verb.option("--level", o->levels,
              "Levels that 'vismat import' reads, from small to large; none by default, as they are not made "
              "here");
  verb.option("--verb", o->verbs, "Only the lines of the table that begin like one of these");
  verb.option("--vismat", o->vismat, "The program (default: the one beside bench)");
  verb.option("--folder", o->folder, "Where the files that the verbs write are kept");
  verb.output("--csv", o->csv, Written::text, "File for the table as CSV");
  verb.note(
      "The size is the matrix's rows, or bays or boxes along a side of the scene. The items are the ones of "
      "the largest matrix that the verb reads or writes, or if it has to do with scenes alone, their "
      "triangles and view cells; a level's size are its items. 'cpu ^' and 'peak ^' are exponents of the "
      "size and 'cpu ^i' those of the items, where 1 is linear, each from one line of a verb to its next. "
      "'others' is the share of the machine's processor time that other programs took meanwhile.");
  verb.example("bench growth --scale 0.0078125 0.015625 0.03125 --csv growth.csv");
  verb.runs([o] { run_growth(*o); });
}

}  // namespace vismat::bench
