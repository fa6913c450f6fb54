// What `welkin info` found, before it is put into words or JSON.
#pragma once

#include <string>

#include "welkin/environment_file.h"

namespace welkin::tool {

struct InfoReport {
  EnvironmentInfo file;
  EnvironmentStatistics pixels;
};

[[nodiscard]] std::string info_json(const InfoReport& report);
[[nodiscard]] std::string info_table(const InfoReport& report);

}  // namespace welkin::tool
