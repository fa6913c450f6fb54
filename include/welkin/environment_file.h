// Environments in files, on disk or in memory: what one is, what is in it, and its light.
//
// Read and written here: OpenEXR, Radiance .hdr, PFM and PNG. Read here too: cubemaps and pictures with their levels in
// KTX2, KTX (the first version) and DDS files, and cubemaps in Babylon.js .env files (in Welkin's axes); bake_file.h
// reads them whole and writes them.
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

/// Where a file is read from: a path, or the file's bytes in memory. A call that takes one also takes a path as it is.
///
///   welkin::read_environment("sky.exr");
///   welkin::read_environment({bytes, "sky.exr"});  // std::vector<std::byte> bytes, or a std::span<const std::byte>
///
/// Both give the same bits and, of a damaged file, the same errors. Bytes in memory are not copied. The caller must
/// keep them, and must not change them, until the call that reads them has returned. The bytes of a `StoredEnvironment`
/// must stay as long as it is used. Several threads may read the same bytes at once.
class FileInput {
 public:
  FileInput() = default;  ///< names no file

  /// The file at a path: whatever converts to `std::filesystem::path`. Nothing is opened yet.
  template <std::convertible_to<std::filesystem::path> Path>
  // A path is an input as it is, and no input is a path.
  // NOLINTNEXTLINE(google-explicit-constructor,bugprone-forwarding-reference-overload)
  FileInput(Path&& path) : path_(std::forward<Path>(path)) {}

  /// All bytes of a file. Messages call it by `name`, in UTF-8, which tells nothing else: the kind of file is told by
  /// its bytes. A square picture, which a path would make one of six files, is refused unless a layout is asked for.
  FileInput(std::span<const std::byte> bytes, std::string_view name)
      : path_(name.empty() ? u8"bytes in memory" : std::u8string(name.begin(), name.end())), bytes_(bytes) {}

  /// The six faces of a cubemap, +X -X +Y -Y +Z -Z, each a square picture of the same size in a file of its own or in
  /// memory. What reads an environment takes them as layout six_files; what reads a texture or tables refuses them
  /// (invalid_argument).
  [[nodiscard]] static FileInput six_faces(const std::array<FileInput, 6>& faces) {
    FileInput input;
    input.path_ = faces[0].path_;
    input.faces_.assign(faces.begin(), faces.end());
    return input;
  }

  /// The path, or the name of the bytes; of six faces that of the first.
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  /// Of a file in memory; nothing if it is read by its path.
  [[nodiscard]] const std::optional<std::span<const std::byte>>& bytes() const noexcept { return bytes_; }
  /// Six, or none.
  [[nodiscard]] std::span<const FileInput> faces() const noexcept { return faces_; }

 private:
  std::filesystem::path path_;
  std::optional<std::span<const std::byte>> bytes_;
  std::vector<FileInput> faces_;
};

/// Where a file is written to: a path, or a vector that becomes the file's bytes. A call that takes one also takes a
/// path as it is.
///
///   std::vector<std::byte> bytes;
///   welkin::write_environment({bytes, "sky.exr"}, picture);
///
/// The vector holds the bytes that the file would have. It is replaced when they are complete; after an error it is as
/// it was.
class FileOutput {
 public:
  /// The file at a path: whatever converts to `std::filesystem::path`.
  template <std::convertible_to<std::filesystem::path> Path>
  // A path is an output as it is, and no output is a path.
  // NOLINTNEXTLINE(google-explicit-constructor,bugprone-forwarding-reference-overload)
  FileOutput(Path&& path) : path_(std::forward<Path>(path)) {}

  /// A vector, which must outlive the call. The extension of `name` chooses the format as that of a path does, and
  /// messages call the file by it.
  FileOutput(std::vector<std::byte>& bytes, std::string_view name)
      : path_(name.empty() ? u8"bytes in memory" : std::u8string(name.begin(), name.end())), bytes_(&bytes) {}

  /// The path, or the name of the bytes.
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return path_; }
  /// Of a file in memory; nullptr if it is written to its path.
  [[nodiscard]] std::vector<std::byte>* bytes() const noexcept { return bytes_; }

 private:
  std::filesystem::path path_;
  std::vector<std::byte>* bytes_ = nullptr;
};

