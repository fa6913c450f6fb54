// The process and its terminal on POSIX.
#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <string_view>
#include <system_error>
#include <thread>

#include "tools/terminal.h"
#include "welkin/core.h"

namespace welkin::tool {

bool is_terminal(Stream stream) {
  const char* kind = std::getenv("TERM");
  return isatty(stream == Stream::output ? STDOUT_FILENO : STDERR_FILENO) == 1 && kind != nullptr &&
         std::string_view(kind) != "dumb";
}

namespace {

std::atomic<int> caught{0};
std::array<int, 2> signal_pipe{-1, -1};  // a handler may write to a pipe, and do little else

extern "C" void note_signal(int number) {
  const int before = errno;
  int none = 0;
  if (!caught.compare_exchange_strong(none, number)) {
    std::signal(number, SIG_DFL);  // a second signal does not wait
    static_cast<void>(std::raise(number));
  }
  const char byte = 0;
  static_cast<void>(write(signal_pipe[1], &byte, 1) == 1);
  errno = before;
}

/// Notes that a file exceeded its limit: the write fails, which stops the work with an error that names the file.
extern "C" void note_file_limit(int number) {
  int none = 0;
  caught.compare_exchange_strong(none, number);
}

/// Passes a signal on to the stop source, which a handler may not touch.
void watch_pipe(stop_source source) {
  char byte = 0;
  while (read(signal_pipe[0], &byte, 1) < 0 && errno == EINTR) {
  }
  source.request_stop();
}

/// Watches signals; without a thread or a pipe for that, signals end the program as usual.
void watch_signals(const stop_source& source) {
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

}  // namespace

std::filesystem::path own_folder() {
  std::error_code unknown;
  return std::filesystem::read_symlink("/proc/self/exe", unknown).parent_path();
}

stop_token stop_on_signals() {
  static const auto& source = *[] {
    auto* const made = new stop_source;  // never destroyed: the watching thread outlives main
    watch_signals(*made);
    return made;
  }();
  return source.get_token();
}

int caught_signal() noexcept { return caught; }

std::string signal_words(int number) { return strsignal(number); }

std::vector<std::string> program_arguments(int count, char** words) { return {words + 1, words + count}; }

void reserve_standard_streams() noexcept {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) >= 0) continue;
    // It gets the lowest free number, which is this one.
    static_cast<void>(open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY));
  }
}

namespace {

[[noreturn]] void fail_reading(const std::optional<std::string>& pipe) {
  throw Error(ErrorCode::file_access,
              pipe.value_or("standard input") + ": cannot be read (" + std::strerror(errno) + ")");
}

}  // namespace

PipeEnd::PipeEnd(const std::optional<std::string>& pipe)
    : pipe_(pipe), file_(pipe ? open(pipe->c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK) : STDIN_FILENO) {
  if (file_ < 0) fail_reading(pipe_);
}

PipeEnd::~PipeEnd() {
  if (pipe_) close(static_cast<int>(file_));
}

std::size_t PipeEnd::read(std::span<std::byte> bytes) {
  constexpr int kPatienceMilliseconds = 50;
  const auto descriptor = static_cast<int>(file_);
  pollfd waited{descriptor, POLLIN, 0};
  for (;;) {
    // A signal would not end a blocked read, which restarts after the handler.
    if (stop_on_signals().stop_requested()) throw Error(ErrorCode::cancelled, "stopped by a signal");
    if (poll(&waited, 1, kPatienceMilliseconds) <= 0) continue;
    const ssize_t count = ::read(descriptor, bytes.data(), bytes.size());
    if (count >= 0) return static_cast<std::size_t>(count);
    if (errno != EINTR && errno != EAGAIN) fail_reading(pipe_);
  }
}

std::string host_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
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
  const int first_reason = errno;
  if (folder.empty() || first_reason == ENOENT) execvp(program.c_str(), words.data());
  const int reason = errno;
  throw Error(ErrorCode::file_access,
              program + ": cannot be run (" + std::strerror(reason) +
                  "); it is a separate program, which belongs next to " +
                  (folder.empty() ? "welkin" : (folder / "welkin").string()) +
                  " or on the PATH: build the target welkin_report_command, or start 'scripts/welkin report'");
}

}  // namespace welkin::tool
