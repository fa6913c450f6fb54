// Files that are written where POSIX can say more: limits on their size, permissions, symbolic links.
#include <sys/resource.h>

#include <csignal>

#include "support/catch.h"
#include "support/exr_files.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"

namespace welkin::test {
namespace {

/// Files of this process end at so many bytes while it lives: what a full disk does.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &saved_);
    const rlimit limit{bytes, saved_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &saved_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  void (*handler_)(int);
  rlimit saved_{};
};

constexpr std::array kNames{"sky.exr", "sky.hdr", "sky.pfm", "sky.png"};

}  // namespace

TEST_CASE("A full disk leaves no file, and says what happened", "[writers]") {
  const LatLongImage map{256, 128, some_pixels(256, 128)};
  for (const char* file : kNames) {
    for (const rlim_t bytes : {0UL, 100UL, 5000UL, 20000UL}) {
      const TemporaryDirectory directory;
      CAPTURE(file, bytes);
      ThrownError error;
      {
        const FileSizeLimit limit(bytes);
        error = thrown_by([&] { write_environment(directory.file(file), map.view()); });
      }
      CHECK(error.code == ErrorCode::file_access);
      CHECK(error.says(file));
      CHECK(error.says("File too large"));
      CHECK(files_in(directory.path()).size() == 0);
    }
  }
}

// Promises: a file that replaces another has its permissions; a symbolic link stays one, and what it leads to is
// replaced.

TEST_CASE("A file that is replaced hands on its permissions", "[writers]") {
  const LatLongImage map{8, 4, some_pixels(8, 4)};
  for (const auto mode : {std::filesystem::perms{0600}, std::filesystem::perms{0664}}) {
    const TemporaryFile path("sky.pfm");
    write_bytes(path, {'o', 'l', 'd'});
    std::filesystem::permissions(path, mode);
    write_environment(path, map.view());
    CHECK(std::filesystem::status(path).permissions() == mode);
    CHECK(std::filesystem::file_size(path) > 3);
  }
}

TEST_CASE("Through a symbolic link the file that it leads to is replaced", "[writers]") {
  const LatLongImage map{8, 4, some_pixels(8, 4)};
  const TemporaryDirectory directory;
  const auto target = directory.file("elsewhere/target.pfm");
  std::filesystem::create_directory(target.parent_path());
  write_bytes(target, {'o', 'l', 'd'});
  const auto link = directory.file("sky.pfm");
  std::filesystem::create_symlink("elsewhere/target.pfm", link);
  const WriteReport report = write_environment(link, map.view());
  CHECK(report.files.front() == link);
  CHECK(std::filesystem::is_symlink(link));
  CHECK(std::filesystem::file_size(target) > 3);
}

}  // namespace welkin::test
