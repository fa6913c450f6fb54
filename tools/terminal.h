// The terminal and the process that the command runs in: all that it asks of the operating system by itself.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "jobs/control.h"
#include "welkin/core.h"

namespace welkin::tool {

/// A token that asks work to stop once somebody wants the program to end: by Ctrl-C, or by the signals SIGTERM and
/// SIGHUP, unless the program was started with them ignored. A second signal ends it at once. From the first call on,
/// writing beyond the limit on a file's size is an error and no signal.
[[nodiscard]] stop_token stop_on_signals();

/// The signal that came; 0: none has. Windows: Ctrl-C is SIGINT, and so is Ctrl-Break; SIGTERM that the window is
/// closed, the user logs off or the system shuts down.
[[nodiscard]] int caught_signal() noexcept;

/// What a person calls a signal: "Interrupt".
[[nodiscard]] std::string signal_words(int number);

/// What follows the program's name, in UTF-8. `count`, `words`: as `main` has them.
[[nodiscard]] std::vector<std::string> program_arguments(int count, char** words);

/// How much the command says beside its results.
enum class Verbosity { quiet, normal, verbose };
void set_verbosity(Verbosity verbosity) noexcept;
[[nodiscard]] Verbosity verbosity() noexcept;

enum class Stream { output, error };
enum class Style { heading, error, note };

/// Whether the stream is a terminal, and one that understands colours and the like (ECMA-48).
[[nodiscard]] bool is_terminal(Stream stream);

/// Takes away what stands in the terminal's line, and goes back to its beginning.
inline constexpr const char* kWipeLine = "\r\033[K";

/// The text in the style's colour where the stream is a terminal that shows colours, and NO_COLOR is not set
/// (no-color.org); else the text.
[[nodiscard]] std::string styled(const std::string& text, Style style, Stream stream);

/// Writes what a person may want to know of work whose result lies elsewhere, such as the files that were written, as
/// `print_result` does; nothing if the command is to be quiet.
void print_summary(const std::string& text);

/// Writes a finished result to standard output in one piece: after an error nothing is there that could be
/// taken for a result. Throws `Error` (file_access) if it cannot be written (a full disk, say).
void print_result(const std::string& text);

using jobs::part_of;

/// Gives /dev/null the numbers of standard input, output and error where the caller has closed them, so that no file
/// that is opened gets them and is written into. Reading and writing them fails as before. On Windows the streams get
/// what other systems' have: bytes as they are written, and a terminal that takes UTF-8 and colours.
void reserve_standard_streams() noexcept;

/// The end of a pipe that is read, by its name; standard input without one. Closed where it was opened.
class PipeEnd {
 public:
  /// Opening waits for nobody to write; reading does. Throws `Error` (file_access).
  explicit PipeEnd(const std::optional<std::string>& pipe);
  ~PipeEnd();
  PipeEnd(const PipeEnd&) = delete;
  PipeEnd& operator=(const PipeEnd&) = delete;

  /// Waits for bytes, and returns how many of them it has read; 0: there will be no more. Throws `Error`: cancelled by
  /// a signal; file_access.
  [[nodiscard]] std::size_t read(std::span<std::byte> bytes);

 private:
  std::optional<std::string> pipe_;
  std::intptr_t file_ = 0;  ///< a descriptor, or Windows' handle
};

/// All that comes out of it. Throws `Error`: limit_exceeded if that is more than so many bytes, and as `PipeEnd`.
[[nodiscard]] std::vector<std::byte> read_to_end(const std::optional<std::string>& pipe, std::uint64_t most);

/// Says what the work of the whole process is at from now on, such as "prefilter": the progress bar shows it, and with
/// --verbose a line on standard error says how long each stage took.
void begin_stage(const std::string& name);

/// As long as it lives, stages are not told and progress does not name them: several are at work side by side.
class WithoutStages {
 public:
  WithoutStages() noexcept;
  ~WithoutStages();
  WithoutStages(const WithoutStages&) = delete;
  WithoutStages& operator=(const WithoutStages&) = delete;
};

/// The network's name of this machine; "" if it has none.
[[nodiscard]] std::string host_name();

/// "bake  [####......]  42 %  3 s left". Draws to standard error, and only if that is a terminal, the command is not to
/// be quiet and the work has taken longer than a moment. Its destructor wipes it away, so that neither results nor
/// error messages share a line with it. One at a time.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// For the call whose progress is to be shown; must not outlive the bar.
  [[nodiscard]] Control control();

 private:
  using Clock = std::chrono::steady_clock;

  void report(double share);
  [[nodiscard]] std::string time_left(double share) const;

  bool terminal_;
  Clock::time_point start_;
  Clock::time_point next_drawing_;
  bool drawn_ = false;
};

/// Why files cannot be made in a folder that is there; empty: they can.
[[nodiscard]] std::string reason_not_to_write_in(const std::filesystem::path& folder);

/// Returns the folder of this program's file; empty where the system does not say.
[[nodiscard]] std::filesystem::path own_folder();

/// Runs another program of Welkin's in the place of this one: the file of that name beside this program's own, or else
/// on the PATH. Returns only by throwing: `Error` (file_access) if there is none or it cannot be run.
[[noreturn]] void become(const std::string& program, const std::vector<std::string>& arguments);

}  // namespace welkin::tool
