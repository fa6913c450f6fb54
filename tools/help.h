// The text of --help, and suggestions for mistyped words. CLI11 lays the text out.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace welkin::tool {

/// Breaks the descriptions of options at 80 columns, which CLI11's own formatter does not.
class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter();
  std::string make_option_desc(const CLI::Option* option) const override;
  /// Leaves out needed and excluded options: the error for breaking that rule names them.
  std::string make_option_opts(const CLI::Option* option) const override;
};

/// Returns the notes of a program or a command with the meaning of exit codes.
[[nodiscard]] std::string with_exit_codes(const std::string& notes);

/// Shortens a command's help to a screen: the named options (all if there are no names), the first clause and the
/// default of each description, a few examples of the notes, the exit codes, and a pointer to the rest. Defaults are
/// those that a description states as "default VALUE", up to the next semicolon, colon or full stop.
void shorten(CLI::App& command, const std::vector<std::string>& everyday);

/// Returns a help text with bold headings if standard output is a terminal that shows them.
[[nodiscard]] std::string with_headings(const std::string& text);

/// Returns suggestions without regard to case: the words that begin with `word`, if it has two letters or more; else
/// the word nearest by letters changed, added, left out or swapped with a neighbour. Empty if none is near: a third of
/// the letters may be wrong.
[[nodiscard]] std::vector<std::string> near_words(const std::string& word, const std::vector<std::string>& words);
[[nodiscard]] std::vector<std::string> near_commands(const std::string& word, const CLI::App& program);
[[nodiscard]] std::vector<std::string> near_options(const std::string& word, const CLI::App& command);

/// Returns "; did you mean --size?", "; did you mean --sun-elevation or --sun-azimuth?"; empty for an empty list.
[[nodiscard]] std::string did_you_mean(const std::vector<std::string>& near);

}  // namespace welkin::tool
