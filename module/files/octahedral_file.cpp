// Octahedral maps in files.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "files/codecs.h"
#include "files/textures.h"
#include "files/write_environment.h"
#include "jobs/control.h"
#include "platform/file.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "welkin/bake_file.h"
#include "welkin/resampling.h"

namespace welkin {
namespace {

using files::PictureJob;
using platform::WholeFile;

void check_map(const std::filesystem::path& path, const OctahedralMap& map) {
  const auto refuse = [&path](const std::string& what) {
    throw platform::file_error(ErrorCode::invalid_argument, path, what);
  };
  if (map.levels.empty()) refuse("cannot be written: the octahedral map has no levels; pass a map of to_octahedral");
  for (int level = 0; level < static_cast<int>(map.levels.size()); ++level) {
    const auto edge = static_cast<std::size_t>(std::max(0, map.level_size(level)));
    if (edge == 0 || map.levels[static_cast<std::size_t>(level)].size() != 3 * edge * edge)
      refuse("cannot be written: level " + std::to_string(level) + " of the octahedral map has " +
             std::to_string(map.levels[static_cast<std::size_t>(level)].size()) + " values instead of " +
             std::to_string(3 * edge * edge) + "; pass a map of to_octahedral");
  }
}

/// "map.exr", of several levels "map_m2.exr".
std::filesystem::path path_of_level(const std::filesystem::path& path, const OctahedralMap& map, std::size_t level) {
  if (map.levels.size() == 1) return path;
  std::filesystem::path name = path.stem();
  name += "_m" + std::to_string(level);
  name += path.extension();
  return path.parent_path() / name;
}

WriteReport write_pictures(const FileOutput& output, const OctahedralMap& map, const TextureOptions& options,
                           const Control& control) {
  if (output.bytes() != nullptr && map.levels.size() > 1) {
    throw platform::file_error(
        ErrorCode::invalid_argument, output.path(),
        "has one image, and the map has " + std::to_string(map.levels.size()) + " levels; write .ktx2, or to a path");
  }
  const SampleType type = options.format == TexelFormat::rgba32f ? SampleType::float32 : SampleType::half;
  std::uint64_t values_clamped = 0;
  std::vector<std::unique_ptr<WholeFile>> files;
  for (std::size_t level = 0; level < map.levels.size(); ++level) {
    files.push_back(std::make_unique<WholeFile>(path_of_level(output.path(), map, level), output.bytes()));
    const files::OutputPicture picture(map.view(static_cast<int>(level)));
    values_clamped += files::write_exr(picture, {*files.back(), type, false, false, {control.stop, {}}});
    files.back()->finish();
  }
  std::vector<WholeFile*> all;
  all.reserve(files.size());
  for (const auto& file : files) all.push_back(file.get());
  return files::commit_files(all, values_clamped, control);
}

}  // namespace

WriteReport write_octahedral(const FileOutput& output, const OctahedralMap& map, const TextureOptions& options,
                             const Control& control) {
  const platform::FloatingPointScope floating_point;
  check_map(output.path(), map);
  files::check_texture_options(output.path(), options);
  const std::string extension = platform::utf8(output.path().extension());
  if (extension == ".exr" || extension == ".EXR") return write_pictures(output, map, options, control);
  if (extension == ".dds" || extension == ".DDS") {
    throw platform::file_error(ErrorCode::invalid_argument, output.path(),
                               "is not written as an octahedral map; use .ktx2 or .exr");
  }
  std::vector<LatLongView> levels;
  levels.reserve(map.levels.size());
  for (int level = 0; level < static_cast<int>(map.levels.size()); ++level) levels.push_back(map.view(level));
  TextureOptions with_border = options;
  with_border.metadata["welkin.octahedral_border"] = std::to_string(map.border);
  WholeFile file(output.path(), output.bytes());
  const std::uint64_t values_clamped = files::write_ktx2(
      PictureJob{file, levels.front(), with_border, control, std::span<const LatLongView>(levels).subspan(1)});
  file.finish();
  return files::commit_files({&file}, values_clamped, control);
}

}  // namespace welkin
