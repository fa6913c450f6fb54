#include "tools/help.h"

#include <algorithm>
#include <iterator>
#include <sstream>
#include <string_view>

#include "tools/arguments.h"
#include "tools/terminal.h"
#include "tools/text.h"
#include "welkin/core.h"

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

/// Returns the text up to the first full stop, semicolon or colon.
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

/// Returns at most `most` lines of the paragraph of the notes that begins with a heading; a line that is indented more
/// than its first belongs to the one before.
std::string paragraph(const std::string& notes, const std::string& heading, int most) {
  const std::size_t start = notes.find(heading);
  if (start == std::string::npos) return "";
  std::istringstream lines(notes.substr(start));
  std::string text;
  int count = 0;
  for (std::string line; count <= most && std::getline(lines, line) && !line.empty(); ++count) text += line + '\n';
  return text;
}

/// Returns whether the name is that of an option as tables name it: with or without its hyphens, or a positional one.
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
    if (line.empty() && was_empty) continue;  // CLI11 separates groups by two lines
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

/// Counts letters changed, added, left out or swapped with a neighbour (Damerau 1964, as optimal string alignment).
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
  std::size_t minimum = std::max<std::size_t>(1, word.size() / 3) + 1;
  for (const std::string& each : words) {
    const std::size_t away = distance(typed, CLI::detail::to_lower(each));
    if (away >= minimum) continue;
    minimum = away;
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

// Shell completions, and the manual page.

namespace {

bool is_positional(const Option& option) { return !option.names.starts_with('-'); }

/// Returns the options that every command takes in addition to its table.
const Options& shared_options() {
  static bool none = false;
  static const Options options = {
      {.names = "-h,--help", .target = &none, .text = "Print the everyday options and some examples"},
      {.names = "--help-all", .target = &none, .text = "Print every option and all details"},
      {.names = "-q,--quiet", .target = &none, .text = "Print errors and requested results only"},
      {.names = "--verbose", .target = &none, .text = "Print each stage and its time on standard error"}};
  return options;
}

Options all_options(const Command& command) {
  Options options = command.options;
  options.insert(options.end(), shared_options().begin(), shared_options().end());
  return options;
}

std::string command_names(const Program& program) {
  return listed(
      program.commands, [](const Command& command) { return command.name; }, " ");
}

std::string bash_command(const Command& command) {
  std::vector<std::string> options;
  std::string text = "    " + command.name + ")\n";
  std::string values;
  for (const Option& option : all_options(command)) {
    if (is_positional(option)) {
      if (!option.words.empty()) options.insert(options.end(), option.words.begin(), option.words.end());
      continue;
    }
    const std::vector<std::string> names = names_of(option);
    options.insert(options.end(), names.begin(), names.end());
    if (!has_value(option)) continue;
    values += "        " + joined(names, "|") + ") words=\"" + joined(option.words, " ") + "\" ;;\n";
  }
  if (!values.empty()) text += "      case \"$previous\" in\n" + values + "        *) words=\"$\" ;;\n      esac\n";
  return text + "      options=\"" + joined(options, " ") + "\" ;;\n";
}

/// Returns the first clause for single quotes in zsh; a colon or a bracket would end a description.
std::string zsh_text(const std::string& text) {
  std::string line = text.substr(0, text.find_first_of(".;"));
  for (const char c : {'[', ']', ':', '\\', '`', '$'}) std::ranges::replace(line, c, ' ');
  return replaced(line, "'", "'\\''");
}

std::string zsh_value(const Option& option) {
  if (!has_value(option)) return "";
  const std::string what = zsh_text(option.type.empty() ? option.names : option.words.empty() ? option.type : "word");
  return ":" + what + ":" + (option.words.empty() ? "_files" : "(" + joined(option.words, " ") + ")");
}

std::string zsh_option(const Option& option) {
  if (is_positional(option)) {
    const bool many = std::holds_alternative<std::vector<std::string>*>(option.target);
    return std::string(" \\\n            '") + (many ? "*:" : ":") + option.names + ":" +
           (option.words.empty() ? "_files" : "(" + joined(option.words, " ") + ")") + "'";
  }
  std::string text;
  for (const std::string& name : names_of(option)) {
    text += " \\\n            '" + name + "[" + zsh_text(option.text) + "]" + zsh_value(option) + "'";
  }
  return text;
}

/// Escapes hyphens, backslashes, and a full stop at the start of a line for roff.
std::string roff(const std::string& text) {
  std::string escaped = replaced(replaced(text, "\\", "\\e"), "-", "\\-");
  if (escaped.starts_with('.') || escaped.starts_with('\'')) escaped.insert(0, "\\&");
  return replaced(replaced(escaped, "\n.", "\n\\&."), "\n'", "\n\\&'");
}

std::string roff_option(const Option& option) {
  std::string text = ".TP\n\\fB" + roff(joined(names_of(option), "\\fR, \\fB")) + "\\fR";
  text = replaced(text, "\\efR", "\\fR");
  text = replaced(text, "\\efB", "\\fB");
  // Allows a line break after each word, because the words together can be longer than a line.
  const std::string words = replaced(roff(option.type), "|", "|\\:");
  if (has_value(option) && !is_positional(option)) text += " \\fI" + words + "\\fR";
  return text + '\n' + roff(option.text) + ".\n";
}

std::string roff_command(const Command& command) {
  std::string text = ".SH \"WELKIN " + command.name + "\"\n" + roff(command.summary) + ".\n";
  std::string group;
  for (const Option& option : all_options(command)) {
    if (!option.group.empty() && option.group != group) text += ".SS \"" + roff(option.group) + "\"\n";
    if (!option.group.empty()) group = option.group;
    text += roff_option(option);
  }
  if (!command.notes.empty()) text += ".PP\n.nf\n" + roff(command.notes) + "\n.fi\n";
  return text;
}

}  // namespace

std::string bash_completion(const Program& program) {
  std::string text =
      "# bash completion for welkin; 'welkin completion bash' writes it.\n"
      "_welkin() {\n"
      "  local current=\"${COMP_WORDS[COMP_CWORD]}\" previous=\"${COMP_WORDS[COMP_CWORD-1]}\" options= words='$'\n"
      "  if ((COMP_CWORD == 1)); then\n"
      "    COMPREPLY=($(compgen -W \"help " +
      command_names(program) +
      " --help --help-all --version\" -- \"$current\"))\n"
      "    return\n"
      "  fi\n"
      "  case \"${COMP_WORDS[1]}\" in\n"
      "    help) COMPREPLY=($(compgen -W \"" +
      command_names(program) + "\" -- \"$current\")); return ;;\n";
  for (const Command& command : program.commands) text += bash_command(command);
  return text +
         "  esac\n"
         "  # '$': the word before takes no value; empty: it takes one of no known words, perhaps a file.\n"
         "  if [[ $words != '$' ]]; then\n"
         "    [[ -z $words ]] || COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n"
         "  elif [[ $current == -* || -n $options && $options != *-* ]]; then\n"
         "    COMPREPLY=($(compgen -W \"$options\" -- \"$current\"))\n"
         "  else\n"
         "    COMPREPLY=($(compgen -W \"$options\" -- \"$current\" | grep -v '^-'))\n"
         "  fi\n"
         "}\n"
         "complete -o bashdefault -o default -F _welkin welkin\n";
}

std::string zsh_completion(const Program& program) {
  std::string commands;
  std::string cases;
  for (const Command& command : program.commands) {
    commands += "    '" + command.name + ":" + zsh_text(command.summary) + "'\n";
    cases += "        " + command.name + ")\n          _arguments -s";
    for (const Option& option : all_options(command)) cases += zsh_option(option);
    cases += " ;;\n";
  }
  return "#compdef welkin\n"
         "# zsh completion for welkin; 'welkin completion zsh' writes it.\n"
         "_welkin() {\n"
         "  local state line\n"
         "  local -a commands\n"
         "  commands=(\n"
         "    'help:Help on a command'\n" +
         commands +
         "  )\n"
         "  _arguments -C '(- *)--help[Help]' '(- *)--help-all[All help]' '(- *)--version[Version]' \\\n"
         "    '1:command:->command' '*::argument:->arguments'\n"
         "  case $state in\n"
         "    command) _describe -t commands command commands ;;\n"
         "    arguments)\n"
         "      case $line[1] in\n"
         "        help) _describe -t commands command commands ;;\n" +
         cases +
         "      esac ;;\n"
         "  esac\n"
         "}\n"
         "if [ \"$funcstack[1]\" = _welkin ]; then _welkin \"$@\"; else compdef _welkin welkin; fi\n";
}

std::string manual_page(const Program& program) {
  std::string text = ".TH WELKIN 1 \"\" \"Welkin " WELKIN_VERSION_STRING
                     "\" \"User Commands\"\n"
                     ".SH NAME\nwelkin \\- environments to light\n"
                     ".SH SYNOPSIS\n.B welkin\n.I COMMAND\n.RI [ OPTIONS ]\n"
                     ".SH DESCRIPTION\n" +
                     roff(program.summary) + "\n.PP\n.nf\n" + roff(with_exit_codes(program.notes)) +
                     "\n.fi\n.SH COMMANDS\n";
  for (const Command& command : program.commands) {
    text += ".TP\n.B " + command.name + '\n' + roff(command.summary) + ".\n";
  }
  for (const Command& command : program.commands) text += roff_command(command);
  return text +
         ".SH ENVIRONMENT\n"
         ".TP\n.B WELKIN_ISA\nThe instruction set to use: sse2, avx2, avx512 or neon.\n"
         ".TP\n.B NO_COLOR\nIf it is set to anything, nothing is printed in colour.\n";
}

}  // namespace welkin::tool
