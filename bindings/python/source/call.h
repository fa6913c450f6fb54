// A call of the library: without the interpreter's lock, with progress, and stopped by Ctrl-C.
//
//   Call call("prefilter", options);
//   options.finish();
//   return call.run([&](const Control& control) { return prefilter_specular(view, how, control); });
#pragma once

#include <pybind11/pybind11.h>

#include <chrono>
#include <cstddef>
#include <optional>
#include <thread>
#include <type_traits>

#include "options.h"
#include "welkin/core.h"

namespace welkin::python {

namespace py = pybind11;

/// Gives up the interpreter's lock for a loop over many directions or numbers; for few, that would cost more than it
/// gives.
class LockReleased {
 public:
  explicit LockReleased(std::size_t count) {
    if (count >= kMany) released_.emplace();
  }

 private:
  static constexpr std::size_t kMany = 256;
  std::optional<py::gil_scoped_release> released_;
};

/// The library reports progress from whichever thread finished a tile. Only the thread that called from Python takes
/// the interpreter's lock then, no more often than every `kPause`: it lets Python handle signals, which on the main
/// thread is where KeyboardInterrupt comes from, and calls the caller's function. What either raises stops the work,
/// and is raised once nothing of it runs any more.
class Call {
 public:
  /// Takes `progress` (None, True or a function of the share) and `threads` (0: all) from the options.
  Call(const char* name, Options& options);
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;
  ~Call();

  /// `work(control)` without the interpreter's lock.
  template <class Work>
  std::invoke_result_t<Work&, const Control&> run(Work work) {
    using Result = std::invoke_result_t<Work&, const Control&>;
    begin();
    try {
      if constexpr (std::is_void_v<Result>) {
        released(work);
        end();
      } else {
        Result result = released(work);
        end();
        return result;
      }
    } catch (const Error&) {
      throw_what_was_raised();
      throw;
    }
  }

 private:
  static constexpr std::chrono::milliseconds kPause{50};

  template <class Work>
  std::invoke_result_t<Work&, const Control&> released(Work& work) {
    using Result = std::invoke_result_t<Work&, const Control&>;
    const Control control{stop_.get_token(), [this](double share) { report(share); }};
    const py::gil_scoped_release released;
    if (!threads_) return work(control);
    if constexpr (std::is_void_v<Result>) {
      run_with_threads(*threads_, [&] { work(control); });
    } else {
      std::optional<Result> result;
      run_with_threads(*threads_, [&] { result.emplace(work(control)); });
      return std::move(*result);
    }
  }

  void begin();
  void report(double share);
  void end();
  void throw_what_was_raised();

  const char* name_;
  py::object progress_;  ///< null: none is wanted
  std::optional<int> threads_;
  welkin::stop_source stop_;
  std::thread::id caller_;
  std::chrono::steady_clock::time_point next_;
  std::optional<py::error_already_set> raised_;
};

}  // namespace welkin::python
