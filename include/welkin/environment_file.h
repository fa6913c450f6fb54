// Environments in files: what one is, what is in it, and its light.
//
// Read here: OpenEXR (scanline and tiled, half and float, every compression, R G B or Y alone) and PFM.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/vec3.hpp>
#include <memory>
#include <string>
#include <vector>

#include "welkin/control.h"
#include "welkin/image_view.h"
#include "welkin/projection.h"

namespace welkin {

/// How a picture holds a sphere.
enum class Layout {
  automatic,       ///< told from the file's header or its shape; an error if neither tells
  lat_long,        ///< see LatLongView
  vertical_strip,  ///< six faces from top to bottom, see CubemapView
};

[[nodiscard]] const char* name(Layout layout) noexcept;  ///< "automatic", "lat-long", "vertical-strip"

struct ReadOptions {
  Layout layout = Layout::automatic;

  /// The most memory that pixels may take, in bytes: those that are held whole and those that are being
  /// decoded, on all threads together. A lat-long that is projected or measured is streamed and stays far
  /// below; a cubemap is held whole. A file that would need more is refused before it is read.
  std::uint64_t memory_limit_bytes = std::uint64_t{8} << 30U;
};

struct ChannelInfo {
  std::string name;  ///< "R", "G", "B", "Y", ...
  std::string type;  ///< "half", "float" or "uint"
};

/// What a file's header says; no pixel is read for it.
struct EnvironmentInfo {
  std::filesystem::path path;
  std::string format;                ///< "OpenEXR" or "PFM"
  std::string compression;           ///< "none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"
  std::string storage;               ///< "scanline" or "tiled 64 x 64"
  Layout layout = Layout::lat_long;  ///< as told from header or shape, or as it was asked for; never automatic
  std::string layout_reason;         ///< what told it
  int width = 0;                     ///< of the picture (the data window), texels
  int height = 0;
  std::vector<ChannelInfo> channels;  ///< all that the file has, in its order
};

/// What is in the pixels, as they are in the file: nothing is replaced or clamped. NaN and infinities are
/// counted and stay out of the other numbers.
struct EnvironmentStatistics {
  std::uint64_t texels = 0;
  glm::dvec3 minimum{}, maximum{};
  glm::dvec3 mean{};             ///< weighted by solid angle: the sphere's average radiance
  glm::dvec3 flux{};             ///< integral over the sphere: 4 pi times the mean
  std::uint64_t nans = 0;        ///< channel values
  std::uint64_t infinities = 0;  ///< channel values
  std::uint64_t negatives = 0;   ///< channel values
  int brightest_column = 0;      ///< as in `Environment::pixels`, by (0.2126, 0.7152, 0.0722) . rgb
  int brightest_row = 0;
  glm::dvec3 brightest{};
  glm::dvec3 brightest_direction{};  ///< unit, of that texel's centre
};

/// An environment held in memory as RGB floats. A strip's faces are in the frames of `CubemapView`: where an
/// OpenEXR header has the envmap attribute of a cube, the faces are mirrored to them on the way in.
struct Environment {
  EnvironmentInfo info;
  std::unique_ptr<float[]> pixels;  ///< width x height x 3, row 0 on top, no padding

  /// Throw `Error` (invalid_argument) if the layout is the other one.
  [[nodiscard]] LatLongView lat_long() const;
  [[nodiscard]] CubemapView cubemap() const;
};

/// Reads a header. Throws `Error`: file_access, corrupt_file, unsupported_file, limit_exceeded.
[[nodiscard]] EnvironmentInfo inspect_environment(const std::filesystem::path& path, const ReadOptions& options = {});

/// Reads a whole file. Throws as `inspect_environment`, and cancelled.
[[nodiscard]] Environment read_environment(const std::filesystem::path& path, const ReadOptions& options = {},
                                           const Control& control = {});

/// Projects a file. A lat-long streams: blocks of rows are decoded and projected in parallel, and memory
/// stays at a few blocks a thread however large the picture is. Same bits as reading it whole and calling
/// `project`. Throws as `read_environment` and `project`.
[[nodiscard]] Projection project_file(const std::filesystem::path& path, const ReadOptions& read_options = {},
                                      const ProjectionOptions& options = {}, const Control& control = {});

/// Measures a file's pixels, streaming. Throws as `read_environment`.
[[nodiscard]] EnvironmentStatistics measure_environment(const std::filesystem::path& path,
                                                        const ReadOptions& options = {}, const Control& control = {});

}  // namespace welkin
