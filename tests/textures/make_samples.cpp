// Writes one file of each kind for other programs to read: texture_samples DIRECTORY
//
// Also writes chain.f32 (the cubemap's RGB floats, level after level, face after face, rows from the top) and
// lat_long.f32. Values are halves, from 2^-6 to 2^7, so that half formats hold them exactly.
#include <Imath/half.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "support/chains.h"
#include "welkin/bake_file.h"
#include "welkin/environment_file.h"
#include "welkin/probes.h"
#include "welkin/resampling.h"

namespace {

using namespace welkin;

constexpr int kSize = 8;

float as_half(float value) { return static_cast<float>(Imath::half(value)); }

void write_floats(const std::filesystem::path& path, const float* values, std::size_t count) {
  std::ofstream stream(path, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(values), static_cast<std::streamsize>(count * sizeof(float)));
}

/// Writes blocks of ASTC and UASTC, and the texels of each level as Welkin's reader decodes them; none in a build
/// without astcenc.
void write_astc(const std::filesystem::path& directory, const Cubemap& chain) {
  const std::pair<TexelFormat, const char*> formats[] = {{TexelFormat::astc_4x4_hdr, "astc4x4"},
                                                         {TexelFormat::astc_6x6_hdr, "astc6x6"},
                                                         {TexelFormat::uastc_hdr_4x4, "uastc_hdr"}};
  for (const auto& [format, name] : formats) {
    const std::filesystem::path path = directory / (std::string(name) + ".ktx2");
    try {
      write_texture(path, chain.views(), {.format = format});
    } catch (const Error& error) {
      if (error.code() != ErrorCode::unsupported_file) throw;
      return;
    }
    const Cubemap decoded = read_texture(path).cubemap;
    write_floats(directory / (std::string(name) + ".f32"), decoded.face(0, 0), decoded.bytes() / sizeof(float));
    write_texture(directory / (std::string(name) + "_zstd.ktx2"), chain.views(),
                  {.format = format, .supercompression = Supercompression::zstd});
  }
}

void write_textures(const std::filesystem::path& directory, const Cubemap& chain) {
  const std::pair<TexelFormat, const char*> formats[] = {{TexelFormat::rgba16f, "rgba16f"},
                                                         {TexelFormat::rgba32f, "rgba32f"},
                                                         {TexelFormat::b10g11r11, "b10g11r11"},
                                                         {TexelFormat::e5b9g9r9, "e5b9g9r9"}};
  const std::pair<Supercompression, const char*> packings[] = {
      {Supercompression::none, ""}, {Supercompression::zlib, "_zlib"}, {Supercompression::zstd, "_zstd"}};
  for (const auto& [format, name] : formats) {
    for (const auto& [packing, suffix] : packings) {
      write_texture(directory / (std::string(name) + suffix + ".ktx2"), chain.views(),
                    {format, packing, {{"roughness", "0 0.25 1"}}});
    }
    write_texture(directory / (std::string(name) + ".dds"), chain.views(), {format});
    write_texture(directory / (std::string(name) + ".ktx"), chain.views(), {format, {}, {{"sh", "1 2 3\n"}}});
  }
  // Blocks of BC6H, and their texels as Welkin's reader decodes them.
  const TextureOptions blocks{.format = TexelFormat::bc6h_ufloat};
  for (const char* name : {"bc6h.dds", "bc6h.ktx", "bc6h.ktx2"}) write_texture(directory / name, chain.views(), blocks);
  const Cubemap decoded = read_texture(directory / "bc6h.dds").cubemap;
  write_environment(directory / "bc6h_decoded.pfm", decoded.view(0), {.layout = Layout::vertical_strip});
  write_floats(directory / "bc6h.f32", decoded.face(0, 0), decoded.bytes() / sizeof(float));
  write_astc(directory, chain);
  for (const char* name : {"image.ktx2", "image.dds"}) {
    write_texture_2d(directory / name, 16, 8, chain.face(0, 0), {TexelFormat::rgba16f});
  }
  write_texture_2d(directory / "image_zstd.ktx2", 16, 8, chain.face(0, 0),
                   {TexelFormat::rgba32f, Supercompression::zstd, {}});
  write_texture(directory / "half.exr", chain.views(), {TexelFormat::rgba16f});
  write_texture(directory / "float.exr", chain.views(), {TexelFormat::rgba32f});
}

/// Writes a map with its levels in one image, and the volumes of a grid of probes.
void write_images(const std::filesystem::path& directory, const Cubemap& chain) {
  const OctahedralMap map = to_octahedral(chain, {.size = 16, .levels = 3});
  std::vector<float> values;
  for (const std::vector<float>& level : map.levels) values.insert(values.end(), level.begin(), level.end());
  write_floats(directory / "octahedral.f32", values.data(), values.size());
  write_octahedral(directory / "octahedral_zstd.ktx2", map, {TexelFormat::rgba32f, Supercompression::zstd, {}});
  write_octahedral(directory / "octahedral_bc6h.ktx2", map, {.format = TexelFormat::bc6h_sfloat});
  const std::vector<CubemapView> captures(6, chain.view(0));
  const std::vector<float> distance(6, 0.5F);
  DepthView depth{{}, 1, 0};
  for (std::size_t face = 0; face < 6; ++face) depth.faces[face] = &distance[face];
  const std::vector<DepthView> depths(6, depth);
  const std::vector<ProbeLayout> layouts{ProbeLayout::three, ProbeLayout::unity_l2, ProbeLayout::unity_l1,
                                         ProbeLayout::bevy, ProbeLayout::rtxgi};
  const ProbeGrid grid{.counts = {3, 2, 1}, .origin = {-1.0, 0.5, 2.0}, .spacing = {0.75, 1.5, 2.0}};
  write_probes(directory / "probes.json", bake_probes(grid, captures, depths), layouts);
}

void write_env(const std::filesystem::path& directory, const Cubemap& chain) {
  BabylonEnvironment environment;
  environment.specular = test::changed(chain, [](float value) { return value; });
  environment.polynomial =
      BabylonPolynomial{{1, 2, 3}, {-0.1, 0.2, 0.3}, {0, 0, 1e-9},       {4, 5, 6},   {1.0 / 3.0, 0.25, 1e10},
                        {7, 8, 9}, {0.5, 1, -2},     {0.125, 0.0625, 3}, {11, 12, 13}};
  environment.irradiance = {kSize, {chain.face(0, 0), chain.face(0, 0) + 18 * kSize * kSize}};
  environment.dominant_direction = glm::dvec3(0.6, 0.0, -0.8);
  write_babylon_environment(directory / "sky.env", environment);
}

int run(const std::filesystem::path& directory) {
  std::filesystem::remove_all(directory);  // a stale file would hide that it is no longer written
  std::filesystem::create_directories(directory);
  const Cubemap chain = test::changed(test::noisy_chain(kSize, full_chain_levels(kSize)), as_half);
  write_floats(directory / "chain.f32", chain.face(0, 0), chain.bytes() / sizeof(float));
  write_textures(directory, chain);
  write_images(directory, chain);
  write_env(directory, chain);
  // A level's 6 N x N texels make a lat-long too: 16 x 8 from the first 128 of them.
  const LatLongView lat_long{chain.face(0, 0), 16, 8, 0, PixelFormat::rgb32f};
  write_environment(directory / "lat_long.exr", lat_long);
  write_environment(directory / "lat_long.hdr", lat_long);
  write_floats(directory / "lat_long.f32", chain.face(0, 0), std::size_t{3} * 16 * 8);
  return 0;
}

}  // namespace

int main(int argument_count, char** arguments) {
  if (argument_count != 2) {
    std::fputs("usage: texture_samples DIRECTORY, which is emptied\n", stderr);
    return 2;
  }
  try {
    return run(arguments[1]);
  } catch (const std::exception& failure) {
    std::fprintf(stderr, "texture_samples: %s\n", failure.what());
    return 1;
  }
}
