// Promise: whatever goes wrong while a file is written, it is not there, and what was there before still is.
#include <sys/resource.h>

#include <csignal>

#include "support/catch.h"
#include "support/exr_files.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/environment_writer.h"
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

std::size_t entries(const TemporaryDirectory& directory) {
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(directory.file("").parent_path())) {
    count += entry.exists() ? 1 : 0;
  }
  return count;
}

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
      CHECK(entries(directory) == 0);
    }
  }
}

TEST_CASE("A cancelled write leaves what was there", "[writers]") {
  const CubemapImage map{32, some_pixels(32, 192)};
  for (const char* file : kNames) {
    for (const Layout layout : {Layout::automatic, Layout::six_files}) {
      const TemporaryDirectory directory;
      write_bytes(directory.file(file), {'o', 'l', 'd'});
      std::stop_source stop;
      const Control control{stop.get_token(), [&](double done) {
                              if (done > 0.6) stop.request_stop();
                            }};
      const auto call = [&] { write_environment(directory.file(file), map.view(), {layout}, control); };
      CHECK(thrown_by(call).code == ErrorCode::cancelled);
      CHECK(entries(directory) == 1);
      CHECK(read_bytes(directory.file(file)) == std::vector<char>{'o', 'l', 'd'});
    }
  }
}

TEST_CASE("A file that is there is replaced, and progress runs to one", "[writers]") {
  const CubemapImage map{8, some_pixels(8, 48)};
  for (const char* file : kNames) {
    for (const Layout layout : {Layout::automatic, Layout::six_files}) {
      const TemporaryDirectory directory;
      write_bytes(directory.file(file), {'o', 'l', 'd'});
      double last = 0.0;
      const Control control{{}, [&](double done) {
                              CHECK(done >= last);
                              last = done;
                            }};
      const WriteReport report = write_environment(directory.file(file), map.view(), {layout}, control);
      CHECK(last == 1.0);
      CHECK(entries(directory) == (layout == Layout::six_files ? 7U : 1U));
      CHECK(std::filesystem::file_size(report.files.back()) > 3);
    }
  }
}

TEST_CASE("Refusals to write say what would do", "[writers]") {
  const TemporaryDirectory directory;
  const LatLongImage map{4, 2, some_pixels(4, 2)};
  const CubemapImage cube{2, some_pixels(2, 12)};
  const auto refusal = [&](const std::string& file, const WriteOptions& options = {}) {
    return thrown_by([&] { write_environment(directory.file(file), map.view(), options); });
  };
  CHECK(refusal("sky.gif").code == ErrorCode::unsupported_file);
  CHECK(refusal("sky.gif").says("\".gif\" is not written; use .exr, .hdr, .pfm or .png"));
  CHECK(refusal("sky").says("no extension"));
  CHECK(refusal("none/sky.exr").code == ErrorCode::file_access);
  CHECK(refusal("none/sky.exr").says("its folder is not there"));
  CHECK(refusal("sky.exr", {Layout::automatic, SampleType::uint8}).says("half or float"));
  CHECK(refusal("sky.hdr", {Layout::automatic, SampleType::float32}).says("RGBE"));
  CHECK(refusal("sky.pfm", {Layout::automatic, SampleType::half}).says("floats alone"));
  CHECK(refusal("sky.png", {Layout::automatic, SampleType::half}).says("8 or 16 bits"));
  CHECK(refusal("sky.exr", {Layout::vertical_strip}).says("to_cubemap"));
  CHECK(refusal("sky.exr", {Layout::vertical_strip}).code == ErrorCode::invalid_argument);
  CHECK(thrown_by([&] {
          write_environment(directory.file("a.exr"), cube.view(), {Layout::lat_long});
        }).says("to_lat_long"));
  CHECK(thrown_by([&] { write_environment(directory.file("a.exr"), LatLongView{}); }).code ==
        ErrorCode::invalid_argument);
  std::filesystem::create_directory(directory.file("folder.exr"));
  CHECK(refusal("folder.exr").says("is a directory"));
  CHECK(entries(directory) == 1);
}

}  // namespace welkin::test
