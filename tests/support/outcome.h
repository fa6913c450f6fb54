// What became of a future, in words; and waiting that ends.
#pragma once

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <future>
#include <new>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>

#include "welkin/core.h"
#include "welkin/worker.h"

namespace welkin::test {

/// Far beyond anything that a test waits for, sanitizers and a busy machine included.
inline constexpr std::chrono::seconds kPatience{120};

/// Waits until `condition()` holds; false if it never does.
template <class Condition>
bool eventually(const Condition& condition) {
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  return true;
}

/// Nobody can unwind a hang: other threads use what this one's stack owns. The program ends, and Catch2 says where.
[[noreturn]] inline void give_up(const char* what) {
  std::fprintf(stderr, "hangs: %s\n", what);
  std::abort();
}

/// What the future gives, or throws.
template <class Result>
Result take(std::future<Result> future) {
  if (future.wait_for(kPatience) != std::future_status::ready) give_up("a future");
  return future.get();
}

/// "result", the name of an Error's code, "bad_alloc", "broken promise", or what another exception says.
template <class Call>
std::string outcome_of(const Call& call) {
  try {
    call();
    return "result";
  } catch (const Error& error) {
    return name(error.code());
  } catch (const std::bad_alloc&) {
    return "bad_alloc";
  } catch (const std::future_error& error) {
    return error.code() == std::future_errc::broken_promise ? "broken promise" : error.what();
  } catch (const std::exception& exception) {
    return exception.what();
  } catch (...) {
    return "something";
  }
}

template <class Result>
std::string outcome(std::future<Result> future) {
  return outcome_of([&] { static_cast<void>(take(std::move(future))); });
}

/// What the job gives, or throws.
template <class Result>
Result take(Job<Result>& job) {
  if (job.valid() && !eventually([&] { return job.ready(); })) give_up("a job");
  return job.get();
}
template <class Result>
Result take(Job<Result>&& job) {
  return take(job);
}

template <class Result>
std::string outcome(Job<Result>& job) {
  return outcome_of([&] { static_cast<void>(take(job)); });
}
template <class Result>
std::string outcome(Job<Result>&& job) {
  return outcome(job);
}

}  // namespace welkin::test
