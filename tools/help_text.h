// The prose of --help.
#pragma once

#include <string_view>

namespace welkin::tool {

extern const std::string_view kProgramDescription;
extern const std::string_view kProgramFooter;
extern const std::string_view kShFooter;
extern const std::string_view kInfoFooter;

}  // namespace welkin::tool
