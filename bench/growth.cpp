// Measures how the verbs of vismat grow: processor time and peak memory on matrices and scenes of plants of growing
// size, each verb in a process of its own, reading and writing of its files included.
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "bench/verbs.h"
#include "matrix/generate.h"
#include "programs/csv.h"
#include "programs/measuring.h"

namespace vismat::bench {
namespace {

struct GrowthOptions {
  std::string vismat, folder = "growth";  // no vismat: the one beside bench
  std::filesystem::path csv;
  std::vector<double> scales = {1. / 128, 1. / 64, 1. / 32};
  std::vector<std::uint32_t> bays = {1, 2, 3};
  std::vector<std::string> verbs;
};

// A command, {} being the size. Those of a family run in this order, as later ones read what earlier ones wrote.
struct Step {
  const char *name, *command;
  const char* read_by = nullptr;  // how the names of the steps begin that read what it writes; "": of all
};

constexpr std::array of_matrices = {
    Step{"generate", "generate power-plant --scale {} -o plant.bsp.h5", ""},
    Step{"info", "info plant.bsp.h5"},
    Step{"convert", "convert plant.bsp.h5 -o plant.mtx"},
    Step{"merge --lost 0.05", "merge plant.bsp.h5 --lost 0.05 -o merged.bsp.h5", "verify"},
    Step{"verify", "verify merged.bsp.h5 plant.bsp.h5"},
    Step{"deltas --neighbours tree", "deltas plant.bsp.h5 --neighbours tree -o deltas.bsp.h5"},
    Step{"tree --by sets", "tree plant.bsp.h5 --side rows --by sets -o tree.bsp.h5"},
    Step{"order --columns best", "order plant.bsp.h5 --columns best --bound none -o ordered.bsp.h5"},
    Step{"encode", "encode plant.bsp.h5 --codec delimiter -o plant.vmat", ""},
    Step{"decode", "decode plant.vmat -o decoded.bsp.h5"},
    Step{"row", "row plant.vmat 17"},
    Step{"compare, 2 codecs", "compare plant.bsp.h5 --codecs delimiter,roaring --seconds 0"},
};

constexpr std::array of_scenes = {
    Step{"plant", "plant --size {} -o plant.scene.h5", ""},
    Step{"cells", "cells plant.scene.h5 --cells grid:2 -o fine.scene.h5"},
    Step{"see --producer sampled", "see plant.scene.h5 --producer sampled -o plant.bsp.h5", ""},
    Step{"triangles", "triangles plant.scene.h5 plant.bsp.h5"},
    Step{"tree --nodes", "tree plant.bsp.h5 --nodes -o nodes.bsp.h5", ""},
    Step{"encode over the tree", "encode nodes.bsp.h5 --codec zach3-range -o nodes.vmat", ""},
    Step{"node", "node nodes.vmat 0"},
    Step{"dense-city", "dense-city --size {} -o dense.scene.h5"},
};

struct Cost {
  double processor_seconds = 0, wall_seconds = 0;
  std::uint64_t peak_bytes = 0;
};

// Runs vismat in `folder`; what it prints goes to a file there.
Cost run(const std::filesystem::path& program, const std::filesystem::path& folder,
         const std::string& command) {
  std::vector<std::string> words = {program.string()};
  std::istringstream text(command);
  for (std::string word; text >> word;) words.push_back(word);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  std::fflush(stdout);
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
    throw std::runtime_error("'" + program.string() + " " + command + "' failed");
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
  };
  return {seconds(used.ru_utime) + seconds(used.ru_stime), wall_seconds() - start,
          static_cast<std::uint64_t>(used.ru_maxrss) * 1024};
}

class Table {
 public:
  Table() {
    std::printf("%-26s %9s %10s %10s %10s %8s %8s\n", "verb", "size", "cpu s", "wall s", "peak MB", "cpu ^",
                "peak ^");
  }
  void add(const std::string& verb, double side, const Cost& cost) {
    const auto exponent = [&](double now, double before) {
      return std::log(now / before) / std::log(side / last_[verb].side);
    };
    std::printf("%-26s %9.0f %10.2f %10.2f %10.0f", verb.c_str(), side, cost.processor_seconds,
                cost.wall_seconds, static_cast<double>(cost.peak_bytes) / 1e6);
    double of_time = 0, of_peak = 0;
    if (last_.contains(verb)) {
      const Cost& before = last_[verb].cost;
      of_time = exponent(cost.processor_seconds, before.processor_seconds);
      of_peak = exponent(static_cast<double>(cost.peak_bytes), static_cast<double>(before.peak_bytes));
      std::printf(" %8.2f %8.2f", of_time, of_peak);
    }
    std::printf("\n");
    std::fflush(stdout);
    csv_ +=
        csv_line(verb, side, cost.processor_seconds, cost.wall_seconds, cost.peak_bytes, of_time, of_peak);
    last_[verb] = {side, cost};
  }
  const std::string& csv() const { return csv_; }

