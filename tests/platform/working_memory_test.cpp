// Working memory that stays between calls: what is kept, what is freed, and that nothing reads unwritten memory.
#include "platform/memory.h"
#include "support/catch.h"
#include "support/heap.h"
#include "support/process_threads.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/welkin.h"

namespace welkin::test {
namespace {

using platform::give_working_memory;
using platform::kept_working_memory;
using platform::take_working_memory;
using platform::WorkingMemory;

constexpr std::size_t kMebi = std::size_t{1} << 20U;

/// A resource on the heap that is not the process's default resource.
memory_resource* own_heap() {
  class Heap final : public memory_resource {
    void* do_allocate(std::size_t bytes, std::size_t alignment) override {
      return new_delete_resource()->allocate(bytes, alignment);
    }
    void do_deallocate(void* memory, std::size_t bytes, std::size_t alignment) override {
      new_delete_resource()->deallocate(memory, bytes, alignment);
    }
    [[nodiscard]] bool do_is_equal(const memory_resource& other) const noexcept override { return this == &other; }
  };
  static Heap heap;
  return &heap;
}

}  // namespace

TEST_CASE("A block that was given back serves the next call", "[platform][memory]") {
  const KeptMemory kept(64 * kMebi);
  const WorkingMemory block = take_working_memory(3 * kMebi);
  CHECK(block.bytes >= 3 * kMebi);
  CHECK(reinterpret_cast<std::uintptr_t>(block.data) % platform::kCacheLine == 0);
  give_working_memory(block);
  CHECK(kept_working_memory() == block.bytes);
  const WorkingMemory again = take_working_memory(3 * kMebi);
  CHECK(again.data == block.data);
  CHECK(kept_working_memory() == 0);
  const WorkingMemory other = take_working_memory(3 * kMebi);  // the first one is in use
  CHECK(other.data != again.data);
  give_working_memory(again);
  give_working_memory(other);
}

TEST_CASE("A block serves requests of half its size and more, the smallest one first", "[platform][memory]") {
  const KeptMemory kept(64 * kMebi);
  const WorkingMemory large = take_working_memory(16 * kMebi);
  const WorkingMemory medium = take_working_memory(10 * kMebi);
  give_working_memory(large);
  give_working_memory(medium);
  const WorkingMemory small = take_working_memory(4 * kMebi);  // both kept blocks are too large
  CHECK(small.data != large.data);
  CHECK(small.data != medium.data);
  CHECK(take_working_memory(9 * kMebi).data == medium.data);
  CHECK(take_working_memory(9 * kMebi).data == large.data);
  for (const WorkingMemory& block : {small, medium, large}) give_working_memory(block);
}

TEST_CASE("The oldest blocks are freed beyond the limit", "[platform][memory]") {
  const KeptMemory kept(12 * kMebi);
  const WorkingMemory first = take_working_memory(6 * kMebi);
  const WorkingMemory second = take_working_memory(6 * kMebi);
  const WorkingMemory third = take_working_memory(6 * kMebi);
  const WorkingMemory huge = take_working_memory(20 * kMebi);
  for (const WorkingMemory& block : {first, second, third}) give_working_memory(block);
  CHECK(kept_working_memory() == second.bytes + third.bytes);
  give_working_memory(huge);  // above the limit by itself: it evicts nothing
  CHECK(kept_working_memory() == second.bytes + third.bytes);
  keep_working_memory(7 * kMebi);
  CHECK(kept_working_memory() == third.bytes);
  welkin_keep_working_memory(0);
  CHECK(kept_working_memory() == 0);
  give_working_memory(take_working_memory(6 * kMebi));
  CHECK(kept_working_memory() == 0);
}

TEST_CASE("Memory that no call uses is freed when asked for", "[platform][memory]") {
  const KeptMemory kept(64 * kMebi);
  const WorkingMemory used = take_working_memory(2 * kMebi);
  give_working_memory(take_working_memory(4 * kMebi));
  CHECK(kept_working_memory() > 0);
  release_working_memory();
  CHECK(kept_working_memory() == 0);
  give_working_memory(used);
  CHECK(kept_working_memory() == used.bytes);
  welkin_release_working_memory();
  CHECK(kept_working_memory() == 0);
}

TEST_CASE("Small blocks stay with the heap, and many blocks are bounded", "[platform][memory]") {
  const KeptMemory kept(1024 * kMebi);
  give_working_memory(take_working_memory(platform::kMinKeptBlock - 1));
  CHECK(kept_working_memory() == 0);
  constexpr std::size_t most = 256;
  std::vector<WorkingMemory> blocks(most + 20);
  for (WorkingMemory& block : blocks) block = take_working_memory(platform::kMinOwnBlock);
  for (const WorkingMemory& block : blocks) give_working_memory(block);
  CHECK(kept_working_memory() == most * blocks.front().bytes);
}

TEST_CASE("Blocks below a mebibyte share huge pages, which are kept when none is in use", "[platform][memory]") {
  const KeptMemory kept(8 * kMebi);
  constexpr std::size_t large = platform::kMinOwnBlock - 1;
  std::vector<WorkingMemory> others;  // fill the pages that tables of earlier tests use
  for (;; others.push_back(take_working_memory(platform::kMinKeptBlock))) {
    REQUIRE(others.size() < 2000);
    give_working_memory(take_working_memory(platform::kMinKeptBlock));
    if (kept_working_memory() > 0) break;
  }
  REQUIRE(kept_working_memory() == 2 * kMebi);

  const WorkingMemory first = take_working_memory(large);
  CHECK(kept_working_memory() == 0);
  const WorkingMemory second = take_working_memory(100'000);
  const WorkingMemory third = take_working_memory(platform::kMinKeptBlock);
  for (const WorkingMemory& block : {second, third}) {
    CHECK(block.page == first.page);
    CHECK(reinterpret_cast<std::uintptr_t>(block.data) % platform::kCacheLine == 0);
  }
  CHECK(second.bytes >= 100'000);
  std::memset(first.data, 1, first.bytes);
  std::memset(second.data, 2, second.bytes);
  std::memset(third.data, 3, third.bytes);
  const auto filled = [](const WorkingMemory& block, char value) {
    const auto* const bytes = static_cast<const char*>(block.data);
    return std::all_of(bytes, bytes + block.bytes, [=](char byte) { return byte == value; });
  };
  CHECK(filled(first, 1));
  CHECK(filled(second, 2));
  CHECK(filled(third, 3));
  const WorkingMemory fourth = take_working_memory(large);  // too large for the rest
  CHECK(fourth.page != first.page);
  give_working_memory(second);
  const WorkingMemory again = take_working_memory(90'000);
  CHECK(again.data == second.data);
  release_working_memory();  // they are in use
  for (const WorkingMemory& block : {first, again}) give_working_memory(block);
  CHECK(kept_working_memory() == 0);
  give_working_memory(third);
  CHECK(kept_working_memory() == 2 * kMebi);
  give_working_memory(fourth);
  CHECK(kept_working_memory() == 4 * kMebi);
  const WorkingMemory six = take_working_memory(6 * kMebi);
  give_working_memory(six);  // one of the pages makes room
  CHECK(kept_working_memory() == 8 * kMebi);
  keep_working_memory(2 * kMebi);
  CHECK(kept_working_memory() == 2 * kMebi);
  release_working_memory();
  CHECK(kept_working_memory() == 0);
  keep_working_memory(kMebi);
  give_working_memory(take_working_memory(large));  // a page is above the limit
  CHECK(kept_working_memory() == 0);
  keep_working_memory(0);
  const WorkingMemory heap = take_working_memory(large);
  CHECK(heap.page < 0);
  give_working_memory(heap);
  for (const WorkingMemory& block : others) give_working_memory(block);
}

TEST_CASE("A block belongs to one thread at a time", "[platform][memory][threads]") {
  const KeptMemory kept(8 * kMebi);
  std::vector<char> mixed(4, 0);
  on_threads(mixed.size(), [&mixed](std::size_t k) {
    for (std::size_t turn = 0; turn < 400; ++turn) {
      const std::size_t bytes = turn % 8 == 7 ? platform::kMinOwnBlock : (1 + turn % 7) * platform::kMinKeptBlock;
      platform::AlignedBuffer<std::size_t> buffer(bytes / sizeof(std::size_t));
      std::fill_n(buffer.data(), buffer.size(), k);
      if (std::any_of(buffer.data(), buffer.data() + buffer.size(), [&](std::size_t value) { return value != k; }))
        mixed[k] = 1;
      if (turn % 50 == 0) release_working_memory();
    }
  });
  CHECK(mixed == std::vector<char>(4, 0));
}

TEST_CASE("A test can fill blocks before they are used", "[platform][memory]") {
  const KeptMemory kept(8 * kMebi);
  platform::fill_taken_memory(0xFF);
  platform::AlignedBuffer<unsigned char> small(100);
  platform::AlignedBuffer<unsigned char> large(kMebi);
  std::memset(large.data(), 0, large.size());
  large = {};
  large = platform::AlignedBuffer<unsigned char>(kMebi);
  platform::fill_taken_memory(-1);
  CHECK(small.data()[99] == 0xFF);
  CHECK(large.data()[0] == 0xFF);
  CHECK(large.data()[kMebi - 1] == 0xFF);
}

TEST_CASE("Large chains leave their memory to the next one, unless the caller gave it", "[platform][memory]") {
  const KeptMemory kept(64 * kMebi);
  Cubemap first(256, 2);
  const float* const pixels = first.face(0, 0);
  first = {};
  CHECK(kept_working_memory() >= 6 * kMebi - kMebi / 2);
  const Cubemap second(256, 2);
  CHECK(second.face(0, 0) == pixels);
  CHECK(kept_working_memory() == 0);
  { const Cubemap small(32, 2); }
  { const Cubemap elsewhere(256, 2, own_heap()); }
  CHECK(kept_working_memory() == 0);
  keep_working_memory(0);
  { const Cubemap third(256, 2); }
  CHECK(kept_working_memory() == 0);
}

}  // namespace welkin::test
