// Options that more than one subcommand has, and the kind that names one of several values.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <utility>
#include <vector>

#include "welkin/environment_file.h"

namespace welkin::tool {

/// What every subcommand that reads an environment takes.
struct CommonOptions {
  bool json = false;
  int threads = 0;  ///< 0: as many as the process may use
  ReadOptions read;
  std::string cache;  ///< a folder; empty: results are not kept
};

void add_json_option(CLI::App& command, CommonOptions& options);
void add_threads_option(CLI::App& command, CommonOptions& options);
CLI::Option* add_memory_limit_option(CLI::App& command, CommonOptions& options);

/// How `input` is read: its layout, which part of it, and how its numbers are meant. They need it.
/// `layout_option`: for a command that has a layout of its own to ask for.
void add_read_options(CLI::App& command, CommonOptions& options, CLI::Option* input,
                      const std::string& layout_option = "--layout");

/// A number from `least` to `most`. (CLI11's own range lets NaN through.)
[[nodiscard]] CLI::Validator finite_between(double least, double most);

/// The layouts' words.
[[nodiscard]] std::vector<std::pair<std::string, Layout>> layout_choices();

/// The number of threads that the options ask for.
[[nodiscard]] int thread_count(const CommonOptions& options);

/// An option whose value is a word. Only the listed words are taken (CLI11's own transformer would
/// also take the enumerators' numbers).
template <typename Value>
CLI::Option* add_choice(CLI::App& command, const std::string& option, Value& target,
                        const std::vector<std::pair<std::string, Value>>& choices, const std::string& description) {
  std::vector<std::string> words;
  words.reserve(choices.size());
  for (const auto& [word, value] : choices) words.push_back(word);
  const auto store = [&target, choices](const std::string& chosen) {
    for (const auto& [word, value] : choices) {
      if (word == chosen) target = value;
    }
  };
  return command.add_option_function<std::string>(option, store, description)
      ->check(CLI::IsMember(words).description(""))
      ->type_name(CLI::detail::join(words, "|"));
}

}  // namespace welkin::tool
