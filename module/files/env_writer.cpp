// Babylon.js's .env files, written.
#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "files/codecs.h"
#include "files/env.h"
#include "files/layout.h"
#include "files/write_environment.h"
#include "harmonics/babylon.h"
#include "image/pixels.h"
#include "jobs/control.h"
#include "jobs/tiles.h"
#include "platform/file.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "welkin/bake_file.h"
#include "welkin/engines.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::files {
namespace {

// Babylon.js's .env, version 2, with PNG pictures.

/// A face to be encoded, and what became of it.
struct Picture {
  CubemapView view;
  int face = 0;
  std::vector<std::uint8_t> png{};
  std::uint64_t clamped = 0;
};

void encode(Picture& picture, const RgbdEncoder& encoder, const stop_token& stop) {
  const auto size = static_cast<std::size_t>(picture.view.size);
  std::vector<std::uint8_t> rgba(4 * size * size);
  for (std::size_t row = 0; row < size; ++row) {  // bottom row first
    jobs::throw_if_cancelled(stop);
    const auto* rgb = static_cast<const float*>(
        image::row_of(picture.view, picture.face, picture.view.size - 1 - static_cast<int>(row)));
    picture.clamped += encoder.encode(rgb, size, rgba.data() + 4 * size * row);
  }
  picture.png = encode_png_rgba(rgba, picture.view.size, stop);
}

void require_finite(const glm::dvec3& value, const char* what) {
  if (std::isfinite(value.x) && std::isfinite(value.y) && std::isfinite(value.z)) return;
  throw Error(ErrorCode::invalid_argument, std::string("the .env's ") + what + " is not finite; pass finite values");
}

void check_polynomial(const BabylonPolynomial& polynomial) {
  for (const glm::dvec3& term : {polynomial.x, polynomial.y, polynomial.z, polynomial.xx, polynomial.yy, polynomial.zz,
                                 polynomial.yz, polynomial.zx, polynomial.xy}) {
    require_finite(term, "polynomial");
  }
}

void check_irradiance(const BabylonEnvironment& environment) {
  const bool has_texture = environment.irradiance.levels() != 0 || environment.dominant_direction;
  if (has_texture && !environment.polynomial) {
    throw Error(ErrorCode::invalid_argument,
                "the .env has an irradiance texture and no polynomial, which Babylon.js reads first; pass one "
                "(babylon_polynomial)");
  }
  if (environment.dominant_direction && environment.irradiance.levels() == 0) {
    throw Error(ErrorCode::invalid_argument,
                "the .env has a dominant direction and no irradiance texture; pass both, or neither");
  }
}

void check(const BabylonEnvironment& environment) {
  const Cubemap& chain = environment.specular;
  const int size = chain.size();
  if (size < 1 || !std::has_single_bit(static_cast<unsigned>(size)) || chain.levels() != full_chain_levels(size)) {
    throw Error(ErrorCode::invalid_argument, "the chain has " + std::to_string(chain.levels()) + " levels from size " +
                                                 std::to_string(size) +
                                                 "; an .env needs a power of two with all levels down to 1 texel");
  }
  if (environment.polynomial) check_polynomial(*environment.polynomial);
  if (environment.dominant_direction) require_finite(*environment.dominant_direction, "dominant direction");
  if (!std::isfinite(environment.lod_generation_scale) || environment.lod_generation_scale < 0.0) {
    throw Error(ErrorCode::invalid_argument, "the .env's lodGenerationScale is " +
                                                 platform::number_text(environment.lod_generation_scale) +
                                                 "; pass a finite value from 0 up (Babylon.js uses 0.8)");
  }
  check_irradiance(environment);
}

/// The six faces of each, encoded in parallel, in that order.
std::vector<Picture> encoded(const std::vector<CubemapView>& levels, const Control& control) {
  std::vector<Picture> pictures;
  std::int64_t texels = 0;
  for (const CubemapView& view : levels) {
    for (int face = 0; face < 6; ++face) pictures.push_back({view, face});
    texels = std::max(texels, std::int64_t{6} * view.size * view.size);
  }
  const RgbdEncoder encoder;
  constexpr std::int64_t as_texels = 16;  // packing one takes as long as doing other things with so many
  const jobs::Placement placement = jobs::placement_for(as_texels * texels);
  jobs::run_tiles(pictures.size(), placement, jobs::worker_count(placement), control,
                  [&](std::size_t tile, std::size_t) { encode(pictures[tile], encoder, control.stop); });
  return pictures;
}

std::vector<CubemapView> levels_of(const BabylonEnvironment& environment) {
  std::vector<CubemapView> levels = environment.specular.views();
  if (environment.irradiance.levels() != 0) levels.push_back(environment.irradiance.view());
  return levels;
}

EnvManifest manifest_for(const BabylonEnvironment& environment, const std::vector<Picture>& pictures) {
  EnvManifest manifest;
  manifest.width = environment.specular.size();
  manifest.polynomial = environment.polynomial;
  manifest.lod_generation_scale = environment.lod_generation_scale;
  manifest.irradiance_size = environment.irradiance.size();
  manifest.dominant_direction = environment.dominant_direction;
  const std::size_t specular = std::size_t{6} * static_cast<std::size_t>(environment.specular.levels());
  std::uint64_t position = 0;
  for (std::size_t index = 0; index < pictures.size(); ++index) {
    auto& list = index < specular ? manifest.specular : manifest.irradiance;
    list.push_back({position, pictures[index].png.size()});
    position += pictures[index].png.size();
  }
  return manifest;
}

}  // namespace
}  // namespace welkin::files

