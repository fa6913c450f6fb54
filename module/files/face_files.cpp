// The six files of a cubemap, identified by the ends of their names.
#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include "files/row_source.h"
#include "image/pixels.h"
#include "platform/file.h"
#include "platform/text.h"
#include "welkin/environment_file.h"

namespace welkin::files {
namespace {

using Path = std::filesystem::path;
using SixNames = std::array<const char*, 6>;
using SixPaths = std::array<Path, 6>;

// In face order. Names of the first row's kind are those of Babylon.js and three.js, the next those of many converters
// and three.js's examples, "rt lf up dn ft bk" those of Quake's sky boxes.
constexpr std::array kFamilies{
    SixNames{"px", "nx", "py", "ny", "pz", "nz"},
    SixNames{"posx", "negx", "posy", "negy", "posz", "negz"},
    SixNames{"right", "left", "top", "bottom", "front", "back"},
    SixNames{"right", "left", "up", "down", "front", "back"},
    SixNames{"rt", "lf", "up", "dn", "ft", "bk"},
    SixNames{"0", "1", "2", "3", "4", "5"},
};
constexpr std::size_t kNumbers = 5;
constexpr std::array kExtensions{".exr", ".hdr", ".pic", ".rgbe", ".pfm", ".png"};
constexpr const char* kFaceNames[] = {"+X", "-X", "+Y", "-Y", "+Z", "-Z"};
constexpr const char* kEnds =
    "px nx py ny pz nz; posx negx posy negy posz negz; right left top bottom front back; right left up down front "
    "back; rt lf up dn ft bk; 0 to 5";

// Returns the part of a stem before a face's name, if the stem ends with that: empty, or ending in a separator. So
// "sky_3" is a face and "map10" is not.
std::optional<std::string> prefix_before(const std::string& stem, std::string_view face_name) {
  if (stem.size() < face_name.size() || !lower_case(stem).ends_with(face_name)) return std::nullopt;
  std::string prefix = stem.substr(0, stem.size() - face_name.size());
  if (!prefix.empty() && std::string_view("_-. ").find(prefix.back()) == std::string_view::npos) return std::nullopt;
  return prefix;
}

struct SetName {
  std::string prefix;
  std::size_t family = 0;

  bool operator<(const SetName& other) const { return std::tie(prefix, family) < std::tie(other.prefix, other.family); }
};

// Returns the sets that a name may belong to.
std::vector<SetName> sets_of(const Path& path) {
  std::vector<SetName> sets;
  for (std::size_t family = 0; family < kFamilies.size(); ++family) {
    for (const char* face_name : kFamilies[family]) {
      if (auto prefix = prefix_before(platform::utf8(path.stem()), face_name)) {
        sets.push_back({std::move(*prefix), family});
      }
    }
  }
  return sets;
}

// The images of a directory: for each set and face the matching names, in alphabetical order.
class Candidates {
 public:
  /// Lists names with an extension of a supported format, or with `extension`.
  Candidates(const Path& directory, const std::string& extension) {
    std::error_code failure;
    const Path folder = directory.empty() ? Path(".") : directory;
    for (std::filesystem::directory_iterator entry(folder, failure), end; !failure && entry != end;
         entry.increment(failure)) {
      const Path file = directory / entry->path().filename();
      std::error_code ignored;
      if (is_image(file, extension) && !entry->is_directory(ignored)) add(file);
    }
    if (failure) {
      throw platform::file_error(ErrorCode::file_access, folder,
                                 "cannot be searched for faces (" + failure.message() + "); check its permissions");
    }
    for (auto& [set, faces] : sets_) {
      for (auto& files : faces) std::sort(files.begin(), files.end());
    }
  }

  [[nodiscard]] const std::map<SetName, std::array<std::vector<Path>, 6>>& sets() const { return sets_; }

  /// Returns whether a series goes on after 5, which makes it no cube.
  [[nodiscard]] bool is_longer_series(const SetName& set) const {
    return set.family == kNumbers && longer_series_.contains(set.prefix);
  }

  /// Returns the set's files, those with `extension` first; where there are none, the only one. Empty paths for missing
  /// faces; throws where two files match equally well.
  [[nodiscard]] SixPaths pick(const SetName& set, const std::string& extension) const {
    SixPaths picked;
    const auto found = sets_.find(set);
    if (found == sets_.end()) return picked;
    for (std::size_t face = 0; face < picked.size(); ++face) {
      const std::vector<Path>& files = found->second[face];
      const auto same =
          std::find_if(files.begin(), files.end(), [&](const Path& file) { return file.extension() == extension; });
      if (same != files.end()) {
        picked[face] = *same;
      } else if (files.size() == 1) {
        picked[face] = files.front();
      } else if (files.size() > 1) {
        throw platform::file_error(ErrorCode::unsupported_file, files[0],
                                   std::string("could be the face ") + kFaceNames[face] + ", and so could " +
                                       platform::utf8(files[1].filename()) + "; keep one of them there");
      }
    }
    return picked;
  }

