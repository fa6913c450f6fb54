#include <algorithm>
#include <string_view>
#include <vector>

#include "tools/arguments.h"
#include "tools/help.h"
#include "tools/text.h"
#include "welkin/core.h"

namespace welkin::tool {
namespace {

bool is_place(const Option& option) { return !option.names.starts_with('-'); }

/// What every command takes besides its table.
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

std::string replaced(std::string text, std::string_view what, std::string_view with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size()) {
    text.replace(at, what.size(), with);
  }
  return text;
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
    if (is_place(option)) {
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

namespace {

/// In single quotes; a colon or a bracket would end a description.
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
  if (is_place(option)) {
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

}  // namespace

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

namespace {

/// Hyphens that are to be typed, backslashes, and a full stop at the start of a line, as roff wants them.
std::string roff(const std::string& text) {
  std::string escaped = replaced(replaced(text, "\\", "\\e"), "-", "\\-");
  if (escaped.starts_with('.') || escaped.starts_with('\'')) escaped.insert(0, "\\&");
  return replaced(replaced(escaped, "\n.", "\n\\&."), "\n'", "\n\\&'");
}

std::string roff_option(const Option& option) {
  std::string text = ".TP\n\\fB" + roff(joined(names_of(option), "\\fR, \\fB")) + "\\fR";
  text = replaced(text, "\\efR", "\\fR");
  text = replaced(text, "\\efB", "\\fB");
  // A line may be broken after each word: together they can be longer than one.
  const std::string words = replaced(roff(option.type), "|", "|\\:");
  if (has_value(option) && !is_place(option)) text += " \\fI" + words + "\\fR";
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
