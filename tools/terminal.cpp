#include "tools/terminal.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <iostream>
#include <sstream>
#include <string_view>
#include <system_error>
#include <thread>

#include "tools/text.h"
#include "welkin/core.h"

namespace welkin::tool {
namespace {

constexpr auto kPatience = std::chrono::milliseconds(300);  // work that is over by then shows nothing
constexpr auto kInterval = std::chrono::milliseconds(50);
constexpr std::string_view kWipe = "\r\033[K";

bool is_terminal(Stream stream) {
  const char* kind = std::getenv("TERM");
  return isatty(stream == Stream::output ? STDOUT_FILENO : STDERR_FILENO) == 1 && kind != nullptr &&
         std::string_view(kind) != "dumb";
}

bool shows_colours(Stream stream) {
  const char* none = std::getenv("NO_COLOR");
  return is_terminal(stream) && (none == nullptr || *none == '\0');
}

Verbosity wanted_verbosity = Verbosity::normal;

/// What the process is at.
struct Stage {
  std::string name;
  std::chrono::steady_clock::time_point start;
};

Stage& current_stage() {
  static Stage stage;
  return stage;
}

/// Of the stage that is over.
void tell_stage() {
  const Stage& stage = current_stage();
  if (verbosity() != Verbosity::verbose || stage.name.empty()) return;
  using Milliseconds = std::chrono::duration<double, std::milli>;
  std::cerr << stage.name + ": " + duration(Milliseconds(std::chrono::steady_clock::now() - stage.start).count()) + '\n'
            << std::flush;
}

std::atomic<int> caught{0};
std::array<int, 2> signal_pipe{-1, -1};  // a handler may write to one, and do little else

extern "C" void note_signal(int number) {
  const int before = errno;
  int none = 0;
  if (!caught.compare_exchange_strong(none, number)) {
    std::signal(number, SIG_DFL);  // whoever asks twice does not want to wait
    static_cast<void>(std::raise(number));
  }
  const char byte = 0;
  static_cast<void>(write(signal_pipe[1], &byte, 1) == 1);
  errno = before;
}

/// A file has outgrown its limit: the write fails, which stops the work with an error that names the file.
extern "C" void note_file_limit(int number) {
  int none = 0;
  caught.compare_exchange_strong(none, number);
}

/// Hands on to the stop source what a handler may not touch.
void watch_pipe(std::stop_source source) {
  char byte = 0;
  while (read(signal_pipe[0], &byte, 1) < 0 && errno == EINTR) {
  }
  source.request_stop();
}

/// Where there is no thread or pipe to watch, signals end the program as ever.
void watch_signals(const std::stop_source& source) {
  struct sigaction limited {};
  limited.sa_handler = note_file_limit;
  sigaction(SIGXFSZ, &limited, nullptr);
  if (pipe2(signal_pipe.data(), O_CLOEXEC) != 0) return;
  try {
    std::thread(watch_pipe, source).detach();
  } catch (const std::system_error&) {
    return;
  }
  struct sigaction noted {};
  noted.sa_handler = note_signal;
  noted.sa_flags = SA_RESTART;
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    if (sigaction(number, nullptr, &before) == 0 && before.sa_handler != SIG_IGN) sigaction(number, &noted, nullptr);
  }
}

/// Empty where the system does not say.
std::filesystem::path own_folder() {
  std::error_code unknown;
  return std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path();
}

}  // namespace

std::stop_token stop_on_signals() {
  static const auto& source = *[] {
    auto* const made = new std::stop_source;  // never destroyed: the watching thread outlives main
    watch_signals(*made);
    return made;
  }();
  return source.get_token();
}

int caught_signal() noexcept { return caught; }

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
  if (!std::cout) throw Error(ErrorCode::file_access, "standard output: cannot be written");
}

void reserve_standard_streams() noexcept {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) >= 0) continue;
    // It gets the lowest number that is free, which is this one.
    static_cast<void>(open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY));
  }
}

