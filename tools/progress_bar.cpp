#include "tools/progress_bar.h"

#include <unistd.h>

#include <cstdlib>
#include <iostream>
#include <string>
#include <string_view>

#include "tools/number_text.h"

namespace welkin::tool {
namespace {

constexpr auto kPatience = std::chrono::milliseconds(300);  // work that is over by then shows nothing
constexpr auto kInterval = std::chrono::milliseconds(50);
constexpr std::string_view kWipe = "\r\033[K";

bool standard_error_is_terminal() {
  const char* kind = std::getenv("TERM");
  return isatty(STDERR_FILENO) == 1 && kind != nullptr && std::string_view(kind) != "dumb";
}

}  // namespace

ProgressBar::ProgressBar() : terminal_(standard_error_is_terminal()), next_drawing_(Clock::now() + kPatience) {}

ProgressBar::~ProgressBar() {
  if (drawn_) std::cerr << kWipe << std::flush;
}

Control ProgressBar::control() {
  Control control;
  if (terminal_) control.progress = [this](double share) { report(share); };
  return control;
}

void ProgressBar::report(double share) {
  const auto now = Clock::now();
  if (now < next_drawing_) return;
  next_drawing_ = now + kInterval;
  drawn_ = true;
  constexpr std::size_t kCells = 40;
  const auto done = static_cast<std::size_t>(share * static_cast<double>(kCells));
  const std::string bar = std::string(done, '#') + std::string(kCells - done, '.');
  const std::string percent = pad_left(std::to_string(static_cast<int>(share * 100.0)), 3);
  std::cerr << std::string(kWipe) + "  [" + bar + "] " + percent + " %" << std::flush;
}

Control part_of(const Control& control, double from, double to) {
  Control part{control.stop, {}};
  if (control.progress) {
    part.progress = [&control, from, to](double done) { control.progress(from + (to - from) * done); };
  }
  return part;
}

}  // namespace welkin::tool
