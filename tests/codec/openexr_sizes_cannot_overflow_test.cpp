// Promise: windows and tiles of an OpenEXR header whose sizes multiply past 64 bits are refused by the header alone.
#include <algorithm>
#include <cstring>

#include "support/catch.h"
#include "support/exr_files.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"

namespace welkin {
namespace {

using namespace std::string_literals;

std::vector<char> small_exr(const std::filesystem::path& path, Imf::Compression compression,
                            const std::optional<Imf::TileDescription>& tiles) {
  test::ExrRecipe recipe{8, 4, 0, 0, compression, Imf::INCREASING_Y, tiles, Imf::ENVMAP_LATLONG, {}};
  recipe.channels = test::rgb_channels(Imf::HALF);
  test::write_exr(path, recipe, test::some_pixels(8, 4));
  return test::read_bytes(path);
}

// Where the value of an attribute begins, by its name and type with the zero between them: behind the type's zero and
// the size.
std::size_t field(const std::vector<char>& bytes, const std::string& name_and_type) {
  const auto found = std::search(bytes.begin(), bytes.end(), name_and_type.begin(), name_and_type.end());
  REQUIRE(found != bytes.end());
  return static_cast<std::size_t>(found - bytes.begin()) + name_and_type.size() + 5;
}

}  // namespace

TEST_CASE("sizes that multiply past 64 bits are refused", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("product.exr");
  for (const Imf::LevelMode mode : {Imf::ONE_LEVEL, Imf::MIPMAP_LEVELS, Imf::RIPMAP_LEVELS}) {
    for (const std::int32_t corner : {0x3ffffffe, 0x7ffffffe, 0x7fffffff}) {
      std::vector<char> bytes = small_exr(path, Imf::ZIP_COMPRESSION, Imf::TileDescription(4, 4, mode));
      for (const std::string& window : {"dataWindow\0box2i"s, "displayWindow\0box2i"s}) {
        const std::size_t place = field(bytes, window);
        for (const auto& [offset, value] : {std::pair{0, -corner}, {4, -corner}, {8, corner}, {12, corner}}) {
          std::memcpy(bytes.data() + place + offset, &value, 4);
        }
      }
      const std::size_t tiles = field(bytes, "tiles\0tiledesc"s);
      for (const std::uint32_t edge : {1U, 0x7fffffffU, 0xffffffffU}) {
        std::memcpy(bytes.data() + tiles, &edge, 4);
        std::memcpy(bytes.data() + tiles + 4, &edge, 4);
        test::write_bytes(path, bytes);
        const test::ThrownError error = test::thrown_by([&] { (void)inspect_environment(path); });
        CHECK(error.says(path.string()));
      }
    }
  }
}

}  // namespace welkin
