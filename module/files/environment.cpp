#include "files/environment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <limits>
#include <numbers>
#include <span>

#include "files/layout.h"
#include "files/row_source.h"
#include "image/geometry.h"
#include "image/pixels.h"
#include "platform/file.h"
#include "platform/float_environment.h"
#include "platform/memory.h"
#include "platform/standard_library.h"
#include "welkin/environment_file.h"

namespace welkin::files {
namespace {

// Returns whether the image's rows are those of `Environment::pixels`, in the same order.
bool lies_as_in_memory(const RowSource& source) {
  const Layout layout = source.info().layout;
  return layout == Layout::lat_long || layout == Layout::six_files ||
         (layout == Layout::vertical_strip && !source.traits().openexr_cube_frames);
}

/// Returns the positions of a cube's faces in the image.
const CubePlacement& placement_in(const RowSource& source) {
  return source.traits().openexr_cube_frames ? openexr_cube_placement() : cube_placement(source.info().layout);
}

std::uint64_t pixel_bytes(const EnvironmentInfo& info) {
  if (info.layout == Layout::lat_long) return rgb_bytes(info.width, info.height);
  const int size = face_size(info.layout, info.width, info.height);
  return rgb_bytes(size, 6 * size);
}

// Each texel of a face has one position in the image: groups write to different memory.
void scatter_faces(const RowSource& source, std::uint64_t memory_limit_bytes, const Control& control, float* pixels) {
  const EnvironmentInfo& info = source.info();
  const CubePlacement& placement = placement_in(source);
  const int size = face_size(info.layout, info.width, info.height);
  const auto width = static_cast<std::size_t>(info.width);
  const auto edge = static_cast<std::size_t>(size);
  const RowGroups groups{comfortable_group_rows(source), memory_limit_bytes};
  for_each_row_group(source, groups, control, [&](const RowGroup& group) {
    for (int row = 0; row < group.row_count; ++row) {
      const float* image_row = group.rgb + 3 * width * static_cast<std::size_t>(row);
      for (const FaceSegment& segment : row_segments(placement, size, group.first_row + row)) {
        const std::size_t face_row =
            static_cast<std::size_t>(segment.face) * edge + static_cast<std::size_t>(segment.face_row);
        copy_segment(image_row + 3 * static_cast<std::size_t>(segment.first_column), pixels + 3 * edge * face_row, size,
                     segment.mirrored);
      }
    }
  });
}

}  // namespace

Environment read_whole(const RowSource& source, const ReadOptions& options, const Control& control) {
  const EnvironmentInfo& info = source.info();
  const std::uint64_t bytes = pixel_bytes(info);
  if (bytes > options.memory_limit_bytes) {
    throw platform::file_error(ErrorCode::limit_exceeded, info.path,
                               std::to_string(info.width) + " x " + std::to_string(info.height) + " texels take " +
                                   std::to_string(bytes) + " bytes as RGB floats, above the limit of " +
                                   std::to_string(options.memory_limit_bytes) +
                                   "; raise the limit or reduce the image");
  }
  Environment environment{info, platform::make_unique_for_overwrite<float[]>(bytes / sizeof(float))};
  platform::advise_huge_pages(environment.pixels.get(), bytes);
  const std::uint64_t left = options.memory_limit_bytes - bytes;
  if (lies_as_in_memory(source)) {
    read_all_rows(source, left, control, environment.pixels.get());
  } else {
    scatter_faces(source, left, control, environment.pixels.get());
  }
  return environment;
}

namespace {

// The statistics of one row. Each row has a slot, and slots are added from top to bottom, so that the sums depend
// neither on the number of threads nor on how the file is cut.
struct RowStatistics : EnvironmentStatistics {
  RowStatistics() {
    minimum = glm::dvec3(std::numeric_limits<double>::infinity());
    maximum = -minimum;
  }

