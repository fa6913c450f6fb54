// Bakes of files: whole, or planned with what a file already carries (mips, reflections, coefficients); requests about
// files for a worker; files of a sky's tables.
//
//   welkin::BakeResult light = welkin::bake_file("sky.exr", {}, {.specular = welkin::PrefilterOptions{.size = 512}});
//
//   const welkin::StoredEnvironment file = welkin::probe_environment("sky.env");
//   welkin::BakeResult needed = welkin::bake(file, welkin::plan(file, {.diffuse_bands = 3}));
//
//   auto job = worker.post(welkin::BakeFile{"sky.exr"});
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "welkin/bake.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"
#include "welkin/plan.h"
#include "welkin/projection.h"
#include "welkin/sky.h"

namespace WELKIN_EXPORT welkin {

// ---- What a file carries beside its pixels

/// What the levels below the first are.
enum class LevelContent {
  automatic,    ///< as the file says; DDS cannot: then they are not used
  radiance,     ///< plain mips
  reflections,  ///< prefiltered, a roughness each
};

/// What a file holds besides its pixels.
struct StoredEnvironment {
  FileInput input;       ///< what is read; bytes in memory must outlive this and its copies
  ReadOptions read;      ///< how it is to be read
  EnvironmentInfo info;  ///< what the file says of itself
  SourceShape shape;     ///< of the pixels as `read_environment` gives them

  bool compressed = true;       ///< pixels must be unpacked
  bool has_polynomial = false;  ///< of an .env: three bands of the light, in full where its pixels end at 255
  int levels = 1;               ///< of a cubemap
  LevelContent content = LevelContent::automatic;  ///< of those levels; automatic: it cannot be told
  std::vector<double> roughness;                   ///< of each level, where they are reflections

  /// "sky.env: Babylon.js .env, cubemap of 256, 9 prefiltered mips, polynomial"
  [[nodiscard]] std::string words() const;
};

/// Reads the header. `content` overrides what the file says; of reflections without a roughness each in the metadata
/// (`welkin.roughness`) it is spread as `RoughnessSchedule::linear` has it. Throws `Error` as `inspect_environment`.
[[nodiscard]] StoredEnvironment probe_environment(const FileInput& input, const ReadOptions& read = {},
                                                  LevelContent content = LevelContent::automatic);

// ---- Bakes of files

/// Reads and bakes a file: all that `read_environment` reads; the full size of .env, KTX2 and DDS cubemaps. Throws as
/// `read_environment` too.
[[nodiscard]] BakeResult bake_file(const FileInput& input, const ReadOptions& read_options = {},
                                   const BakeOptions& options = {}, const Control& control = {});

/// Plans a bake of a file that was probed, with what it carries. Where nothing wants pixels it is projected while it is
/// read, or not even read. Nothing is read here.
[[nodiscard]] Plan plan(const StoredEnvironment& file, const SceneNeeds& needs, const BakeOptions& whole = {});

/// Carries out the plan of a file. Throws as `bake` and `bake_file`, and invalid_argument for another file's plan.
[[nodiscard]] BakeResult bake(const StoredEnvironment& file, const Plan& plan, const Control& control = {});

// ---- Requests about files, for a worker (requests.h has the others)

// Each reads a file by its path, or from bytes that it shares (`memory`), which count against the worker's memory
// limit; the path is then their name.

/// `project_file`.
struct ProjectFile {
  std::filesystem::path path;                              ///< the file, or one of six
  ReadOptions read_options{};                              ///< how it is read
  ProjectionOptions options{};                             ///< how it is projected
  std::shared_ptr<const std::vector<std::byte>> memory{};  ///< the file's bytes, if they are not read from the path

  [[nodiscard]] Projection operator()(const Control& control) const;
  /// Those of the bytes in memory; 0 for a path.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return memory ? memory->size() : 0; }
};

/// `read_environment`.
struct ReadFile {
  std::filesystem::path path;                              ///< the file, or one of six
  ReadOptions read_options{};                              ///< how it is read
  std::shared_ptr<const std::vector<std::byte>> memory{};  ///< the file's bytes, if they are not read from the path

  [[nodiscard]] Environment operator()(const Control& control) const;
  /// Those of the bytes in memory; 0 for a path.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return memory ? memory->size() : 0; }
};

/// `measure_environment`.
struct MeasureFile {
  std::filesystem::path path;                              ///< the file, or one of six
  ReadOptions read_options{};                              ///< how it is read
  std::shared_ptr<const std::vector<std::byte>> memory{};  ///< the file's bytes, if they are not read from the path

  [[nodiscard]] EnvironmentStatistics operator()(const Control& control) const;
  /// Those of the bytes in memory; 0 for a path.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return memory ? memory->size() : 0; }
};

/// `bake_file`.
struct BakeFile {
  std::filesystem::path path;                              ///< the file, or one of six
  ReadOptions read_options{};                              ///< how it is read
  BakeOptions options{};                                   ///< what is made of it
  std::shared_ptr<const std::vector<std::byte>> memory{};  ///< the file's bytes, if they are not read from the path

  [[nodiscard]] std::shared_ptr<const BakeResult> operator()(const Control& control) const;
  /// Those of the bytes in memory; 0 for a path.
  [[nodiscard]] std::uint64_t bytes() const noexcept { return memory ? memory->size() : 0; }
};

// ---- Files of a sky's tables, so that they are computed once

/// Writes tables with all their parameters and a checksum; read again they are the same bits. Written beside, renamed.
/// Throws `Error`: invalid_argument for tables whose sizes are not their options', file_access.
void save_sky_tables(const SkyTables& tables, const FileOutput& output);
/// Reads tables that `save_sky_tables` wrote. Throws `Error`: file_access, corrupt_file (a checksum that differs, a
/// table cut off), unsupported_file (another version), limit_exceeded.
[[nodiscard]] SkyTables load_sky_tables(const FileInput& input,
                                        std::uint64_t memory_limit_bytes = std::uint64_t{4} << 30U);

}  // namespace welkin