 private:
  static bool is_image(const Path& file, const std::string& extension) {
    const std::string its = platform::utf8(file.extension());
    return its == extension || std::find(kExtensions.begin(), kExtensions.end(), lower_case(its)) != kExtensions.end();
  }

  void add(const Path& file) {
    const std::string stem = platform::utf8(file.stem());
    if (const auto prefix = prefix_before(stem, "6")) longer_series_.insert(*prefix);
    for (std::size_t family = 0; family < kFamilies.size(); ++family) {
      for (std::size_t face = 0; face < 6; ++face) {
        if (const auto prefix = prefix_before(stem, kFamilies[family][face])) {
          sets_[{*prefix, family}][face].push_back(file);
        }
      }
    }
  }

  std::map<SetName, std::array<std::vector<Path>, 6>> sets_;
  std::set<std::string> longer_series_;
};

std::size_t files_in(const SixPaths& paths) {
  return static_cast<std::size_t>(
      std::count_if(paths.begin(), paths.end(), [](const Path& path) { return !path.empty(); }));
}

[[noreturn]] void report_missing(const Path& path, const SetName& set, const SixPaths& found) {
  std::string missing;
  for (std::size_t face = 0; face < found.size(); ++face) {
    if (!found[face].empty()) continue;
    const std::string wanted = set.prefix + kFamilies[set.family][face] + platform::utf8(path.extension());
    missing += (missing.empty() ? "" : ", ") + std::string(kFaceNames[face]) + " (" + wanted + ")";
  }
  throw platform::file_error(ErrorCode::file_access, path,
                             "is one of six faces, and others are missing in its folder: " + missing +
                                 "; put them there, or rename the six so that they differ only at their ends");
}

SixPaths faces_beside(const Path& path) {
  const std::vector<SetName> sets = sets_of(path);
  std::error_code ignored;
  const Path directory = path.has_parent_path() ? path.parent_path() : Path(".");
  if (!std::filesystem::exists(sets.empty() ? path : directory, ignored)) {
    throw platform::file_error(ErrorCode::file_access, path, "there is no such file; check the path");
  }
  if (sets.empty()) {
    throw platform::file_error(ErrorCode::unsupported_file, path,
                               std::string("its name does not end as one of six faces does (") + kEnds +
                                   "; optionally after one of _ - . and space); rename the six files accordingly");
  }
  const std::string extension = platform::utf8(path.extension());
  const Candidates candidates(path.parent_path(), extension);
  const SetName* closest = nullptr;
  SixPaths of_closest;
  for (const SetName& set : sets) {
    SixPaths found = candidates.pick(set, extension);
    if (candidates.is_longer_series(set)) {
      throw platform::file_error(ErrorCode::unsupported_file, path,
                                 "belongs to a series that continues after 5 (there is a " + set.prefix +
                                     "6), so no six files of a cube; name the faces px nx py ny pz nz");
    }
    if (files_in(found) == found.size()) return found;
    if (closest == nullptr || files_in(found) > files_in(of_closest)) {
      closest = &set;
      of_closest = std::move(found);
    }
  }
  report_missing(path, *closest, of_closest);
}

SixPaths faces_in(const Path& directory) {
  const Candidates candidates(directory, "");
  std::set<SixPaths> whole_sets;
  for (const auto& [set, faces] : candidates.sets()) {
    if (candidates.is_longer_series(set)) continue;
    if (std::any_of(faces.begin(), faces.end(), [](const auto& files) { return files.empty(); })) continue;
    for (const Path& file : faces.front()) {
      whole_sets.insert(candidates.pick(set, platform::utf8(file.extension())));
    }
  }
  if (whole_sets.empty()) {
    throw platform::file_error(ErrorCode::file_access, directory,
                               std::string("is a directory without six faces of a cube; their names must end in ") +
                                   kEnds + "; name an image in it");
  }
  if (whole_sets.size() > 1) {
    throw platform::file_error(ErrorCode::unsupported_file, directory,
                               "holds more than one cube of six files, such as " +
                                   platform::utf8((*whole_sets.begin())[0].filename()) + " and " +
                                   platform::utf8((*whole_sets.rbegin())[0].filename()) +
                                   " with their others; name one file of the intended set");
  }
  return *whole_sets.begin();
}

using Faces = std::array<std::unique_ptr<RowSource>, 6>;

std::string shape(const EnvironmentInfo& info) {
  return std::to_string(info.width) + " x " + std::to_string(info.height);
}

// Opens a face with the layout that no shape contradicts: a single face has no layout.
std::unique_ptr<RowSource> open_face(const FileInput& input, const ReadOptions& options) {
  ReadOptions of_face = options;
  of_face.layout = Layout::lat_long;
  return open_image(input, of_face);
}

void require_fitting_faces(const Faces& faces) {
  const EnvironmentInfo& first = faces.front()->info();
  for (const auto& face : faces) {
    const EnvironmentInfo& info = face->info();
    if (info.width != info.height) {
      throw platform::file_error(
          ErrorCode::unsupported_file, info.path,
          "is " + shape(info) +
              ", and the six faces of a cube are square; if it is not a face, pass --layout to say what it "
              "is");
    }
    if (info.width != first.width) {
      throw platform::file_error(ErrorCode::unsupported_file, info.path,
                                 "is " + shape(info) + ", and " + platform::utf8(first.path.filename()) + " is " +
                                     shape(first) + "; the six faces of a cube are of one size: export them alike");
    }
    if (info.width > image::kLargestFace) {
      throw platform::file_error(ErrorCode::unsupported_file, info.path,
                                 "is " + std::to_string(info.width) + " texels wide; reduce the faces to " +
                                     std::to_string(image::kLargestFace) + " or fewer");
    }
  }
}

template <class Value>
void add_once(std::vector<Value>& values, const Value& value) {
  if (std::find(values.begin(), values.end(), value) == values.end()) values.push_back(value);
}

// Returns "zip", or "zip, deflate" where the files differ.
std::string joined(const Faces& faces, std::string EnvironmentInfo::*text) {
  std::vector<std::string> different;
  for (const auto& face : faces) add_once(different, face->info().*text);
  std::string all;
  for (const std::string& its : different) all += (all.empty() ? "" : ", ") + its;
  return all;
}

// Returns the levels that all six have, at their sizes.
std::vector<LevelInfo> common_levels(const Faces& faces) {
  std::vector<LevelInfo> levels = faces.front()->info().levels;
  for (const auto& face : faces) {
    const std::vector<LevelInfo>& others = face->info().levels;
    std::size_t same = 0;
    while (same < std::min(levels.size(), others.size()) && levels[same].width == others[same].width &&
           levels[same].height == others[same].height) {
      ++same;
    }
    levels.resize(same);
  }
  for (LevelInfo& level : levels) level.height *= 6;
  return levels;
}

EnvironmentInfo describe(const std::filesystem::path& path, const Faces& faces, const std::string& reason) {
  EnvironmentInfo info = faces.front()->info();
  info.path = path;
  info.compression = joined(faces, &EnvironmentInfo::compression);
  info.storage = joined(faces, &EnvironmentInfo::storage);
  info.layout = Layout::six_files;
  info.layout_reason = reason;
  info.height *= 6;
  info.levels = common_levels(faces);
  for (std::size_t face = 0; face < faces.size(); ++face) {
    const EnvironmentInfo& its = faces[face]->info();
    info.faces[face] = its.path;
    if (its.format != info.format) add_once(info.other_formats, its.format);
    for (const std::string& note : its.notes) add_once(info.notes, note);
  }
  return info;
}

// Reads six files and holds one face open at a time: the reader of a section stays in its face.
class SixFilesReader final : public RowReader {
 public:
  explicit SixFilesReader(const Faces& faces) : faces_(faces), size_(faces.front()->info().width) {}

