#include "tools/terminal.h"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <iostream>
#include <sstream>
#include <string_view>

#include "tools/text.h"
#include "welkin/core.h"

namespace welkin::tool {
namespace {

constexpr auto kPatience = std::chrono::milliseconds(300);  // shorter work shows nothing
constexpr auto kInterval = std::chrono::milliseconds(50);

bool shows_colours(Stream stream) {
  const char* none = std::getenv("NO_COLOR");
  return is_terminal(stream) && (none == nullptr || *none == '\0');
}

Verbosity wanted_verbosity = Verbosity::normal;

/// The current work of the process.
struct Stage {
  std::string name;
  std::chrono::steady_clock::time_point start;
};

std::atomic<bool> has_stages{true};

Stage& current_stage() {
  static Stage stage;
  return stage;
}

/// Prints the name and duration of the finished stage.
void tell_stage() {
  const Stage& stage = current_stage();
  if (verbosity() != Verbosity::verbose || stage.name.empty()) return;
  using Milliseconds = std::chrono::duration<double, std::milli>;
  std::cerr << stage.name + ": " + duration(Milliseconds(std::chrono::steady_clock::now() - stage.start).count()) + '\n'
            << std::flush;
}

}  // namespace

void set_verbosity(Verbosity verbosity) noexcept { wanted_verbosity = verbosity; }

Verbosity verbosity() noexcept { return wanted_verbosity; }

std::string styled(const std::string& text, Style style, Stream stream) {
  if (!shows_colours(stream)) return text;
  const char* const code = style == Style::error ? "1;31" : style == Style::note ? "33" : "1";  // ECMA-48, 8.3.117
  return std::string("\033[") + code + 'm' + text + "\033[0m";
}

void print_summary(const std::string& text) {
  if (verbosity() == Verbosity::quiet) return;
  std::istringstream lines(text);
  std::string shown;
  for (std::string line; std::getline(lines, line);) {
    constexpr std::string_view kNote = "note:";
    const bool note = line.starts_with(kNote);
    shown += note ? styled(std::string(kNote), Style::note, Stream::output) + line.substr(kNote.size()) : line;
    shown += '\n';
  }
  print_result(shown);
}

void print_result(const std::string& text) {
  std::cout << text << std::flush;
  if (!std::cout) throw Error(ErrorCode::file_access, "standard output: cannot be written; is the disk full?");
}

std::vector<std::byte> read_to_end(const std::optional<std::string>& pipe, std::uint64_t most) {
  PipeEnd end(pipe);
  std::vector<std::byte> bytes;
  std::vector<std::byte> block(std::size_t{1} << 20U);
  while (const std::size_t count = end.read(block)) {
    bytes.insert(bytes.end(), block.data(), block.data() + count);
    if (bytes.size() <= most) continue;
    throw Error(ErrorCode::limit_exceeded, pipe.value_or("standard input") + ": has more than the " +
                                               std::to_string(most) +
                                               " bytes that --memory-limit allows; raise it, or pass a file");
  }
  return bytes;
}

WithoutStages::WithoutStages() noexcept { has_stages = false; }
WithoutStages::~WithoutStages() { has_stages = true; }

void begin_stage(const std::string& name) {
  if (!has_stages) return;
  tell_stage();
  current_stage() = {name, std::chrono::steady_clock::now()};
}

ProgressBar::ProgressBar()
    : terminal_(is_terminal(Stream::error) && verbosity() != Verbosity::quiet),
      start_(Clock::now()),
      next_drawing_(start_ + kPatience) {}

ProgressBar::~ProgressBar() {
  if (drawn_) std::cerr << kWipeLine << std::flush;
  begin_stage("");
}

Control ProgressBar::control() {
  Control control;
  control.stop = stop_on_signals();
  if (terminal_) control.progress = [this](double share) { report(share); };
  return control;
}

void ProgressBar::report(double share) {
  const auto now = Clock::now();
  if (now < next_drawing_) return;
  next_drawing_ = now + kInterval;
  drawn_ = true;
  constexpr std::size_t kCells = 40;
  share = std::clamp(share, 0.0, 1.0);
  const auto done = static_cast<std::size_t>(share * static_cast<double>(kCells));
  const std::string bar = std::string(done, '#') + std::string(kCells - done, '.');
  const std::string percent = pad_left(std::to_string(static_cast<int>(share * 100.0)), 3);
  const std::string stage = current_stage().name.empty() ? "" : current_stage().name + "  ";
  std::cerr << std::string(kWipeLine) + "  " + stage + '[' + bar + "] " + percent + " %" + time_left(share)
            << std::flush;
}

/// Estimates from the time of the finished fraction; returns nothing while that is too small.
std::string ProgressBar::time_left(double share) const {
  constexpr double kTelling = 0.02;
  if (share < kTelling) return "";
  const double seconds = std::chrono::duration<double>(Clock::now() - start_).count() * (1.0 - share) / share;
  return "  " + long_duration(seconds) + " left";
}

}  // namespace welkin::tool
