#include "tools/bake_source.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "tools/progress_bar.h"
#include "tools/sky_model.h"
#include "welkin/error.h"
#include "welkin/harmonic_transforms.h"
#include "welkin/resampling.h"

namespace welkin::tool {
namespace {

constexpr double kRead = 0.7;  // of the progress; the rest is turning

bool is_reused(const Projection& projection) {
  const std::vector<PassRecord>& passes = projection.diagnostics.passes;
  return std::any_of(passes.begin(), passes.end(),
                     [](const PassRecord& pass) { return pass.name == "project" && pass.action == "reuse"; });
}

/// The light that an .env file stores beside its pixels; none where there is no polynomial, at a smaller level, and
/// where pixels are to be clamped or decoded: that light was made without.
std::optional<Projection> light_stored_in(const EnvironmentInfo& info, const BakeCommandOptions& options,
                                          const Control& control) {
  const ReadOptions& read = options.common.read;
  if (info.format != "Babylon.js .env" || read.level != 0) return std::nullopt;
  if (options.sun.take_out || options.clamp.clamps || options.bake.pixels.gamma) return std::nullopt;
  Projection projection = project_file(info.path, read, {}, {control.stop, {}});
  if (!is_reused(projection)) return std::nullopt;
  return projection;
}

}  // namespace

BakeSource::BakeSource(const BakeCommandOptions& options, const Control& control) {
  read(options, part_of(control, 0.0, kRead));
  if (options.sun.take_out) {
    sun_ = file_ ? take_out_sun(*file_, options.sun.options) : take_out_sun(pixels_, options.sun.options);
  }
  turn(options, part_of(control, kRead, 1.0));
}

std::uint64_t BakeSource::bytes() const noexcept {
  constexpr std::uint64_t kTexelBytes = 12;
  if (!file_) {
    return sizeof(float) * (pixels_.cubemap.pixels.size() + pixels_.lat_long.pixels.size() + picture_.pixels.size());
  }
  const auto face = static_cast<std::uint64_t>(file_->face_size());
  const auto texels = static_cast<std::uint64_t>(file_->info.width) * static_cast<std::uint64_t>(file_->info.height);
  return kTexelBytes * (face > 0 ? 6 * face * face : texels);
}

void BakeSource::read(const BakeCommandOptions& options, const Control& control) {
  if (!options.input) {
    ComputedPicture computed = options.compute ? options.compute(control) : built_in_sky(control);
    pixels_.lat_long = std::move(computed.image);
    description_ = std::move(computed.source);
    sky_ = std::move(computed.sky);
    sun_ = computed.sun;
    if (!options.picture_name.empty()) picture_ = pixels_.lat_long;
    return;
  }
  file_ = read_environment(*options.input, options.common.read, control);
  description_ = source_of(*options.input, file_->info);
  stored_light_ = light_stored_in(file_->info, options, control);
}

void BakeSource::turn(const BakeCommandOptions& options, const Control& control) {
  TurnOptions into_welkin = options.turn;
  into_welkin.to = Engine::welkin;
  if (sun_) sun_->direction = turn_of_light(into_welkin, is_cubemap()) * sun_->direction;
  const glm::dmat3 matrix = turn_of_picture(into_welkin, is_cubemap(), is_cubemap());
  if (matrix == glm::dmat3(1.0)) return;
  if (stored_light_) {
    SphericalHarmonics& radiance = stored_light_->radiance;
    radiance = transform(radiance, turn_of_light(into_welkin, is_cubemap()));
  }
  const std::uint64_t limit = options.common.read.memory_limit_bytes;
  if (2 * bytes() > limit) {
    throw Error(ErrorCode::limit_exceeded, description_.path + ": takes " + std::to_string(2 * bytes()) +
                                               " bytes while it is turned, above the limit of " +
                                               std::to_string(limit) + "; raise --memory-limit");
  }
  Pixels turned;
  turned.is_cubemap = is_cubemap();
  if (turned.is_cubemap) {
    const CubemapView view = file_ ? file_->cubemap() : pixels_.cubemap.view();
    turned.cubemap = to_cubemap(view, view.size, matrix, control);
  } else {
    const LatLongView view = file_ ? file_->lat_long() : pixels_.lat_long.view();
    turned.lat_long = to_lat_long(view, view.width, view.height, matrix, control);
  }
  pixels_ = std::move(turned);
  file_.reset();
}

}  // namespace welkin::tool