/// How a picture holds a sphere. Faces are those of `CubemapView`, N x N texels each.
enum class Layout {
  automatic,         ///< told from the file's header, its shape or its name; an error if none of them tells
  lat_long,          ///< see LatLongView; W x H, 2:1 as a rule
  vertical_strip,    ///< N x 6N: +X -X +Y -Y +Z -Z from top to bottom
  horizontal_strip,  ///< 6N x N: the same from left to right
  horizontal_cross,  ///< 4N x 3N: -X +Z +X -Z in the middle row, +Y above +Z, -Y below it
  vertical_cross,    ///< 3N x 4N: +Y; -X +Z +X; -Y; and -Z below that, turned by half a turn
  six_files,         ///< one N x N picture a face, told apart by the ends of their names; see `face_files`
};

/// "automatic", "lat-long", "vertical-strip", "horizontal-strip", "horizontal-cross", "vertical-cross", "six-files"
[[nodiscard]] const char* name(Layout layout) noexcept;

/// What the numbers in a picture of integers (PNG) mean.
enum class Transfer {
  automatic,  ///< sRGB, but linear where the file says that its gamma is 1
  srgb,       ///< IEC 61966-2-1
  linear,
};

/// The colours that pixels are handed out in.
enum class Primaries {
  rec709,     ///< converted to Rec. 709 (sRGB) primaries and white where the file states others
  as_stored,  ///< the file's numbers as they are (XYZ stays XYZ)
};

/// How a file is read. A part, layer, level or element that the file does not have is refused (unsupported_file), even
/// if its format has no such thing; part "0", level 0 and element 0 are in every file.
struct ReadOptions {
  Layout layout = Layout::automatic;  ///< how the picture holds the sphere; automatic: header, shape or name tell

  /// Of a multi-part OpenEXR file: the part's name, or its number from 0. Empty: the first part that holds
  /// colour in whole, else the first that holds luminance.
  std::string part{};

  /// Of an OpenEXR file with layers (channels "env.R", ...): which one. Empty: the channels without a layer,
  /// else the only layer in colour, else the only layer.
  std::string layer{};

  /// Of a file with a mip chain (OpenEXR, KTX2, KTX, DDS, .env): 0 is the full size. Rip maps have the levels that
  /// shrink both ways.
  int level = 0;

  /// Of a KTX2, KTX or DDS array: which of its cubemaps or pictures, from 0.
  int element = 0;

  Transfer transfer = Transfer::automatic;  ///< what the numbers of a PNG mean
  Primaries primaries = Primaries::rec709;  ///< whether colours become Rec. 709

  /// The most memory that pixels may take, in bytes: those that are held whole and those that are being
  /// decoded, on all threads together. A lat-long that is projected or measured is streamed and stays far
  /// below; a cubemap is held whole. A file that would need more is refused before it is read.
  std::uint64_t memory_limit_bytes = std::uint64_t{8} << 30U;

  friend bool operator==(const ReadOptions&, const ReadOptions&) = default;
};

/// The kinds of file that are read.
enum class FileFormat { openexr, radiance, pfm, png, ktx2, dds, babylon, ktx1 };

/// "OpenEXR", "Radiance", "PFM", "PNG", "KTX2", "DDS", "Babylon.js .env", "KTX"
[[nodiscard]] const char* name(FileFormat format) noexcept;

/// How a file holds a channel's values.
enum class ChannelType {
  unknown,          ///< a type that OpenEXR has not
  half,             ///< 16-bit float
  float32,          ///< 32-bit float
  uint32,           ///< OpenEXR's unsigned integers
  rgbe,             ///< Radiance: 8 bits and an exponent that three channels share
  xyze,             ///< the same of CIE XYZ
  rgbd,             ///< Babylon.js .env: 8 bits, gamma encoded, and a divisor that three channels share
  uint1,            ///< PNG, as are the next four; a palette's colours are uint8
  uint2,            ///< 2 bits
  uint4,            ///< 4 bits
  uint8,            ///< 8 bits; in KTX2 and DDS too
  uint16,           ///< 16 bits
  ufloat10,         ///< float of 10 bits without a sign, KTX2 and DDS
  ufloat11,         ///< float of 11 bits without a sign, KTX2 and DDS
  shared_exponent,  ///< 9 bits and an exponent that three channels share, KTX2 and DDS
};

/// "unknown", "half", "float", "uint", "rgbe", "xyze", "rgbd", "uint1", "uint2", "uint4", "uint8", "uint16",
/// "ufloat10", "ufloat11", "shared exponent"
[[nodiscard]] const char* name(ChannelType type) noexcept;

/// A channel of the file.
struct ChannelInfo {
  std::string name;                         ///< "R", "G", "B", "Y", ...
  ChannelType type = ChannelType::unknown;  ///< how its values are held
};

/// A level of a chain in the file.
struct LevelInfo {
  int width = 0;   ///< texels
  int height = 0;  ///< texels
};

