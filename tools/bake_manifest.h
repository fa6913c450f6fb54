// The folder that a bake goes to, what was written there, and what is said of it: its manifest.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "platform/file.h"
#include "tools/baked.h"
#include "tools/json.h"
#include "tools/preview_light.h"
#include "welkin/environment_file.h"
#include "welkin/reflections.h"

namespace welkin::tool {

/// A command's sets of files.
struct FileSet {
  const char* command;  ///< "bake", for messages
  const char* index;    ///< the JSON file that lists the others: "welkin", and "files" with name and bytes of each
  bool (*has_name)(std::string_view name);  ///< whether one of its files can be called so
};

/// The files of a set in one folder. Those that the index lists are the command's own and may be replaced; any other
/// file with a name that is to be written is refused.
///
/// While a set is written there is no index, but `unfinished_NAME`, which lists what the earlier index listed and what
/// is being written. So a run that was killed leaves a list for the next one.
class OwnFiles {
 public:
  /// Reads the lists of an earlier run. Throws `Error` (file_access) if the index is there and is not the command's.
  OwnFiles(std::filesystem::path folder, const FileSet& set);

  /// Throws `Error` (file_access), naming the file, if one of these names belongs to something that cannot be replaced
  /// (a folder, a pipe, a device) or to a file that is on no list.
  void require(const std::vector<std::string>& names) const;

  /// Lists these names as unfinished, and removes the index. Throws as `require`.
  void begin(const std::vector<std::string>& names) const;

  /// Writes the index, and removes the files of the earlier run that are not among `written`: regular files of this
  /// folder that are as long as they were, and not among those that this run `read`. Returns a remark about what was
  /// removed and about what stays.
  [[nodiscard]] std::vector<std::string> finish(const std::string& index, const std::vector<std::string>& written,
                                                const std::vector<std::filesystem::path>& read) const;

 private:
  [[nodiscard]] std::filesystem::path unfinished() const;
  void add_listed(const std::filesystem::path& list);

  std::filesystem::path folder_;
  FileSet set_;
  std::map<std::string, std::optional<std::uint64_t>> listed_;  ///< with its length, if the run recorded it
};

/// A file of the result.
struct WrittenFile {
  std::string name;    ///< in the folder
  std::string what;    ///< "specular", "irradiance", ...
  std::string format;  ///< for a person: "KTX2 rgba16f"
  Json details{};      ///< more members for the manifest: sizes, roughness, axes
  std::uint64_t values_clamped = 0;
  std::string range{};         ///< words for the range that they were clamped to; empty if the format holds every value
  std::string caution{};       ///< what else its format costs, if a person should know
  double share_clamped = 0.0;  ///< of all light, that the clamped values lost
  std::string remedy{};        ///< what keeps that light
  std::uint64_t bytes = 0;
};

inline constexpr const char* kManifestName = "manifest.json";
inline constexpr FileSet kBakeFiles{"bake", kManifestName, is_bake_name};

/// Throws `Error` (file_access) if it can be seen in advance that the folder cannot be made or written to.
void check_output_folder(const std::filesystem::path& path);

/// What is in it besides stays there. As long as this lives, no other bake has the folder: two at a time would leave
/// the files of both in it, and in caches each other's.
class OutputFolder {
 public:
  /// Makes the folder, and those above it, and waits until other bakes have left it. Takes away the manifest of an
  /// earlier bake: until this one's is written, as the last file, nobody shall take the folder for a finished one.
  /// `names`: of all files that may be written; `set`: of what they are. Throws `Error`: file_access if that cannot be
  /// done or as `OwnFiles::require`; cancelled if `control` says so while it waits.
  OutputFolder(std::filesystem::path path, const std::vector<std::string>& names, const Control& control,
               const FileSet& set = kBakeFiles);

  /// Writes the manifest, which makes the folder a finished one, and removes what an earlier bake wrote and this one
  /// did not, but nothing that it `read`. Returns remarks for a person about such files.
  [[nodiscard]] std::vector<std::string> finish(const std::string& manifest,
                                                const std::vector<std::filesystem::path>& read) const;

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  [[nodiscard]] const std::vector<WrittenFile>& files() const noexcept { return files_; }
  [[nodiscard]] std::filesystem::path place(const std::string& name) const { return path_ / name; }

  /// Notes a file that is written; its size is looked up.
  void add(WrittenFile file);
  /// Writes a file of text, and notes it.
  void write(WrittenFile file, const std::string& text);
  /// The same of several, before those that are noted.
  void add_in_front(std::vector<WrittenFile> files);

  /// One line for each file whose format could not hold all values, or costs more than it should.
  [[nodiscard]] std::vector<std::string> format_notes() const;

 private:
  void wait_for_others(const Control& control);

  std::filesystem::path path_;
  std::optional<platform::FolderLock> lock_;
  std::optional<OwnFiles> own_;
  std::vector<WrittenFile> files_;
};

/// manifest.json, and what `welkin bake --json` prints. Members are only ever added: programs read this.
[[nodiscard]] std::string bake_manifest(const Baked& baked, const BakeCommandOptions& options,
                                        const OutputFolder& folder, const ToneMap& tone_map);

/// What a person should know of it: values replaced and clamped, by the policies and by the formats.
[[nodiscard]] std::vector<std::string> bake_notes(const Baked& baked, const BakeCommandOptions& options,
                                                  const OutputFolder& folder);

/// Writes cubemaps, .env, BRDF table, harmonics and previews, all but the manifest. Turns the cubemaps of `baked` to
/// the engine's faces on the way.
void write_bake(Baked& baked, const BakeCommandOptions& options, OutputFolder& folder, const Control& control);

/// Of the previews: as --exposure has it, else by the environment, of which a few mips below the top tell enough.
[[nodiscard]] ToneMap tone_map_of(const Baked& baked, const BakeCommandOptions& options);

inline constexpr const char* kPreviewPage = "preview.html";

/// Writes preview.html into a folder: one file that needs no other and no network, for browsers with WebGL 2. It shades
/// by the split sum from what it holds of the bake: mips of the specular chain from 128 texels down, a sharp
/// environment of at most 256, irradiance and the BRDF table, colours with shared exponents (within 0.4 % of the
/// brightest channel). With an environment of 256 it takes 3 MB. `light` is in Welkin's axes and must have its specular
/// chain. Throws `Error`: file_access, cancelled.
void write_preview_page(const BakeResult& light, const ToneMap& tone_map, const std::filesystem::path& file,
                        const Control& control = {});

/// What its channels are, for the manifest.
[[nodiscard]] std::vector<std::string> brdf_channels(const BrdfTableOptions& options);

}  // namespace welkin::tool
