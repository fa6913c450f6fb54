// Environments in files, on disk or in memory: headers, pixels, statistics and harmonics.
//
// Reads and writes OpenEXR, Radiance .hdr, PFM and PNG. Also reads JPEG with a gain map (Ultra HDR, ISO 21496-1),
// cubemaps and images with their levels from KTX2, KTX (version 1) and DDS files, and cubemaps from Babylon.js .env
// files (in Welkin's axes); bake_file.h reads those with all their mips, and writes them.
//
//   function               reads               returns
//   inspect_environment    the header          size, layout, channels, levels
//   measure_environment    pixels, streaming   ranges, mean, brightest texel
//   project_file           pixels, streaming   harmonics
//   read_environment       all pixels          RGB floats
//
// Calls that read files throw `Error`: file_access, corrupt_file, unsupported_file, limit_exceeded.
#pragma once

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/projection.h"

namespace WELKIN_EXPORT welkin {

/// Input file: a path, or bytes in memory. A call that takes one also accepts a path directly.
///
///   welkin::read_environment("sky.exr");
///   welkin::read_environment({bytes, "sky.exr"});  // std::vector<std::byte> bytes, or a std::span<const std::byte>
///
/// Both give the same bits and, for a damaged file, the same errors. Bytes in memory are not copied; they must not
/// change until the call that reads them returns. The bytes of a `StoredEnvironment` must stay valid as long as it is
/// used. Several threads may read the same bytes at once.
class FileInput {
 public:
  FileInput() = default;  ///< refers to no file

  /// Refers to the file at a path, of any type that converts to `std::filesystem::path`. Does not open it.
  template <std::convertible_to<std::filesystem::path> Path>
  // A path converts to an input; an input never converts to a path.
  // NOLINTNEXTLINE(google-explicit-constructor,bugprone-forwarding-reference-overload)
  FileInput(Path&& path) : path_(std::forward<Path>(path)) {}

  /// Refers to the bytes of a file. `name`, in UTF-8, is used in messages only; the kind of file is detected from the
  /// bytes. A square image, which by a path would be one of six files, is refused unless a layout is requested.
  FileInput(std::span<const std::byte> bytes, std::string_view name)
      : path_(name.empty() ? u8"bytes in memory" : std::u8string(name.begin(), name.end())), bytes_(bytes) {}

  /// Combines the six faces of a cubemap, +X -X +Y -Y +Z -Z, each a square image of the same size in a file or in
  /// memory. Calls that read an environment treat them as layout six_files; calls that read a texture or tables throw
  /// `Error` (invalid_argument).
  [[nodiscard]] static FileInput six_faces(const std::array<FileInput, 6>& faces) {
    FileInput input;
    input.path_ = faces[0].path_;
    input.faces_.assign(faces.begin(), faces.end());
    return input;
  }

  /// Returns the path, or the name of the bytes; for six faces that of the first.
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  /// Returns the bytes of a file in memory, or nothing for a path.
  [[nodiscard]] const std::optional<std::span<const std::byte>>& bytes() const noexcept { return bytes_; }
  /// Returns the six faces, or nothing.
  [[nodiscard]] std::span<const FileInput> faces() const noexcept { return faces_; }

 private:
  std::filesystem::path path_;
  std::optional<std::span<const std::byte>> bytes_;
  std::vector<FileInput> faces_;
};

/// Output file: a path, or a vector that receives the file's bytes. A call that takes one also accepts a path directly.
///
///   std::vector<std::byte> bytes;
///   welkin::write_environment({bytes, "sky.exr"}, image);
///
/// The vector is replaced when the bytes are complete. After an error it is unchanged.
class FileOutput {
 public:
  /// Refers to the file at a path, of any type that converts to `std::filesystem::path`.
  template <std::convertible_to<std::filesystem::path> Path>
  // A path converts to an output; an output never converts to a path.
  // NOLINTNEXTLINE(google-explicit-constructor,bugprone-forwarding-reference-overload)
  FileOutput(Path&& path) : path_(std::forward<Path>(path)) {}

  /// Refers to a vector, which must outlive the call. The extension of `name` selects the format, and messages use the
  /// name.
  FileOutput(std::vector<std::byte>& bytes, std::string_view name)
      : path_(name.empty() ? u8"bytes in memory" : std::u8string(name.begin(), name.end())), bytes_(&bytes) {}