/// What a file's header says; no pixel is read for it.
struct EnvironmentInfo {
  std::filesystem::path path;               ///< as it was named; of `FileInput::six_faces` the first
  FileFormat format = FileFormat::openexr;  ///< of six files that of the first face
  std::vector<FileFormat> other_formats;    ///< of six files those that differ from it, each once; else empty
  std::string compression;            ///< "none", "zip", "piz", ... as OpenEXR has them; "rle", "old rle"; "deflate"
  std::string storage;                ///< "scanline", "tiled 64 x 64", "mip-mapped tiles 16 x 16", "columns", ...
  Layout layout = Layout::lat_long;   ///< as told from header or shape, or as it was asked for; never automatic
  std::string layout_reason;          ///< what told it
  int width = 0;                      ///< of the picture at the level that was asked for, texels; of six_files N,
  int height = 0;                     ///< and 6N: they are taken as the vertical strip that they make up
  std::vector<ChannelInfo> channels;  ///< all that the file (or part) has, in its order
  std::vector<LevelInfo> levels;      ///< the file's mip chain, full size first; one entry without a chain
  std::vector<std::string> parts;     ///< names of a multi-part file's parts, in its order; else empty
  std::vector<std::string> layers;    ///< names of the layers that hold colour or luminance; "" is not among them
  std::vector<std::string> notes;     ///< what was done on the way in: primaries, exposure, windows; for a person
  std::array<std::filesystem::path, 6> faces;  ///< of six_files, in face order; else empty

  /// The formats' names: "OpenEXR"; "OpenEXR, PNG" of six files that differ.
  [[nodiscard]] std::string format_words() const;
};

/// What is in the pixels, as they are in the file: nothing is replaced or clamped. NaN and infinities are
/// counted and stay out of the other numbers.
struct EnvironmentStatistics {
  std::uint64_t texels = 0;  ///< of the sphere: what lies between the faces of a cross does not count, here or below
  dvec3 minimum{};           ///< of each channel, NaN and infinities left out
  dvec3 maximum{};           ///< likewise
  dvec3 mean{};              ///< weighted by solid angle: the sphere's average radiance
  dvec3 total_radiance{};    ///< integral over the sphere: 4 pi times the mean
  std::uint64_t nans = 0;    ///< channel values
  std::uint64_t infinities = 0;  ///< channel values
  std::uint64_t negatives = 0;   ///< channel values
  int brightest_column = 0;      ///< of the picture, as it is in the file; by (0.2126, 0.7152, 0.0722) . rgb
  int brightest_row = 0;         ///< of six_files as if they stood one above the other
  dvec3 brightest{};             ///< radiance of the brightest texel, by luminance
  dvec3 brightest_direction{};   ///< unit, of that texel's centre; 0 if no texel is finite
};

/// An environment held in memory as RGB floats: a lat-long, or six faces in the frames of `CubemapView`,
/// whatever layout they had in the file. (Where an OpenEXR header has the envmap attribute of a cube, the faces
/// are mirrored to those frames on the way in.)
struct Environment {
  EnvironmentInfo info;             ///< what the file said of itself
  std::unique_ptr<float[]> pixels;  ///< lat-long: width x height x 3; cube: 6 x size x size x 3; row 0 on top

  /// Edge of a face in texels; 0 for a lat-long.
  [[nodiscard]] int face_size() const noexcept;

  /// Throw `Error` (invalid_argument) if the layout is the other one.
  [[nodiscard]] LatLongView lat_long() const;
  /// Valid for the other layouts; throws `Error` (invalid_argument) for a lat-long.
  [[nodiscard]] CubemapView cubemap() const;
};

/// The six files of a cubemap, +X -X +Y -Y +Z -Z, by any one of them or by the directory that holds them (and no
/// other such six). Their names differ at the end alone, before the extension: px nx py ny pz nz; posx negx posy ..;
/// right left top bottom front back; right left up down front back; rt lf up dn ft bk; 0 to 5 (but not if there is
/// a 6). Before that end stands nothing, or the same in all six up to one of _ - . and space; small and capital
/// letters are the same there. Extensions may differ; among several that would do, the one of `path` counts.
/// Looks at names alone. Throws `Error`: file_access naming the faces that are missing, unsupported_file if the name
/// is none of a face or if more than one choice of six would do.
[[nodiscard]] std::array<std::filesystem::path, 6> face_files(const std::filesystem::path& path);

/// Reads a header. Throws `Error`: file_access, corrupt_file, unsupported_file, limit_exceeded.
[[nodiscard]] EnvironmentInfo inspect_environment(const FileInput& input, const ReadOptions& options = {});

