#include "tools/batch_costs.h"

#include <algorithm>

#include "welkin/plan.h"

namespace welkin::tool {
namespace {

// Processor time beside the passes that a plan knows, measured on an EPYC (Zen 4, one thread, user time) whose cores
// others used too: bakes of a photograph of 1024 x 512 with `--size 256`, less what the same bake costs without. They
// only decide what is a fair share.
constexpr double kSecondsOfAJob = 0.004;           // opening, hashing and naming eight files
constexpr double kSecondsOfATexel = 20e-9;         // reading one
constexpr double kSecondsOfAByte = 2e-9;           // writing one, of the results in memory
constexpr double kSecondsOfPreviews = 0.12;        // of spheres of the default size
constexpr double kSecondsOfLatLongTexel = 240e-9;  // resampled from the background

double texels_of_chain(double size) { return 6.0 * size * size * 4.0 / 3.0; }

/// Seconds per texel that encoding a file takes beyond copying it.
double encoding_of(const OutputFile& file) {
  double seconds = 0.0;
  switch (file.container) {
    case Container::exr: seconds = 75e-9; break;
    case Container::hdr: seconds = 18e-9; break;
    case Container::env:
    case Container::glb: seconds = 120e-9; break;
    default: break;
  }
  if (file.container == Container::ktx2) {
    if (file.supercompression == Supercompression::zlib) seconds += 350e-9;
    if (file.supercompression == Supercompression::zstd) seconds += 40e-9;
    if (file.format == TexelFormat::astc_4x4_hdr) seconds += 1950e-9;
    if (file.format == TexelFormat::astc_6x6_hdr) seconds += 2550e-9;
  }
  return seconds;
}

/// Returns the picture's own size for a lat-long that stands alone in an engine's folder, else the background's.
double lat_long_texels(const Prediction& prediction, const BakeCommandOptions& options) {
  const double face = std::max(1, options.background_size > 0 ? options.background_size : options.specular.size);
  const bool is_alone = is_engine_folder(options) && !contains(options.files, Content::background);
  const double texels = 8.0 * face * face;
  return is_alone && options.background_size == 0 ? std::max(texels, static_cast<double>(prediction.texels)) : texels;
}

double texels_in(const OutputFile& file, const Prediction& prediction, const BakeCommandOptions& options) {
  const double specular = options.specular.size;
  switch (file.content) {
    case Content::lat_long: return lat_long_texels(prediction, options);
    case Content::background: return texels_of_chain(options.background_size > 0 ? options.background_size : specular);
    case Content::octahedral: return texels_of_chain(options.octahedral_size) / 6.0;
    case Content::lambert:
    case Content::irradiance: return 6.0 * options.irradiance_size * options.irradiance_size;
    case Content::brdf:
    case Content::usd_stage:
    case Content::readme: return 0.0;
    default: return texels_of_chain(specular);
  }
}

/// Returns whether the scene leaves it out.
bool is_needed(Content content, const SceneNeeds& needs) {
  switch (content) {
    case Content::lat_long:
    case Content::background: return needs.background;
    case Content::env:
    case Content::gltf_light:
    case Content::octahedral:
    case Content::specular:
    case Content::charlie:
    case Content::phong: return needs.glossy.has_value();
    default: return true;
  }
}

double seconds_of_files(const Prediction& prediction, const BakeCommandOptions& options) {
  const SceneNeeds needs = options.scene.needs();
  double seconds = 0.0;
  for (const OutputFile& file : options.files) {
    if (is_needed(file.content, needs)) seconds += encoding_of(file) * texels_in(file, prediction, options);
  }
  if (contains(options.files, Content::lat_long) && needs.background)
    seconds += kSecondsOfLatLongTexel * lat_long_texels(prediction, options);
  return seconds;
}

}  // namespace

double seconds_of_job(const Prediction& prediction, const BakeCommandOptions& options) {
  constexpr double kMilliseconds = 1e-3;
  const double ball = static_cast<double>(options.preview_size) / BakeCommandOptions().preview_size;
  return kSecondsOfAJob + kMilliseconds * prediction.milliseconds +
         kSecondsOfATexel * static_cast<double>(prediction.texels) +
         kSecondsOfAByte * static_cast<double>(prediction.result_bytes) + seconds_of_files(prediction, options) +
         (options.previews ? kSecondsOfPreviews * ball * ball : 0.0);
}

}  // namespace welkin::tool
