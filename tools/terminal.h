// The terminal and the process of the command: all its direct requests to the operating system.
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

/// Returns a token that requests a stop after Ctrl-C, or after the signals SIGTERM and SIGHUP, unless the program was
/// started with them ignored. A second signal ends it at once. From the first call on, writing beyond the limit on a
/// file's size is an error and no signal.
[[nodiscard]] stop_token stop_on_signals();

/// Returns the signal that was caught; 0: none. Windows: Ctrl-C is SIGINT, and so is Ctrl-Break; SIGTERM means that the
/// window is closed, the user logs off or the system shuts down.
[[nodiscard]] int caught_signal() noexcept;

/// Returns a signal's name for people: "Interrupt".
[[nodiscard]] std::string signal_words(int number);

/// Returns the words after the program's name, in UTF-8. `count`, `words`: those of `main`.
[[nodiscard]] std::vector<std::string> program_arguments(int count, char** words);

/// How much the command prints in addition to its results.
enum class Verbosity { quiet, normal, verbose };
void set_verbosity(Verbosity verbosity) noexcept;
[[nodiscard]] Verbosity verbosity() noexcept;

enum class Stream { output, error };
enum class Style { heading, error, note };

/// Returns whether the stream is a terminal that understands control sequences (ECMA-48), such as colours.
[[nodiscard]] bool is_terminal(Stream stream);

/// Clears the terminal's line, and returns to its beginning.
inline constexpr const char* kWipeLine = "\r\033[K";

/// Returns the text in the style's colour if the stream is a terminal that shows colours, and NO_COLOR is not set
/// (`no-color.org`); else the text.
[[nodiscard]] std::string styled(const std::string& text, Style style, Stream stream);

/// Prints information about work whose result is elsewhere, such as the written files, like `print_result`; nothing if
/// the command is quiet.
void print_summary(const std::string& text);

/// Writes a finished result to standard output in one piece: after an error there is nothing that could be mistaken for
/// a result. Throws `Error` (file_access) if it cannot be written (a full disk, say).
void print_result(const std::string& text);

using jobs::part_of;

/// Assigns /dev/null to the descriptors of standard input, output and error that the caller has closed, so that no file
/// that is opened gets them and is written into. Reading and writing them fails as before. On Windows the streams get
/// the properties of other systems: bytes as written, and a terminal that takes UTF-8 and colours.
void reserve_standard_streams() noexcept;

/// The reading end of a named pipe, which the destructor closes; without a name standard input, which stays open.
class PipeEnd {
 public:
  /// Opens without waiting for a writer; reading waits. Throws `Error` (file_access).
  explicit PipeEnd(const std::optional<std::string>& pipe);
  ~PipeEnd();
  PipeEnd(const PipeEnd&) = delete;
  PipeEnd& operator=(const PipeEnd&) = delete;

  /// Waits for bytes, and returns the number read; 0: there will be no more. Throws `Error`: cancelled by a signal;
  /// file_access.
  [[nodiscard]] std::size_t read(std::span<std::byte> bytes);

 private:
  std::optional<std::string> pipe_;
  std::intptr_t file_ = 0;  ///< a descriptor, or a handle of Windows
};

/// Returns all bytes of a pipe. Throws `Error`: limit_exceeded beyond `most` bytes, and the errors of `PipeEnd`.
[[nodiscard]] std::vector<std::byte> read_to_end(const std::optional<std::string>& pipe, std::uint64_t most);

/// Begins a stage of the whole process, such as "prefilter": the progress bar shows it, and with --verbose a line on
/// standard error reports the duration of each stage.
void begin_stage(const std::string& name);

/// During its lifetime, stages are not reported and progress does not name them, because several run concurrently.
class WithoutStages {
 public:
  WithoutStages() noexcept;
  ~WithoutStages();
  WithoutStages(const WithoutStages&) = delete;
  WithoutStages& operator=(const WithoutStages&) = delete;
};

/// Returns this machine's name on the network; "" if it has none.
[[nodiscard]] std::string host_name();

/// "bake  [####......]  42 %  3 s left". Draws to standard error, and only if that is a terminal, the command is not
/// quiet and the work has taken longer than a moment. Its destructor clears it, so that neither results nor error
/// messages share a line with it. At most one exists at a time.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Returns the control for the call whose progress is shown; must not outlive the bar.
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

/// Returns the reason why files cannot be made in an existing folder; empty: they can.
[[nodiscard]] std::string reason_not_to_write_in(const std::filesystem::path& folder);

/// Returns the folder of this program's file; empty if the system does not provide it.
[[nodiscard]] std::filesystem::path own_folder();

/// Replaces this process by another program of Welkin: the file of that name next to this program's own, or else on the
/// PATH. Returns only by throwing: `Error` (file_access) if there is none or it cannot be run.
[[noreturn]] void become(const std::string& program, const std::vector<std::string>& arguments);

}  // namespace welkin::tool
