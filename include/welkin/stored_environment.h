// What a file carries beside the pixels: told from its header, before anything is read.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "welkin/environment_file.h"
#include "welkin/export.h"
#include "welkin/source_shape.h"

namespace WELKIN_EXPORT welkin {

/// What the levels below the first are.
enum class LevelContent {
  automatic,    ///< as the file says; DDS cannot: then they are not used
  radiance,     ///< plain mips
  reflections,  ///< prefiltered, a roughness each
};

/// What a file holds besides its pixels.
struct StoredEnvironment {
  std::filesystem::path path;  ///< as it was named
  ReadOptions read;            ///< how it is to be read
  EnvironmentInfo info;        ///< what the file says of itself
  SourceShape shape;           ///< of the pixels as `read_environment` gives them

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
[[nodiscard]] StoredEnvironment probe_environment(const std::filesystem::path& path, const ReadOptions& read = {},
                                                  LevelContent content = LevelContent::automatic);

}  // namespace welkin
