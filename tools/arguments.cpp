#include "tools/arguments.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <exception>
#include <iostream>
#include <memory>
#include <new>
#include <string_view>
#include <system_error>

#include "tools/help.h"
#include "tools/terminal.h"
#include "tools/text.h"
#include "welkin/core.h"

namespace welkin::tool {
namespace {

/// Reads a size without CLI11, which would wrap "-1" around to the largest number, and clamp larger numbers to it.
CLI::Validator size_in_bytes() {
  return {[](std::string& text) {
            if (text.find('-') != std::string::npos) return text + " is not a size";
            std::uint64_t number = 0;
            if (std::from_chars(text.data(), text.data() + text.size(), number).ec == std::errc::result_out_of_range) {
              return text + " is more than the largest size, 18446744073709551615 bytes";
            }
            return CLI::AsSizeValue(true)(text);
          },
          ""};
}

/// Returns whole numbers in full: "1000000", not "1e+06".
std::string bound_text(double bound) {
  constexpr double kMaxDigits = 1e15;
  const bool is_short_and_whole = std::abs(bound) < kMaxDigits && bound == std::floor(bound);
  return is_short_and_whole ? std::to_string(static_cast<std::int64_t>(bound)) : significant(bound);
}

/// `value_in` returns the number in a text; `kind` says what it must be, such as "a whole number".
template <class ValueIn>
CLI::Validator range(const Bounds& bounds, const char* kind, const ValueIn& value_in) {
  return {[=](const std::string& text) {
            const auto value = value_in(text);
            if (value && *value >= bounds.minimum && *value <= bounds.maximum) return std::string();
            return text + " is not " + kind + " from " + bound_text(bounds.minimum) + " to " +
                   bound_text(bounds.maximum);
          },
          ""};
}

CLI::Validator positive_number() {
  return {[](const std::string& text) {
            const std::optional<double> value = number_in(text);
            const bool good = value && std::isfinite(*value) && *value > 0.0;
            return good ? std::string() : text + " is not a finite number above 0";
          },
          ""};
}

/// Accepts words in any case. The error for a wrong word names the nearest right one.
CLI::Validator one_of(const std::vector<std::string>& words,
                      const std::function<std::string(const std::string& word)>& hint) {
  return {[words, hint](const std::string& text) {
            const auto same = [&text](const std::string& word) { return same_word(word, text); };
            if (std::ranges::any_of(words, same)) return std::string();
            const std::string said = hint ? hint(text) : "";
            return text + " is none of " + CLI::detail::join(words, ", ") +
                   (said.empty() ? did_you_mean(near_words(text, words)) : said);
          },
          ""};
}

void check_bounds(CLI::Option& added, const Bounds& bounds) {
  switch (bounds.kind) {
    case Bounds::Kind::none: break;
    case Bounds::Kind::whole: added.check(range(bounds, "a whole number", whole_number_in)); break;
    case Bounds::Kind::number: added.check(range(bounds, "a number", number_in)); break;
    case Bounds::Kind::positive: added.check(positive_number()); break;
  }
}

/// Adds an option to a command according to the type of its target.
class Adding {
 public:
  Adding(CLI::App& command, const Option& option) : command_(command), option_(option) {}

  CLI::Option* operator()(bool* target) const { return command_.add_flag(option_.names, *target, option_.text); }
  CLI::Option* operator()(const OnFlag& call) const {
    return command_.add_flag_callback(option_.names, call, option_.text);
  }
  CLI::Option* operator()(const ByteCount& count) const {
    return command_.add_option(option_.names, *count.bytes, option_.text)->transform(size_in_bytes());
  }
  template <class Value>
  CLI::Option* operator()(Value* target) const {
    return command_.add_option(option_.names, *target, option_.text);
  }
  template <class Value>
  CLI::Option* operator()(const On<Value>& call) const {
    const auto guarded = [call](const Value& value) {
      try {
        call(value);
      } catch (const BadValue& bad) {
        throw CLI::ValidationError(bad.option, bad.what);
      }
    };
    return command_.add_option_function<Value>(option_.names, guarded, option_.text);
  }

