#include "tools/source.h"

namespace welkin::tool {

Source source_of(const std::string& path, const EnvironmentInfo& info) {
  std::string detail = info.channels.empty() ? "" : info.channels.front().type + ", ";
  if (info.compression != "none") detail += info.compression + ", ";
  return {path, name(info.layout), info.width, info.height, info.format, detail + info.layout_reason, info.notes};
}

Source built_in_sky(int width, int height) {
  return {"built-in sky", name(Layout::lat_long), width, height, "computed", "no input file was named", {}};
}

}  // namespace welkin::tool
