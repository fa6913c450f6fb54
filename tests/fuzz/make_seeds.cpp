// Writes small sound files to start a fuzzer from: make_seeds exr|pfm DIRECTORY
#include <cstdio>
#include <string>

#include "support/exr_files.h"
#include "support/pfm_files.h"
#include "support/temporary_directory.h"

namespace {

using namespace welkin;

void make_exr_seeds(const std::filesystem::path& directory) {
  const std::optional<Imf::TileDescription> tilings[] = {std::nullopt, Imf::TileDescription(8, 8),
                                                         Imf::TileDescription(5, 3, Imf::MIPMAP_LEVELS),
                                                         Imf::TileDescription(4, 4, Imf::RIPMAP_LEVELS)};
  int count = 0;
  for (int compression = 0; compression < Imf::NUM_COMPRESSION_METHODS; ++compression) {
    for (const auto& tiles : tilings) {
      for (const Imf::PixelType type : {Imf::HALF, Imf::FLOAT}) {
        test::ExrRecipe recipe{16,    8,  -3, 5, static_cast<Imf::Compression>(compression), Imf::INCREASING_Y,
                               tiles, {}, {}};
        recipe.channels = test::rgb_channels(type);
        if (count % 4 == 3) {
          recipe.width = 4;
          recipe.height = 24;
          recipe.envmap = Imf::ENVMAP_CUBE;
        }
        if (count % 5 == 4) {
          recipe.channels = {{"Y", type}, {"A", Imf::HALF}};
        }
        test::write_exr(directory / ("seed" + std::to_string(count++) + ".exr"), recipe,
                        test::some_pixels(recipe.width, recipe.height));
      }
    }
  }
}

void make_pfm_seeds(const std::filesystem::path& directory) {
  int count = 0;
  for (const bool grey : {false, true}) {
    for (const char* scale : {"-1.0", "1", "-2.5e-3"}) {
      for (const auto& [width, height] : {std::pair{8, 4}, {2, 12}, {2, 1}}) {
        std::vector<float> values = test::some_pixels(width, height);
        values.resize(values.size() / (grey ? 3 : 1));
        test::write_bytes(directory / ("seed" + std::to_string(count++) + ".pfm"),
                          test::pfm_bytes(width, height, grey, scale, values));
      }
    }
  }
}

}  // namespace

int main(int argument_count, char** arguments) {
  const std::string format = argument_count == 3 ? arguments[1] : "";
  if (format == "exr") {
    make_exr_seeds(arguments[2]);
  } else if (format == "pfm") {
    make_pfm_seeds(arguments[2]);
  } else {
    std::fputs("usage: fuzz_seeds exr|pfm DIRECTORY\n", stderr);
    return 2;
  }
  return 0;
}
