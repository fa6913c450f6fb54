#include "tables/table_cache.h"

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include "support/catch.h"

namespace welkin::test {
namespace {

struct Table {
  std::size_t size;
  [[nodiscard]] std::size_t bytes() const { return size; }
};

std::shared_ptr<const Table> make(std::size_t size) { return std::make_shared<const Table>(Table{size}); }

}  // namespace

TEST_CASE("Threads that want the same table build it once", "[tables]") {
  tables::TableCache<int, Table> cache(1000);
  std::atomic<int> built{0};
  std::vector<std::thread> threads;
  for (int k = 0; k < 8; ++k) {
    threads.emplace_back([&] {
      for (int key = 0; key < 5; ++key) {
        const auto table = cache.get(key, [&] {
          ++built;
          std::this_thread::sleep_for(std::chrono::milliseconds(2));
          return make(10);
        });
        if (table->size != 10) built = 1000;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(built == 5);
}

TEST_CASE("What is looked for is found if it is there, and counts as used", "[tables]") {
  tables::TableCache<int, Table> cache(100);
  CHECK(cache.find(1) == nullptr);
  const auto first = cache.get(1, [&] {
    CHECK(cache.find(1) == nullptr);  // not yet, and nobody waits
    return make(40);
  });
  cache.get(2, [] { return make(40); });
  CHECK(cache.find(1) == first);  // now 2 is the oldest
  cache.get(3, [] { return make(40); });
  CHECK(cache.find(2) == nullptr);
  CHECK(cache.find(1) == first);
}

TEST_CASE("The least recently used tables go when the bound is reached", "[tables]") {
  tables::TableCache<int, Table> cache(100);
  int built = 0;
  const auto get = [&](int key) {
    return cache.get(key, [&] {
      ++built;
      return make(40);
    });
  };
  const auto held = get(1);
  get(2);
  CHECK(cache.bytes() == 80);
  get(1);  // now 2 is the oldest
  get(3);  // 120 bytes: 2 goes
  CHECK(cache.bytes() == 80);
  get(1);
  CHECK(built == 3);
  get(2);
  CHECK(built == 4);
  CHECK(held->size == 40);  // whoever holds a table keeps it
}

TEST_CASE("A table larger than the bound is handed out and not kept", "[tables]") {
  tables::TableCache<int, Table> cache(100);
  CHECK(cache.get(1, [] { return make(500); })->size == 500);
  CHECK(cache.bytes() == 0);
}

TEST_CASE("A failed build is tried again", "[tables]") {
  tables::TableCache<int, Table> cache(100);
  CHECK_THROWS_AS(cache.get(1, []() -> std::shared_ptr<const Table> { throw std::runtime_error("no memory"); }),
                  std::runtime_error);
  CHECK(cache.get(1, [] { return make(7); })->size == 7);
}

}  // namespace welkin::test
