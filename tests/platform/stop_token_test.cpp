// Promise: Welkin's stop token, for standard libraries without one, behaves as std::stop_token does.
#include "support/catch.h"
#include "welkin/detail/standard_library.h"

namespace welkin::test {
namespace {

namespace standard = detail::standard;

/// The names of either implementation, so that both are tested.
struct Own {
  using Source = standard::stop_source;
  using Token = standard::stop_token;
  template <class Function>
  using Callback = standard::stop_callback<Function>;
  static Source without_state() { return Source(standard::nostopstate); }
};
#ifdef __MINGW32__
using Standard = Own;  // callbacks of the standard library may hang there
#else
struct Standard {
  using Source = std::stop_source;
  using Token = std::stop_token;
  template <class Function>
  using Callback = std::stop_callback<Function>;
  static Source without_state() { return Source(std::nostopstate); }
};
#endif

}  // namespace

TEMPLATE_TEST_CASE("A stop is requested once and seen by all tokens", "[platform]", Own, Standard) {
  typename TestType::Source source;
  const typename TestType::Token token = source.get_token();
  const typename TestType::Token copy = token;
  CHECK(token.stop_possible());
  CHECK_FALSE(token.stop_requested());
  CHECK(source.request_stop());
  CHECK_FALSE(source.request_stop());
  CHECK(token.stop_requested());
  CHECK(copy.stop_requested());
  CHECK(copy == token);
  CHECK_FALSE(typename TestType::Token() == token);
}

TEMPLATE_TEST_CASE("Without a source nothing can stop any more", "[platform]", Own, Standard) {
  auto source = std::make_optional<typename TestType::Source>();
  auto second = std::make_optional(*source);
  const typename TestType::Token token = source->get_token();
  source.reset();
  CHECK(token.stop_possible());
  auto third = std::make_optional(std::move(*second));
  second.reset();
  CHECK(token.stop_possible());
  third.reset();
  CHECK_FALSE(token.stop_possible());
  const typename TestType::Source none = TestType::without_state();
  CHECK_FALSE(none.stop_possible());
  CHECK_FALSE(none.get_token().stop_possible());
  CHECK_FALSE(typename TestType::Token().stop_possible());
}

TEST_CASE("A source of our own that another is assigned to stops nothing more", "[platform]") {
  Own::Source source;
  const Own::Token token = source.get_token();
  source = Own::without_state();  // libstdc++ 12 still counts the old one here
  CHECK_FALSE(token.stop_possible());
  CHECK_FALSE(source.request_stop());
}

TEMPLATE_TEST_CASE("Callbacks are called once, at once if they come late, and not once they are gone", "[platform]",
                   Own, Standard) {
  using Function = std::function<void()>;
  using Callback = typename TestType::template Callback<Function>;
  typename TestType::Source source;
  int first = 0;
  int gone = 0;
  int last = 0;
  const Callback one(source.get_token(), [&] { ++first; });
  auto two = std::make_unique<Callback>(source.get_token(), [&] { ++gone; });
  const Callback three(source.get_token(), [&] { ++last; });
  two.reset();
  source.request_stop();
  source.request_stop();
  CHECK(first == 1);
  CHECK(gone == 0);
  CHECK(last == 1);
  int late = 0;
  const Callback four(source.get_token(), [&] { ++late; });
  CHECK(late == 1);
}

TEMPLATE_TEST_CASE("A callback may destroy itself and others", "[platform]", Own, Standard) {
  using Callback = typename TestType::template Callback<std::function<void()>>;
  typename TestType::Source source;
  int calls = 0;
  std::unique_ptr<Callback> one;
  std::unique_ptr<Callback> two;
  const auto destroy_both = [&] {
    ++calls;
    one.reset();
    two.reset();
  };
  one = std::make_unique<Callback>(source.get_token(), destroy_both);
  two = std::make_unique<Callback>(source.get_token(), destroy_both);
  source.request_stop();
  CHECK(calls == 1);
  CHECK_FALSE(one);
  CHECK_FALSE(two);
}

TEMPLATE_TEST_CASE("A callback that goes waits until its call in another thread has returned", "[platform]", Own,
                   Standard) {
  using Callback = typename TestType::template Callback<std::function<void()>>;
  for (int round = 0; round < 200; ++round) {
    typename TestType::Source source;
    std::atomic<int> state{0};
    auto callback = std::make_unique<Callback>(source.get_token(), [&] {
      state = 1;
      std::this_thread::yield();
      state = 2;
    });
    std::thread other([&] { source.request_stop(); });
    if (round % 2 == 0) {
      while (state == 0) std::this_thread::yield();
    }
    callback.reset();
    CHECK(state != 1);
    other.join();
  }
}

TEST_CASE("The heap as a memory resource of our own aligns what it gives", "[platform]") {
  detail::standard::memory_resource* const heap = detail::standard::get_default_resource();
  CHECK(*heap == *detail::standard::new_delete_resource());
  for (const std::size_t alignment : {std::size_t{16}, std::size_t{64}, std::size_t{4096}}) {
    void* const block = heap->allocate(100, alignment);
    CHECK(reinterpret_cast<std::uintptr_t>(block) % alignment == 0);
    heap->deallocate(block, 100, alignment);
  }
}

}  // namespace welkin::test