/// Reads a whole file. Throws as `inspect_environment`, and cancelled.
[[nodiscard]] Environment read_environment(const FileInput& input, const ReadOptions& options = {},
                                           const Control& control = {});

/// Projects a file. A lat-long streams: blocks of rows are decoded and projected in parallel, and memory
/// stays at a few blocks a thread however large the picture is. Same bits as reading it whole and calling
/// `project`. Throws as `read_environment` and `project`.
///
/// Memory for a lat-long, on each thread: the rows that decode together (1 in PFM; 1 to 32 in most OpenEXR files, 256
/// with dwab, a row of tiles in tiled ones), two at least from 16384 columns down, at 12 bytes a texel, and what
/// decoding holds beside them, at most 5 times those rows as the file has them; for all threads together: sums and
/// tables, 0.15 % of the picture as RGB floats with 3 bands, 1 % with 10. So a 16384 x 8192 picture (1.5 GiB as
/// floats) takes 4 MiB on one thread as PFM, and as OpenEXR 10 MiB for each thread with zip (16 rows), 16 MiB with piz
/// (32 rows), 120 MiB with dwab. If that exceeds the memory limit for all threads, one works alone. A file whose
/// rows come only in order (PNG) is decoded by one thread at a time while the others project.
///
/// With `target_size`, and `ReadOptions::level` at 0, a file that has a mip chain is read at the level that is
/// nearest to the target in log2 (a face's edge against the target, a lat-long's width against four times it)
/// instead of being reduced; the pass "reduce" then says "reuse" and which level. Not so where the levels are
/// prefiltered for reflections: in .env files, in KTX2 and OpenEXR files whose metadata speaks of roughness, and in DDS
/// files, which cannot say.
///
/// An .env file's polynomial is taken as it is stored (the pass "project" says "reuse"): its pixels are clipped at 255,
/// and it is not. With more than three bands, or another level, its pixels are projected after all.
[[nodiscard]] Projection project_file(const FileInput& input, const ReadOptions& read_options = {},
                                      const ProjectionOptions& options = {}, const Control& control = {});

/// Measures a file's pixels, streaming. Throws as `read_environment`.
[[nodiscard]] EnvironmentStatistics measure_environment(const FileInput& input, const ReadOptions& options = {},
                                                        const Control& control = {});

// Environments to files.

/// How a channel's value is stored.
enum class SampleType {
  automatic,  ///< half in OpenEXR; the others have one kind alone (PNG: 8 bit)
  half,       ///< OpenEXR; values beyond +-65504 are clamped to it and counted
  float32,    ///< OpenEXR, PFM
  uint8,      ///< PNG: sRGB, values clamped to [0, 1]
  uint16,     ///< PNG: sRGB, values clamped to [0, 1]
};

/// How a file is written.
struct WriteOptions {
  /// automatic: lat-long for a lat-long, vertical strip for a cubemap (with OpenEXR's envmap attribute in .exr,
  /// its faces then in OpenEXR's own frames). A cubemap can be written in every other layout too.
  /// Faces of a horizontal strip may have up to 10922 texels: wider pictures than 65536 are not read anywhere.
  /// six_files: "sky.exr" makes sky_px.exr, sky_nx.exr, ..., sky_nz.exr; not in memory.
  Layout layout = Layout::automatic;
  SampleType type = SampleType::automatic;  ///< halves, floats or bytes; automatic: the usual one of the format
};

/// What a format could not hold of the values.
struct WriteReport {
  std::vector<std::filesystem::path> files;  ///< that were written; in memory the name
  std::uint64_t values_clamped = 0;          ///< channel values beyond the format's range (NaN becomes 0)
};

/// Throws what `write_environment` would by output and options alone: ask it before a picture is made for them. (Of the
/// place only the folder is looked at, and nothing of a vector; the rest shows when it is written.)
void check_write_options(const FileOutput& output, const WriteOptions& options, bool is_cubemap);

/// Writes a picture in the format that the extension names: .exr, .hdr, .pfm, .png.
///
/// A file is complete or not there: it is written beside its place and renamed when it is whole. Existing files
/// are replaced. Throws `Error`: invalid_argument for a view, layout or type that does not fit (naming what
/// does), unsupported_file for an extension that is not written, file_access, cancelled.
WriteReport write_environment(const FileOutput& output, const LatLongView& picture, const WriteOptions& options = {},
                              const Control& control = {});
WriteReport write_environment(const FileOutput& output, const CubemapView& picture, const WriteOptions& options = {},
                              const Control& control = {});

}  // namespace welkin
