// Babylon.js's .env, version 2, with PNG pictures: see env_manifest.h.
#include <bit>
#include <cmath>
#include <string>
#include <vector>

#include "codec/env_manifest.h"
#include "codec/env_pictures.h"
#include "codec/rgbd.h"
#include "codec/stop.h"
#include "codec/whole_file.h"
#include "image/check_views.h"
#include "image/float_plane.h"
#include "jobs/tiles.h"
#include "welkin/babylon_environment.h"

namespace welkin {
namespace codec {
namespace {

/// A face to be encoded, and what became of it.
struct Picture {
  CubemapView view;
  int face = 0;
  std::vector<std::uint8_t> png{};
  std::uint64_t clamped = 0;
};

void encode(Picture& picture, const RgbdEncoder& encoder, const std::stop_token& stop) {
  const auto size = static_cast<std::size_t>(picture.view.size);
  std::vector<std::uint8_t> rgba(4 * size * size);
  for (std::size_t row = 0; row < size; ++row) {  // bottom row first
    throw_if_stopped(stop);
    const auto* rgb = static_cast<const float*>(
        image::row_of(picture.view, picture.face, picture.view.size - 1 - static_cast<int>(row)));
    picture.clamped += encoder.encode(rgb, size, rgba.data() + 4 * size * row);
  }
  picture.png = encode_png_rgba(rgba, picture.view.size, stop);
}

void require_finite(const glm::dvec3& value, const char* what) {
  if (std::isfinite(value.x) && std::isfinite(value.y) && std::isfinite(value.z)) return;
  throw Error(ErrorCode::invalid_argument, std::string("the .env's ") + what + " is not finite");
}

void check_polynomial(const BabylonPolynomial& polynomial) {
  for (const glm::dvec3& term : {polynomial.x, polynomial.y, polynomial.z, polynomial.xx, polynomial.yy, polynomial.zz,
                                 polynomial.yz, polynomial.zx, polynomial.xy}) {
    require_finite(term, "polynomial");
  }
}

void check_irradiance(const BabylonEnvironment& environment) {
  const CubemapImage& irradiance = environment.irradiance;
  if (irradiance.size != 0) {
    image::check_face_size(irradiance.size);
    const auto edge = static_cast<std::size_t>(irradiance.size);
    if (irradiance.pixels.size() != 18 * edge * edge) {
      throw Error(ErrorCode::invalid_argument, "the .env's irradiance cubemap has " +
                                                   std::to_string(irradiance.pixels.size()) +
                                                   " values; its size takes " + std::to_string(18 * edge * edge));
    }
  }
  const bool has_texture = irradiance.size != 0 || environment.dominant_direction;
  if (has_texture && !environment.polynomial) {
    throw Error(ErrorCode::invalid_argument,
                "an .env with an irradiance texture has a polynomial too, which Babylon.js reads first; pass one "
                "(babylon_polynomial)");
  }
  if (environment.dominant_direction && irradiance.size == 0) {
    throw Error(ErrorCode::invalid_argument,
                "an .env keeps a dominant direction with its irradiance texture alone; pass one, or leave it out");
  }
}

void check(const BabylonEnvironment& environment) {
  const CubemapChain& chain = environment.specular;
  const int size = chain.size();
  if (size < 1 || !std::has_single_bit(static_cast<unsigned>(size)) || chain.levels() != full_chain_levels(size)) {
    throw Error(ErrorCode::invalid_argument,
                "an .env holds a chain whose size is a power of two, down to 1 texel; this one has " +
                    std::to_string(chain.levels()) + " levels from " + std::to_string(size));
  }
  if (environment.polynomial) check_polynomial(*environment.polynomial);
  if (environment.dominant_direction) require_finite(*environment.dominant_direction, "dominant direction");
  if (!std::isfinite(environment.lod_generation_scale) || environment.lod_generation_scale < 0.0) {
    throw Error(ErrorCode::invalid_argument, "the .env's lodGenerationScale is " +
                                                 std::to_string(environment.lod_generation_scale) +
                                                 "; it is not below 0, and Babylon.js's own is 0.8");
  }
  check_irradiance(environment);
}

std::vector<Picture> pictures_of(const BabylonEnvironment& environment) {
  std::vector<Picture> pictures;
  const auto add = [&pictures](const CubemapView& view) {
    for (int face = 0; face < 6; ++face) pictures.push_back({view, face});
  };
  for (const CubemapView& view : environment.specular.views()) add(view);
  if (environment.irradiance.size != 0) add(environment.irradiance.view());
  return pictures;
}

EnvManifest manifest_for(const BabylonEnvironment& environment, const std::vector<Picture>& pictures) {
  EnvManifest manifest;
  manifest.width = environment.specular.size();
  manifest.polynomial = environment.polynomial;
  manifest.lod_generation_scale = environment.lod_generation_scale;
  manifest.irradiance_size = environment.irradiance.size;
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
}  // namespace codec

WriteReport write_babylon_environment(const std::filesystem::path& path, const BabylonEnvironment& environment,
                                      const Control& control) {
  codec::check(environment);
  codec::WholeFile file(path);
  std::vector<codec::Picture> pictures = codec::pictures_of(environment);
  const codec::RgbdEncoder encoder;
  const auto size = std::int64_t{environment.specular.size()};
  constexpr std::int64_t as_texels = 16;  // packing one takes as long as doing other things with so many
  const jobs::Placement placement = jobs::placement_for(as_texels * 6 * size * size);
  const Control packing = jobs::part_of(control, 0.0, 0.95);
  jobs::run_tiles(pictures.size(), placement, jobs::worker_count(placement), packing,
                  [&](std::size_t tile, std::size_t) { codec::encode(pictures[tile], encoder, control.stop); });

  WriteReport report;
  const std::string manifest = codec::env_manifest_bytes(codec::manifest_for(environment, pictures));
  file.write(manifest.data(), manifest.size());
  for (const codec::Picture& picture : pictures) {
    file.write(picture.png.data(), picture.png.size());
    report.values_clamped += picture.clamped;
  }
  file.finish();
  file.commit();
  report.files.push_back(file.path());
  if (control.progress) control.progress(1.0);
  return report;
}

}  // namespace welkin
