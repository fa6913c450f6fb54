// Calls that do the same to many things: their errors say which it was.
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <limits>
#include <mutex>
#include <string>

#include "welkin/core.h"

namespace welkin::jobs {

/// Calls `work`, and has what it throws say which probe it was. (A cancelled call says so alone.)
template <class Work>
auto naming_probe(std::size_t probe, const Work& work) {
  try {
    return work();
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled) throw;
    throw Error(error.code(), "probe " + std::to_string(probe) + ": " + error.what());
  }
}

/// The error of the first probe whose pixels are rejected: which one a call reports must not depend on threads.
class FirstRejection {
 public:
  /// Calls `work` for a probe, unless one before it was rejected: then it cannot change how the call ends. Keeps the
  /// error if that rejects a pixel; throws all others.
  template <class Work>
  void guard(std::size_t probe, const Work& work) {
    if (probe > first_.load(std::memory_order_relaxed)) return;
    try {
      naming_probe(probe, work);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::rejected_pixel) throw;
      const std::scoped_lock lock(mutex_);
      if (probe >= first_) return;
      first_ = probe;
      error_ = std::current_exception();
    }
  }

  /// After all calls of `guard`.
  void throw_if_any() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::mutex mutex_;
  std::atomic<std::size_t> first_{std::numeric_limits<std::size_t>::max()};
  std::exception_ptr error_;
};

}  // namespace welkin::jobs
