// What --help prints, and which word was meant. CLI11 lays the text out.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace welkin::tool {

/// Breaks the options' descriptions at 80 columns, which CLI11's own formatter does not.
class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter();
  std::string make_option_desc(const CLI::Option* option) const override;
  /// Without the options that this one needs or excludes: who breaks the rule is told.
  std::string make_option_opts(const CLI::Option* option) const override;
};

/// The notes of a program or a command, and what exit codes mean.
[[nodiscard]] std::string with_exit_codes(const std::string& notes);

/// Leaves of a command's help what fits a screen: the options of these names (all of them if there are none), of each
/// description the first clause and the default, of the notes a few examples and the exit codes, and where the rest is
/// found. Defaults are those that a description states as "default VALUE", up to the next semicolon, colon or full
/// stop.
void shorten(CLI::App& command, const std::vector<std::string>& everyday);

/// The headings of a help text in bold, if standard output is a terminal that shows it.
[[nodiscard]] std::string with_headings(const std::string& text);

/// Returns the words that may be meant, without regard to case: those that begin with `word`, if it has two letters or
/// more; else the one that is nearest by letters to be changed, added, left out or swapped with a neighbour. Empty if
/// none is near: a third of the letters may be wrong.
[[nodiscard]] std::vector<std::string> near_words(const std::string& word, const std::vector<std::string>& words);
[[nodiscard]] std::vector<std::string> near_commands(const std::string& word, const CLI::App& program);
[[nodiscard]] std::vector<std::string> near_options(const std::string& word, const CLI::App& command);

/// "; did you mean --size?", "; did you mean --sun-elevation or --sun-azimuth?", or nothing where there is nothing.
[[nodiscard]] std::string did_you_mean(const std::vector<std::string>& near);

}  // namespace welkin::tool
