// The six files of a cubemap, told apart by the ends of their names.
#include <algorithm>
#include <cctype>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include "codec/byte_file.h"
#include "welkin/environment_file.h"

namespace welkin {
namespace codec {
namespace {

using Path = std::filesystem::path;
using SixNames = std::array<const char*, 6>;
using SixPaths = std::array<Path, 6>;

// In face order. Sets of the first row's kind are named so by Babylon.js and three.js, the next by many converters and
// three.js's examples, "rt lf up dn ft bk" by Quake's sky boxes.
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

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

// What stands before a face's name in a stem, if that ends with it: nothing, or something up to a separator. So
// "sky_3" is a face and "map10" is none.
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

// The sets that a name may belong to.
std::vector<SetName> sets_of(const Path& path) {
  std::vector<SetName> sets;
  for (std::size_t family = 0; family < kFamilies.size(); ++family) {
    for (const char* face_name : kFamilies[family]) {
      if (auto prefix = prefix_before(path.stem().string(), face_name)) {
        sets.push_back({std::move(*prefix), family});
      }
    }
  }
  return sets;
}

// Pictures of a directory, for each set and face those whose names fit, in the order of their names.
class Candidates {
 public:
  /// Looks at names with an extension of a format that is read, or with `extension`.
  Candidates(const Path& directory, const std::string& extension) {
    std::error_code failure;
    const Path place = directory.empty() ? Path(".") : directory;
    for (std::filesystem::directory_iterator entry(place, failure), end; !failure && entry != end;
         entry.increment(failure)) {
      const Path file = directory / entry->path().filename();
      std::error_code ignored;
      if (is_picture(file, extension) && !entry->is_directory(ignored)) add(file);
    }
    if (failure) {
      throw file_error(ErrorCode::file_access, place, "cannot be searched for faces: " + failure.message());
    }
    for (auto& [set, faces] : sets_) {
      for (auto& files : faces) std::sort(files.begin(), files.end());
    }
  }

  [[nodiscard]] const std::map<SetName, std::array<std::vector<Path>, 6>>& sets() const { return sets_; }

  /// A series that goes on after 5 is no cube.
  [[nodiscard]] bool is_longer_series(const SetName& set) const {
    return set.family == kNumbers && longer_series_.contains(set.prefix);
  }

  /// The set's files, those with `extension` first; where there are none, the only one. Empty paths for faces
  /// that are missing; throws where two would do equally.
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
        throw file_error(ErrorCode::unsupported_file, files[0],
                         std::string("could be the face ") + kFaceNames[face] + ", and so could " +
                             files[1].filename().string() + "; keep one of them there");
      }
    }
    return picked;
  }

 private:
  static bool is_picture(const Path& file, const std::string& extension) {
    const std::string its = file.extension().string();
    return its == extension || std::find(kExtensions.begin(), kExtensions.end(), lower_case(its)) != kExtensions.end();
  }

  void add(const Path& file) {
    const std::string stem = file.stem().string();
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
    const std::string wanted = set.prefix + kFamilies[set.family][face] + path.extension().string();
    missing += (missing.empty() ? "" : ", ") + std::string(kFaceNames[face]) + " (" + wanted + ")";
  }
  throw file_error(ErrorCode::file_access, path,
                   "is one of six faces of which others are missing beside it: " + missing +
                       "; put them there, or see that the six names differ at their ends alone");
}

SixPaths faces_beside(const Path& path) {
  const std::vector<SetName> sets = sets_of(path);
  std::error_code ignored;
  const Path directory = path.has_parent_path() ? path.parent_path() : Path(".");
  if (!std::filesystem::exists(sets.empty() ? path : directory, ignored)) {
    throw file_error(ErrorCode::file_access, path, "there is no such file");
  }
  if (sets.empty()) {
    throw file_error(ErrorCode::unsupported_file, path,
                     std::string("its name does not end as one of six faces does (") + kEnds +
                         "; before that nothing, or one of _ - . and space); rename the six files so");
  }
  const std::string extension = path.extension().string();
  const Candidates candidates(path.parent_path(), extension);
  const SetName* closest = nullptr;
  SixPaths of_closest;
  for (const SetName& set : sets) {
    SixPaths found = candidates.pick(set, extension);
    if (candidates.is_longer_series(set)) {
      throw file_error(ErrorCode::unsupported_file, path,
                       "is one of a series that goes on after 5 (there is a " + set.prefix +
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
      whole_sets.insert(candidates.pick(set, file.extension().string()));
    }
  }
  if (whole_sets.empty()) {
    throw file_error(ErrorCode::file_access, directory,
                     std::string("is a directory without six faces of a cube, whose names would end in ") + kEnds +
                         "; name a picture in it");
  }
  if (whole_sets.size() > 1) {
    throw file_error(ErrorCode::unsupported_file, directory,
                     "holds more than one cube of six files, such as " + (*whole_sets.begin())[0].filename().string() +
                         " and " + (*whole_sets.rbegin())[0].filename().string() +
                         " with their others; name one file of the one that is meant");
  }
  return *whole_sets.begin();
}

}  // namespace
}  // namespace codec

std::array<std::filesystem::path, 6> face_files(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_directory(path, ignored) ? codec::faces_in(path) : codec::faces_beside(path);
}

}  // namespace welkin