  void read(int first_row, int row_count, float* rgb) override {
    const int end = first_row + row_count;
    for (int row = first_row; row < end;) {
      const int face = row / size_;
      const int part_end = std::min(end, (face + 1) * size_);
      if (face != open_face_) {
        reader_.reset();
        reader_ = faces_[static_cast<std::size_t>(face)]->open_reader();
        open_face_ = face;
      }
      reader_->read(row - face * size_, part_end - row, rgb);
      rgb += rgb_bytes(size_, part_end - row) / sizeof(float);
      row = part_end;
    }
  }

 private:
  const Faces& faces_;
  int size_;
  int open_face_ = -1;
  std::unique_ptr<RowReader> reader_;
};

RowTraits six_files_traits(const Faces& faces) {
  RowTraits traits{.sections = 6};
  for (const auto& face : faces) {
    const RowTraits& its = face->traits();
    traits.natural_rows = std::max(traits.natural_rows, its.natural_rows);
    traits.sequential = traits.sequential || its.sequential;
    traits.reader_bytes = std::max(traits.reader_bytes, its.reader_bytes);
  }
  return traits;
}

}  // namespace

std::vector<FileInput> six_inputs(const FileInput& input) {
  if (!input.faces().empty()) return std::vector<FileInput>(input.faces().begin(), input.faces().end());
  if (input.bytes()) {
    throw platform::file_error(ErrorCode::invalid_argument, input.path(),
                               "is in memory, so the other faces cannot be found; pass all six "
                               "(FileInput::six_faces)");
  }
  const std::array<std::filesystem::path, 6> paths = face_files(input.path());
  return std::vector<FileInput>(paths.begin(), paths.end());
}

std::unique_ptr<RowSource> open_six_files(const FileInput& input, const std::vector<FileInput>& inputs,
                                          const ReadOptions& options, const std::string& reason) {
  const auto faces = std::make_shared<Faces>();
  for (std::size_t face = 0; face < faces->size(); ++face) (*faces)[face] = open_face(inputs[face], options);
  require_fitting_faces(*faces);
  return std::make_unique<RowSource>(describe(input.path(), *faces, reason), six_files_traits(*faces),
                                     [faces] { return std::make_unique<SixFilesReader>(*faces); });
}

std::array<std::filesystem::path, 6> face_files(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored) ? faces_in(path) : faces_beside(path);
}

}  // namespace welkin::files