 private:
  CLI::App& command_;
  const Option& option_;
};

void add_option(CLI::App& command, const Option& option) {
  CLI::Option& added = *std::visit(Adding(command, option), option.target);
  if (option.list != List::none) added.delimiter(',');
  if (option.count > 0) added.expected(option.count);
  if (option.list == List::commas) added.allow_extra_args(false);
  if (!option.words.empty()) added.check(one_of(option.words, option.hint));
  check_bounds(added, option.bounds);
  if (has_value(option)) added.type_name(option.type);
  if (!option.group.empty()) added.group(option.group);
  if (option.required) added.required();
  if (!option.environment.empty()) added.envname(option.environment);
  if (option.named != nullptr) added.each([named = option.named](const std::string& /*value*/) { *named = true; });
}

void add_options(CLI::App& command, const Options& table) {
  for (const Option& option : table) add_option(command, option);
  for (const Option& option : table) {
    const std::string name = names_of(option).front();
    for (const std::string& other : option.needs) command.get_option(name)->needs(command.get_option(other));
    for (const std::string& other : option.excludes) command.get_option(name)->excludes(command.get_option(other));
  }
}

/// Adds --quiet and --verbose to a command or to the program itself.
void add_verbosity(CLI::App& command) {
  command
      .add_flag_callback(
          "-q,--quiet", [] { set_verbosity(Verbosity::quiet); },
          "Print errors and requested results only: no progress, no table of files")
      ->group(kRunningGroup);
  command
      .add_flag_callback(
          "--verbose", [] { set_verbosity(Verbosity::verbose); }, "Print each stage and its time on standard error")
      ->group(kRunningGroup);
}

Given given_to(const CLI::App& command) {
  return Given([&command](const std::string& name) { return command.get_option(name)->results(); });
}

void add_command(CLI::App& program, const Command& command) {
  CLI::App& added = *program.add_subcommand(command.name, command.summary);
  added.get_option("--help")->group(kRunningGroup);
  added.get_option("--help-all")->group(kRunningGroup);
  added.footer(with_exit_codes(command.notes));
  add_options(added, command.options);
  add_verbosity(added);
  added.callback([&command, &added] {
    static_cast<void>(active_instruction_set());  // refuses a wrong WELKIN_ISA; decoders, which are noexcept, could not
    command.run(given_to(added));
  });
}

std::string version_text() {
  std::string text = "welkin " WELKIN_VERSION_STRING "\ninstruction sets here:";
  for (const InstructionSet set : available_instruction_sets()) text += std::string(" ") + name(set);
  return text + " (in use: " + name(active_instruction_set()) + ")";
}

ExitCode complain(ExitCode code, const std::string& message) {
  std::cerr << styled("welkin:", Style::error, Stream::error) << ' ' << printable_lines(message) << '\n';
  return code;
}

/// Returns the error about an unknown option, an unknown command or an extra argument; empty if there is none.
/// `command`: the command that was named, or null.
std::string unknown_words(const CLI::App& program, const Command* command, const std::vector<std::string>& arguments) {
  constexpr std::string_view kEndOfOptions = "--";
  const std::vector<std::string> left = program.remaining(true);
  const auto is_left = [&](const std::string& word) { return std::ranges::find(left, word) != left.end(); };
  const auto chosen = program.get_subcommands();
  const CLI::App& asked = chosen.empty() ? program : *chosen.front();
  const std::string who = chosen.empty() ? "" : asked.get_name() + ": ";
  for (const std::string& word : arguments) {
    if (word == kEndOfOptions) break;
    if (!is_left(word) || word.size() < 2 || word.front() != '-') continue;
    const std::string option = word.substr(0, word.find('='));
    return (who + "there is no option ").append(option).append(did_you_mean(near_options(option, asked)));
  }
  for (const std::string& word : arguments) {
    if (!is_left(word) || word == kEndOfOptions) continue;
    return who + word + " is an argument too many" + (command != nullptr ? command->several : "");
  }
  return "";
}

/// Returns null if the program has no such command.
const Command* command_of(const Program& program, const std::string& name) {
  const auto found = std::ranges::find(program.commands, name, &Command::name);
  return found == program.commands.end() ? nullptr : &*found;
}

/// Prints help, the version or an error: CLI11 reports a request for help or the version as an exception too.
ExitCode answer(CLI::App& program, const Program& table, const CLI::ParseError& request,
                const std::vector<std::string>& arguments) {
  if (dynamic_cast<const CLI::CallForVersion*>(&request) != nullptr) {
    print_result(std::string(request.what()) + '\n');
    return ExitCode::success;
  }
  const auto chosen = program.get_subcommands();
  const Command* const command = chosen.empty() ? nullptr : command_of(table, chosen.front()->get_name());
  if (request.get_exit_code() == 0) {
    const bool all = dynamic_cast<const CLI::CallForAllHelp*>(&request) != nullptr;
    if (!all)
      shorten(chosen.empty() ? program : *chosen.front(),
              command == nullptr ? std::vector<std::string>() : command->everyday);
    const std::string text = !chosen.empty()
                                 ? chosen.front()->help("welkin")
                                 : program.help("", all ? CLI::AppFormatMode::All : CLI::AppFormatMode::Normal);
    print_result(with_headings(text));
    return ExitCode::success;
  }
  const std::string unknown = unknown_words(program, command, arguments);
  const std::string help = chosen.empty() ? "welkin --help" : "welkin " + chosen.front()->get_name() + " --help";
  return complain(ExitCode::bad_usage,
                  (unknown.empty() ? std::string(request.what()) : unknown) + "\n'" + help + "' lists what it takes.");
}

std::string command_lines(const Program& program) {
  constexpr std::size_t kNameWidth = 12;
  std::string text;
  for (const Command& command : program.commands) {
    text += "  " + pad_right(command.name, kNameWidth) + command.summary + '\n';
  }
  return text;
}

ExitCode run(const Program& program, const std::vector<std::string>& arguments) {
  CLI::App parser{program.summary, "welkin"};
  parser.allow_windows_style_options(false);  // "/sky.exr" is a path on Windows too
  parser.footer(with_exit_codes(program.notes));
  parser.set_help_all_flag("--help-all", "Print every option, and all that there is to know");
  parser.set_version_flag("-V,--version", version_text, "Print the version and the instruction sets that run here");
  parser.formatter(std::make_shared<HelpFormatter>());
  parser.require_subcommand(0, 1);
  try {
    for (const Command& command : program.commands) add_command(parser, command);
    add_verbosity(parser);
    // This precedes the answer to --help: 'welkin help bakee' names no command.
    if (!arguments.empty() && !arguments.front().starts_with('-') &&
        command_of(program, arguments.front()) == nullptr) {
      return complain(ExitCode::bad_usage, "there is no command " + arguments.front() +
                                               did_you_mean(near_commands(arguments.front(), parser)) +
                                               "\n'welkin --help' lists the commands.");
    }
    parser.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));  // which takes them from the back
    if (!parser.get_subcommands().empty()) return ExitCode::success;
    return complain(ExitCode::bad_usage, "nothing to do: name a command\n" + command_lines(program) +
                                             "'welkin help COMMAND' lists a command's options.");
  } catch (const CLI::ParseError& request) {
    return answer(parser, program, request, arguments);
  }
}

}  // namespace

