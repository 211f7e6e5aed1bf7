#include "programs/options.h"

#include <CLI/CLI.hpp>

#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <new>
#include <optional>
#include <sstream>

#include "programs/process.h"

namespace vismat {
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

/// Refuses what is no number or not `good`. Help shows `kind` after the option's name.
CLI::Validator number_check(const std::string& kind, const std::string& fault,
                            std::function<bool(double)> good) {
  return CLI::Validator(
      [=](const std::string& text) {
        double value = 0;
        const bool fine = CLI::detail::lexical_cast(text, value) && good(value);
        return fine ? std::string() : "Value " + text + " " + fault;
      },
      kind);
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

Option Option::not_negative() const {
  option_->check(number_check("0 or more", "below 0", [](double value) { return value >= 0; }));
  return *this;
}

Option Option::size_in_bytes() const {
  option_->transform(CLI::AsSizeValue(false));
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
  CLI::Option* option = app_->add_option(name, value, help_text(help));
  if (has_default(value)) option->capture_default_str();
  return Option(option);
}

template Option Verb::option(const std::string&, std::string&, const std::string&) const;
template Option Verb::option(const std::string&, std::filesystem::path&, const std::string&) const;
template Option Verb::option(const std::string&, int&, const std::string&) const;
template Option Verb::option(const std::string&, std::uint32_t&, const std::string&) const;
template Option Verb::option(const std::string&, std::uint64_t&, const std::string&) const;
template Option Verb::option(const std::string&, float&, const std::string&) const;
template Option Verb::option(const std::string&, double&, const std::string&) const;
template Option Verb::option(const std::string&, std::optional<std::uint32_t>&, const std::string&) const;
template Option Verb::option(const std::string&, std::optional<std::uint64_t>&, const std::string&) const;
template Option Verb::option(const std::string&, std::optional<double>&, const std::string&) const;
template Option Verb::option(const std::string&, std::vector<std::string>&, const std::string&) const;
template Option Verb::option(const std::string&, std::vector<std::filesystem::path>&,
                             const std::string&) const;
template Option Verb::option(const std::string&, std::vector<std::uint32_t>&, const std::string&) const;
template Option Verb::option(const std::string&, std::vector<std::uint64_t>&, const std::string&) const;
template Option Verb::option(const std::string&, std::vector<double>&, const std::string&) const;

Option Verb::flag(const std::string& name, bool& value, const std::string& help) const {
  return Option(app_->add_flag(name, value, help_text(help)));
}

Option Verb::threads(unsigned& value) const {
  return option("--threads", value,
                "Number of threads; 0: one per core. The result is the same for any number");
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
  app_->callback(std::move(work));
}

void Verb::runs_with_rest(std::function<void(const std::vector<std::string>&)> work) const {
  app_->allow_extras();
  app_->callback([app = app_, work = std::move(work)] { work(app->remaining()); });
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
  return Verb(app);
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
