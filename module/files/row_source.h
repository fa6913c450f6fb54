// An image in a file, as rows of RGB floats.
//
// Opening a source reads and checks the header and decodes nothing. Readers are independent of one another,
// each with its own handle on the file or its own position in the bytes in memory, so that blocks of rows decode
// concurrently, one reader per thread, without a lock.
#pragma once

#include <cctype>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "platform/file.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::files {

/// The largest image that any layout can hold; a larger one is refused by its header.
inline constexpr int kMaximumWidth = 65536;
inline constexpr int kMaximumHeight = 6 * 16384;

/// Opens a file at its first byte. Throws `Error`: file_access, invalid_argument for six faces, which are not one file.
[[nodiscard]] platform::ByteFile open_file(const FileInput& input);

/// Returns the first eight bytes, or all of a shorter file, and rewinds the file to its beginning.
[[nodiscard]] std::string first_bytes(platform::ByteFile& file);

/// Converts by the C library's `tolower`, byte by byte.
[[nodiscard]] inline std::string lower_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// Returns the input that `file` reads, to open it once more.
[[nodiscard]] FileInput input_of(const platform::ByteFile& file);

class RowReader {
 public:
  virtual ~RowReader() = default;

  /// Decodes rows [first_row, first_row + row_count) of the image, row 0 on top, to row_count x width x 3 floats. The
  /// caller keeps the range inside the image. Throws `Error`: corrupt_file, file_access, limit_exceeded. After that the
  /// reader must not be used.
  virtual void read(int first_row, int row_count, float* rgb) = 0;
};

/// Reads an image whose rows come in order from the top: a request for a row above the last one restarts it.
class SequentialReader : public RowReader {
 public:
  explicit SequentialReader(int width) : row_floats_(std::size_t{3} * static_cast<std::size_t>(width)) {}

  void read(int first_row, int row_count, float* rgb) override {
    if (first_row < next_row_) {
      restart();
      next_row_ = 0;
    }
    for (; next_row_ < first_row; ++next_row_) next(next_row_, nullptr);
    for (const int end = first_row + row_count; next_row_ < end; ++next_row_, rgb += row_floats_) next(next_row_, rgb);
  }

 protected:
  virtual void restart() = 0;
  /// Decodes the next row to `width` x 3 floats, or skips it if `rgb` is null.
  virtual void next(int row, float* rgb) = 0;

 private:
  std::size_t row_floats_;
  int next_row_ = 0;
};

/// Properties of an image's rows from its header.
struct RowTraits {
  /// Rows that decode together: a compressed block of scanlines, a row of tiles. At least 1, at most the
  /// section's rows. Reading multiples of it from multiples of it (counted in a section) decodes everything once.
  int natural_rows = 1;

  /// Parts of equally many rows that decode independently: six where the image is made up from six files.
  int sections = 1;

  /// Whether rows can only be decoded in order from the top (a PNG). Then a section has one reader, its reads start at
  /// the section's top and follow one another without a gap, and a thread that needs the next rows waits for its turn.
  bool sequential = false;

  /// Whether the image is a vertical strip whose faces have the orientation of OpenEXR's envmap attribute. Readers
  /// still return the rows as they are in the file.
  bool openexr_cube_frames = false;

  /// Whether the smaller levels are blurred for reflections, so that none of them stands for the image.
  bool prefiltered_levels = false;

  /// Three bands of radiance that the file stores in addition to the image, in Welkin's axes.
  std::optional<SphericalHarmonics> stored_radiance{};

  /// An upper bound on what one reader holds in memory.
  std::uint64_t reader_bytes = 0;

  /// The remedy for a reader that takes too much memory, for a message: "..., or save it with smaller blocks".
  const char* smaller_reader = "save it with smaller blocks";
};

/// An image's header and readers of its rows.
class RowSource {
 public:
  using Open = std::function<std::unique_ptr<RowReader>()>;

  /// `open` makes a reader, which may refer to what the function holds. It throws the errors of `RowReader::read`.
  RowSource(EnvironmentInfo info, RowTraits traits, Open open)
      : info_(std::move(info)), traits_(std::move(traits)), open_(std::move(open)) {}
  RowSource(const RowSource&) = delete;
  RowSource& operator=(const RowSource&) = delete;