  /// Returns the path, or the name of the bytes.
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  /// Returns the vector, or nullptr for a path.
  [[nodiscard]] std::vector<std::byte>* bytes() const noexcept { return bytes_; }

 private:
  std::filesystem::path path_;
  std::vector<std::byte>* bytes_ = nullptr;
};

/// The layout of a sphere in an image. Faces are those of `CubemapView`, N x N texels each.
enum class Layout {
  automatic,         ///< detected from the file's header, its shape or its name; an error if that is ambiguous
  lat_long,          ///< see LatLongView; W x H, usually 2:1
  vertical_strip,    ///< N x 6N: +X -X +Y -Y +Z -Z from top to bottom
  horizontal_strip,  ///< 6N x N: +X -X +Y -Y +Z -Z from left to right
  horizontal_cross,  ///< 4N x 3N: -X +Z +X -Z in the middle row, +Y above +Z, -Y below it
  vertical_cross,    ///< 3N x 4N: +Y; -X +Z +X; -Y; and -Z below that, rotated by 180 degrees
  six_files,         ///< one N x N image per face, identified by the ends of their names (docs/reference/files.md)
};

/// Returns "automatic", "lat-long", "vertical-strip", "horizontal-strip", "horizontal-cross", "vertical-cross" or
/// "six-files".
[[nodiscard]] const char* name(Layout layout) noexcept;

/// Encoding of integer values (PNG, JPEG).
enum class Transfer {
  automatic,  ///< sRGB, or linear where the file states a gamma of 1
  srgb,       ///< IEC 61966-2-1
  linear,
};

/// Colour primaries of the pixels that are returned.
enum class Primaries {
  rec709,     ///< converted to Rec. 709 (sRGB) primaries and white where the file states others
  as_stored,  ///< values as stored (XYZ stays XYZ)
};

/// Options for reading a file. A part, layer, level or element that the file lacks throws `Error` (unsupported_file),
/// even if its format has no such thing. Part "0", level 0 and element 0 exist in every file.
struct ReadOptions {
  Layout layout = Layout::automatic;  ///< layout of the sphere in the image

  /// Part of a multi-part OpenEXR file: its name, or its index from 0. If empty: the first part with all colour
  /// channels, else the first with luminance.
  std::string part{};

  /// Layer of an OpenEXR file (channels "env.R", ...). If empty: the channels without a layer, else the only layer with
  /// colour, else the only layer.
  std::string layer{};

  /// Level of a file with mips (OpenEXR, KTX2, KTX, DDS, .env); 0 is the full size. In rip maps, only levels that
  /// shrink both ways count.
  int level = 0;

  /// Index of a cubemap or image in a KTX2, KTX or DDS array, from 0.
  int element = 0;

  Transfer transfer = Transfer::automatic;  ///< encoding of values in a PNG or JPEG
  Primaries primaries = Primaries::rec709;  ///< conversion of colours to Rec. 709

  /// Limit in bytes for pixels, including those being decoded, on all threads together. It is checked before the file
  /// is read. A lat-long that is projected or measured is streamed and needs far less than its size; a cubemap is held
  /// whole.
  std::uint64_t memory_limit_bytes = std::uint64_t{8} << 30U;

