#include "tools/batch_progress.h"

#include <cmath>
#include <iostream>

#include "tools/terminal.h"
#include "tools/text.h"

namespace welkin::tool {
namespace {

constexpr auto kInterval = std::chrono::milliseconds(100);

}  // namespace

BatchProgress::BatchProgress(std::size_t jobs, double seconds)
    : terminal_(is_terminal(Stream::error) && verbosity() != Verbosity::quiet),
      jobs_(jobs),
      seconds_(seconds),
      start_(Clock::now()),
      next_drawing_(start_ + kInterval) {}

BatchProgress::~BatchProgress() {
  if (drawn_) std::cerr << kWipeLine << std::flush;
}

void BatchProgress::add(double seconds, bool failed) {
  const std::scoped_lock lock(mutex_);
  ++done_;
  failed_ += failed ? 1 : 0;
  seconds_done_ += seconds;
  // What was there need not be done: it is no work that this run could be measured by.
  draw();
}

std::string BatchProgress::line() const {
  const double passed = std::chrono::duration<double>(Clock::now() - start_).count();
  std::string text = std::to_string(done_) + " of " + counted(jobs_, "file");
  if (failed_ > 0) text += ", " + std::to_string(failed_) + " failed";
  if (done_ == 0 || passed <= 0.0) return text;
  text += ", " + significant(static_cast<double>(done_) / passed, 3) + " a second";
  const double share =
      seconds_ > 0.0 ? seconds_done_ / seconds_ : static_cast<double>(done_) / static_cast<double>(jobs_);
  constexpr double kTelling = 0.01;
  if (share >= kTelling && done_ < jobs_) text += ", " + long_duration(passed * (1.0 - share) / share) + " left";
  return text;
}

void BatchProgress::draw() {
  const auto now = Clock::now();
  if (!terminal_ || now < next_drawing_) return;
  next_drawing_ = now + kInterval;
  drawn_ = true;
  std::cerr << std::string(kWipeLine) + "  " + line() << std::flush;
}

std::string long_duration(double seconds) {
  constexpr long kMinute = 60;
  constexpr long kHour = 60 * kMinute;
  const auto whole = static_cast<long>(std::ceil(seconds));
  if (whole < kMinute) return std::to_string(whole) + " s";
  if (whole < kHour) return std::to_string(whole / kMinute) + " min " + std::to_string(whole % kMinute) + " s";
  return std::to_string(whole / kHour) + " h " + std::to_string(whole % kHour / kMinute) + " min";
}

}  // namespace welkin::tool
