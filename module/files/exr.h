// OpenEXR: when its static objects are made, and what the readers and writers share. Included by every exr_ source, so
// that a program that links any of them gets the objects.
#pragma once

#include <Iex.h>
#include <IlmThreadPool.h>
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfTileDescription.h>
#include <half.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <glm/mat3x3.hpp>
#include <memory>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "files/row_source.h"
#include "platform/compiler.h"
#include "platform/file.h"
#include "platform/text.h"
#include "welkin/environment_file.h"

namespace welkin::files {

/// OpenEXR makes its attribute types and its pool of threads (which has none) at first use. They would be destroyed
/// before a worker that is a global object, whose threads may still read or write files. So they are made before every
/// static object of the program, and destroyed after them.
WELKIN_RUN_BEFORE_STATIC_OBJECTS static void make_openexr_statics() {
  Imf::staticInitialize();
  (void)IlmThread::ThreadPool::globalThreadPool();
}

// The parts of an OpenEXR file: all headers, checked before the library allocates what they claim.

struct ExrPart {
  Imf::Header header;
  bool tiled = false;
  bool deep = false;   ///< holds samples at depths, or is of an unknown type: not an image
  std::string name{};  ///< printable; empty in a single-part file without a name
};

struct ExrParts {
  std::vector<ExrPart> parts;  ///< at least one
  bool multi_part = false;
  std::uint64_t header_bytes = 0;  ///< of all headers in the file
};

/// Reads magic number, version and all headers. `file` is at its beginning. Windows are not checked yet. Throws
/// `Error`: unsupported_file for an unknown version, corrupt_file.
[[nodiscard]] ExrParts read_exr_parts(platform::ByteFile& file);

/// Checks what the library will allocate for every part when it opens the file: its tables of offsets, eight bytes per
/// chunk, which the file must be long enough to hold. Returns their bytes. `file` is after the headers. Throws
/// `Error`: corrupt_file.
std::uint64_t check_exr_tables(const ExrParts& parts, const platform::ByteFile& file);

/// Returns the part requested by name or number; if `asked_for` is empty, the first that holds colour (in `layer` if
/// that is not empty), else the first that holds luminance. Deep parts are skipped. Throws `Error`: unsupported_file
/// naming the parts.
[[nodiscard]] std::size_t choose_exr_part(const ExrParts& parts, const std::filesystem::path& path,
                                          const std::string& asked_for, const std::string& layer);

// The channels of an OpenEXR part that make up the image.

struct ExrChannels {
  enum class Kind {
    colour,            ///< names: red, green, blue
    luminance,         ///< names[0]: Y
    luminance_chroma,  ///< names: RY, Y, BY; one of the chroma channels may be absent
  };
  Kind kind = Kind::colour;
  std::array<std::string, 3> names{};
};

/// A layer is the part of a channel's name before its last dot: "env" of "env.R", "a.b" of "a.b.R". Views other than
/// the default one of a multi-view file are named the same way ("left.R"), and are layers here.
///
/// A layer is an image if it has R, G and B (also written r g b, red green blue, Red Green Blue, as compositors do)
/// or else Y, perhaps with RY and BY. X, Y and Z together are a vector, as renderers write for normals and positions,
/// and no image. Alpha, depth and the like are ignored; colour is used unchanged, premultiplied or not.

/// Returns whether `layer` (any, if that is empty) holds an image: one in colour, or any other.
[[nodiscard]] bool holds_image(const Imf::ChannelList& channels, const std::string& layer, bool in_colour);

// The geometry in an OpenEXR header, checked before any pixel memory is allocated for it.

/// The largest block of scanlines or tile, uncompressed and with all channels, that is decoded. 65536 texels
/// of four float channels at DWAB's 256 scanlines take half of it.
inline constexpr std::uint64_t kMaximumUnitBytes = std::uint64_t{512} << 20U;

/// One part, layer and level of a scanline or tiled file. The image is `info.width` x `info.height`; what is
/// stored is data_width x data_height, and usually the same rectangle.
struct ExrImage {
  EnvironmentInfo info;  ///< complete, layout included
  FileInput input;       ///< what readers open
  int part = 0;
  bool tiled = false;
  int level = 0;  ///< (level, level) of a mip or rip map
  ExrChannels channels;
  std::optional<glm::dmat3> to_rec709;
  bool prefiltered = false;  ///< an attribute speaks of roughness
  bool cube_frames = false;  ///< a strip whose faces have the orientation of OpenEXR's envmap attribute
  int first_column = 0;      ///< the data window's left and top, in the file's coordinates
  int first_row = 0;
  int data_width = 0;  ///< at the level
  int data_height = 0;
  int column_offset = 0;  ///< of the image's (0, 0) in the stored texels; negative if that is not stored
  int row_offset = 0;
  int unit_rows = 1;              ///< rows that decode together, at most the data's height
  std::uint64_t unit_bytes = 0;   ///< of one block of scanlines or tile, uncompressed, all channels
  std::uint64_t table_bytes = 0;  ///< of all parts' headers and tables of offsets, which every reader holds