  friend bool operator==(const ReadOptions&, const ReadOptions&) = default;
};

/// File formats that are read.
enum class FileFormat { openexr, radiance, pfm, png, ktx2, dds, babylon, ktx1, jpeg };

/// Returns "OpenEXR", "Radiance", "PFM", "PNG", "KTX2", "DDS", "Babylon.js .env", "KTX" or "JPEG".
[[nodiscard]] const char* name(FileFormat format) noexcept;

/// Type of a channel's values in a file.
enum class ChannelType {
  unknown,          ///< a type that OpenEXR does not define
  half,             ///< 16-bit float
  float32,          ///< 32-bit float
  uint32,           ///< OpenEXR's unsigned integers
  rgbe,             ///< Radiance: 8 bits and an exponent shared by three channels
  xyze,             ///< Radiance: CIE XYZ in the same form
  rgbd,             ///< Babylon.js .env: 8 bits, gamma encoded, and a divisor shared by three channels
  uint1,            ///< 1 bit, PNG; colours of a palette are uint8
  uint2,            ///< 2 bits, PNG
  uint4,            ///< 4 bits, PNG
  uint8,            ///< 8 bits, PNG, JPEG, KTX2 and DDS
  uint16,           ///< 16 bits, PNG
  ufloat10,         ///< unsigned float of 10 bits, KTX2 and DDS
  ufloat11,         ///< unsigned float of 11 bits, KTX2 and DDS
  shared_exponent,  ///< 9 bits and an exponent shared by three channels, KTX2 and DDS
};

/// Returns "unknown", "half", "float", "uint", "rgbe", "xyze", "rgbd", "uint1", "uint2", "uint4", "uint8", "uint16",
/// "ufloat10", "ufloat11" or "shared exponent".
[[nodiscard]] const char* name(ChannelType type) noexcept;

/// A channel of a file.
struct ChannelInfo {
  std::string name;                         ///< "R", "G", "B", "Y", ...
  ChannelType type = ChannelType::unknown;  ///< type of its values
};

/// Size of one level of a file.
struct LevelInfo {
  int width = 0;   ///< texels
  int height = 0;  ///< texels
};

/// Contents of a file's header.
struct EnvironmentInfo {
  std::filesystem::path path;               ///< path as given; for `FileInput::six_faces` that of the first
  FileFormat format = FileFormat::openexr;  ///< for six files that of the first face
  /// for six files the formats that differ from `format`, without duplicates; else empty
  std::vector<FileFormat> other_formats;
  std::string compression;           ///< "none", "zip", "piz", ... in OpenEXR; "rle", "old rle"; "deflate"
  std::string storage;               ///< "scanline", "tiled 64 x 64", "mip-mapped tiles 16 x 16", "columns", ...
  Layout layout = Layout::lat_long;  ///< as detected or requested; never automatic
  std::string layout_reason;         ///< how the layout was detected
  int width = 0;                     ///< width in texels at the requested level; for six_files N
  int height = 0;                    ///< height in texels at the requested level; for six_files 6N, as a vertical strip
  std::vector<ChannelInfo> channels;  ///< all channels of the file (or part), in its order
  std::vector<LevelInfo> levels;      ///< levels of the file, full size first; one entry without mips
  std::vector<std::string> parts;     ///< names of a multi-part file's parts, in its order; else empty
  std::vector<std::string> layers;    ///< names of layers with colour or luminance, without ""
  std::vector<std::string> notes;     ///< conversions applied while reading (primaries, exposure, windows); for people
  std::array<std::filesystem::path, 6> faces;  ///< paths of six_files, in face order; else empty

  /// Returns the formats' names: "OpenEXR", or "OpenEXR, PNG" for six files that differ.
  [[nodiscard]] std::string format_description() const;
};

/// Statistics of a file's pixels as stored, without replacing or clamping. NaN and infinities are counted and excluded
/// from the other numbers.
struct EnvironmentStatistics {
  std::uint64_t texels = 0;  ///< texels of the sphere; here and below, space between the faces of a cross is excluded
  dvec3 minimum{};           ///< minimum of each channel
  dvec3 maximum{};           ///< maximum of each channel
  dvec3 mean{};              ///< mean radiance, weighted by solid angle
  dvec3 total_radiance{};    ///< integral over the sphere: 4 pi times the mean
  std::uint64_t nans = 0;    ///< channel values
  std::uint64_t infinities = 0;  ///< channel values
  std::uint64_t negatives = 0;   ///< channel values
  int brightest_column = 0;      ///< column in the file's image of the maximum of (0.2126, 0.7152, 0.0722) . rgb
  int brightest_row = 0;         ///< row of the same texel; six_files count as stacked vertically
  dvec3 brightest{};             ///< radiance of that texel
  dvec3 brightest_direction{};   ///< unit direction of that texel's centre; 0 if no texel is finite
};

/// An environment in memory as RGB floats: a lat-long, or six faces with the axes of `CubemapView`, whatever layout the
/// file has. (Cubemaps with OpenEXR's envmap attribute are mirrored to those axes when read.)
struct Environment {
  EnvironmentInfo info;             ///< header of the file
  std::unique_ptr<float[]> pixels;  ///< lat-long: width x height x 3; cubemap: 6 x size x size x 3; top row first

  /// Returns the texels per edge of a face, or 0 for a lat-long.
  [[nodiscard]] int face_size() const noexcept;

