// A file read, and baked.
#include "welkin/bake_file.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "bake/bake_plan.h"
#include "bake/needs.h"
#include "files/env_manifest.h"
#include "jobs/tiles.h"
#include "platform/file.h"
#include "welkin/babylon_environment.h"
#include "welkin/bake.h"
#include "welkin/error.h"
#include "welkin/stored_environment.h"

namespace welkin {
namespace {

constexpr double kReadingShare = 0.5;  ///< of the progress: a compressed picture takes about as long as its bake

using Clock = std::chrono::steady_clock;

bool is_babylon_file(const std::filesystem::path& path) {
  std::error_code none;
  if (!std::filesystem::is_regular_file(path, none)) return false;  // a folder of six faces, or for others to refuse
  platform::ByteFile file(path);
  return files::is_env(file);
}

/// `work`, which speaks of faces, rows and columns; the reader of the message wants the file as well.
template <class Work>
void naming_file(const std::filesystem::path& path, const Work& work) {
  try {
    work();
  } catch (const Error& failure) {
    if (failure.code() != ErrorCode::rejected_pixel) throw;
    throw platform::file_error(failure.code(), path, failure.what());
  }
}

void put_first(BakeResult& result, std::string reason, Clock::duration time) {
  std::vector<PassRecord>& passes = result.diagnostics.passes;
  passes.insert(passes.begin(),
                {"read", "run", std::move(reason), std::chrono::duration<double, std::milli>(time).count()});
}

/// The chain's mip 0, turned from Babylon.js's axes to ours; the polynomial as it is stored, and the harmonics from it.
BakeResult bake_babylon_file(const std::filesystem::path& path, const ReadOptions& read_options,
                             const BakeOptions& options, const Control& control) {
  const Clock::time_point start = Clock::now();
  BabylonEnvironment environment =
      read_babylon_environment(path, read_options.memory_limit_bytes, jobs::part_of(control, 0.0, kReadingShare));
  CubemapChain chain = mirrored_x(environment.specular);
  environment.specular = {};
  const Clock::duration reading = Clock::now() - start;
  // Of the polynomial: it has the light that RGBD cuts off.
  std::optional<SphericalHarmonics> stored;
  if (environment.polynomial) stored = project_file(path, read_options, {}, {control.stop, {}}).radiance;
  BakeResult result;
  naming_file(path, [&] {
    baking::bake_source(result, chain.view(0), options, {.harmonics = stored ? &*stored : nullptr}, {},
                        jobs::part_of(control, kReadingShare, 1.0));
  });
  put_first(result,
            "Babylon.js .env, version " + std::to_string(environment.version) + "; mip 0 of " +
                std::to_string(chain.levels()) + ", its radiance ends at 255",
            reading);
  result.stored_polynomial = environment.polynomial;
  return result;
}

}  // namespace

BakeResult bake_file(const std::filesystem::path& path, const ReadOptions& read_options, const BakeOptions& options,
                     const Control& control) {
  if (is_babylon_file(path)) return bake_babylon_file(path, read_options, options, control);
  const Clock::time_point start = Clock::now();
  const Environment environment = read_environment(path, read_options, jobs::part_of(control, 0.0, kReadingShare));
  const Clock::duration reading = Clock::now() - start;
  const Control rest = jobs::part_of(control, kReadingShare, 1.0);
  BakeResult result;
  naming_file(path, [&] {
    result = environment.face_size() > 0 ? bake(environment.cubemap(), options, rest)
                                         : bake(environment.lat_long(), options, rest);
  });
  const EnvironmentInfo& info = environment.info;
  put_first(result, info.format + ", " + info.storage + ", " + info.compression, reading);
  return result;
}

namespace files {
namespace {

// Plans for files: what they carry already, and whether their pixels are wanted at all.

constexpr const char* kRead = "read";

/// Stored results were made of the pixels as they are, and as the file says.
bool changes_pixels(const StoredEnvironment& file, const BakeOptions& options) {
  return file.read.transfer != Transfer::automatic || options.pixels.clamp || options.pixels.gamma ||
         options.pixels.negative != NegativePolicy::keep || options.pixels.nan == NonFinitePolicy::reject ||
         options.pixels.infinity == NonFinitePolicy::reject;
}

baking::UnusedMips unused_of(const StoredEnvironment& file, const SceneNeeds& needs) {
  return baking::unused_mips(file.roughness, *needs.glossy);
}

bool takes_specular(const StoredEnvironment& file, const SceneNeeds& needs, const BakeOptions& options) {
  if (!options.specular || !needs.glossy || file.content != LevelContent::reflections) return false;
  return std::ranges::is_sorted(file.roughness) && file.roughness.front() <= needs.glossy->minimum &&
         file.roughness.back() >= needs.glossy->maximum;
}

baking::StoredKinds stored_kinds(const StoredEnvironment& file, const SceneNeeds& needs, const BakeOptions& options) {
  baking::StoredKinds kinds;
  if (!needs.stored_results || changes_pixels(file, options)) return kinds;
  if (file.has_polynomial) kinds.harmonics_bands = 3;
  if (file.content == LevelContent::radiance) kinds.background_levels = file.levels;
  if (!takes_specular(file, needs, options)) return kinds;
  const baking::UnusedMips unused = unused_of(file, needs);
  kinds.specular_mips = file.levels - unused.sharp - unused.rough;
  kinds.specular_size = std::max(1, file.shape.columns >> unused.sharp);
  return kinds;
}

bool wants_pixels(const Plan& plan) {
  if (plan.take_specular) return true;  // of the chain itself
  return plan.pass("clean").action != PassAction::skip || plan.pass("project").action == PassAction::run;
}

/// Nothing but a projection, or less. (What reads a file for its light alone takes a stored polynomial, asked or not.)
bool streams(const StoredEnvironment& file, const Plan& plan) {
  if (plan.pass("clean").action != PassAction::skip || plan.take_specular) return false;
  return plan.take_light || !file.has_polynomial || plan.pass("project").action == PassAction::skip;
}

PlannedPass read_pass(const StoredEnvironment& file, const Plan& plan, const CostModel& costs) {
  constexpr double kNanoseconds = 1e6;  // in a millisecond
  if (!wants_pixels(plan))
    return {kRead, PassAction::skip, "no pass wants pixels; the header has all that is needed", 0.0, 0};
  auto texels = static_cast<double>(file.shape.texels());
  if (plan.take_specular || plan.take_levels) texels *= 4.0 / 3.0;
  const double cost = texels * (file.compressed ? costs.read_texel : costs.read_plain_texel) / kNanoseconds;
  if (plan.streams) return {kRead, PassAction::run, "projected while it is read", cost, 0};
  const std::uint64_t bytes = static_cast<std::uint64_t>(texels) * 3 * sizeof(float);
  return {kRead, PassAction::run, file.words(), cost, bytes};
}

}  // namespace
}  // namespace files

Plan plan(const StoredEnvironment& file, const SceneNeeds& needs, const BakeOptions& whole, const CostModel& costs) {
  check(needs);
  baking::refuse_budget(needs, "read the file and plan the view of its pixels");
  baking::NeededOptions needed = baking::needed_options(file.shape, needs, whole);
  const baking::StoredKinds kinds = files::stored_kinds(file, needs, needed.options);
  Plan plan = baking::plan_pixels(file.shape, needed, kinds, costs);
  plan.source = file.words();
  if (plan.take_specular) {
    plan.first_stored_mip = files::unused_of(file, needs).sharp;
    plan.stored_mips = kinds.specular_mips;
  }
  plan.streams = files::streams(file, plan);
  plan.passes.insert(plan.passes.begin(), files::read_pass(file, plan, costs));
  return plan;
}

}  // namespace welkin
