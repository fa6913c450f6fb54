// Promises: a file that replaces another has its permissions; a symbolic link stays one, and what it leads to is
// replaced.
#include <filesystem>

#include "support/catch.h"
#include "support/exr_files.h"
#include "support/temporary_directory.h"
#include "welkin/environment_writer.h"
#include "welkin/image.h"

namespace welkin::test {

TEST_CASE("A file that is replaced hands on its permissions", "[writers]") {
  const LatLongImage map{8, 4, some_pixels(8, 4)};
  for (const auto mode : {std::filesystem::perms{0600}, std::filesystem::perms{0664}}) {
    const TemporaryDirectory directory;
    const auto path = directory.file("sky.pfm");
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