 private:
  struct Last {
    double side;
    Cost cost;
  };
  std::map<std::string, Last> last_;
  std::string csv_ =
      "verb,size,processor_seconds,wall_seconds,peak_bytes,exponent_of_time,exponent_of_peak\n";
};

std::filesystem::path vismat_of(const GrowthOptions& options) {
  if (!options.vismat.empty()) return std::filesystem::absolute(options.vismat);
  return std::filesystem::read_symlink("/proc/self/exe").replace_filename("vismat");
}

void run_steps(const GrowthOptions& options, std::span<const Step> steps, const std::string& size,
               double side, Table& table) {
  const auto asked = [&](const Step& step) {
    return options.verbs.empty() || std::ranges::any_of(options.verbs, [&](const std::string& verb) {
             return std::string_view(step.name).starts_with(verb);
           });
  };
  if (std::ranges::none_of(steps, asked)) return;
  for (const Step& step : steps) {
    const auto reads_it = [&](const Step& later) {
      return step.read_by != nullptr && &later > &step && asked(later) &&
             std::string_view(later.name).starts_with(step.read_by);
    };
    if (!asked(step) && std::ranges::none_of(steps, reads_it)) continue;
    std::string command = step.command;
    if (const std::size_t at = command.find("{}"); at != std::string::npos) command.replace(at, 2, size);
    const Cost cost = run(vismat_of(options), options.folder, command);
    if (asked(step)) table.add(step.name, side, cost);
  }
}

void run_growth(const GrowthOptions& options) {
  std::filesystem::create_directories(options.folder);
  Table table;
  for (const double scale : options.scales)
    run_steps(options, of_matrices, csv_values(scale), power_plant_scene(scale).shape.rows, table);
  for (const std::uint32_t bays : options.bays)
    run_steps(options, of_scenes, std::to_string(bays), bays, table);
  write_table(options.csv, table.csv());
}

}  // namespace

void add_growth(const Verb& verb) {
  const auto o = std::make_shared<GrowthOptions>();
  verb.option("--scale", o->scales,
              "Sizes of the matrix that 'vismat generate power-plant' makes, from small to large")
      .between(1e-4, 1.);
  verb.option("--bays", o->bays, "Sizes of the scene that 'vismat plant' makes, from small to large");
  verb.option("--verb", o->verbs, "Only the lines of the table that begin like one of these");
  verb.option("--vismat", o->vismat, "The program (default: the one beside bench)");
  verb.option("--folder", o->folder, "Where the files that the verbs write are kept");
  verb.output("--csv", o->csv, Written::text, "File for the table as CSV");
  verb.note(
      "The size is the matrix's rows, or bays along a side of the scene; exponents are of that size, from "
      "one "
      "line of a verb to its next.");
  verb.example("bench growth --scale 0.0078125 0.015625 0.03125 --csv growth.csv");
  verb.runs([o] { run_growth(*o); });
}

}  // namespace vismat::bench
