// Where light came from, for those who read of it.
#pragma once

#include <string>
#include <vector>

#include "welkin/environment_file.h"

namespace welkin::tool {

struct Source {
  std::string path;
  std::string layout;
  int width = 0;
  int height = 0;
  std::string format;
  std::string detail;  ///< what a person may want to know besides: channel type, compression, what told the layout
  std::vector<std::string> notes;  ///< what was done to the pixels on the way in
};

[[nodiscard]] Source source_of(const std::string& path, const EnvironmentInfo& info);

}  // namespace welkin::tool
