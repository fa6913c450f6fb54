// `welkin report`: how good each setting is, and how long it takes.
#pragma once

#include <CLI/CLI.hpp>

namespace welkin::tool {

void add_report_command(CLI::App& program);

}  // namespace welkin::tool
