// The command line.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace engine_loop {

struct Options {
  double seconds = 10.0;  ///< each run's
  double work_ms = 6.0;
  std::vector<std::string> setups{"own-idle"};
  int threads = 0;
  bool real_time = false;
  std::filesystem::path environments;  ///< a folder; empty: none
  std::filesystem::path output = "engine_loop";
  int sky_size = 256;
  int level_size = 1024;
  bool no_plot = false;

  [[nodiscard]] int frames() const { return static_cast<int>(60.0 * seconds + 0.5); }
};

/// None if the program is to end with `exit_code`: help was asked for, or something in the arguments is wrong.
[[nodiscard]] std::optional<Options> parse_options(int argument_count, char** arguments, int& exit_code);

}  // namespace engine_loop
