// Plans for files carried out.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <optional>
#include <span>
#include <sstream>
#include <utility>

#include "bake/bake_plan.h"
#include "files/env_manifest.h"
#include "files/textures.h"
#include "jobs/tiles.h"
#include "platform/file.h"
#include "welkin/babylon_environment.h"
#include "welkin/bake_file.h"
#include "welkin/error.h"
#include "welkin/harmonic_transforms.h"
#include "welkin/irradiance_cubemap.h"
#include "welkin/plan.h"
#include "welkin/roughness.h"
#include "welkin/stored_environment.h"
#include "welkin/texture_file.h"

namespace welkin {
namespace {

constexpr double kReadingShare = 0.5;  ///< of the progress

/// What was read of a file, in Welkin's axes.
struct Contents {
  CubemapChain chain;       ///< of files with levels
  Environment environment;  ///< of others
};

Contents read_contents(const StoredEnvironment& file, const Plan& plan, const Control& control) {
  Contents contents;
  const std::uint64_t limit = file.read.memory_limit_bytes;
  if (!plan.take_specular && !plan.take_levels) {
    contents.environment = read_environment(file.path, file.read, control);
  } else if (file.info.format == "Babylon.js .env") {
    contents.chain = mirrored_x(read_babylon_environment(file.path, limit, control).specular);
  } else {
    contents.chain = read_texture(file.path, limit, control).cubemap;
  }
  return contents;
}

/// The mips that are used, and what is known of them.
PrefilteredSpecular stored_specular(const StoredEnvironment& file, const Plan& plan, const CubemapChain& chain) {
  PrefilteredSpecular part;
  part.cubemap = CubemapChain(chain.level_size(plan.first_stored_mip), plan.stored_mips);
  for (int level = 0; level < plan.stored_mips; ++level) {
    const int mip = plan.first_stored_mip + level;
    const auto edge = static_cast<std::size_t>(part.cubemap.level_size(level));
    std::memcpy(part.cubemap.face(level, 0), chain.face(mip, 0), 18 * edge * edge * sizeof(float));
    MipRecord record;
    record.size = part.cubemap.level_size(level);
    record.roughness = file.roughness[static_cast<std::size_t>(mip)];
    record.method = "stored";
    record.mean = average_radiance(project(part.cubemap.view(level), {.bands = 1}).radiance);
    part.mips.push_back(std::move(record));
  }
  return part;
}

/// The file's name comes before faces, rows and columns.
template <class Work>
void naming_file(const StoredEnvironment& file, const Work& work) {
  try {
    work();
  } catch (const Error& failure) {
    if (failure.code() != ErrorCode::rejected_pixel) throw;
    throw platform::file_error(failure.code(), file.path, failure.what());
  }
}

/// Light from the polynomial.
std::optional<SphericalHarmonics> stored_light(const StoredEnvironment& file, const Plan& plan,
                                               const Control& control) {
  if (!plan.take_light) return std::nullopt;
  return project_file(file.path, file.read, {}, {control.stop, {}}).radiance;
}

BakeResult bake_contents(const StoredEnvironment& file, const Plan& plan, Contents contents, const Control& control) {
  BakeResult result;
  baking::StoredResults stored;
  const std::optional<SphericalHarmonics> light = stored_light(file, plan, control);
  if (light) stored.harmonics = &*light;
  PrefilteredSpecular specular;
  if (plan.take_specular) {
    specular = stored_specular(file, plan, contents.chain);
    stored.specular = &specular;
  }
  if (plan.take_levels) stored.levels = &contents.chain;
  const auto bake_view = [&](const auto& view) {
    baking::bake_source(result, view, plan.options, stored, plan.passes, control);
  };
  if (contents.chain.levels() > 0) {
    bake_view(contents.chain.view(0));
  } else if (contents.environment.face_size() > 0) {
    bake_view(contents.environment.cubemap());
  } else {
    bake_view(contents.environment.lat_long());
  }
  return result;
}

/// As it stands in the manifest.
std::optional<BabylonPolynomial> stored_polynomial(const StoredEnvironment& file) {
  if (!file.has_polynomial) return std::nullopt;
  platform::ByteFile bytes(file.path);
  return files::read_env_manifest(bytes).polynomial;
}

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Only light, a table, or nothing: no pixel is held.
class StreamedBake {
 public:
  StreamedBake(const StoredEnvironment& file, const Plan& plan) : file_(file), plan_(plan) {}

  BakeResult run(const Control& control) {
    baking::require_memory(plan_.result_bytes, plan_.working_bytes, plan_.options);
    for (const PlannedPass& pass : plan_.passes) {
      const Clock::time_point start = Clock::now();
      if (pass.action != PassAction::skip) run_pass(pass.name, control);
      records_.push_back({pass.name, name(pass.action), pass.reason,
                          pass.action == PassAction::skip ? 0.0 : milliseconds_since(start)});
    }
    result_.diagnostics.passes = std::move(records_);
    result_.peak_bytes = plan_.result_bytes + plan_.working_bytes;
    if (control.progress) control.progress(1.0);
    return std::move(result_);
  }

 private:
  /// Reading and projecting are one: all of it counts as projecting.
  void run_pass(const std::string& pass, const Control& control) {
    const BakeOptions& options = plan_.options;
    if (pass == "project") {
      ProjectionOptions projecting = options.pixels;
      projecting.target_size = 0;
      projecting.quadrature = Quadrature::exact;
      const int projected = plan_.take_light ? 0 : options.projected_bands;
      projecting.bands = options.bands > 0 ? std::max(options.bands, projected) : 1;
      Projection projection = project_file(file_.path, file_.read, projecting, jobs::part_of(control, 0.0, 0.9));
      if (options.bands > 0 && options.bands < projecting.bands)
        projection.radiance = with_bands(projection.radiance, options.bands);
      result_.diagnostics = std::move(projection.diagnostics);
      if (options.bands > 0) result_.radiance = std::move(projection.radiance);
    } else if (pass == "irradiance") {
      result_.irradiance =
          irradiance_cubemap(irradiance_from_radiance(*result_.radiance), options.irradiance_size, {control.stop, {}});
    } else if (pass == "brdf") {
      result_.brdf = brdf_table(*options.brdf, {control.stop, {}});
    }
  }