Bounds whole_between(int minimum, int maximum) {
  return {Bounds::Kind::whole, static_cast<double>(minimum), static_cast<double>(maximum)};
}
Bounds number_between(double minimum, double maximum) { return {Bounds::Kind::number, minimum, maximum}; }
Bounds finite_and_positive() { return {Bounds::Kind::positive}; }

void add_option(Options& table, std::string names, Target target, std::string type, std::string text, Option rules) {
  rules.names = std::move(names);
  rules.target = std::move(target);
  rules.type = std::move(type);
  rules.text = std::move(text);
  table.push_back(std::move(rules));
}

void in_group(Options& options, const std::string& group) {
  for (Option& one : options) {
    if (one.group.empty()) one.group = group;
  }
}

std::vector<std::string> names_of(const Option& option) { return CLI::detail::split(option.names, ','); }

Option& option(Options& options, const std::string& name) {
  for (Option& one : options) {
    const std::vector<std::string> names = names_of(one);
    if (std::ranges::find(names, name) != names.end()) return one;
  }
  throw std::logic_error("there is no option " + name);
}

bool same_word(const std::string& one, const std::string& other) {
  return CLI::detail::to_lower(one) == CLI::detail::to_lower(other);
}

bool has_value(const Option& option) noexcept {
  return !std::holds_alternative<bool*>(option.target) && !std::holds_alternative<OnFlag>(option.target);
}

