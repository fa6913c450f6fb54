// Promises that hold on every system: names of any characters and length, files that are replaced as a whole,
// exclusive locks of folders, offsets beyond 4 GiB.
#include "platform/file.h"
#include "platform/text.h"
#include "support/catch.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"

namespace welkin::test {
namespace {

using platform::ByteFile, platform::FolderLock, platform::SharedFile, platform::WholeFile;

void write_whole(const std::filesystem::path& path, const std::string& text) {
  WholeFile file(path);
  file.write(text.data(), text.size());
  file.finish(true);
  file.commit();
}

std::string read_whole(const std::filesystem::path& path) {
  ByteFile file(path);
  std::string text(file.size(), '\0');
  file.read(text.data(), text.size());
  return text;
}

std::size_t entries(const std::filesystem::path& folder) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) count += entry.exists() ? 1 : 0;
  return count;
}

/// Names with characters of two, three and four bytes in UTF-8; those of four bytes are pairs in UTF-16.
constexpr std::array kNames{"H\xC3\xB6he.pfm", "\xE5\xA4\xA9\xE7\xA9\xBA.pfm", "\xF0\x9F\x8C\x84 sunrise.pfm",
                            "\xD0\xBD\xD0\xB5\xD0\xB1\xD0\xBE.pfm"};

}  // namespace

TEST_CASE("Files whose names have characters of any language are written, read and named in errors", "[platform]") {
  const TemporaryDirectory directory;
  for (const char* const name : kNames) {
    CAPTURE(name);
    const std::filesystem::path path = platform::path_of(platform::utf8(directory.file("")) + name);
    CHECK(platform::utf8(path.filename()) == name);
    write_whole(path, "light");
    CHECK(read_whole(path) == "light");
    SharedFile shared(path);
    REQUIRE(shared.is_open());
    CHECK(shared.size() == 5U);
    std::array<char, 5> bytes{};
    CHECK(shared.read(bytes.data(), bytes.size()));
    CHECK(std::memcmp(bytes.data(), "light", bytes.size()) == 0);
    CHECK_FALSE(shared.read(bytes.data(), 1));
  }
  CHECK(entries(directory.file("")) == kNames.size());
  const std::filesystem::path missing = directory.file("") / platform::path_of("f\xC3\xBCr nichts.exr");
  CHECK(thrown_by([&] { ByteFile file(missing); }).says("f\xC3\xBCr nichts.exr: there is no such file"));
}

TEST_CASE("Files deep in folders, with names beyond Windows' 260 characters, are written and read", "[platform]") {
  const TemporaryDirectory directory;
  std::filesystem::path folder = directory.file("");
  for (int depth = 0; depth < 8; ++depth) folder /= std::string(60, static_cast<char>('a' + depth));
  folder = platform::reachable(folder);
  std::filesystem::create_directories(folder);
  const std::filesystem::path path = folder / "deep.pfm";
  REQUIRE(path.native().size() > 480);
  write_whole(path, "light");
  write_whole(path, "lights");
  CHECK(read_whole(path) == "lights");
  CHECK(SharedFile(path).size() == 6U);
  // (libstdc++ lists no such folder on Windows.)
}

TEST_CASE("A path that is reachable as it is stays as it is", "[platform]") {
  CHECK(platform::reachable("sky.exr") == "sky.exr");
  CHECK(platform::reachable("") == "");
}

TEST_CASE("A file that is not committed leaves what was there, and nothing beside it", "[platform]") {
  const TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.bin");
  write_whole(path, "before");
  {
    WholeFile file(path);
    file.write("after", 5);
    file.finish();
    CHECK(read_whole(path) == "before");
  }
  CHECK(read_whole(path) == "before");
  CHECK(entries(directory.file("")) == 1);
}

