#include "codec/cube_levels.h"

#include <algorithm>
#include <string>

#include "codec/byte_file.h"

namespace welkin::codec {

void settle_cube(EnvironmentInfo& info, int size, int levels, const ReadOptions& options) {
  if (options.layout != Layout::automatic && options.layout != Layout::vertical_strip) {
    throw file_error(ErrorCode::unsupported_file, info.path,
                     std::string("was asked for as a ") + name(options.layout) + ", and " + info.format +
                         " holds six faces, read as a vertical strip; leave --layout out");
  }
  if (options.level < 0 || options.level >= levels) {
    throw file_error(ErrorCode::unsupported_file, info.path,
                     "has no level " + std::to_string(options.level) + "; it has " +
                         (levels == 1 ? "one, level 0: leave --level out"
                                      : std::to_string(levels) + ": pass --level 0 to " + std::to_string(levels - 1)));
  }
  for (int level = 0; level < levels; ++level) {
    const int edge = std::max(1, size >> level);
    info.levels.push_back({edge, 6 * edge});
  }
  info.layout = Layout::vertical_strip;
  info.layout_reason = info.format + " holds six faces";
  info.width = info.levels[static_cast<std::size_t>(options.level)].width;
  info.height = 6 * info.width;
}

}  // namespace welkin::codec