  [[nodiscard]] const EnvironmentInfo& info() const noexcept { return info_; }
  [[nodiscard]] const RowTraits& traits() const noexcept { return traits_; }
  [[nodiscard]] int section_rows() const noexcept { return info_.height / traits_.sections; }

  /// Opens a reader, which must not outlive the source. Throws the errors of `RowReader::read`.
  [[nodiscard]] std::unique_ptr<RowReader> open_reader() const { return open_(); }

 private:
  EnvironmentInfo info_;
  RowTraits traits_;
  Open open_;
};

/// Opens one image file of any supported kind, by its first bytes. If its layout comes out as six_files, it is one face
/// of them. Throws the errors of `inspect_environment`.
[[nodiscard]] std::unique_ptr<RowSource> open_image(const FileInput& input, const ReadOptions& options);

/// Opens an environment: an image file, or the six files of a cubemap, given as they are or by the path of any of them
/// or of their directory. Throws the errors of `inspect_environment`.
[[nodiscard]] std::unique_ptr<RowSource> open_row_source(const FileInput& input, const ReadOptions& options);

/// Finds the six files of a cubemap, +X -X +Y -Y +Z -Z, from any one of them, or from a directory that holds one such
/// set, by names alone (docs/reference/files.md). If several sets match, the extension of `path` decides. Throws
/// `Error`: file_access naming the missing faces, unsupported_file if the name is no face's, or the set is ambiguous.
[[nodiscard]] std::array<std::filesystem::path, 6> face_files(const std::filesystem::path& path);

/// Returns the six faces that an input has, or those that `face_files` finds by its path. Throws the errors of
/// `face_files`, and invalid_argument for one face in memory.
[[nodiscard]] std::vector<FileInput> six_inputs(const FileInput& input);

/// Opens a strip N x 6N, layout six_files, from six square images, each a section: `inputs`, as `six_inputs` finds them
/// for `input`. Throws the errors of `inspect_environment`; unsupported_file naming the file that is not square or
/// differs in size from the first.
[[nodiscard]] std::unique_ptr<RowSource> open_six_files(const FileInput& input, const std::vector<FileInput>& inputs,
                                                        const ReadOptions& options, const std::string& reason);

/// Returns the bytes of `rows` rows of `width` RGB float texels. Within an image's bounds this cannot overflow.
[[nodiscard]] constexpr std::uint64_t rgb_bytes(int width, int rows) noexcept {
  return std::uint64_t{12} * static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(rows);
}

// Processing an image's rows in groups, concurrently, with a bounded number of readers.

/// The way an image is cut: by its shape and its file's, never by the number of threads.
struct RowGroups {
  int rows = 1;                          ///< per group, except the last one of a section
  std::uint64_t memory_limit_bytes = 0;  ///< for decoding and the groups' rows, on all threads together
};

/// Decoded rows.
struct RowGroup {
  int first_row = 0;
  int row_count = 0;
  const float* rgb = nullptr;  ///< row_count x width x 3, valid during the call
  std::size_t worker = 0;      ///< below jobs::worker_count(Placement::arena), exclusive for this call
};

/// Returns the rows of a group by default: a multiple of the source's natural rows that is worth a task.
[[nodiscard]] int comfortable_group_rows(const RowSource& source);

/// Decodes every group once and calls `work` with it, several at a time. Returns the time spent in decoding, summed
/// over threads.
///
/// The groups of a sequential source are decoded in order and handed to free threads: the next one is decoded while
/// others are worked on. After an error no more are decoded.
///
/// Each thread holds one group's rows, and one reader (sequential: one per section instead). Small images, and those
/// for which all that would exceed the memory limit, are processed on the calling thread. Throws `Error`:
/// limit_exceeded if even that would exceed it, cancelled; and whatever reading or `work` throws.
std::chrono::nanoseconds for_each_row_group(const RowSource& source, const RowGroups& groups, const Control& control,
                                            const std::function<void(const RowGroup&)>& work);

/// Decodes the whole image straight to `rgb` (height x width x 3), several comfortable groups at a time. Throws the
/// errors of `for_each_row_group`.
void read_all_rows(const RowSource& source, std::uint64_t memory_limit_bytes, const Control& control, float* rgb);

}  // namespace welkin::files