  /// Returns a view of the pixels, valid as long as `pixels` is unchanged.
  [[nodiscard]] EnvironmentView view() const;
  /// Returns the view of a lat-long. Throws `Error` (invalid_argument) that names the file for a cubemap.
  [[nodiscard]] LatLongView lat_long() const;
  /// Returns the view of a cubemap. Throws `Error` (invalid_argument) that names the file for a lat-long.
  [[nodiscard]] CubemapView cubemap() const;
};

/// Reads a header.
[[nodiscard]] EnvironmentInfo inspect_environment(const FileInput& input, const ReadOptions& options = {});

/// Reads a whole file.
[[nodiscard]] Environment read_environment(const FileInput& input, const ReadOptions& options = {},
                                           const Control& control = {});

/// Projects a file. A lat-long is streamed: blocks of rows are decoded and projected in parallel, in a few blocks of
/// memory per thread for any image size. The result is bit-identical to `project` of the whole image. Throws the same
/// errors as `read_environment` and `project`.
///
/// Memory per thread for a lat-long: 12 bytes per texel of the rows that decode together (1 in PFM; 1 to 32 in most
/// OpenEXR files, 256 with dwab, a row of tiles in tiled files; at least 2 up to 16384 columns), plus the decoder's
/// memory, at most 5 times those rows as stored. Shared by all threads: sums and tables, 0.15 % of the image as RGB
/// floats with 3 bands, 1 % with 10. A 16384 x 8192 image (1.5 GiB as floats) thus needs 4 MiB on one thread as PFM; as
/// OpenEXR it needs 10 MiB per thread with zip (16 rows), 16 MiB with piz (32 rows) and 120 MiB with dwab. If all
/// threads together would exceed the memory limit, one thread is used. Files whose rows must be decoded in order (PNG)
/// are decoded by one thread at a time while the others project.
///
/// With `target_size` and level 0, a file with mips is not reduced; the level nearest to the target in log2 is read
/// instead (face size against the target, width of a lat-long against four times the target). The pass "reduce" then
/// has the action "reuse" and names the level. Levels prefiltered for reflections are not used for this: those of .env
/// files, of KTX2 and OpenEXR files with roughness in their metadata, and of DDS files, which cannot state it.
///
/// For an .env file, the stored polynomial is used (pass "project", action "reuse"), because the pixels are clamped at
/// 255. With more than three bands, or another level, the pixels are projected.
[[nodiscard]] Projection project_file(const FileInput& input, const ReadOptions& read_options = {},
                                      const ProjectionOptions& options = {}, const Control& control = {});

/// Measures a file's pixels, streaming.
[[nodiscard]] EnvironmentStatistics measure_environment(const FileInput& input, const ReadOptions& options = {},
                                                        const Control& control = {});

// Writing environments.

/// Type of a written channel's values.
enum class SampleType {
  automatic,  ///< half float in OpenEXR; PNG 8 bits; the only type of other formats
  half,       ///< OpenEXR; values beyond +-65504 are clamped and counted
  float32,    ///< OpenEXR, PFM
  uint8,      ///< PNG: sRGB, values clamped to [0, 1]
  uint16,     ///< PNG: sRGB, values clamped to [0, 1]
};

/// Options for writing an environment.
struct WriteOptions {
  /// Layout of the sphere. `automatic` is lat-long for a lat-long and vertical strip for a cubemap; .exr then has the
  /// envmap attribute and OpenEXR's axes. A cubemap can be written in every layout except lat-long. Faces of a
  /// horizontal strip have at most 10922 texels per edge, because no reader accepts images wider than 65536. With
  /// six_files, "sky.exr" writes sky_px.exr, sky_nx.exr, ..., sky_nz.exr; not available in memory.
  Layout layout = Layout::automatic;
  SampleType type = SampleType::automatic;  ///< type of written values
};

/// Files written, and values that their format could not hold.
struct WriteReport {
  std::vector<std::filesystem::path> files;  ///< files written; in memory the name
  std::uint64_t values_clamped = 0;          ///< channel values outside the format's range (NaN becomes 0)
};

/// Checks output and options, and throws what `write_environment` would, before an image is computed for them. For the
/// target, it checks only that the folder exists.
void check_write_options(const FileOutput& output, const WriteOptions& options, bool is_cubemap);

/// Writes an environment in the format that the extension names: .exr, .hdr, .pfm or .png. Files are written
/// atomically: complete or not at all. Existing files are replaced. Throws `Error`: invalid_argument for a view, layout
/// or type that does not fit (naming what does), unsupported_file for another extension, file_access.
WriteReport write_environment(const FileOutput& output, const EnvironmentView& image, const WriteOptions& options = {},
                              const Control& control = {});

}  // namespace welkin
