#include "codec/read_environment.h"

#include "codec/byte_file.h"
#include "codec/layout.h"
#include "codec/row_groups.h"

namespace welkin {
namespace codec {
namespace {

// Whether the picture's rows are those of `Environment::pixels`, in their order.
bool lies_as_in_memory(const RowSource& source) {
  const Layout layout = source.info().layout;
  return layout == Layout::lat_long || layout == Layout::six_files ||
         (layout == Layout::vertical_strip && !source.has_openexr_cube_frames());
}

std::uint64_t pixel_bytes(const EnvironmentInfo& info) {
  if (info.layout == Layout::lat_long) return rgb_bytes(info.width, info.height);
  const int size = face_size(info.layout, info.width, info.height);
  return rgb_bytes(size, 6 * size);
}

// Each texel of a face has one place in the picture: groups write to different places.
void scatter_faces(const RowSource& source, std::uint64_t memory_limit_bytes, const Control& control, float* pixels) {
  const EnvironmentInfo& info = source.info();
  const CubePlacement& placement = placement_in(source);
  const int size = face_size(info.layout, info.width, info.height);
  const auto width = static_cast<std::size_t>(info.width);
  const auto edge = static_cast<std::size_t>(size);
  const RowGroups groups{comfortable_group_rows(source), memory_limit_bytes};
  for_each_row_group(source, groups, control, [&](const RowGroup& group) {
    for (int row = 0; row < group.row_count; ++row) {
      const float* picture_row = group.rgb + 3 * width * static_cast<std::size_t>(row);
      for (const FaceSegment& segment : row_segments(placement, size, group.first_row + row)) {
        const std::size_t face_row =
            static_cast<std::size_t>(segment.face) * edge + static_cast<std::size_t>(segment.face_row);
        copy_segment(picture_row + 3 * static_cast<std::size_t>(segment.first_column), pixels + 3 * edge * face_row,
                     size, segment.mirrored);
      }
    }
  });
}

}  // namespace

const CubePlacement& placement_in(const RowSource& source) {
  return source.has_openexr_cube_frames() ? openexr_cube_placement() : cube_placement(source.info().layout);
}

Environment read_whole(const RowSource& source, const ReadOptions& options, const Control& control) {
  const EnvironmentInfo& info = source.info();
  const std::uint64_t bytes = pixel_bytes(info);
  if (bytes > options.memory_limit_bytes) {
    throw file_error(ErrorCode::limit_exceeded, info.path,
                     std::to_string(info.width) + " x " + std::to_string(info.height) + " texels take " +
                         std::to_string(bytes) + " bytes as RGB floats, above the limit of " +
                         std::to_string(options.memory_limit_bytes) + "; raise the limit or reduce the picture");
  }
  Environment environment{info, std::make_unique_for_overwrite<float[]>(bytes / sizeof(float))};
  const std::uint64_t left = options.memory_limit_bytes - bytes;
  if (lies_as_in_memory(source)) {
    read_all_rows(source, left, control, environment.pixels.get());
  } else {
    scatter_faces(source, left, control, environment.pixels.get());
  }
  return environment;
}

}  // namespace codec

EnvironmentInfo inspect_environment(const std::filesystem::path& path, const ReadOptions& options) {
  return codec::open_row_source(path, options)->info();
}

Environment read_environment(const std::filesystem::path& path, const ReadOptions& options, const Control& control) {
  return codec::read_whole(*codec::open_row_source(path, options), options, control);
}

}  // namespace welkin