  [[nodiscard]] bool is_framed() const noexcept {
    return column_offset != 0 || row_offset != 0 || data_width != info.width || data_height != info.height;
  }
};

/// Reads and checks all of a file's headers and chooses part, layer, level and window. `file` is at its beginning.
/// Throws the errors of `inspect_environment`.
[[nodiscard]] ExrImage inspect_exr(platform::ByteFile& file, const ReadOptions& options);

// Compressions, and the sizes of an OpenEXR image's levels.

struct CompressionKind {
  const char* name;  ///< "none", "zip", ..
  int scanlines;     ///< compressed together
};

/// Returns nullptr if the compression is unknown.
[[nodiscard]] const CompressionKind* compression_kind(Imf::Compression compression) noexcept;

/// The levels of an image of width x height, full size first: of a mip map all, of a rip map those that shrink both
/// ways, else one. Each edge halves from level to level, rounded as the file says, down to 1
/// (ImfTileDescription.h; the chain ends where the longer edge of a mip map, the shorter one of a rip map is 1).
[[nodiscard]] std::vector<LevelInfo> level_sizes(const Imf::TileDescription& tiles, int width, int height);

// The meaning of an OpenEXR file's numbers as colours.

/// Returns the matrix to Rec. 709, or none if there is nothing to convert: no chromaticities attribute (which means
/// Rec. 709), the numbers requested as stored, luminance alone, which is grey in any primaries, or a matrix that would
/// change nothing but roundings. `info.notes` states what was done.
///
/// White becomes white: the adoptedNeutral attribute's, if there is one, as in OpenEXR's ImfAcesFile, else the
/// chromaticities'. whiteLuminance (candelas per square metre of (1, 1, 1)) changes no number. Throws `Error`
/// (corrupt_file) naming the attribute if it makes no colours.
[[nodiscard]] std::optional<glm::dmat3> exr_colour_matrix(EnvironmentInfo& info, const Imf::Header& header,
                                                          ExrChannels::Kind kind, Primaries wanted);

// The interface to the OpenEXR library: its stream over our file, and its exceptions as ours. Included only by the exr_
// sources, the only ones that use the library.

class ExrStream final : public Imf::IStream {
 public:
  /// `file` must outlive the stream.
  explicit ExrStream(platform::ByteFile& file) : Imf::IStream(platform::utf8(file.path()).c_str()), file_(file) {}

  bool read(char bytes[], int count) override {
    if (count < 0) {
      throw platform::file_error(ErrorCode::corrupt_file, file_.path(), "holds a block of negative size");
    }
    file_.read(bytes, static_cast<std::size_t>(count));
    block_.emplace(bytes, static_cast<std::size_t>(count));
    return file_.remaining() > 0;
  }
  /// Returns the library's last read, in the library's memory, if it has read since the last call: after a block was
  /// decoded, that block as stored in the file.
  [[nodiscard]] std::optional<std::span<const char>> take_block() noexcept {
    return std::exchange(block_, std::nullopt);
  }
  std::uint64_t tellg() override { return file_.position(); }
  void seekg(std::uint64_t position) override { file_.seek(position); }

 private:
  platform::ByteFile& file_;
  std::optional<std::span<const char>> block_;
};

/// Runs `work`, which calls OpenEXR, and converts whatever that throws to `Error`s that name the file.
template <typename Work>
auto call_openexr(const std::filesystem::path& path, const Work& work) -> decltype(work()) {
  try {
    return work();
  } catch (const Error&) {
    throw;
  } catch (const Iex::ErrnoExc& failure) {
    throw platform::file_error(ErrorCode::file_access, path,
                               std::string("OpenEXR says: ") + platform::printable(failure.what()));
  } catch (const std::bad_alloc&) {
    throw platform::file_error(ErrorCode::limit_exceeded, path,
                               "there is not enough memory to decode it; free some, or save it with smaller tiles");
  } catch (const std::exception& failure) {
    throw platform::file_error(
        ErrorCode::corrupt_file, path,
        std::string("is damaged, fetch or export it again; OpenEXR says: ") + platform::printable(failure.what()));
  }
}

/// Returns the memory of a channel for the library: texel (column, row) of the file's coordinates is at `first`, others
/// `texel_bytes` and `row_bytes` on. (It expects the address that texel (0, 0) would have, which may lie outside of
/// anything, and so is worked out in integers.) Channels sampled at every second texel have `sampling` 2.
[[nodiscard]] inline Imf::Slice exr_slice(Imf::PixelType type, void* first, int column, int row,
                                          std::size_t texel_bytes, std::size_t row_bytes, int sampling = 1) {
  const auto left = static_cast<std::intptr_t>(column / sampling) * static_cast<std::intptr_t>(texel_bytes);
  const auto top = static_cast<std::intptr_t>(row / sampling) * static_cast<std::intptr_t>(row_bytes);
  const std::intptr_t base = reinterpret_cast<std::intptr_t>(first) - left - top;
  return {type, reinterpret_cast<char*>(base), texel_bytes, row_bytes, sampling, sampling};
}

}  // namespace welkin::files
