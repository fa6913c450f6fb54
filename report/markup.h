// Text inside HTML and SVG.
#pragma once

#include <string>

namespace welkin::report {

/// & < > " ' as entities: fit for text and for attributes in quotes.
[[nodiscard]] std::string escaped(const std::string& text);

/// A time as `duration` has it, with a Greek mu.
[[nodiscard]] std::string duration_markup(double seconds);

}  // namespace welkin::report
