// A coroutine that nobody waits for: it starts at once and frees itself at its end.
#pragma once

#include <atomic>
#include <coroutine>
#include <exception>

namespace welkin::test {

struct Detached {
  /// How many have begun and not ended. A test that leaks one sees it here.
  inline static std::atomic<int> alive{0};

  // NOLINTBEGIN(readability-convert-member-functions-to-static): the names are the language's
  struct promise_type {
    promise_type() { ++alive; }
    ~promise_type() { --alive; }
    promise_type(const promise_type&) = delete;
    promise_type& operator=(const promise_type&) = delete;

    Detached get_return_object() noexcept { return {}; }
    std::suspend_never initial_suspend() noexcept { return {}; }
    std::suspend_never final_suspend() noexcept { return {}; }
    void return_void() noexcept {}
    void unhandled_exception() noexcept { std::terminate(); }
  };
  // NOLINTEND(readability-convert-member-functions-to-static)
};

}  // namespace welkin::test
