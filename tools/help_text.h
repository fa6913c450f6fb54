// The prose of --help.
#pragma once

#include <string_view>

namespace welkin::tool {

extern const std::string_view kProgramDescription;
extern const std::string_view kProgramFooter;
extern const std::string_view kBakeFooter;
extern const std::string_view kShFooter;
extern const std::string_view kSkyFooter;     // sky_help.cpp
extern const std::string_view kReportFooter;  // report_help.cpp
extern const std::string_view kInfoFooter;
extern const std::string_view kConvertFooter;
extern const std::string_view kTestmapFooter;

}  // namespace welkin::tool
