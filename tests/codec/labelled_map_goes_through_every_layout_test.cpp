// Promise: a labelled map goes through every layout, format and orientation and back, and no texel moves.
#include <cstring>
#include <tuple>

#include "support/catch.h"
#include "support/temporary_directory.h"
#include "welkin/convention.h"
#include "welkin/environment_writer.h"
#include "welkin/resampling.h"
#include "tools/test_map.h"

namespace welkin::test {
namespace {

bool same_bits(const std::vector<float>& wanted, const float* found) {
  return std::memcmp(wanted.data(), found, wanted.size() * sizeof(float)) == 0;
}

constexpr std::array kCubeLayouts{Layout::automatic,        Layout::vertical_strip, Layout::horizontal_strip,
                                  Layout::horizontal_cross, Layout::vertical_cross, Layout::six_files};

}  // namespace

TEST_CASE("The labelled map goes through every layout and back without a moved texel", "[writers][layouts]") {
  for (const int size : {1, 2, 7, 32}) {
    const CubemapImage map = test_map_cubemap(size);
    for (const char* extension : {".exr", ".pfm"}) {
      for (const Layout layout : kCubeLayouts) {
        const TemporaryDirectory directory;
        const auto path = directory.file(std::string("map") + extension);
        const WriteReport report = write_environment(path, map.view(), {layout, SampleType::float32});
        CAPTURE(size, extension, name(layout));
        REQUIRE(report.files.size() == (layout == Layout::six_files ? 6U : 1U));
        const Environment read = read_environment(report.files.front());  // the layout is told from shape and header
        REQUIRE(read.face_size() == size);
        CHECK(same_bits(map.pixels, read.pixels.get()));
      }
    }
  }
}

TEST_CASE("In 8 bits and in RGBE the same texels are in the same places", "[writers][layouts]") {
  const int size = 16;
  const CubemapImage map = test_map_cubemap(size);
  for (const auto& [extension, off] : {std::pair{".png", 0.006F}, {".hdr", 0.003F}}) {
    for (const Layout layout : kCubeLayouts) {
      const TemporaryDirectory directory;
      const WriteReport report =
          write_environment(directory.file(std::string("map") + extension), map.view(), {layout});
      const Environment read = read_environment(report.files.front());
      REQUIRE(read.face_size() == size);
      for (std::size_t i = 0; i < map.pixels.size(); ++i) REQUIRE(std::abs(read.pixels[i] - map.pixels[i]) < off);
    }
  }
}

TEST_CASE("The labelled map goes into every engine's faces and back without a moved texel", "[resampling]") {
  const CubemapImage map = test_map_cubemap(32);
  for (const Convention& engine : conventions()) {
    if (!engine.faces_from_engine) continue;
    const glm::dmat3 there = *engine.faces_from_engine * engine.from_welkin;
    CAPTURE(engine.name);
    const CubemapImage turned = to_cubemap(map.view(), 32, there);
    CHECK(same_bits(map.pixels, to_cubemap(turned.view(), 32, glm::transpose(there)).pixels.data()));
  }
}

}  // namespace welkin::test
