// Entries of a cache's folder that somebody else made: sizes that cannot be, no memory for what they state.
#include "cache/entry_store.h"
#include "cache/recipe.h"
#include "cache/result_cache.h"
#include "support/catch.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "welkin/result_cache.h"

namespace welkin::test {
namespace {

using cache::EntryFolder;

constexpr std::uint64_t kLarge = std::uint64_t{1} << 30U;

cache::EntryName named(unsigned char number) { return {cache::EntryKind::projection, hash_bytes(&number, 1)}; }

}  // namespace

TEST_CASE("entries: no memory is taken for more than an entry of its kind can have") {
  const TemporaryDirectory directory;
  const std::filesystem::path place = directory.file("cache");
  EntryFolder folder(place, kLarge);
  folder.store(named(1), std::vector<std::uint8_t>(100, 7));
  CHECK(folder.find(named(1), 100).has_value());
  CHECK_FALSE(folder.find(named(1), 99).has_value());
  CHECK(folder.counts().damaged == 1);

  // A sparse file of a terabyte whose header says so, under the name of a projection's entry.
  const TestLatLong picture = make_lat_long(Content::smooth, 16, 8, 3);
  const CacheOptions options{.folder = place, .memory_bytes = 0, .disk_bytes = std::uint64_t{1} << 50U};
  static_cast<void>(ResultCache(options).project(picture.view()));
  REQUIRE(files_in(place).size() == 1);
  const std::filesystem::path entry = files_in(place).front();
  std::vector<char> bytes = read_bytes(entry);
  bytes.resize(cache::kEntryHeaderBytes);
  const std::uint64_t payload = std::uint64_t{1} << 40U;
  std::memcpy(bytes.data() + 32, &payload, sizeof payload);
  const std::uint64_t sum = hash_bytes(bytes.data(), cache::kEntryHeaderBytes - sizeof payload).low;
  std::memcpy(bytes.data() + cache::kEntryHeaderBytes - sizeof sum, &sum, sizeof sum);
  write_bytes(entry, bytes);
  std::error_code unsupported;
  std::filesystem::resize_file(entry, payload + cache::kEntryHeaderBytes, unsupported);
  if (unsupported) return;  // a file system without sparse files
  ResultCache cache(options);
  CHECK(cache.project(picture.view()).radiance.at(1, 0) == project(picture.view()).radiance.at(1, 0));
  CHECK(cache.statistics().damaged == 1);
}

TEST_CASE("entries: running out of memory for an entry is a miss") {
  const TemporaryDirectory directory;
  cache::ResultStore store({.folder = directory.file("cache"), .memory_bytes = 0});
  const cache::EntryName name = named(1);
  store.store(name, [] { return cache::Bytes(100, 7); });
  const auto size = [](cache::ByteSpan bytes) { return std::optional(bytes.size()); };
  REQUIRE(store.find(name, 100, size)->value == 100);
  const auto no_memory = [](cache::ByteSpan) -> std::optional<std::size_t> { throw std::bad_alloc(); };
  CHECK_FALSE(store.find(name, 100, no_memory).has_value());
  CHECK(store.find(name, 100, size)->value == 100);  // it is still there
  store.store(named(2), []() -> cache::Bytes { throw std::bad_alloc(); });
  CHECK(store.statistics().write_failures == 1);
  CHECK_FALSE(store.find(named(2), 100, size).has_value());
}

TEST_CASE("entries: bytes of the caller's are found again in another process's cache") {
  const TemporaryDirectory directory;
  const CacheOptions options{.folder = directory.file("cache"), .memory_bytes = 0};
  const std::array bytes{std::byte{1}, std::byte{0}, std::byte{3}};
  const ContentHash key = hash_bytes("key", 3);
  ResultCache(options).keep_bytes(key, bytes);
  ResultCache other(options);
  const auto found = other.find_bytes(key, 3);
  REQUIRE(found.has_value());
  CHECK(std::ranges::equal(*found, bytes));
  CHECK_FALSE(other.find_bytes(hash_bytes("kez", 3), 3).has_value());
  CHECK_FALSE(other.find_bytes(key, 2).has_value());
}

}  // namespace welkin::test
