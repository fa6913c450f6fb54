// The files of a whole bake in a cache: the same command line with the same inputs gives them again.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/bake_manifest.h"
#include "tools/bake_options.h"
#include "welkin/result_cache.h"

namespace welkin::tool {

/// What the table for a person says beside the files.
struct BakeWords {
  std::string source;   ///< the line of the input
  std::string results;  ///< mips and sun
  std::vector<std::string> notes;
};

/// A bake that was made before.
struct KeptBake {
  struct File {
    WrittenFile about{};  ///< name, format and bytes
    ContentHash hash{};
    std::vector<std::byte> contents{};
  };
  std::vector<File> files;  ///< without the manifest
  std::string manifest;     ///< with the times of this run
  BakeWords words;
};

/// Finds and keeps the bake that some options ask for.
class BakeFolderCache {
 public:
  /// Hashes the input. Does nothing without `--cache`, where a plan is to be explained, and where what is baked comes
  /// from no file: its results are found one by one. Throws what reading the input does.
  explicit BakeFolderCache(const BakeCommandOptions& options);

  /// Nothing if it is not there as a whole.
  [[nodiscard]] std::optional<KeptBake> find();

  /// Reads the folder's files once more. Does nothing if the input is not what was hashed any more. What fails is a
  /// note.
  void keep(const OutputFolder& folder, const std::string& manifest, const BakeWords& words,
            std::vector<std::string>& notes);

 private:
  const BakeCommandOptions& options_;
  std::optional<ResultCache> cache_;
  ContentHash key_;
};

/// All files of an input: itself or, of six, each.
[[nodiscard]] std::vector<std::filesystem::path> input_files(const BakeCommandOptions& options,
                                                             const EnvironmentInfo& info);

/// Returns the key of all files of a bake: over the bytes of its input, how that was understood, what was asked for and
/// stood in files that options name, and the version of results. Reads the input. Throws `Error` as
/// `inspect_environment`.
[[nodiscard]] ContentHash bake_key(const BakeCommandOptions& options);

/// What `ContentHash::text` has written.
[[nodiscard]] Member hash(const char* name, ContentHash& target);

/// Of a file in the folder itself and no other place: the list may be anybody's. A manifest's is none.
[[nodiscard]] bool is_plain_name(std::string_view name);

}  // namespace welkin::tool
