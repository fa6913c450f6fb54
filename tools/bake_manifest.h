// The output folder of a bake, the files that were written there, and the manifest.
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

/// The set of files that a command writes.
struct FileSet {
  const char* command;  ///< "bake", for messages
  const char* index;    ///< JSON file that lists the others: "welkin", and "files" with name and bytes of each
  bool (*has_name)(std::string_view name);  ///< whether a file of the command may have that name
};

/// The files of a set in one folder. Files that the index lists belong to the command and may be replaced; any other
/// file with a name that is to be written is refused.
///
/// While a set is written there is no index, but `unfinished_NAME`, which lists the files of the earlier index and
/// those being written. A run that was killed thus leaves a list for the next one.
class OwnFiles {
 public:
  /// Reads the lists of an earlier run. Throws `Error` (file_access) if there is an index that is not the command's.
  OwnFiles(std::filesystem::path folder, const FileSet& set);

  /// Throws `Error` (file_access), naming the file, if one of these names belongs to something that cannot be replaced
  /// (a folder, a pipe, a device) or to a file that is on no list.
  void require(const std::vector<std::string>& names) const;

  /// Lists these names as unfinished, and removes the index. Throws the errors of `require`.
  void begin(const std::vector<std::string>& names) const;

  /// Writes the index, and removes files of the earlier run that are not among `written`: regular files of this folder
  /// whose length is unchanged and that this run did not `read`. Returns remarks about the files that were removed and
  /// kept.
  [[nodiscard]] std::vector<std::string> finish(const std::string& index, const std::vector<std::string>& written,
                                                const std::vector<std::filesystem::path>& read) const;

 private:
  [[nodiscard]] std::filesystem::path unfinished() const;
  void add_listed(const std::filesystem::path& list);

  std::filesystem::path folder_;
  FileSet set_;
  std::map<std::string, std::optional<std::uint64_t>> listed_;  ///< with the length, if the run recorded it
};

/// A file of the result.
struct WrittenFile {
  std::string name;    ///< in the folder
  std::string what;    ///< "specular", "irradiance", ...
  std::string format;  ///< for a person: "KTX2 rgba16f"
  Json details{};      ///< more members for the manifest: sizes, roughness, axes
  std::uint64_t values_clamped = 0;
  std::string range{};         ///< describes the range that they were clamped to; empty if the format holds every value
  std::string caution{};       ///< other costs of the format for a person to know
  double share_clamped = 0.0;  ///< fraction of all light that clamping lost
  std::string remedy{};        ///< how to keep that light
  std::uint64_t bytes = 0;
};

inline constexpr const char* kManifestName = "manifest.json";
inline constexpr FileSet kBakeFiles{"bake", kManifestName, is_bake_name};

/// Throws `Error` (file_access) if the folder can be seen in advance to be impossible to make or to write to.
void check_output_folder(const std::filesystem::path& path);

/// An output folder. Other files in it stay. For the lifetime of this object no other bake uses the folder: two at a
/// time would leave the files of both in it, and would cache each other's.
class OutputFolder {
 public:
  /// Makes the folder and its parents, and waits until other bakes have left it. Removes the manifest of an earlier
  /// bake: the new one is written last, so that an unfinished folder never has a manifest. `names`: all files that may
  /// be written; `set`: the set they belong to. Throws `Error`: file_access if that fails, and the errors of
  /// `OwnFiles::require`; cancelled if `control` requests that while it waits.
  OutputFolder(std::filesystem::path path, const std::vector<std::string>& names, const Control& control,
               const FileSet& set = kBakeFiles);

  /// Writes the manifest, which marks the folder as finished. Removes files of an earlier bake that this one neither
  /// wrote nor `read`. Returns remarks for a person about such files.
  [[nodiscard]] std::vector<std::string> finish(const std::string& manifest,
                                                const std::vector<std::filesystem::path>& read) const;

  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  [[nodiscard]] const std::vector<WrittenFile>& files() const noexcept { return files_; }
  [[nodiscard]] std::filesystem::path place(const std::string& name) const { return path_ / name; }

  /// Notes a written file and its size.
  void add(WrittenFile file);
  /// Writes a text file, and notes it.
  void write(WrittenFile file, const std::string& text);
  /// Notes several written files before those that are already noted.
  void add_in_front(std::vector<WrittenFile> files);

  /// Returns one line per file whose format could not hold all values or has a high cost.
  [[nodiscard]] std::vector<std::string> format_notes() const;

 private:
  void wait_for_others(const Control& control);

  std::filesystem::path path_;
  std::optional<platform::FolderLock> lock_;
  std::optional<OwnFiles> own_;
  std::vector<WrittenFile> files_;
};

/// Returns manifest.json, which `welkin bake --json` prints. Members are only ever added: programs read this.
[[nodiscard]] std::string bake_manifest(const Baked& baked, const BakeCommandOptions& options,
                                        const OutputFolder& folder, const ToneMap& tone_map);

/// Returns notes for a person: values replaced and clamped, by the policies and by the formats.
[[nodiscard]] std::vector<std::string> bake_notes(const Baked& baked, const BakeCommandOptions& options,
                                                  const OutputFolder& folder);

/// Writes cubemaps, .env, BRDF table, harmonics and previews, everything but the manifest. Rotates the cubemaps of
/// `baked` into the engine's faces.
void write_bake(Baked& baked, const BakeCommandOptions& options, OutputFolder& folder, const Control& control);

/// Returns the tone mapping of the previews: by --exposure, else by a few mips of the environment below the top.
[[nodiscard]] ToneMap tone_map_of(const Baked& baked, const BakeCommandOptions& options);

inline constexpr const char* kPreviewPage = "preview.html";

/// Writes preview.html into a folder: a single file for browsers with WebGL 2 that needs no network. It shades by the
/// split sum from the data that it holds: mips of the specular chain from 128 texels down, a sharp environment of at
/// most 256, irradiance and the BRDF table, colours with shared exponents (within 0.4 % of the brightest channel). With
/// an environment of 256 it takes 3 MB. `light` is in Welkin's axes and must have its specular chain. Throws `Error`:
/// file_access, cancelled.
void write_preview_page(const BakeResult& light, const ToneMap& tone_map, const std::filesystem::path& file,
                        const Control& control = {});

/// Returns the names of the table's channels for the manifest.
[[nodiscard]] std::vector<std::string> brdf_channels(const BrdfTableOptions& options);

}  // namespace welkin::tool
