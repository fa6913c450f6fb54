#include "tools/source.h"

namespace welkin::tool {

Source source_of(const std::string& path, const EnvironmentInfo& info) {
  std::string detail = info.channels.empty() ? "" : info.channels.front().type + ", ";
  if (info.compression != "none") detail += info.compression + ", ";
  return {path, name(info.layout), info.width, info.height, info.format, detail + info.layout_reason, info.notes};
}

}  // namespace welkin::tool
