// A cache of all files of a bake: the same command line with the same inputs finds them again.
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

/// Lines of the table for a person, in addition to the files.
struct BakeWords {
  std::string source;   ///< the line of the input
  std::string results;  ///< mips and sun
  std::vector<std::string> notes;
};

/// A bake from an earlier run.
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

/// Finds and keeps the bake that a set of options makes.
class BakeFolderCache {
 public:
  /// Hashes the input. Does nothing without `--cache`, if a plan is to be explained, and if the bake reads no input
  /// file: its results are then cached one by one. Throws the errors of reading the input.
  explicit BakeFolderCache(const BakeCommandOptions& options);

  /// Returns nothing unless all files are there.
  [[nodiscard]] std::optional<KeptBake> find();

  /// Reads the folder's files once more. Does nothing if the input has changed since it was hashed. A failure becomes a
  /// note.
  void keep(const OutputFolder& folder, const std::string& manifest, const BakeWords& words,
            std::vector<std::string>& notes);

 private:
  const BakeCommandOptions& options_;
  std::optional<ResultCache> cache_;
  ContentHash key_;
};

/// Returns all files of an input: the file itself or each of six.
[[nodiscard]] std::vector<std::filesystem::path> input_files(const BakeCommandOptions& options,
                                                             const EnvironmentInfo& info);

/// Returns the key of all files of a bake: over the bytes of its input, how it is interpreted, the result options, the
/// files that options name, and the version of results. Reads the input. Throws the errors of `inspect_environment`.
[[nodiscard]] ContentHash bake_key(const BakeCommandOptions& options);

/// A member with the text of `ContentHash::text`.
[[nodiscard]] Member hash(const char* name, ContentHash& target);

/// Returns whether the name is that of a file in the folder itself: the list may come from anyone. False for a
/// manifest's.
[[nodiscard]] bool is_plain_name(std::string_view name);

}  // namespace welkin::tool
