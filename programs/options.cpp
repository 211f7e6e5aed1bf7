#include "programs/options.h"

#include <CLI/CLI.hpp>

#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <limits>
#include <new>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <type_traits>

#include "programs/process.h"

namespace vismat {

/// The files that a verb reads and writes, as far as they are known once the arguments are parsed.
struct VerbFiles {
  using Paths = std::function<std::vector<std::filesystem::path>()>;
  struct Output {
    std::string option;
    Paths paths;
    Written what;
  };
  std::vector<Paths> inputs;
  std::vector<Output> outputs;

  void check() const {
    std::vector<std::filesystem::path> read;
    for (const Paths& input : inputs) {
      for (const auto& path : input()) read.push_back(path);
    }
    std::vector<OutputName> written;
    for (const Output& output : outputs) {
      for (const auto& path : output.paths()) written.push_back({output.option, path, output.what});
    }
    check_outputs(read, written);
  }
};

namespace {

constexpr std::size_t help_indent = 34, help_width = 110;
const std::string example_mark = "Example: ";

/// Lines of at most `width` characters, broken at blanks; those that begin with blanks continue two further in.
std::string wrapped(const std::string& text, std::size_t width) {
  std::istringstream lines(text);
  std::string result;
  for (std::string line; std::getline(lines, line);) {
    if (!result.empty()) result += '\n';
    const std::size_t first = std::min(line.find_first_not_of(' '), line.size());
    const std::string indent(first == 0 ? 0 : first + 2, ' ');
    while (line.size() > width) {
      const std::size_t blank = line.rfind(' ', width);
      if (blank == std::string::npos || blank <= indent.size()) break;
      result += line.substr(0, blank) + '\n';
      line = indent + line.substr(blank + 1);
    }
    result += line;
  }
  return result;
}

std::string help_text(const std::string& help) {
  return wrapped(help, help_width - help_indent);
}

void add_note(CLI::App& app, const std::string& text) {
  const std::string before = app.get_footer();
  app.footer(before + (before.empty() ? "" : "\n") + wrapped(text, help_width));
}

void add_example(CLI::App& app, const std::string& command) {
  const std::string before = app.get_footer();
  const bool first = before.find(example_mark) == std::string::npos;
  app.footer(before + (before.empty() ? "" : "\n") +
             (first ? example_mark : std::string(example_mark.size(), ' ')) + command);
}

template <typename Value>
bool has_default(const Value& value) {
  if constexpr (requires { value.empty(); }) return !value.empty();
  if constexpr (requires { value.has_value(); }) return value.has_value();
  return true;
}

/// 0.25, 1000000
std::string short_form(double number) {
  std::ostringstream text;
  text.precision(10);
  text << number;
  return text.str();
}

/// Plain decimal notation, which ends where the text ends.
template <typename Number>
std::from_chars_result parse_number(std::string_view text, Number& value) {
  if constexpr (std::is_floating_point_v<Number>) {
    return std::from_chars(text.data(), text.data() + text.size(), value, std::chars_format::general);
  } else {
    return std::from_chars(text.data(), text.data() + text.size(), value);
  }
}

/// What is wrong with the text as a number; empty if nothing. Leading zeros are removed, since CLI11 takes them for octal.
template <typename Number>
std::string number_fault(std::string& text) {
  constexpr bool whole = std::is_integral_v<Number>;
  const std::string fault =
      "Value '" + text + "' is " +
      (whole ? "no whole number from 0 to " + std::to_string(std::numeric_limits<Number>::max())
             : std::string("no finite number of 0 or more"));
  Number value = 0;
  const auto [end, error] = parse_number(text, value);
  if (error != std::errc() || end != text.data() + text.size()) return fault;
  if constexpr (!whole) {
    if (!std::isfinite(value)) return fault;
  }
  if (value < 0) return "Value " + text + " below 0";
  if constexpr (whole) text = std::to_string(value);
  return {};
}

template <typename Value>
struct Element {
  using Type = Value;
};
template <typename Value>
requires requires {
  typename Value::value_type;
}
struct Element<Value> {
  using Type = typename Value::value_type;
};
template <>
struct Element<std::string> {
  using Type = std::string;
};

/// Refuses what is not `good`; that it is a number is checked before. Help shows `kind` after the option's name.
CLI::Validator number_check(const std::string& kind, const std::string& fault,
                            std::function<bool(double)> good) {
  return CLI::Validator(
      [=](const std::string& text) {
        double value = 0;
        parse_number(text, value);
        return good(value) ? std::string() : "Value " + text + " " + fault;
      },
      kind);
}

/// "12G", "12GB", "12gib" and "12884901888" as the last of these; anything else stays, for number_fault to refuse.
std::string in_bytes(const std::string& text) {
  std::uint64_t count = 0;
  const auto [end, error] = parse_number(text, count);
  std::string unit = CLI::detail::to_lower(text.substr(static_cast<std::size_t>(end - text.data())));
  if (error != std::errc()) return text;
  constexpr std::string_view units = "kmgtpe";
  const std::size_t place = unit.empty() ? std::string_view::npos : units.find(unit[0]);
  const std::size_t shift = place == std::string_view::npos ? 0 : 10 * (place + 1);
  if (shift > 0) unit.erase(0, 1);
  const bool known = unit.empty() || unit == "b" || (shift > 0 && unit == "ib");
  if (!known || count > std::numeric_limits<std::uint64_t>::max() >> shift) return text;
  return std::to_string(count << shift);
}

template <typename Value>
std::vector<std::filesystem::path> paths_in(const Value& value) {
  std::vector<std::filesystem::path> paths;
  if constexpr (std::is_convertible_v<Value, std::filesystem::path>) {
    if (!value.empty()) paths.emplace_back(value);
  } else {
    paths.assign(value.begin(), value.end());
  }
  return paths;
}

template <typename Value>
CLI::Option* add_option(CLI::App& app, const std::string& name, Value& value, const std::string& help) {
  CLI::Option* option = app.add_option(name, value, help_text(help));
  if (has_default(value)) option->capture_default_str();
  return option;
}

}  // namespace

Option Option::required() const {
  option_->required();
  return *this;
}

Option Option::one_of(const std::vector<std::string>& words) const {
  option_->check(CLI::IsMember(words));
  return *this;
}

Option Option::between(double low, double high) const {
  const std::string range = short_form(low) + " to " + short_form(high);
  option_->check(number_check(range, "not in range " + range,
                              [=](double value) { return value >= low && value <= high; }));
  return *this;
}

Option Option::positive() const {
  option_->check(number_check("above 0", "not above 0", [](double value) { return value > 0; }));
  return *this;
}

Option Option::size_in_bytes() const {
  option_->transform(CLI::Validator(
      [](std::string& text) {
        text = in_bytes(text);
        return std::string();
      },
      "SIZE"));
  return *this;
}

Option Option::comma_separated() const {
  option_->delimiter(',')->allow_extra_args(false);
  option_->type_name("A,B,...");
  return *this;
}

Option Option::repeatable() const {
  option_->allow_extra_args(false);
  return *this;
}

Option Option::excludes(Option other) const {
  option_->excludes(other.option_);
  return *this;
}

Option Option::needs(Option other) const {
  option_->needs(other.option_);
  return *this;
}

template <typename Value>
Option Verb::option(const std::string& name, Value& value, const std::string& help) const {
  CLI::Option* option = add_option(*app_, name, value, help);
  using Number = typename Element<Value>::Type;
  if constexpr (std::is_arithmetic_v<Number>)
    option->transform(CLI::Validator([](std::string& text) { return number_fault<Number>(text); }, ""));
  return Option(option);
}

template <typename Value>
Option Verb::input(const std::string& name, Value& value, const std::string& help) const {
  files_->inputs.push_back([&value] { return paths_in(value); });
  return Option(add_option(*app_, name, value, help)->type_name("FILE"));
}

template <typename Value>
Option Verb::output(const std::string& name, Value& value, Written what, const std::string& help) const {
  CLI::Option* const option = add_option(*app_, name, value, help);
  const std::string short_name = name.substr(0, name.find(','));
  const auto paths = [&value, option, short_name] {
    if (option->count() > 0 && value.empty()) throw std::invalid_argument(short_name + ": names no file");
    return paths_in(value);
  };
  files_->outputs.push_back({short_name, paths, what});
  return Option(
      option->type_name(what == Written::folder || what == Written::made_folder ? "FOLDER" : "FILE"));
}

template Option Verb::option(const std::string&, std::string&, const std::string&) const;
template Option Verb::option(const std::string&, int&, const std::string&) const;
template Option Verb::option(const std::string&, std::uint32_t&, const std::string&) const;
template Option Verb::option(const std::string&, std::uint64_t&, const std::string&) const;
template Option Verb::option(const std::string&, float&, const std::string&) const;
template Option Verb::option(const std::string&, double&, const std::string&) const;
template Option Verb::option(const std::string&, std::optional<std::uint32_t>&, const std::string&) const;
template Option Verb::option(const std::string&, std::optional<std::uint64_t>&, const std::string&) const;
template Option Verb::option(const std::string&, std::optional<double>&, const std::string&) const;
template Option Verb::option(const std::string&, std::vector<std::string>&, const std::string&) const;
template Option Verb::input(const std::string&, std::string&, const std::string&) const;
template Option Verb::input(const std::string&, std::filesystem::path&, const std::string&) const;
template Option Verb::input(const std::string&, std::vector<std::string>&, const std::string&) const;
template Option Verb::input(const std::string&, std::vector<std::filesystem::path>&,
                            const std::string&) const;
template Option Verb::output(const std::string&, std::string&, Written, const std::string&) const;
template Option Verb::output(const std::string&, std::filesystem::path&, Written, const std::string&) const;
template Option Verb::option(const std::string&, std::vector<std::uint32_t>&, const std::string&) const;
template Option Verb::option(const std::string&, std::vector<std::uint64_t>&, const std::string&) const;
template Option Verb::option(const std::string&, std::vector<double>&, const std::string&) const;

Option Verb::flag(const std::string& name, bool& value, const std::string& help) const {
  return Option(app_->add_flag(name, value, help_text(help)));
}

Option Verb::threads(unsigned& value) const {
  return option("--threads", value,
                "Number of threads; 0: one per core. The result is the same for any number")
      .between(0, 65536);
}

Verb Verb::note(const std::string& text) const {
  add_note(*app_, text);
  return *this;
}

Verb Verb::example(const std::string& command) const {
  add_example(*app_, command);
  return *this;
}

void Verb::runs(std::function<void()> work) const {
  app_->callback([files = files_, work = std::move(work)] {
    files->check();
    work();
  });
}

void Verb::runs_with_rest(std::function<void(const std::vector<std::string>&)> work) const {
  app_->allow_extras();
  app_->callback([app = app_, files = files_, work = std::move(work)] {
    files->check();
    work(app->remaining());
  });
}

Program::Program(const std::string& name, const std::string& what, const std::string& version)
    : name_(name), app_(std::make_unique<CLI::App>(wrapped(what, help_width), name)) {
  if (!version.empty()) app_->set_version_flag("--version", version);
  app_->require_subcommand(1);
  app_->get_formatter()->column_width(help_indent);
  app_->get_formatter()->label("SUBCOMMAND", "VERB");
}

Program::~Program() = default;

Verb Program::verb(const std::string& name, const std::string& what, const std::string& group) {
  CLI::App* app = app_->add_subcommand(name, what);
  app->group(group)->footer("");
  return Verb(app, files_.emplace_back(std::make_unique<VerbFiles>()).get());
}

Program& Program::note(const std::string& text) {
  add_note(*app_, text);
  return *this;
}

Program& Program::example(const std::string& command) {
  add_example(*app_, command);
  return *this;
}

int Program::run(int argc, char** argv) {
  begin_process();
  return end_process(name_, parse_and_run(argc, argv));
}

int Program::parse_and_run(int argc, char** argv) {
  const auto fail = [&](const char* why) {
    std::fprintf(stderr, "%s: %s\n", name_.c_str(), why);
    return 1;
  };
  try {
    app_->parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app_->exit(help);
  } catch (const CLI::RequiredError& error) {
    if (!app_->get_subcommands().empty()) return fail(error.what());
    const bool word = argc > 1 && argv[1][0] != '-';
    const std::string what = word ? "there is no verb '" + std::string(argv[1]) + "'" : "name a verb";
    return fail((what + "; '" + name_ + " --help' lists them").c_str());
  } catch (const std::bad_alloc&) {
    return fail("not enough memory");
  } catch (const std::exception& error) {
    return fail(error.what());
  }
  return 0;
}

}  // namespace vismat