namespace welkin {
namespace {

// From Welkin's axes to Babylon.js's left-handed ones and back: x changes its sign.

/// On every face columns run along or against x, or else against or along z where x is what tells +X from -X: so
/// those two change places, and the columns of all six run the other way.
void mirror_face(const float* from, int size, float* to) {
  const std::ptrdiff_t row_floats = std::ptrdiff_t{3} * size;
  for (std::ptrdiff_t row = 0; row < size; ++row) {
    files::copy_segment(from + row * row_floats, to + row * row_floats, size, true);
  }
}

int mirrored_side(int side) { return side < 2 ? 1 - side : side; }

}  // namespace

Cubemap mirrored_x(const Cubemap& cubemap) {
  if (cubemap.levels() == 0) return {};
  Cubemap mirrored(cubemap.size(), cubemap.levels());
  for (int level = 0; level < cubemap.levels(); ++level) {
    for (int side = 0; side < 6; ++side) {
      mirror_face(cubemap.face(level, side), cubemap.level_size(level), mirrored.face(level, mirrored_side(side)));
    }
  }
  return mirrored;
}

BabylonEnvironment to_babylon(const Cubemap& specular, const SphericalHarmonics& radiance,
                              const Cubemap& irradiance_over_pi) {
  const platform::FloatingPointScope floating_point;
  BabylonEnvironment environment;
  environment.specular = mirrored_x(specular);
  environment.polynomial = babylon_polynomial(rotate(radiance, convention(Engine::babylon).from_welkin));
  environment.irradiance = mirrored_x(irradiance_over_pi);
  return environment;
}

WriteReport write_babylon_environment(const FileOutput& output, const BabylonEnvironment& environment,
                                      const Control& control) {
  const platform::FloatingPointScope floating_point;
  files::check(environment);
  files::require_codec(files::Codec::png, output.path(), "write a texture (.ktx2, .dds)");
  files::OutputFiles written;
  platform::WholeFile& file = written.add(output);
  const std::vector<files::Picture> pictures =
      files::encoded(files::levels_of(environment), jobs::part_of(control, 0.0, 0.95));

  std::uint64_t values_clamped = 0;
  const std::string manifest = files::env_manifest_bytes(files::manifest_for(environment, pictures));
  file.write(manifest.data(), manifest.size());
  for (const files::Picture& picture : pictures) {
    file.write(picture.png.data(), picture.png.size());
    values_clamped += picture.clamped;
  }
  return written.commit(values_clamped, control);
}

RgbdPictures rgbd_pictures(const Cubemap& chain, const Control& control) {
  const platform::FloatingPointScope floating_point;
  files::require_codec(files::Codec::png, "images of RGBD", "write a texture (.ktx2, .dds)");
  RgbdPictures result;
  for (files::Picture& picture : files::encoded(chain.views(), control)) {
    result.png.push_back(std::move(picture.png));
    result.values_clamped += picture.clamped;
  }
  return result;
}

}  // namespace welkin
