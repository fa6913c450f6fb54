// Parts, layers, levels and elements that a file does not have.
#include <zlib.h>

#include "support/catch.h"
#include "support/chains.h"
#include "support/exr_files.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/bake_file.h"
#include "welkin/environment_file.h"

namespace welkin::test {

// Promise: a part, layer, level or element that a file does not have is an error in every format, and never gives
// another image's light. Number 0, which every file has, may be requested.

namespace {

struct File {
  std::string name;
  std::vector<std::byte> bytes{};
};

std::vector<File> a_file_of_each_format() {
  const std::vector<float> pixels(std::size_t{3} * 8 * 4, 0.5F);
  const Cubemap chain = noisy_chain(4, 3);
  std::vector<File> files{{"sky.env"}, {"sky.hdr"}, {"sky.pfm"}, {"sky.png"},
                          {"sky.exr"}, {"sky.ktx"}, {"sky.dds"}, {"sky.ktx2"}};
  for (File& file : files) {
    const FileOutput output(file.bytes, file.name);
    const std::string extension = file.name.substr(4);
    if (extension == "env") {
      write_babylon_environment(output, to_babylon(chain, SphericalHarmonics(3)));
    } else if (extension == "dds" || extension.starts_with("ktx")) {
      write_texture(output, chain.views());
    } else {
      write_environment(output, LatLongView{pixels.data(), 8, 4, 0, PixelFormat::rgb32f});
    }
  }
  return files;
}

const std::vector<std::pair<const char*, ReadOptions>> kAskedFor{
    {"level 9", {.level = 9}},       {"level -1", {.level = -1}}, {"element 5", {.element = 5}},
    {"element -1", {.element = -1}}, {"part 3", {.part = "3"}},   {"part sky", {.part = "sky"}},
    {"layer sky", {.layer = "sky"}}};

}  // namespace

TEST_CASE("A part, layer, level or element that a file does not have is refused in every format", "[codec]") {
  for (const File& file : a_file_of_each_format()) {
    const FileInput input(file.bytes, file.name);
    for (const auto& asked : kAskedFor) {
      INFO(file.name << ", " << asked.first);
      const ReadOptions& options = asked.second;
      const ThrownError inspected = thrown_by([&] { static_cast<void>(inspect_environment(input, options)); });
      CHECK(inspected.code == ErrorCode::unsupported_file);
      CHECK(inspected.message.find(file.name + ": has ") == 0);
      CHECK(thrown_by([&] { static_cast<void>(read_environment(input, options)); }).message == inspected.message);
      CHECK(thrown_by([&] { static_cast<void>(project_file(input, options)); }).message == inspected.message);
    }
  }
}

TEST_CASE("Number 0 may be asked for in every format", "[codec]") {
  const ReadOptions options{.part = "0", .level = 0, .element = 0};
  for (const File& file : a_file_of_each_format()) {
    INFO(file.name);
    CHECK_NOTHROW(read_environment(FileInput(file.bytes, file.name), options));
  }
}

// OpenEXR blocks that unpack to less than their texels: an error, and never what memory held before.

namespace {

std::string zipped(const std::string& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string packed(size, '\0');
  REQUIRE(compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                   static_cast<uLong>(bytes.size())) == Z_OK);
  packed.resize(size);
  return packed;
}

/// Returns the sound file with its first block, by offset, replaced; `header_bytes` stand before the block's length.
std::string with_block(const std::filesystem::path& sound, std::size_t blocks, std::size_t header_bytes,
                       const std::string& block) {
  std::string bytes = read_text(sound);
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
  ExrRecipe recipe{.width = 64, .height = 32, .compression = kind.compression};
  if (tiled) recipe.tiles = Imf::TileDescription(16, 16);
  return recipe;
}

}  // namespace

TEST_CASE("an OpenEXR block that unpacks to too little is refused by its place", "[codec][damage]") {
  const TemporaryFile path("short.exr");
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
