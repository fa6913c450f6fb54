// What the commands that write pictures share.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "welkin/environment_writer.h"
#include "welkin/image.h"

namespace welkin::tool {

struct OutputOptions {
  std::string path;
  WriteOptions write;
  int size = 0;  ///< of a cube: a face's edge; of a lat-long: its width; 0: as it comes
};

/// --layout, --size and --type.
void add_output_options(CLI::App& command, OutputOptions& options);

/// Whether the options ask for a cubemap, where the environment at hand is one or is none.
[[nodiscard]] bool wants_cubemap(const OutputOptions& options, bool have_cubemap) noexcept;

/// A lat-long's height for its width: half, rounded up.
[[nodiscard]] constexpr int lat_long_height(int width) noexcept { return (width + 1) / 2; }

/// Writes, and says what was written: a line a file, and a note about clamped values.
[[nodiscard]] std::string write_output(const OutputOptions& options, const LatLongView& picture,
                                       const Control& control);
[[nodiscard]] std::string write_output(const OutputOptions& options, const CubemapView& picture,
                                       const Control& control);

}  // namespace welkin::tool
