// The command line of a program with verbs: each verb's options, its help with examples, and what it runs.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "programs/output_check.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace vismat {

struct VerbFiles;

/// An option or argument of a verb, and what its value must be. Borrows from its Program, as does Verb; both may be
/// copied.
class Option {
 public:
  Option required() const;
  Option one_of(const std::vector<std::string>& words) const;
  Option between(double low, double high) const;  // both inclusive
  Option positive() const;
  Option size_in_bytes() const;    // 12G or 12GB is 12 * 2^30
  Option comma_separated() const;  // a list: --orders natural,best; else --orders natural best
  Option repeatable() const;       // a list: --from 1,2,3 --from 4,5,6
  Option excludes(Option other) const;
  Option needs(Option other) const;

 private:
  friend class Verb;
  explicit Option(CLI::Option* option) : option_(option) {}
  CLI::Option* option_;
};

class Verb {
 public:
  /// A name that begins with '-' makes an option, such as "-o,--output"; any other name a positional argument. Help
  /// shows the present value as the default, except for empty text, lists and optionals. `value` must live until
  /// Program::run ends, so keep it in what `runs` captures. Value may be text, int, unsigned, size_t, float or double,
  /// or an optional or a vector of one of these; see options.cpp. Numbers are decimal, finite and not negative, and fit
  /// their type; Option narrows that.
  template <typename Value>
  Option option(const std::string& name, Value& value, const std::string& help) const;
  Option flag(const std::string& name, bool& value, const std::string& help) const;

  /// Files, which may be given as text or paths, or lists of them. Each file that the verb reads or writes has to be
  /// added by one of these: before the verb runs, its outputs are checked by check_outputs, unless they are empty.
  template <typename Value>
  Option input(const std::string& name, Value& value, const std::string& help) const;
  template <typename Value>
  Option output(const std::string& name, Value& value, Written what, const std::string& help) const;
  /// The option -o,--output, which is required.
  template <typename Value>
  Option output(Value& value, Written what, const std::string& help) const {
    return output("-o,--output", value, what, help).required();
  }
  /// The option --threads; 0 means one thread for each core.
  Option threads(unsigned& value) const;

  /// Adds a paragraph below the options; line breaks in it stay, long lines are broken.
  Verb note(const std::string& text) const;
  /// Adds a command line to copy, last in the help.
  Verb example(const std::string& command) const;

  void runs(std::function<void()> work) const;
  /// Gives `work` the arguments that are not the verb's own; it may parse them by other means.
  void runs_with_rest(std::function<void(const std::vector<std::string>&)> work) const;

 private:
  friend class Program;
  Verb(CLI::App* app, VerbFiles* files) : app_(app), files_(files) {}
  CLI::App* app_;
  VerbFiles* files_;
};

class Program {
 public:
  Program(const std::string& name, const std::string& what, const std::string& version = "");
  ~Program();
  /// Adds a verb. The program's help lists the verbs of a group under the group's name.
  Verb verb(const std::string& name, const std::string& what, const std::string& group = "Verbs");
  Program& note(const std::string& text);
  Program& example(const std::string& command);

  /// Parses the arguments, runs the verb that they name, and returns the exit code: 0, or 1 after one line on stderr
  /// that says what was wrong with the arguments, with standard output, or what the verb threw. See process.h, too.
  int run(int argc, char** argv);

 private:
  int parse_and_run(int argc, char** argv);

  std::string name_;
  std::unique_ptr<CLI::App> app_;
  std::vector<std::unique_ptr<VerbFiles>> files_;  // of each verb
};

}  // namespace vismat