  const StoredEnvironment& file_;
  const Plan& plan_;
  BakeResult result_;
  std::vector<PassRecord> records_;
};

}  // namespace

BakeResult bake(const StoredEnvironment& file, const Plan& plan, const Control& control) {
  if (plan.source != file.words()) {
    throw Error(ErrorCode::invalid_argument,
                "the plan is for " + plan.source + ", the file is " + file.words() + "; plan again for this file");
  }
  if (plan.streams) {
    BakeResult streamed = StreamedBake(file, plan).run(control);
    streamed.stored_polynomial = stored_polynomial(file);
    return streamed;
  }
  const Clock::time_point start = Clock::now();
  Contents contents = read_contents(file, plan, jobs::part_of(control, 0.0, kReadingShare));
  const double reading = milliseconds_since(start);
  BakeResult result;
  naming_file(file, [&] {
    result = bake_contents(file, plan, std::move(contents), jobs::part_of(control, kReadingShare, 1.0));
  });
  std::vector<PassRecord>& passes = result.diagnostics.passes;
  result.stored_polynomial = stored_polynomial(file);
  const PlannedPass& read = plan.pass("read");
  passes.insert(passes.begin(), {read.name, name(read.action), read.reason, reading});
  return result;
}

namespace {

/// Mip k of an .env is for alpha = 2^(k / scale) / size, at most 1; 0 at mip 0.
std::vector<double> babylon_roughness(int levels, int size, double scale) {
  std::vector<double> roughness{0.0};
  for (int level = 1; level < levels; ++level)
    roughness.push_back(std::sqrt(std::min(1.0, std::exp2(level / scale) / size)));
  return roughness;
}

void look_into_env(StoredEnvironment& stored) {
  platform::ByteFile file(stored.path);
  const files::EnvManifest manifest = files::read_env_manifest(file);
  stored.has_polynomial = manifest.polynomial.has_value();
  stored.levels = manifest.levels();
  if (!(manifest.lod_generation_scale > 0.0)) {
    stored.content = LevelContent::radiance;  // what Babylon.js stores of a cubemap that was not prefiltered
    return;
  }
  stored.content = LevelContent::reflections;
  stored.roughness = babylon_roughness(stored.levels, manifest.width, manifest.lod_generation_scale);
}

/// Numbers with spaces between them, as many as there are levels, each from 0 to 1 and none below the one before.
std::vector<double> roughness_in(const std::string& text, int levels) {
  std::istringstream stream(text);
  std::vector<double> roughness;
  for (double value = 0.0; stream >> value;) roughness.push_back(value);
  const bool sound = static_cast<int>(roughness.size()) == levels && std::ranges::is_sorted(roughness) &&
                     roughness.front() >= 0.0 && roughness.back() <= 1.0;
  if (!sound) roughness.clear();
  return roughness;
}

void look_into_texture(StoredEnvironment& stored) {
  platform::ByteFile file(stored.path);
  const files::TextureLayout layout = files::read_texture_layout(file);
  stored.levels = static_cast<int>(layout.levels.size());
  stored.compressed = layout.supercompression != Supercompression::none;
  if (!layout.has_metadata) return;  // DDS: it cannot be told
  stored.content = LevelContent::radiance;
  for (const auto& [key, value] : layout.metadata) {
    if (!files::speaks_of_roughness(key)) continue;
    stored.content = LevelContent::reflections;
    stored.roughness = roughness_in(value, stored.levels);
  }
}

}  // namespace

std::string StoredEnvironment::words() const {
  std::string text = path.filename().string() + ": " + info.format + ", " + shape.words();
  if (levels > 1) {
    text += ", " + std::to_string(levels) +
            (content == LevelContent::reflections ? " prefiltered mips"
             : content == LevelContent::radiance  ? " mips"
                                                  : " levels of which it does not say what they are");
  }
  return has_polynomial ? text + ", polynomial" : text;
}

StoredEnvironment probe_environment(const std::filesystem::path& path, const ReadOptions& read, LevelContent content) {
  StoredEnvironment stored;
  stored.path = path;
  stored.read = read;
  stored.info = inspect_environment(path, read);
  const EnvironmentInfo& info = stored.info;
  Environment shapes;
  shapes.info = info;
  const int face = shapes.face_size();
  stored.shape = face > 0 ? SourceShape{true, face, 6 * face, PixelFormat::rgb_f32}
                          : SourceShape{false, info.width, info.height, PixelFormat::rgb_f32};
  stored.compressed = info.format != "PFM" && info.compression != "none";
  if (info.format == "Babylon.js .env") look_into_env(stored);
  if (info.format == "KTX2" || info.format == "DDS") look_into_texture(stored);
  if (content != LevelContent::automatic && stored.levels > 1) stored.content = content;
  if (read.level != 0) {  // one of the levels alone
    stored.levels = 1;
    stored.content = LevelContent::automatic;
    stored.has_polynomial = false;
  }
  if (stored.content != LevelContent::reflections) {
    stored.roughness.clear();
  } else if (stored.roughness.empty()) {
    stored.roughness = roughness_of_mips(RoughnessSchedule::linear, stored.levels, face);
  }
  return stored;
}

}  // namespace welkin
