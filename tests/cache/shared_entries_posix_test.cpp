// Entries of a cache's folder in situations that need POSIX: links, pipes, locks, a full disk, killed processes.
#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cache/entry_store.h"
#include "support/catch.h"
#include "support/payload.h"
#include "support/process_threads.h"
#include "support/temporary_directory.h"

namespace welkin::test {
namespace {

using cache::EntryFolder;

constexpr std::uint64_t kLarge = std::uint64_t{1} << 30U;

cache::EntryName named(unsigned number) { return {cache::EntryKind::projection, {number, ~std::uint64_t{number}}}; }

TEST_CASE("entries: what a killed writer left behind goes, and what a living one writes stays") {
  const TemporaryFile root("cache");
  std::filesystem::create_directory(root);
  write_bytes(root / ".welkin-1-0.part", {'x'});
  write_bytes(root / ".welkin-2-0-5.part", {'x'});
  std::filesystem::create_symlink("/dev/null", root / ".welkin-3-0.part");
  const int living = open((root / ".welkin-2-0-5.part").c_str(), O_RDONLY | O_CLOEXEC);
  REQUIRE(flock(living, LOCK_EX) == 0);
  {
    const EntryFolder folder(root, 1000);
    CHECK_FALSE(std::filesystem::exists(root / ".welkin-1-0.part"));
    CHECK(std::filesystem::exists(root / ".welkin-2-0-5.part"));
    CHECK(std::filesystem::is_symlink(root / ".welkin-3-0.part"));
  }
  close(living);
  const EntryFolder folder(root, 1000);
  CHECK_FALSE(std::filesystem::exists(root / ".welkin-2-0-5.part"));
}

TEST_CASE("entries: a link under an entry's name is not followed, for reading or for writing") {
  const TemporaryDirectory directory;
  const std::filesystem::path root = directory.file("cache");
  EntryFolder folder(root, kLarge);
  folder.store(named(1), std::vector<std::uint8_t>(100, 7));
  REQUIRE(files_in(root).size() == 1);
  const std::filesystem::path entry = files_in(root).front();
  const std::filesystem::path elsewhere = directory.file("elsewhere");
  std::filesystem::rename(entry, elsewhere);
  std::filesystem::create_symlink(elsewhere, entry);
  const std::vector<char> before = read_bytes(elsewhere);
  CHECK_FALSE(folder.find(named(1)).has_value());
  folder.store(named(1), std::vector<std::uint8_t>(200, 8));
  CHECK(read_bytes(elsewhere) == before);
  CHECK_FALSE(std::filesystem::is_symlink(entry));
  CHECK(folder.find(named(1))->size() == 200);
}

TEST_CASE("entries: files of others stay, and pipes and folders under an entry's name keep nobody waiting") {
  const TemporaryFile root("cache");
  EntryFolder folder(root, 1000);
  const std::vector<std::string> theirs{"notes.txt", "mine.welkin-entry", ".welkin-notes.part", ".welkin-.part"};
  for (const std::string& name : theirs) {
    write_bytes(root / name, std::vector<char>(5000, 'x'));
    std::filesystem::last_write_time(root / name,
                                     std::filesystem::file_time_type::clock::now() - std::chrono::hours(200));
  }
  folder.store(named(1), payload_of(1, 500));
  const std::string name = [&] {
    for (const auto& path : files_in(root)) {
      if (std::ranges::find(theirs, path.filename().string()) == theirs.end()) return path.filename().string();
    }
    return std::string();
  }();
  std::filesystem::remove(root / name);
  REQUIRE(mkfifo((root / name).c_str(), 0600) == 0);
  CHECK_FALSE(folder.find(named(1)).has_value());
  std::filesystem::create_directory(root / name);
  CHECK_FALSE(folder.find(named(1)).has_value());
  for (unsigned number = 2; number < 6; ++number) folder.store(named(number), payload_of(number, 500));
  const EntryFolder once_more(root, 1000);
  for (const std::string& each : theirs) CHECK(std::filesystem::exists(root / each));
}

/// Starts a process that exits with the result of `work`; returns its id.
template <class Work>
pid_t start_process(const Work& work) {
  const pid_t child = fork();
  if (child == 0) _exit(work());
  return child;
}

int exit_code(pid_t child) {
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 256 + WTERMSIG(status);
}

TEST_CASE("entries: a full disk is no reason to fail and leaves nothing behind") {
  const TemporaryFile root("cache");
  const pid_t child = start_process([&] {
    signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{4096, 4096};
    setrlimit(RLIMIT_FSIZE, &limit);
    EntryFolder folder(root, kLarge);
    folder.store(named(1), payload_of(1, 100'000));
    folder.store(named(2), payload_of(2, 1000));
    const bool right = folder.counts().write_failures == 1 && !folder.find(named(1)) && folder.find(named(2));
    return right ? 0 : 1;
  });
  CHECK(exit_code(child) == 0);
  CHECK(files_in(root).size() == 1);
}

/// Stores and finds entries among those of other processes; returns 0 if every found entry was right.
int work_among_others(const std::filesystem::path& root, unsigned seed, int rounds) {
  // The folder is small, so that entries come and go while others read them.
  EntryFolder folder(root, 40'000);
  unsigned state = seed * 2654435761U + 1;
  for (int round = 0; round < rounds; ++round) {
    state = state * 1664525U + 1013904223U;
    const unsigned number = (state >> 16U) % 12;
    const std::size_t bytes = 1000 + 500 * number;
    if (const auto found = folder.find(named(number)); found && *found != payload_of(number, bytes)) return 1;
    if ((state >> 28U) % 2 == 0) folder.store(named(number), payload_of(number, bytes));
  }
  return folder.counts().write_failures == 0 ? 0 : 2;
}

TEST_CASE("entries: processes and threads that share a folder never see half an entry") {
  const TemporaryFile root("cache");
  std::vector<pid_t> children;
  for (unsigned seed = 0; seed < 4; ++seed) {
    children.push_back(start_process([&] { return work_among_others(root, seed, 60); }));
  }
  const pid_t killed = start_process([&] { return work_among_others(root, 9, 1'000'000); });
  for (const pid_t child : children) CHECK(exit_code(child) == 0);
  kill(killed, SIGKILL);
  CHECK(exit_code(killed) == 256 + SIGKILL);
  std::vector<int> codes(3, -1);
  on_threads(3, [&](std::size_t k) { codes[k] = work_among_others(root, 20 + static_cast<unsigned>(k), 60); });
  CHECK(codes == std::vector<int>{0, 0, 0});
  EntryFolder folder(root, kLarge);
  for (unsigned number = 0; number < 12; ++number) {
    const auto found = folder.find(named(number));
    CHECK((!found || *found == payload_of(number, 1000 + 500 * number)));
  }
  CHECK(folder.counts().damaged == 0);
}

}  // namespace
}  // namespace welkin::test
