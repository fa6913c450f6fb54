// OpenEXR blocks that unpack to less than their texels: an error, and never what memory held before.
#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "support/catch.h"
#include "support/exr_files.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"

namespace welkin::test {
namespace {

std::string zipped(const std::string& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string packed(size, '\0');
  REQUIRE(compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                   static_cast<uLong>(bytes.size())) == Z_OK);
  packed.resize(size);
  return packed;
}

template <class Value>
Value number_at(const std::string& bytes, std::size_t at) {
  Value value{};
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

/// The sound file of that recipe with its first block, by place, replaced: `header_bytes` stand before its length.
std::string with_block(const std::filesystem::path& sound, std::size_t blocks, std::size_t header_bytes,
                       const std::string& block) {
  std::string bytes;
  {
    const std::vector<char> read = read_bytes(sound);
    bytes.assign(read.begin(), read.end());
  }
  // The table of offsets ends where the first block begins.
  std::size_t table = 0;
  for (table = 8; number_at<std::uint64_t>(bytes, table) != table + 8 * blocks; ++table) {
  }
  const std::size_t first = number_at<std::uint64_t>(bytes, table);
  const std::size_t length_at = first + header_bytes;
  const auto old_length = number_at<std::int32_t>(bytes, length_at);
  const auto length = static_cast<std::int32_t>(block.size());
  const std::int64_t longer = length - old_length;
  for (std::size_t i = 1; i < blocks; ++i) {
    const std::uint64_t moved = number_at<std::uint64_t>(bytes, table + 8 * i) + static_cast<std::uint64_t>(longer);
    std::memcpy(bytes.data() + table + 8 * i, &moved, sizeof moved);
  }
  std::memcpy(bytes.data() + length_at, &length, sizeof length);
  return bytes.replace(length_at + 4, static_cast<std::size_t>(old_length), block);
}

struct Kind {
  const char* name;
  Imf::Compression compression;
  std::string block;  ///< that unpacks to 100 bytes
};

std::vector<Kind> kinds() {
  const std::string some(100, '\x11');
  return {{"zip", Imf::ZIP_COMPRESSION, zipped(some)},
          {"zips", Imf::ZIPS_COMPRESSION, zipped(some)},
          {"rle", Imf::RLE_COMPRESSION, std::string("\x63\x33")},
          {"none", Imf::NO_COMPRESSION, some}};
}

ExrRecipe recipe_of(const Kind& kind, bool tiled) {
  ExrRecipe recipe;
  recipe.width = 64;
  recipe.height = 32;
  recipe.compression = kind.compression;
  recipe.channels = rgb_channels(Imf::HALF);
  if (tiled) recipe.tiles = Imf::TileDescription(16, 16);
  return recipe;
}

}  // namespace

TEST_CASE("an OpenEXR block that unpacks to too little is refused by its place", "[codec][damage]") {
  const TemporaryDirectory folder;
  const std::filesystem::path path = folder.file("short.exr");
  std::vector<float> rgb(std::size_t{64} * 32 * 3);
  for (std::size_t i = 0; i < rgb.size(); ++i)
    rgb[i] = static_cast<float>(i * 7919 % 1009);  // packs, but not to nothing
  for (const bool tiled : {false, true}) {
    for (const Kind& kind : kinds()) {
      const ExrRecipe recipe = recipe_of(kind, tiled);
      write_exr(path, recipe, rgb);
      REQUIRE_NOTHROW(read_environment(path));
      const std::size_t rows = kind.compression == Imf::ZIP_COMPRESSION ? 16 : 1;
      const std::string bytes =
          tiled ? with_block(path, 8, 16, kind.block) : with_block(path, 32 / rows, 4, kind.block);
      std::ofstream(path, std::ios::binary) << bytes;
      INFO(kind.name << (tiled ? ", tiles" : ", rows"));
      const ThrownError error = thrown_by([&] { (void)read_environment(path); });
      CHECK(error.code == ErrorCode::corrupt_file);
      CHECK(error.message.find(tiled ? "tile 0, 0 unpacks to 100 bytes" : "the block of row 0 unpacks to 100 bytes") !=
            std::string::npos);
    }
  }
}

}  // namespace welkin::test
