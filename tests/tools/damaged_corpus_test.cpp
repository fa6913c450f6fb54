// The command meets damaged files: it reads them or says in one line why not, within 512 MB and ten seconds.
#include <sstream>
#include <string>
#include <vector>

#include "places.h"
#include "support/catch.h"
#include "support/damaged_files.h"
#include "support/temporary_directory.h"
#include "tools/command.h"

using namespace welkin::test;

#if defined(__SANITIZE_ADDRESS__)
#define WELKIN_LIMIT "0"  // address space is not theirs to save: the sanitizer itself counts what is resident
#define WELKIN_SANITIZER_LIMIT "ASAN_OPTIONS=hard_rss_limit_mb=512:allocator_may_return_null=0 "
#elif defined(__SANITIZE_THREAD__)
#define WELKIN_LIMIT "0"
#define WELKIN_SANITIZER_LIMIT ""
#else
#define WELKIN_LIMIT "524288"
#define WELKIN_SANITIZER_LIMIT ""
#endif

namespace {

constexpr int kFilesOfAKind = 24;

/// Evenly chosen damages of every sound file, and the sound files themselves.
int write_corpus(const std::filesystem::path& folder, const std::filesystem::path& scratch) {
  int written = 0;
  for (const SoundFile& sound : sound_files(scratch)) {
    std::vector<std::vector<char>> all;
    for_each_damage(sound, [&](const std::vector<char>& bytes) { all.push_back(bytes); });
    write_bytes(folder / ("sound-" + sound.name), sound.bytes);
    ++written;
    for (std::size_t i = 0; i < kFilesOfAKind; ++i, ++written) {
      const std::size_t which = (2 * i + 1) * all.size() / (2 * kFilesOfAKind);
      write_bytes(folder / (std::to_string(which) + "-" + sound.name), all[which]);
    }
  }
  return written;
}

std::string output_of(const std::string& line) {
  std::string output;
  FILE* pipe = popen(line.c_str(), "r");
  REQUIRE(pipe != nullptr);
  char block[4096];
  for (std::size_t read = 0; (read = fread(block, 1, sizeof(block), pipe)) > 0;) output.append(block, read);
  CHECK(pclose(pipe) == 0);
  return output;
}

}  // namespace

TEST_CASE("command: damaged files within 512 MB", "[tools][damage]") {
  const TemporaryDirectory directory;
  std::filesystem::create_directory(directory.file("corpus"));
  const int files = write_corpus(directory.file("corpus"), directory.file(""));
  const std::string script = std::string(WELKIN_TEST_DATA) + "/../tools/run_limited.sh";
  std::istringstream results(output_of("cd " + quoted(directory.file("corpus")) +
                                       " && ls | " WELKIN_SANITIZER_LIMIT "xargs -P 2 -I{} " +
                                       quoted(std::filesystem::path(script)) + " " +
                                       quoted(std::filesystem::path(WELKIN_COMMAND)) + " " WELKIN_LIMIT " {}"));
  int runs = 0;
  for (std::string line; std::getline(results, line); ++runs) {
    INFO("file, command, exit code, lines on standard error, their first word: " << line);
    std::istringstream words(line);
    std::string file;
    std::string command;
    std::string first;
    int code = -1;
    int lines = -1;
    words >> file >> command >> code >> lines >> first;
    CHECK((code == 0 || code == 1 || code == 2));
    CHECK(lines == (code == 0 ? 0 : 1));
    CHECK((code == 0 || first == "welkin:"));
    if (file.rfind("sound-", 0) == 0) CHECK(code == 0);
  }
  CHECK(runs == 2 * files);
}
