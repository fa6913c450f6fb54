// Numbers and text as a page shows them.
#pragma once

#include <string>

namespace welkin::report {

/// Two significant digits of a percentage: 0.0123 is "1.2 %"; below 0.001 % scientific; "no number" for a NaN.
[[nodiscard]] std::string percent(double share);

/// Three significant digits in ns, us, ms or s; "no number" for a NaN.
[[nodiscard]] std::string duration(double seconds);

}  // namespace welkin::report
