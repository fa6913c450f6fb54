// Writes small sound files to start a fuzzer from: make_seeds exr|hdr|jpeg|pfm|png|ktx1|ktx2|dds|env|sky|probes|entry
// DIRECTORY
#include <ImfHeader.h>
#include <ImfStandardAttributes.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "cache/entry_store.h"
#include "cache/recipe.h"
#include "support/chains.h"
#include "support/exr_files.h"
#include "support/hdr_files.h"
#include "support/jpeg_files.h"
#include "support/ktx_files.h"
#include "support/pfm_files.h"
#include "support/png_files.h"
#include "support/temporary_directory.h"
#include "support/webp_env.h"
#include "welkin/bake_file.h"
#include "welkin/image.h"
#include "welkin/probes.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"
#include "welkin/sky.h"

namespace {

using namespace welkin;

// Writes EXR seeds with channels other than R, G and B, with other windows, and with several parts.
void make_odd_exr_seeds(const std::filesystem::path& directory) {
  const test::ExrRecipe plain{.width = 16, .height = 8};
  const std::vector<float> pixels = test::some_pixels(16, 8);
  const auto write = [&](const char* name, const test::ExrRecipe& recipe) {
    test::write_exr(directory / (std::string(name) + ".exr"), recipe, pixels);
  };
  test::ExrRecipe recipe = plain;
  recipe.channels = test::rgb_channels(Imf::UINT);
  write("uint", recipe);
  recipe.channels = {{"env.R"}, {"env.G"}, {"env.B"}, {"a.b.Y"}, {"N.X"}, {"N.Y"}, {"N.Z"}};
  write("layers", recipe);
  recipe = plain;
  recipe.adjust = [](Imf::Header& header) {
    Imf::addChromaticities(header, {{0.7F, 0.3F}, {0.2F, 0.8F}, {0.1F, 0.05F}, {0.33F, 0.33F}});
    Imf::addAdoptedNeutral(header, {0.34F, 0.35F});
    Imf::addWhiteLuminance(header, 100.0F);
  };
  write("chromaticities", recipe);
  test::write_luminance_chroma_exr(directory / "luminance_chroma.exr", recipe, pixels);
  recipe.first_row = -4;
  recipe.compression = Imf::PIZ_COMPRESSION;
  test::write_luminance_chroma_exr(directory / "luminance_chroma_piz.exr", recipe, pixels);
  recipe = plain;
  recipe.adjust = [](Imf::Header& header) { header.displayWindow() = {{-3, 2}, {16, 11}}; };
  write("windows", recipe);
  test::ExrPartRecipe mask{"mask", plain, pixels};
  mask.recipe.channels = {{"Y"}};
  test::ExrPartRecipe tiles{"tiles", plain, pixels};
  tiles.recipe.tiles = Imf::TileDescription(5, 4, Imf::MIPMAP_LEVELS);
  test::ExrPartRecipe deep{"deep", plain, pixels, true};
  deep.recipe.compression = Imf::ZIPS_COMPRESSION;
  test::write_exr_parts(directory / "parts.exr", {mask, {"sky", plain, pixels}, tiles});
  test::write_exr_parts(directory / "parts_tiled.exr", {mask, tiles});
  test::write_exr_parts(directory / "parts_deep.exr", {deep, mask});
}

void make_exr_seeds(const std::filesystem::path& directory) {
  const std::optional<Imf::TileDescription> tilings[] = {std::nullopt, Imf::TileDescription(8, 8),
                                                         Imf::TileDescription(5, 3, Imf::MIPMAP_LEVELS),
                                                         Imf::TileDescription(4, 4, Imf::RIPMAP_LEVELS)};
  int count = 0;
  for (int compression = 0; compression < Imf::NUM_COMPRESSION_METHODS; ++compression) {
    for (const auto& tiles : tilings) {
      for (const Imf::PixelType type : {Imf::HALF, Imf::FLOAT}) {
        test::ExrRecipe recipe{.width = 16,
                               .height = 8,
                               .first_column = -3,
                               .first_row = 5,
                               .compression = static_cast<Imf::Compression>(compression),
                               .tiles = tiles,
                               .channels = test::rgb_channels(type)};
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
  make_odd_exr_seeds(directory);
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

void make_hdr_seeds(const std::filesystem::path& directory) {
  const std::vector<std::string> headers[] = {
      {"FORMAT=32-bit_rle_rgbe"},
      {"FORMAT=32-bit_rle_xyze", "EXPOSURE=2", "COLORCORR=1 2 3"},
      {"# comment", "PRIMARIES=0.7 0.3 0.2 0.8 0.1 0.05 0.31 0.33", "GAMMA=2.2", "VIEW=-vtv"}};
  int count = 0;
  for (const test::HdrForm form :
       {test::HdrForm::flat, test::HdrForm::old_rle, test::HdrForm::new_rle, test::HdrForm::mixed}) {
    for (int orientation = 0; orientation < 8; ++orientation) {
      for (const auto& [width, height] : {std::pair{16, 8}, {6, 3}, {3, 18}}) {
        test::HdrRecipe recipe{width, height, form, orientation >= 4, orientation % 4 >= 2, orientation % 2 == 1};
        recipe.lines = headers[count % 3];
        test::write_bytes(directory / ("seed" + std::to_string(count++) + ".hdr"),
                          test::hdr_bytes(recipe, test::some_rgbe(width, height)));
      }
    }
  }
}

void make_jpeg_seeds(const std::filesystem::path& directory) {
  int count = 0;
  const std::string profile =
      test::profile_segment({{{0.5151, 0.2412, -0.0011}, {0.2920, 0.6922, 0.0419}, {0.1571, 0.0666, 0.7841}}});
  test::GainNumbers coloured;
  coloured.maximum = {3.0, 4.0, 2.5};
  for (const bool progressive : {false, true}) {
    for (const auto& gains : {std::pair{1, test::gain_xmp({})},
                              {1, test::gain_xmp(coloured)},
                              {2, test::gain_iso(coloured, true)},
                              {2, test::gain_iso({}, false)}}) {
      const int components = count % 2 == 0 ? 3 : 1;
      const std::vector<char> base =
          test::jpeg_bytes({12, 6, components, progressive, {{2, profile}}}, test::smooth_samples(12, 6, components));
      const std::vector<char> map =
          test::jpeg_bytes({4, 3, components, progressive, {gains}}, test::smooth_samples(4, 3, components));
      test::write_bytes(directory / ("seed" + std::to_string(count++) + ".jpg"), test::gain_map_file(base, map));
    }
  }
}

void make_png_seeds(const std::filesystem::path& directory) {
  int count = 0;
  for (const int colour_type : {SPNG_COLOR_TYPE_GRAYSCALE, SPNG_COLOR_TYPE_TRUECOLOR, SPNG_COLOR_TYPE_INDEXED,
                                SPNG_COLOR_TYPE_GRAYSCALE_ALPHA, SPNG_COLOR_TYPE_TRUECOLOR_ALPHA}) {
    for (const int bits : {2, 8, 16}) {
      const bool can_be_packed = colour_type == SPNG_COLOR_TYPE_GRAYSCALE || colour_type == SPNG_COLOR_TYPE_INDEXED;
      if ((bits == 2 && !can_be_packed) || (bits == 16 && colour_type == SPNG_COLOR_TYPE_INDEXED)) {
        continue;
      }
      for (const bool interlaced : {false, true}) {
        test::PngRecipe recipe{12, 6, bits, colour_type, interlaced};
        if (colour_type == SPNG_COLOR_TYPE_INDEXED) {
          recipe.palette = {{1, 2, 3, 0}, {4, 5, 6, 0}, {7, 8, 9, 0}};
        }
        recipe.srgb = count % 3 == 1;
        recipe.gamma = count % 3 == 2 ? std::optional<std::uint32_t>(100000) : std::nullopt;
        if (count % 4 == 3) {
          recipe.primaries = spng_chrm_int{31270, 32900, 70800, 29200, 17000, 79700, 13100, 4600};
        }
        const std::vector<char> file = test::png_bytes(recipe, test::some_samples(recipe));
        test::write_bytes(directory / ("seed" + std::to_string(count++) + ".png"),
                          test::with_png_chunk(file, "iCCP", "profile"));
      }
    }
  }
}

/// Blocks of ASTC, cubemaps and images: none in a build without astcenc.
void make_astc_seeds(const std::filesystem::path& directory) {
  int count = 0;
  for (const TexelFormat format : {TexelFormat::astc_4x4_hdr, TexelFormat::astc_6x6_hdr}) {
    for (const Supercompression packing : {Supercompression::none, Supercompression::zstd}) {
      const TextureOptions options{.format = format, .supercompression = packing};
      const Cubemap chain = test::noisy_chain(7, full_chain_levels(7), 2);
      const auto path = [&] { return directory / ("astc" + std::to_string(count++) + ".ktx2"); };
      try {
        write_texture(path(), chain.views(), options);
        write_texture_2d(path(), 14, 7, chain.face(0, 0), options);
      } catch (const Error& error) {
        if (error.code() != ErrorCode::unsupported_file) throw;
      }
    }
  }
}

void make_texture_seeds(const std::filesystem::path& directory, const std::string& extension) {
  int count = 0;
  for (const TexelFormat format :
       {TexelFormat::rgba16f, TexelFormat::rgba32f, TexelFormat::b10g11r11, TexelFormat::e5b9g9r9,
        TexelFormat::bc6h_ufloat, TexelFormat::bc6h_sfloat, TexelFormat::uastc_hdr_4x4}) {
    if (extension == ".dds" && format == TexelFormat::uastc_hdr_4x4) continue;
    for (const Supercompression packing : {Supercompression::none, Supercompression::zlib, Supercompression::zstd}) {
      if (extension == ".dds" && packing != Supercompression::none) continue;
      for (const int size : {1, 4, 5}) {
        TextureOptions options{format, packing, {}};
        if (count % 2 == 1) options.metadata = {{"roughness", "0 1"}, {"note", "seed"}};
        const Cubemap chain = test::noisy_chain(size, count % 3 == 0 ? 1 : full_chain_levels(size));
        write_texture(directory / ("seed" + std::to_string(count++) + extension), chain.views(), options);
        if (size < 4) continue;
        write_texture_2d(directory / ("seed" + std::to_string(count++) + extension), 2 * size, size, chain.face(0, 0),
                         options);
      }
    }
  }
}

void make_ktx2_seeds(const std::filesystem::path& directory) {
  make_texture_seeds(directory, ".ktx2");
  make_astc_seeds(directory);
}

/// Cubemaps and images, alone and in arrays, of each format.
void make_ktx1_seeds(const std::filesystem::path& directory) {
  struct Kind {
    std::uint32_t type, format, internal, texel_bytes;
  };
  int count = 0;
  for (const Kind& kind : {Kind{0x1406, 0x1908, 0x8814, 16}, Kind{0x140B, 0x1908, 0x881A, 8},
                           Kind{0x1406, 0x1907, 0x8815, 12}, Kind{0x8C3B, 0x1907, 0x8C3A, 4},
                           Kind{0x8C3E, 0x1907, 0x8C3D, 4}, Kind{0x1401, 0x1908, 0x8058, 4}, Kind{0, 0, 0x8E8F, 16}}) {
    for (const std::uint32_t faces : {6U, 1U}) {
      for (const std::uint32_t elements : {0U, 2U}) {
        const test::KtxKind shape{kind.type, kind.format, 4, faces == 6 ? 4U : 2U, elements, faces};
        const std::uint32_t texels = kind.type == 0 ? 1 : shape.width * shape.height;
        std::vector<std::byte> level;
        while (level.size() < std::size_t{texels} * kind.texel_bytes * faces * std::max(elements, 1U)) {
          test::append_value(level, std::uint32_t{0x3C003800});
        }
        const std::vector<std::byte> bytes = test::ktx1_bytes(shape, kind.internal, {level}, "1");
        std::ofstream(directory / ("seed" + std::to_string(count++) + ".ktx"), std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
      }
    }
  }
}

void make_env_seeds(const std::filesystem::path& directory) {
  int count = 0;
  for (const int size : {1, 2, 8}) {
    for (const int irradiance : {-1, 0, 3}) {  // -1: not even a polynomial
      BabylonEnvironment environment;
      environment.specular = test::noisy_chain(size, full_chain_levels(size));
      if (irradiance >= 0) environment.polynomial = BabylonPolynomial{};
      if (irradiance > 0) {
        environment.irradiance = test::noisy_chain(irradiance, 1);
        environment.dominant_direction = glm::dvec3(0.0, 1.0, 0.0);
      }
      const std::filesystem::path path = directory / ("seed" + std::to_string(count) + ".env");
      write_babylon_environment(path, environment);
      test::write_bytes(directory / ("webp" + std::to_string(count++) + ".env"),
                        test::with_webp_images(test::read_bytes(path)));
    }
  }
}

void make_sky_seeds(const std::filesystem::path& directory) {
  SkyTableOptions options{.heights = 2, .view_zeniths = 4, .sun_zeniths = 4, .sun_angles = 2, .orders = 1};
  options.transmittance_heights = options.transmittance_zeniths = 2;
  options.irradiance_heights = options.irradiance_sun_zeniths = 2;
  save_sky_tables(precompute_sky(earth(), options), directory / "full.sky");
  options.layout = ScatteringLayout::compact;
  save_sky_tables(precompute_sky(mars(), options), directory / "compact.sky");
}

void write_entry(const std::filesystem::path& path, cache::EntryKind kind, const cache::Bytes& payload) {
  const cache::EntryHeader header = cache::entry_header({kind, {1, 2}}, payload);
  const auto* const first = reinterpret_cast<const char*>(&header);
  std::vector<char> bytes(first, first + sizeof header);
  bytes.insert(bytes.end(), payload.begin(), payload.end());
  test::write_bytes(path, bytes);
}

void make_entry_seeds(const std::filesystem::path& directory) {
  const std::vector<float> pixels(6 * 4 * 4 * 3, 0.5F);
  const Cubemap image{4, pixels};
  using Kind = cache::EntryKind;
  write_entry(directory / "projection", Kind::projection, cache::encode(project(image.view())));
  const PrefilteredSpecular chain = prefilter_specular(image.view(), {.size = 2});
  write_entry(directory / "mip", Kind::specular_mip, cache::encode_mip(chain.mips.front(), chain.cubemap.face(0, 0)));
  write_entry(directory / "cubemap", Kind::cubemap, cache::encode(build_mips(image.view())));
  write_entry(directory / "faces", Kind::face_sums, cache::encode(*project_faces(image.view()).face(0)));
}

/// A description, a zero byte, the arrays.
void make_probe_seeds(const std::filesystem::path& directory) {
  const test::TemporaryDirectory folder;
  const std::vector<float> pixels(6 * 3, 0.5F);
  const Cubemap image{1, pixels};
  const std::vector<float> distance(6, 0.5F);
  DepthView depth{{}, 1, 0};
  for (std::size_t face = 0; face < 6; ++face) depth.faces[face] = &distance[face];
  for (const bool with_depths : {false, true}) {
    const std::vector<CubemapView> cubes(2, image.view());
    const std::vector<DepthView> depths(with_depths ? 2 : 0, depth);
    BakedProbes probes =
        bake_probes({.counts = {2, 1, 1}}, cubes, depths,
                    {.projection = {.bands = 1}, .distance_size = 1, .environment_bands = with_depths ? 1 : 0});
    if (with_depths) probes.offsets.assign(2, dvec3(0.1));
    write_probes(folder.file("probes.json"), probes);
    std::ofstream seed(directory / (with_depths ? "depths" : "plain"), std::ios::binary);
    seed << std::ifstream(folder.file("probes.json"), std::ios::binary).rdbuf() << '\0'
         << std::ifstream(folder.file("probes.bin"), std::ios::binary).rdbuf();
  }
}

using Maker = std::function<void(const std::filesystem::path& directory)>;

const std::map<std::string, Maker> kMakers{
    {"exr", make_exr_seeds},      {"hdr", make_hdr_seeds},
    {"pfm", make_pfm_seeds},      {"jpeg", make_jpeg_seeds},
    {"png", make_png_seeds},      {"ktx1", make_ktx1_seeds},
    {"ktx2", make_ktx2_seeds},    {"dds", [](const auto& directory) { make_texture_seeds(directory, ".dds"); }},
    {"env", make_env_seeds},      {"sky", make_sky_seeds},
    {"probes", make_probe_seeds}, {"entry", make_entry_seeds}};

}  // namespace

int main(int argument_count, char** arguments) {
  const auto maker = kMakers.find(argument_count == 3 ? arguments[1] : "");
  if (maker == kMakers.end()) {
    std::fputs("usage: fuzz_seeds exr|hdr|jpeg|pfm|png|ktx1|ktx2|dds|env|sky|probes|entry DIRECTORY\n", stderr);
    return 2;
  }
  maker->second(arguments[2]);
  return 0;
}
