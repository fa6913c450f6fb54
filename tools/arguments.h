// Tables of options, by which the command line is read and --help is written.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace welkin::tool {

/// Thrown by a function that takes an option's value and cannot use it; ends the program with `ExitCode::bad_usage` and
/// "OPTION: WHAT".
struct BadValue {
  std::string option;
  std::string what;
};

/// A number of bytes, written as "512MiB", "2GB" or "4096".
struct ByteCount {
  std::uint64_t* bytes;
};

/// Called with an option's value once it is checked.
template <class Value>
using On = std::function<void(const Value&)>;
/// Called if a flag is present.
using OnFlag = std::function<void()>;

/// The destination of an option's value. A `bool` or an `OnFlag` has no value: it receives that the option is present.
using Target =
    std::variant<bool*, int*, double*, std::string*, std::optional<std::string>*, std::optional<double>*,
                 std::vector<double>*, std::vector<std::string>*, ByteCount, OnFlag, On<int>, On<float>, On<double>,
                 On<std::string>, On<std::vector<int>>, On<std::vector<double>>, On<std::vector<std::string>>>;

/// The numbers that an option takes.
struct Bounds {
  enum class Kind { none, whole, number, positive };
  Kind kind = Kind::none;
  double minimum = 0.0;
  double maximum = 0.0;
};
/// Whole numbers from `minimum` to `maximum`, or all numbers in that range except NaN.
[[nodiscard]] Bounds whole_between(int minimum, int maximum);
[[nodiscard]] Bounds number_between(double minimum, double maximum);
[[nodiscard]] Bounds finite_and_positive();

/// Whether an option takes several values.
enum class List {
  none,
  commas,            ///< separated by commas
  commas_or_spaces,  ///< or as separate arguments
};

struct Option {
  std::string names{};  ///< "-o,--output"; without a hyphen it is positional: "INPUT"
  Target target{};
  std::string text{};                ///< for --help, which breaks its lines
  std::string type{};                ///< what --help calls the value
  std::vector<std::string> words{};  ///< the only values that are accepted; empty: any
  /// Returns the hint for another word, such as "; did you mean 'plan hdr/'?"; if it is empty or not set, the nearest
  /// word is named.
  std::function<std::string(const std::string& word)> hint{};
  Bounds bounds{};  ///< of each value
  List list = List::none;
  int count = 0;  ///< number of values in a list; 0: any
  bool required = false;
  std::string environment{};            ///< the variable that is read where the option is absent
  std::vector<std::string> needs{};     ///< options without which this one is refused
  std::vector<std::string> excludes{};  ///< options that cannot be combined with this one
  std::string group{};                  ///< heading in --help
  bool* named = nullptr;                ///< set to true if the option is present with its value
};

using Options = std::vector<Option>;

/// Adds an option to a table. `rules`: its other members.
void add_option(Options& table, std::string names, Target target, std::string type, std::string text,
                Option rules = {});

/// The heading of options that control how a command runs and do not affect its result.
inline constexpr const char* kRunningGroup = "Running";

/// Puts all options that have no group yet under that heading.
void in_group(Options& options, const std::string& group);

/// Returns the option of that name, which must exist.
[[nodiscard]] Option& option(Options& options, const std::string& name);

/// Returns "one|two|three", the form in which --help lists the words that an option takes.
[[nodiscard]] std::string alternatives(const std::vector<std::string>& words);

/// Returns whether the words are equal without regard to case: "Unity" and "unity".
[[nodiscard]] bool same_word(const std::string& one, const std::string& other);

/// Makes an option whose value is one of several words, each of which stands for a value. `target` must outlive it.
template <typename Value>
Option choice(const std::string& name, Value& target, const std::vector<std::pair<std::string, Value>>& choices,
              const std::string& text) {
  std::vector<std::string> words;
  words.reserve(choices.size());
  for (const auto& [word, value] : choices) words.push_back(word);
  const auto store = [&target, choices](const std::string& chosen) {
    for (const auto& [word, value] : choices) {
      if (same_word(word, chosen)) target = value;
    }
  };
  return {.names = name, .target = On<std::string>(store), .text = text, .type = alternatives(words), .words = words};
}

