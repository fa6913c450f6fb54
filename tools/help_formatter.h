// How --help is laid out.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace welkin::tool {

/// Breaks the options' descriptions at 80 columns, which CLI11's own formatter does not.
class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter();
  std::string make_option_desc(const CLI::Option* option) const override;
};

}  // namespace welkin::tool
