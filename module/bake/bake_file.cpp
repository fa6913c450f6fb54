// A file read, and baked.
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include "bake/bake_source.h"
#include "codec/byte_file.h"
#include "codec/env_manifest.h"
#include "jobs/tiles.h"
#include "welkin/babylon_environment.h"
#include "welkin/bake.h"
#include "welkin/error.h"

namespace welkin {
namespace {

constexpr double kReadingShare = 0.5;  ///< of the progress: a compressed picture takes about as long as its bake

using Clock = std::chrono::steady_clock;

bool is_babylon_file(const std::filesystem::path& path) {
  std::error_code none;
  if (!std::filesystem::is_regular_file(path, none)) return false;  // a folder of six faces, or for others to refuse
  codec::ByteFile file(path);
  return codec::is_env(file);
}

/// `work`, which speaks of faces, rows and columns; the reader of the message wants the file as well.
template <class Work>
void naming_file(const std::filesystem::path& path, const Work& work) {
  try {
    work();
  } catch (const Error& failure) {
    if (failure.code() != ErrorCode::rejected_pixel) throw;
    throw codec::file_error(failure.code(), path, failure.what());
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

}  // namespace welkin