TEST_CASE("A file that somebody reads is replaced: the reader keeps what it opened", "[platform]") {
  const TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.bin");
  write_whole(path, "before");
  SharedFile reader(path);
  REQUIRE(reader.is_open());
  std::string failure;
  try {
    write_whole(path, "after");
  } catch (const Error& error) {  // Windows without POSIX renaming (FAT, or before 1709): the error states why
    failure = error.what();
    CHECK(error.code() == ErrorCode::file_access);
    CHECK(failure.find("another program has the file that is there open") != std::string::npos);
  }
  std::array<char, 6> bytes{};
  CHECK(reader.read(bytes.data(), bytes.size()));
  CHECK(std::memcmp(bytes.data(), "before", bytes.size()) == 0);
  CHECK(read_whole(path) == (failure.empty() ? "after" : "before"));
  CHECK(entries(directory.file("")) == 1);
}

TEST_CASE("What a writer that lives has not finished is not taken for what a dead one left", "[platform]") {
  const TemporaryDirectory directory;
  const std::filesystem::path folder = directory.file("");
  write_bytes(folder / ".welkin-1-0.part", {'x'});
  write_bytes(folder / ".welkin-notes.part", {'x'});
  WholeFile file(folder / "sky.bin");
  file.write("light", 5);
  platform::remove_left_behind(folder);
  CHECK_FALSE(std::filesystem::exists(folder / ".welkin-1-0.part"));
  CHECK(std::filesystem::exists(folder / ".welkin-notes.part"));
  file.finish();
  platform::remove_left_behind(folder);
  file.commit();
  CHECK(read_whole(folder / "sky.bin") == "light");
  CHECK(entries(folder) == 2);
}

TEST_CASE("One at a time has a folder", "[platform]") {
  const TemporaryDirectory directory;
  const std::filesystem::path folder = directory.file("out");
  std::filesystem::create_directory(folder);
  std::optional<FolderLock> first(folder);
  FolderLock second(folder);
  CHECK(first->take());
  CHECK(first->take());
  CHECK_FALSE(second.take());
  write_whole(folder / "sky.bin", "light");  // the owner of the lock can write
  CHECK(read_whole(folder / "sky.bin") == "light");
  first.reset();
  CHECK(second.take());
  FolderLock third(folder);
  CHECK_FALSE(third.take());
  std::filesystem::create_directory(directory.file("other"));
  FolderLock other(directory.file("other"));
  CHECK(other.take());
  FolderLock nowhere(directory.file("none"));
  CHECK(nowhere.take());  // succeeds where no lock is possible, so that no caller waits for one
}

TEST_CASE("The time of a file's last change can be set to now", "[platform]") {
  const TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.bin");
  write_whole(path, "light");
  const auto long_ago = std::filesystem::file_time_type::clock::now() - std::chrono::hours(48);
  std::filesystem::last_write_time(path, long_ago);
  SharedFile(path).touch();
  CHECK(std::filesystem::last_write_time(path) > long_ago + std::chrono::hours(47));
}

// (A file system without sparse files, such as NTFS, writes 5 GiB, so there this test runs only by its name.)
#if defined(_WIN32)
constexpr const char* kLargeTags = "[platform][.large]";
#else
constexpr const char* kLargeTags = "[platform]";
#endif
TEST_CASE("Places beyond 4 GiB are written and read", kLargeTags) {
  const TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("large.bin");
  constexpr std::uint64_t kFar = std::uint64_t{5} << 30U;
  WholeFile file(path);
  file.write("near", 4);
  file.seek(kFar);
  file.write("far", 3);
  file.finish();
  file.commit();
  ByteFile reader(path);
  CHECK(reader.size() == kFar + 3);
  std::array<char, 3> bytes{};
  reader.seek(kFar);
  reader.read(bytes.data(), bytes.size());
  CHECK(std::memcmp(bytes.data(), "far", bytes.size()) == 0);
  reader.seek(0);
  reader.read(bytes.data(), bytes.size());
  CHECK(std::memcmp(bytes.data(), "nea", bytes.size()) == 0);
  CHECK(SharedFile(path).size() == kFar + 3);
}

TEST_CASE("Bytes that are no UTF-8 name a file only where names are bytes", "[platform]") {
  const std::string name = "sky\xFF.exr";
#if defined(_WIN32)
  CHECK(thrown_by([&] { static_cast<void>(platform::path_of(name)); }).says("is not valid UTF-8"));
#else
  CHECK(platform::utf8(platform::path_of(name)) == name);
#endif
}

}  // namespace welkin::test
