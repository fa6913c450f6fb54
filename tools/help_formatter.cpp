#include "tools/help_formatter.h"

#include <sstream>

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

}  // namespace welkin::tool
