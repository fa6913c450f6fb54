#include "codec/read_environment.h"

#include "codec/byte_file.h"
#include "codec/row_groups.h"

namespace welkin {
namespace codec {

Environment read_whole(const RowSource& source, const ReadOptions& options, const Control& control) {
  const EnvironmentInfo& info = source.info();
  const std::uint64_t bytes = rgb_bytes(info.width, info.height);
  if (bytes > options.memory_limit_bytes) {
    throw file_error(ErrorCode::limit_exceeded, info.path,
                     std::to_string(info.width) + " x " + std::to_string(info.height) + " texels take " +
                         std::to_string(bytes) + " bytes as RGB floats, above the limit of " +
                         std::to_string(options.memory_limit_bytes) + "; raise the limit or reduce the picture");
  }
  Environment environment{info, std::make_unique_for_overwrite<float[]>(bytes / sizeof(float))};
  const std::size_t row_floats = std::size_t{3} * static_cast<std::size_t>(info.width);
  const RowGroups groups{comfortable_group_rows(source), false, options.memory_limit_bytes - bytes};
  for_each_row_group(source, groups, control, [&](RowWorker& worker, int first_row, int row_count) {
    worker.reader->read(first_row, row_count,
                        environment.pixels.get() + static_cast<std::size_t>(first_row) * row_floats);
  });
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