  glm::dvec3 solid_angle{};  // of the finite values; `total_radiance` is the sum of value times solid angle
  double brightest_luminance = -std::numeric_limits<double>::infinity();
};

double luminance(const glm::dvec3& rgb) { return 0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b; }

void add_value(RowStatistics& row, int channel, float value, double solid_angle) {
  if (std::isnan(value)) {
    ++row.nans;
    return;
  }
  if (std::isinf(value)) {
    ++row.infinities;
    return;
  }
  const auto wide = static_cast<double>(value);
  row.negatives += value < 0.0F ? 1U : 0U;
  row.minimum[channel] = std::min(row.minimum[channel], wide);
  row.maximum[channel] = std::max(row.maximum[channel], wide);
  row.total_radiance[channel] += wide * solid_angle;
  row.solid_angle[channel] += solid_angle;
}

// Adds `solid_angles.size()` texels, each with its solid angle.
void add_texels(RowStatistics& row, const float* rgb, int first_column, std::span<const double> solid_angles) {
  for (std::size_t index = 0; index < solid_angles.size(); ++index) {
    const float* texel = rgb + 3 * (static_cast<std::size_t>(first_column) + index);
    for (int channel = 0; channel < 3; ++channel) {
      add_value(row, channel, texel[channel], solid_angles[index]);
    }
    const glm::dvec3 colour(texel[0], texel[1], texel[2]);
    const double brightness = luminance(colour);
    if (std::isfinite(brightness) && brightness > row.brightest_luminance) {
      row.brightest_luminance = brightness;
      row.brightest_column = first_column + static_cast<int>(index);
      row.brightest = colour;
    }
  }
}

// Maps the image's texels to the sphere. Texels between the faces of a cross are not on it.
class Geometry {
 public:
  explicit Geometry(const RowSource& source)
      : width_(source.info().width),
        height_(source.info().height),
        size_(face_size(source.info().layout, width_, height_)),
        placement_(size_ > 0 ? &placement_in(source) : nullptr) {}

  [[nodiscard]] std::uint64_t texels() const {
    const auto edge = static_cast<std::uint64_t>(size_);
    return size_ > 0 ? 6 * edge * edge : static_cast<std::uint64_t>(width_) * static_cast<std::uint64_t>(height_);
  }

  /// `angles`: scratch for the image's width.
  [[nodiscard]] RowStatistics measure_row(const float* rgb, int row, std::vector<double>& angles) const {
    RowStatistics found;
    if (placement_ == nullptr) {
      const std::span all(angles.data(), static_cast<std::size_t>(width_));
      std::fill(all.begin(), all.end(), image::lat_long_texel_solid_angle(width_, height_, row));
      add_texels(found, rgb, 0, all);
      return found;
    }
    const std::span edge(angles.data(), static_cast<std::size_t>(size_));
    int row_of_angles = -1;
    for (const FaceSegment& segment : row_segments(*placement_, size_, row)) {
      if (segment.face_row != row_of_angles) image::cubemap_row_solid_angles(segment.face_row, edge);
      row_of_angles = segment.face_row;
      add_texels(found, rgb, segment.first_column, edge);  // the angles of a face's row are symmetric
    }
    return found;
  }

  /// Returns the direction of the centre of a texel that lies on the sphere.
  [[nodiscard]] glm::dvec3 direction(int column, int row) const {
    if (placement_ == nullptr) return image::lat_long_direction(width_, height_, column + 0.5, row + 0.5);
    for (const FaceSegment& segment : row_segments(*placement_, size_, row)) {
      const int offset = column - segment.first_column;
      if (offset < 0 || offset >= size_) continue;
      const int face_column = segment.mirrored ? size_ - 1 - offset : offset;
      return image::face_direction(size_, segment.face, face_column + 0.5, segment.face_row + 0.5);
    }
    return {};
  }

