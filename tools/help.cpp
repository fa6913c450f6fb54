#include "tools/help.h"

#include <algorithm>
#include <iterator>
#include <sstream>
#include <string_view>

#include "tools/arguments.h"
#include "tools/terminal.h"

namespace welkin::tool {
namespace {

constexpr std::size_t kPageWidth = 80;
constexpr std::size_t kOptionWidth = 28;

std::string broken_at(const std::string& text, std::size_t width) {
  std::istringstream words(text);
  std::string lines;
  std::size_t used = 0;
  for (std::string word; words >> word; used += word.size() + 1) {
    const bool fits = used + word.size() < width;
    if (!lines.empty()) lines += fits ? ' ' : '\n';
    if (!fits) used = 0;
    lines += word;
  }
  return lines;
}

}  // namespace

HelpFormatter::HelpFormatter() { column_width(kOptionWidth); }

std::string HelpFormatter::make_option_desc(const CLI::Option* option) const {
  return broken_at(option->get_description(), kPageWidth - kOptionWidth);
}

std::string HelpFormatter::make_option_opts(const CLI::Option* option) const {
  if (option->get_type_size() == 0) return "";
  std::string text;
  if (!option->get_type_name().empty()) text += ' ' + option->get_type_name();
  if (option->get_required()) text += " REQUIRED";
  if (!option->get_envname().empty()) text += " (environment: " + option->get_envname() + ')';
  return text;
}

namespace {

/// Up to the first full stop, semicolon or colon.
std::string first_clause(const std::string& text) {
  std::size_t end = text.size();
  for (const char* mark : {". ", "; ", ": "}) end = std::min(end, text.find(mark));
  return text.substr(0, end);
}

/// Returns the first clause and, if a later one states it, the default: "Texels along an edge (default 256)".
std::string short_text(const std::string& text) {
  constexpr std::string_view kWord = "efault";  // with or without a capital
  const std::string clause = first_clause(text);
  if (clause.find(kWord) != std::string::npos) return clause;
  for (std::size_t at = text.find(kWord, clause.size()); at != std::string::npos; at = text.find(kWord, at + 1)) {
    std::size_t value = at + kWord.size();
    if (text.compare(value, 1, ":") == 0) ++value;
    if (text.compare(value, 1, " ") != 0) continue;
    std::string stated = clause;
    return stated.append(" (default ").append(first_clause(text.substr(value + 1))).append(")");
  }
  return clause;
}

/// The paragraph of the notes that begins with a heading, and at most so many lines of it; a line that is indented
/// more than its first belongs to the one before.
std::string paragraph(const std::string& notes, const std::string& heading, int most) {
  const std::size_t start = notes.find(heading);
  if (start == std::string::npos) return "";
  std::istringstream lines(notes.substr(start));
  std::string text;
  int count = 0;
  for (std::string line; count <= most && std::getline(lines, line) && !line.empty(); ++count) text += line + '\n';
  return text;
}

/// Names an option as the tables do: with or without its hyphens, or a place on the command line.
bool is_named(const CLI::Option& option, const std::string& name) {
  return option.check_name(name) || option.get_name(true) == name;
}

}  // namespace

std::string with_exit_codes(const std::string& notes) {
  return notes + R"(

Exit codes: 0 done; 1 a bad file; 2 a bad command line; 128 + n: signal n.
  130 is Ctrl-C, 143 SIGTERM, 129 SIGHUP, 153 a file beyond its limit.)";
}

void shorten(CLI::App& command, const std::vector<std::string>& everyday) {
  constexpr int kExamples = 5;
  for (CLI::Option* const option : command.get_options()) {
    const bool shown = everyday.empty() || std::ranges::any_of(everyday, [option](const std::string& name) {
                         return is_named(*option, name);
                       });
    const std::string group = option->get_group();
    const bool own_heading = group == kRunningGroup || group.ends_with("utput");
    if (!shown) {
      option->group("");
    } else if (!everyday.empty() && !option->get_positional() && !own_heading) {
      option->group("Result");  // a heading for each two options would fill the screen
    }
    option->description(short_text(option->get_description()));
  }
  const std::string notes = command.get_footer();
  const bool whole = command.get_parent() == nullptr;
  const std::string all = whole ? "welkin help COMMAND" : "welkin " + command.get_name() + " --help-all";
  const std::string more = whole ? "    all about a command\n" : "    every option, with details\n";
  command.footer(paragraph(notes, "Examples:", kExamples) + "\n  " + all + more + '\n' +
                 paragraph(notes, "Exit codes:", 0));
}

std::string with_headings(const std::string& text) {
  std::istringstream lines(text);
  std::string styled_text;
  bool was_empty = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() && was_empty) continue;  // CLI11 parts groups by two lines
    was_empty = line.empty();
    const std::size_t colon = line.find(':');
    const bool heading = !line.empty() && line.front() != ' ' && colon != std::string::npos;
    styled_text +=
        heading ? styled(line.substr(0, colon + 1), Style::heading, Stream::output) + line.substr(colon + 1) : line;
    styled_text += '\n';
  }
  return styled_text;
}

namespace {

/// Letters to be changed, added, left out or swapped with a neighbour (Damerau 1964, as optimal string alignment).
std::size_t distance(const std::string& a, const std::string& b) {
  std::vector<std::vector<std::size_t>> rows(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        rows[i][j] = i + j;
        continue;
      }
      const std::size_t change = a[i - 1] == b[j - 1] ? 0 : 1;
      rows[i][j] = std::min({rows[i - 1][j] + 1, rows[i][j - 1] + 1, rows[i - 1][j - 1] + change});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        rows[i][j] = std::min(rows[i][j], rows[i - 2][j - 2] + 1);
      }
    }
  }
  return rows[a.size()][b.size()];
}

}  // namespace

std::vector<std::string> near_words(const std::string& word, const std::vector<std::string>& words) {
  const std::string typed = CLI::detail::to_lower(word);
  const std::size_t letters = typed.size() - std::min(typed.size(), typed.find_first_not_of('-'));
  std::vector<std::string> longer;
  std::ranges::copy_if(words, std::back_inserter(longer), [&](const std::string& each) {
    return letters > 1 && CLI::detail::to_lower(each).starts_with(typed);
  });
  if (!longer.empty()) return longer;
  std::vector<std::string> nearest;
  std::size_t least = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string& each : words) {
    const std::size_t away = distance(typed, CLI::detail::to_lower(each));
    if (away >= least) continue;
    least = away;
    nearest = {each};
  }
  return nearest;
}

std::vector<std::string> near_commands(const std::string& word, const CLI::App& program) {
  std::vector<std::string> names = {"help"};
  for (const CLI::App* const command : program.get_subcommands({})) names.push_back(command->get_name());
  return near_words(word, names);
}

std::vector<std::string> near_options(const std::string& word, const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* const option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return near_words(word, names);
}

std::string did_you_mean(const std::vector<std::string>& near) {
  std::string text;
  for (std::size_t i = 0; i < near.size(); ++i) {
    text += (i == 0 ? "; did you mean " : i + 1 < near.size() ? ", " : " or ") + near[i];
  }
  return near.empty() ? "" : text + '?';
}

}  // namespace welkin::tool
