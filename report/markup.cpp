#include "report/markup.h"

#include "report/number_words.h"

namespace welkin::report {

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&': result += "&amp;"; break;
      case '<': result += "&lt;"; break;
      case '>': result += "&gt;"; break;
      case '"': result += "&quot;"; break;
      case '\'': result += "&#39;"; break;
      default: result += c;
    }
  }
  return result;
}

std::string duration_markup(double seconds) {
  std::string text = duration(seconds);
  const std::size_t at = text.find(" us");
  return at == std::string::npos ? text : text.replace(at, 3, " &#181;s");
}

}  // namespace welkin::report