namespace {

/// Until there is something to read, or nothing will come any more. A signal would not end a read that waits: who
/// handles it goes on reading.
void wait_for_bytes(int descriptor) {
  constexpr int kPatienceMilliseconds = 50;
  pollfd waited{descriptor, POLLIN, 0};
  do {
    if (stop_on_signals().stop_requested()) throw Error(ErrorCode::cancelled, "stopped by a signal");
  } while (poll(&waited, 1, kPatienceMilliseconds) <= 0);
}

/// Closed where it was opened.
class PipeEnd {
 public:
  /// Opening waits for nobody to write; reading does.
  explicit PipeEnd(const std::optional<std::string>& name)
      : named_(name), descriptor_(name ? open(name->c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK) : STDIN_FILENO) {}
  ~PipeEnd() {
    if (named_ && descriptor_ >= 0) close(descriptor_);
  }
  PipeEnd(const PipeEnd&) = delete;
  PipeEnd& operator=(const PipeEnd&) = delete;

  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }

 private:
  bool named_;
  int descriptor_;
};

}  // namespace

std::vector<std::byte> read_to_end(const std::optional<std::string>& pipe, std::uint64_t most) {
  const std::string name = pipe.value_or("standard input");
  const auto fail = [&name] {
    throw Error(ErrorCode::file_access, name + ": cannot be read (" + std::strerror(errno) + ")");
  };
  const PipeEnd end(pipe);
  if (end.descriptor() < 0) fail();
  std::vector<std::byte> bytes;
  constexpr std::size_t kBlock = std::size_t{1} << 20U;
  for (ssize_t count = 1; count != 0;) {
    wait_for_bytes(end.descriptor());
    const std::size_t before = bytes.size();
    bytes.resize(before + kBlock);
    count = read(end.descriptor(), bytes.data() + before, kBlock);
    if (count < 0 && errno != EINTR && errno != EAGAIN) fail();
    bytes.resize(before + static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    if (bytes.size() > most) {
      throw Error(ErrorCode::limit_exceeded, name + ": has more than the " + std::to_string(most) +
                                                 " bytes that --memory-limit allows; raise it, or pass a file");
    }
  }
  return bytes;
}

void begin_stage(const std::string& name) {
  tell_stage();
  current_stage() = {name, std::chrono::steady_clock::now()};
}

ProgressBar::ProgressBar()
    : terminal_(is_terminal(Stream::error) && verbosity() != Verbosity::quiet),
      start_(Clock::now()),
      next_drawing_(start_ + kPatience) {}

ProgressBar::~ProgressBar() {
  if (drawn_) std::cerr << kWipe << std::flush;
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
  std::cerr << std::string(kWipe) + "  " + stage + '[' + bar + "] " + percent + " %" + time_left(share) << std::flush;
}

/// By the time that the share took; nothing as long as that says little.
std::string ProgressBar::time_left(double share) const {
  constexpr double kTelling = 0.02;
  if (share < kTelling) return "";
  const double seconds = std::chrono::duration<double>(Clock::now() - start_).count() * (1.0 - share) / share;
  const auto whole = static_cast<long>(std::ceil(seconds));
  constexpr long kMinute = 60;
  if (whole < kMinute) return "  " + std::to_string(whole) + " s left";
  return "  " + std::to_string(whole / kMinute) + " min " + std::to_string(whole % kMinute) + " s left";
}

Control part_of(const Control& control, double from, double to) {
  Control part{control.stop, {}};
  if (control.progress) {
    part.progress = [&control, from, to](double done) { control.progress(from + (to - from) * done); };
  }
  return part;
}

std::string reason_not_to_write_in(const std::filesystem::path& folder) {
  return access(folder.c_str(), W_OK | X_OK) == 0 ? "" : std::strerror(errno);
}

void become(const std::string& program, const std::vector<std::string>& arguments) {
  std::vector<std::string> copies = arguments;
  std::string name = program;
  std::vector<char*> words = {name.data()};
  for (std::string& word : copies) words.push_back(word.data());
  words.push_back(nullptr);
  const std::filesystem::path folder = own_folder();
  if (!folder.empty()) execv((folder / program).c_str(), words.data());
  const int beside = errno;
  if (folder.empty() || beside == ENOENT) execvp(program.c_str(), words.data());
  const int reason = errno;
  throw Error(ErrorCode::file_access,
              program + ": cannot be run (" + std::strerror(reason) +
                  "); it is a program of its own, which belongs beside " +
                  (folder.empty() ? "welkin" : (folder / "welkin").string()) +
                  " or on the PATH: build the target welkin_report_command, or start 'scripts/welkin report'");
}

}  // namespace welkin::tool
