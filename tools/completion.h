// What shells and `man` are told of the program, from the same tables as --help.
#pragma once

#include <string>

#include "tools/arguments.h"

namespace welkin::tool {

/// A script that completes commands, options, the words that options take, and files.
[[nodiscard]] std::string bash_completion(const Program& program);
[[nodiscard]] std::string zsh_completion(const Program& program);

/// The manual page welkin(1), in man's macros of roff.
[[nodiscard]] std::string manual_page(const Program& program);

}  // namespace welkin::tool