/// Returns values with their names, for `choice`.
template <typename Value>
std::vector<std::pair<std::string, Value>> by_name(std::initializer_list<Value> values) {
  std::vector<std::pair<std::string, Value>> choices;
  for (const Value value : values) choices.emplace_back(name(value), value);
  return choices;
}

/// Returns all values of an enumeration with words in the same order, for `choice`.
template <typename Value, std::size_t count>
std::vector<std::pair<std::string, Value>> by_order(const std::array<const char*, count>& words) {
  std::vector<std::pair<std::string, Value>> choices;
  choices.reserve(count);
  for (const char* const word : words) choices.emplace_back(word, static_cast<Value>(choices.size()));
  return choices;
}

/// Returns the number in the text; nothing if the text is not a number.
[[nodiscard]] std::optional<double> number_in(const std::string& text);
[[nodiscard]] std::optional<int> whole_number_in(const std::string& text);

/// The options that were on the command line.
class Given {
 public:
  /// `values` returns the values of an option as written; nothing if the option is absent.
  explicit Given(std::function<std::vector<std::string>(const std::string& name)> values)
      : values_(std::move(values)) {}

  [[nodiscard]] bool operator()(const std::string& name) const { return !values_(name).empty(); }

  /// Returns the given options of a table by their long names, in the table's order, however they were written. Flags
  /// have an empty value, lists one with commas.
  [[nodiscard]] std::vector<std::pair<std::string, std::string>> of(const Options& table) const;

 private:
  std::function<std::vector<std::string>(const std::string& name)> values_;
};
using GivenOptions = std::vector<std::pair<std::string, std::string>>;

/// Reads words like a command line: each option's value goes to its target. Returns the given options. Throws `Error`
/// (invalid_argument).
GivenOptions read_options(const Options& table, const std::vector<std::string>& words);

/// Returns whether the option takes a value.
[[nodiscard]] bool has_value(const Option& option) noexcept;

/// Returns "-o" and "--output" of "-o,--output".
[[nodiscard]] std::vector<std::string> names_of(const Option& option);

/// A subcommand.
struct Command {
  std::string name;
  std::string summary;  ///< one line
  std::string notes;    ///< shown below the options by --help-all; --help shows some of its examples
  Options options{};
  std::function<void(const Given& given)> run{};  ///< called once all options have their values
  std::vector<std::string> everyday{};            ///< names of the options that --help shows; empty: all
  std::string several{};  ///< added to the error about an extra argument: "; 'welkin batch' ..."
};

struct Program {
  std::string summary;
  std::string notes;
  std::vector<Command> commands;
};

/// The meaning of a program's exit code. Scripts rely on these values: they never change.
enum ExitCode : int {
  success = 0,
  bad_input = 1,  ///< a file or its pixels, or no memory or output device for the work
  bad_usage = 2,  ///< an unknown option, or a value that no input could make valid
  // And 128 more than a signal's number if that stopped the work: 130 for Ctrl-C, 143 for SIGTERM, 129 for SIGHUP, 153
  // for SIGXFSZ, a file larger than the process may write.
};

/// Turns any exception of `work` into a message on standard error and an exit code.
[[nodiscard]] ExitCode run_guarded(const std::function<ExitCode()>& work);

/// Returns "help bake" as "bake --help", and "help" as "--help".
[[nodiscard]] std::vector<std::string> without_help_command(std::vector<std::string> arguments);

/// Returns "-o out bake city.hdr" as "bake -o out city.hdr": options of a command may come before its name.
[[nodiscard]] std::vector<std::string> with_command_first(const Program& program, std::vector<std::string> arguments);

/// Reads the command line (without the program's name) and runs the command that it names. Turns exceptions into a
/// message on standard error and an exit code; answers --help and --version. Messages call the program `welkin`,
/// whatever its file is called.
[[nodiscard]] ExitCode run_program(const Program& program, const std::vector<std::string>& arguments);

/// Returns a script that completes commands, options, the words that options take, and files.
[[nodiscard]] std::string bash_completion(const Program& program);
[[nodiscard]] std::string zsh_completion(const Program& program);

/// Returns the manual page welkin(1), in roff's man macros.
[[nodiscard]] std::string manual_page(const Program& program);

}  // namespace welkin::tool