 private:
  int width_;
  int height_;
  int size_;
  const CubePlacement* placement_;  // nullptr: a lat-long
};

EnvironmentStatistics summarise(const Geometry& geometry, const std::vector<RowStatistics>& rows) {
  RowStatistics total;
  for (std::size_t index = 0; index < rows.size(); ++index) {
    const RowStatistics& row = rows[index];
    total.minimum = glm::min(total.minimum, row.minimum);
    total.maximum = glm::max(total.maximum, row.maximum);
    total.total_radiance += row.total_radiance;
    total.solid_angle += row.solid_angle;
    total.nans += row.nans;
    total.infinities += row.infinities;
    total.negatives += row.negatives;
    if (row.brightest_luminance > total.brightest_luminance) {
      total.brightest_luminance = row.brightest_luminance;
      total.brightest_column = row.brightest_column;
      total.brightest_row = static_cast<int>(index);
      total.brightest = row.brightest;
    }
  }

  EnvironmentStatistics& result = total;
  result.texels = geometry.texels();
  for (int channel = 0; channel < 3; ++channel) {
    if (total.solid_angle[channel] > 0.0) {
      result.mean[channel] = total.total_radiance[channel] / total.solid_angle[channel];
    } else {  // the channel has no finite value
      result.minimum[channel] = result.maximum[channel] = 0.0;
    }
  }
  result.total_radiance = 4.0 * std::numbers::pi * result.mean;
  if (std::isfinite(total.brightest_luminance)) {  // else there is none, and its direction stays 0
    result.brightest_direction = geometry.direction(total.brightest_column, total.brightest_row);
  }
  return result;
}

}  // namespace
}  // namespace welkin::files

namespace welkin {
namespace {

[[noreturn]] void refuse_view(const EnvironmentInfo& info, const char* wanted) {
  throw platform::file_error(ErrorCode::invalid_argument, info.path,
                             std::string("is a ") + name(info.layout) + " (" + info.layout_reason + "), not a " +
                                 wanted + "; read it with the layout of a " + wanted);
}

}  // namespace

std::string EnvironmentInfo::format_description() const {
  std::string words = name(format);
  for (const FileFormat other : other_formats) words += std::string(", ") + name(other);
  return words;
}

int Environment::face_size() const noexcept { return files::face_size(info.layout, info.width, info.height); }

EnvironmentView Environment::view() const {
  if (info.layout == Layout::lat_long) return lat_long();
  return cubemap();
}

LatLongView Environment::lat_long() const {
  if (info.layout != Layout::lat_long) refuse_view(info, "lat-long");
  return {pixels.get(), info.width, info.height, 0, PixelFormat::rgb32f};
}

CubemapView Environment::cubemap() const {
  const int size = face_size();
  if (size == 0) refuse_view(info, "cubemap");
  return image::packed_cubemap(pixels.get(), size);
}

EnvironmentInfo inspect_environment(const FileInput& input, const ReadOptions& options) {
  const platform::FloatingPointScope floating_point;
  return files::open_row_source(input, options)->info();
}

Environment read_environment(const FileInput& input, const ReadOptions& options, const Control& control) {
  const platform::FloatingPointScope floating_point;
  return files::read_whole(*files::open_row_source(input, options), options, control);
}

EnvironmentStatistics measure_environment(const FileInput& input, const ReadOptions& options, const Control& control) {
  const platform::FloatingPointScope floating_point;
  const auto source = files::open_row_source(input, options);
  const EnvironmentInfo& info = source->info();
  const auto width = static_cast<std::size_t>(info.width);
  const files::Geometry geometry(*source);
  std::vector<files::RowStatistics> rows(static_cast<std::size_t>(info.height));
  const files::RowGroups groups{files::comfortable_group_rows(*source), options.memory_limit_bytes};
  files::for_each_row_group(*source, groups, control, [&](const files::RowGroup& group) {
    std::vector<double> solid_angles(width);
    for (int row = 0; row < group.row_count; ++row) {
      const float* rgb = group.rgb + static_cast<std::size_t>(row) * 3 * width;
      const int image_row = group.first_row + row;
      rows[static_cast<std::size_t>(image_row)] = geometry.measure_row(rgb, image_row, solid_angles);
    }
  });
  return files::summarise(geometry, rows);
}

}  // namespace welkin