GivenOptions Given::of(const Options& table) const {
  GivenOptions given;
  for (const Option& option : table) {
    const std::string name = names_of(option).back();
    const std::vector<std::string> values = values_(name);
    if (!values.empty()) given.emplace_back(name, has_value(option) ? joined(values, ",") : "");
  }
  return given;
}

GivenOptions read_options(const Options& table, const std::vector<std::string>& words) {
  CLI::App parser;
  parser.allow_windows_style_options(false);
  parser.set_help_flag("");
  add_options(parser, table);
  try {
    parser.parse(std::vector<std::string>(words.rbegin(), words.rend()));
    return given_to(parser).of(table);
  } catch (const CLI::ParseError& flaw) {
    throw Error(ErrorCode::invalid_argument, flaw.what());
  }
}

std::string alternatives(const std::vector<std::string>& words) { return CLI::detail::join(words, "|"); }

std::optional<double> number_in(const std::string& text) {
  double value = 0.0;
  return CLI::detail::lexical_cast(text, value) ? std::optional(value) : std::nullopt;
}

std::optional<int> whole_number_in(const std::string& text) {
  int value = 0;
  return CLI::detail::lexical_cast(text, value) ? std::optional(value) : std::nullopt;
}

ExitCode run_guarded(const std::function<ExitCode()>& work) {
  try {
    return work();
  } catch (const Error& error) {
    if (const int signal = caught_signal(); signal != 0) {
      constexpr int kSignalBase = 128;  // as in shells
      const auto code = static_cast<ExitCode>(kSignalBase + signal);
      if (error.code() != ErrorCode::cancelled) return complain(code, error.what());
      return complain(code, "stopped (" + signal_words(signal) + "); unfinished files were removed");
    }
    const bool usage = error.code() == ErrorCode::invalid_argument;
    return complain(usage ? ExitCode::bad_usage : ExitCode::bad_input, error.what());
  } catch (const std::bad_alloc&) {
    return complain(ExitCode::bad_input,
                    "there is not enough memory; --threads 1 takes the least, and --memory-limit refuses what would "
                    "need more before it is begun");
  } catch (const std::exception& error) {
    return complain(ExitCode::bad_input, error.what());
  }
}

std::vector<std::string> without_help_command(std::vector<std::string> arguments) {
  if (arguments.empty() || arguments.front() != "help") return arguments;
  arguments.erase(arguments.begin());
  const bool names_command = !arguments.empty() && !arguments.front().starts_with('-');
  arguments.insert(arguments.begin() + (names_command ? 1 : 0), "--help");
  return arguments;
}

namespace {

/// Returns whether the word is an option of any command that takes the next word as its value.
bool awaits_value(const Program& program, const std::string& word) {
  const auto takes_it = [&word](const Option& option) {
    const std::vector<std::string> names = names_of(option);
    return has_value(option) && std::ranges::find(names, word) != names.end();
  };
  return std::ranges::any_of(program.commands,
                             [&](const Command& command) { return std::ranges::any_of(command.options, takes_it); });
}

}  // namespace

std::vector<std::string> with_command_first(const Program& program, std::vector<std::string> arguments) {
  const std::vector<std::string> shared = {"-h",        "--help", "--help-all", "-V",
                                           "--version", "-q",     "--quiet",    "--verbose"};
  const auto first = std::ranges::find_if(
      arguments, [&shared](const std::string& word) { return std::ranges::find(shared, word) == shared.end(); });
  if (first == arguments.end() || !first->starts_with('-')) return arguments;
  for (auto word = first + 1; word != arguments.end(); ++word) {
    if (command_of(program, *word) == nullptr || awaits_value(program, *(word - 1))) continue;
    std::rotate(arguments.begin(), word, word + 1);
    break;
  }
  return arguments;
}

ExitCode run_program(const Program& program, const std::vector<std::string>& arguments) {
  reserve_standard_streams();
  return run_guarded([&] { return run(program, without_help_command(arguments)); });
}

}  // namespace welkin::tool
