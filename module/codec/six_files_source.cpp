#include "codec/six_files_source.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "codec/byte_file.h"
#include "sh/check_arguments.h"

namespace welkin::codec {
namespace {

using Faces = std::array<std::unique_ptr<RowSource>, 6>;

std::string shape(const EnvironmentInfo& info) {
  return std::to_string(info.width) + " x " + std::to_string(info.height);
}

// Opened as what no shape contradicts: a face alone has no layout.
std::unique_ptr<RowSource> open_face(const std::filesystem::path& path, const ReadOptions& options) {
  ReadOptions of_face = options;
  of_face.layout = Layout::lat_long;
  return open_picture(path, of_face);
}

void require_fitting_faces(const Faces& faces) {
  const EnvironmentInfo& first = faces.front()->info();
  for (const auto& face : faces) {
    const EnvironmentInfo& info = face->info();
    if (info.width != info.height) {
      throw file_error(ErrorCode::unsupported_file, info.path,
                       "is " + shape(info) +
                           ", and the six faces of a cube are square; if it is no face, pass --layout to say what it "
                           "is");
    }
    if (info.width != first.width) {
      throw file_error(ErrorCode::unsupported_file, info.path,
                       "is " + shape(info) + ", and " + first.path.filename().string() + " is " + shape(first) +
                           "; the six faces of a cube are of one size: export them alike");
    }
    if (info.width > sh::kLargestFace) {
      throw file_error(ErrorCode::unsupported_file, info.path,
                       "is " + std::to_string(info.width) + " texels wide; reduce the faces to " +
                           std::to_string(sh::kLargestFace) + " or fewer");
    }
  }
}

// "OpenEXR", or "OpenEXR, PNG" where the files differ.
std::string joined(const Faces& faces, std::string EnvironmentInfo::*text) {
  std::vector<std::string> different;
  for (const auto& face : faces) {
    const std::string& its = face->info().*text;
    if (std::find(different.begin(), different.end(), its) == different.end()) different.push_back(its);
  }
  std::string all;
  for (const std::string& its : different) all += (all.empty() ? "" : ", ") + its;
  return all;
}

// Levels that all six have, of the size that they have there.
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
  info.format = joined(faces, &EnvironmentInfo::format);
  info.compression = joined(faces, &EnvironmentInfo::compression);
  info.storage = joined(faces, &EnvironmentInfo::storage);
  info.layout = Layout::six_files;
  info.layout_reason = reason;
  info.height *= 6;
  info.levels = common_levels(faces);
  for (std::size_t face = 0; face < faces.size(); ++face) {
    const EnvironmentInfo& its = faces[face]->info();
    info.faces[face] = its.path;
    for (const std::string& note : its.notes) {
      if (std::find(info.notes.begin(), info.notes.end(), note) == info.notes.end()) info.notes.push_back(note);
    }
  }
  return info;
}

// Holds one face open at a time: whoever reads a section stays in its face.
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

class SixFilesSource final : public RowSource {
 public:
  SixFilesSource(const std::filesystem::path& path, Faces faces, const std::string& reason)
      : RowSource(describe(path, faces, reason)), faces_(std::move(faces)) {}

  [[nodiscard]] int natural_rows() const override {
    int rows = 1;
    for (const auto& face : faces_) rows = std::max(rows, face->natural_rows());
    return rows;
  }
  [[nodiscard]] int section_rows() const override { return info().width; }
  [[nodiscard]] bool sequential() const override {
    return std::any_of(faces_.begin(), faces_.end(), [](const auto& face) { return face->sequential(); });
  }
  [[nodiscard]] std::uint64_t reader_bytes() const override {
    std::uint64_t bytes = 0;
    for (const auto& face : faces_) bytes = std::max(bytes, face->reader_bytes());
    return bytes;
  }
  [[nodiscard]] std::unique_ptr<RowReader> open_reader() const override {
    return std::make_unique<SixFilesReader>(faces_);
  }

 private:
  Faces faces_;
};

}  // namespace

std::unique_ptr<RowSource> open_six_files(const std::filesystem::path& path, const ReadOptions& options,
                                          const std::string& reason) {
  const std::array<std::filesystem::path, 6> paths = face_files(path);
  Faces faces;
  for (std::size_t face = 0; face < faces.size(); ++face) faces[face] = open_face(paths[face], options);
  require_fitting_faces(faces);
  return std::make_unique<SixFilesSource>(path, std::move(faces), reason);
}

}  // namespace welkin::codec
