// Parts, layers, levels and elements that a file does not have.
#include <cstddef>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/chains.h"
#include "support/thrown_error.h"
#include "welkin/bake_file.h"
#include "welkin/environment_file.h"

namespace welkin::test {

// Promise: who asks for a part, layer, level or element that a file does not have gets an error, whatever the format,
// and never another picture's light. What every file has (number 0) may be asked for.

namespace {

struct File {
  std::string name;
  std::vector<std::byte> bytes;
};

std::vector<File> a_file_of_each_format() {
  const std::vector<float> pixels(std::size_t{3} * 8 * 4, 0.5F);
  const Cubemap chain = noisy_chain(4, 3);
  std::vector<File> files;
  for (const char* name : {"sky.hdr", "sky.pfm", "sky.png", "sky.exr"}) {
    File& file = files.emplace_back();
    file.name = name;
    write_environment({file.bytes, name}, LatLongView{pixels.data(), 8, 4, 0, PixelFormat::rgb32f});
  }
  for (const char* name : {"sky.ktx2", "sky.ktx", "sky.dds"}) {
    File& file = files.emplace_back();
    file.name = name;
    write_texture({file.bytes, name}, chain.views());
  }
  File& env = files.emplace_back();
  env.name = "sky.env";
  write_babylon_environment({env.bytes, env.name}, to_babylon(chain, SphericalHarmonics(3)));
  return files;
}

ReadOptions asking_for(const std::string& what) {
  ReadOptions options;
  if (what == "level 9") options.level = 9;
  if (what == "level -1") options.level = -1;
  if (what == "element 5") options.element = 5;
  if (what == "element -1") options.element = -1;
  if (what == "part 3") options.part = "3";
  if (what == "part sky") options.part = "sky";
  if (what == "layer sky") options.layer = "sky";
  return options;
}

}  // namespace

TEST_CASE("A part, layer, level or element that a file does not have is refused in every format", "[codec]") {
  for (const File& file : a_file_of_each_format()) {
    const FileInput input(file.bytes, file.name);
    for (const char* what : {"level 9", "level -1", "element 5", "element -1", "part 3", "part sky", "layer sky"}) {
      INFO(file.name << ", " << what);
      const ReadOptions options = asking_for(what);
      const ThrownError inspected = thrown_by([&] { static_cast<void>(inspect_environment(input, options)); });
      CHECK(inspected.code == ErrorCode::unsupported_file);
      CHECK(inspected.message.find(file.name + ": has ") == 0);
      CHECK(thrown_by([&] { static_cast<void>(read_environment(input, options)); }).message == inspected.message);
      CHECK(thrown_by([&] { static_cast<void>(project_file(input, options)); }).message == inspected.message);
    }
  }
}

TEST_CASE("Number 0 may be asked for in every format", "[codec]") {
  ReadOptions options;
  options.part = "0";
  options.level = 0;
  options.element = 0;
  for (const File& file : a_file_of_each_format()) {
    INFO(file.name);
    CHECK_NOTHROW(read_environment(FileInput(file.bytes, file.name), options));
  }
}

}  // namespace welkin::test
