// What the writers of textures share.
#pragma once

#include <span>
#include <vector>

#include "files/texel_formats.h"
#include "platform/file.h"
#include "welkin/control.h"
#include "welkin/image_view.h"

namespace welkin::files {

/// A texture that is about to be written; all that was checked.
struct TextureJob {
  platform::WholeFile& file;
  std::span<const CubemapView> mips;
  const TextureOptions& options;
  const Control& control;
};

/// A picture of one level that is about to be written as a texture.
struct PictureJob {
  platform::WholeFile& file;
  const LatLongView& picture;  ///< any picture: rows, not directions
  const TextureOptions& options;
  const Control& control;
};

/// Each writes the texture to the job's file and returns how many values were clamped. Throw `Error` as
/// `write_texture` does.
std::uint64_t write_ktx2(const TextureJob& job);
std::uint64_t write_dds(const TextureJob& job);
std::uint64_t write_exr_cube(const TextureJob& job);
std::uint64_t write_ktx2(const PictureJob& job);
std::uint64_t write_dds(const PictureJob& job);

/// Throws `Error` (cancelled), and tells the share that is done.
void report_share(const Control& control, double done);

/// Turns a level's face into texels, a block of rows after the other.
class TexelEncoder {
 public:
  explicit TexelEncoder(TexelFormat format) : format_(format) {}

  /// Some rows of a face, to `texels`: rows x view.size texels.
  void encode(const CubemapView& view, int face, int first_row, int rows, std::uint8_t* texels);

  void encode(const LatLongView& picture, int first_row, int rows, std::uint8_t* texels);

  [[nodiscard]] std::uint64_t clamped() const noexcept { return clamped_; }

 private:
  void encode_row(PixelFormat format, const void* row, int width, std::uint8_t* texels);

  TexelFormat format_;
  std::vector<float> rgb_;  // a row
  std::uint64_t clamped_ = 0;
};

/// How far texels have come, for the progress of a whole chain.
class TexelProgress {
 public:
  TexelProgress(std::span<const CubemapView> mips, const Control& control);
  /// Before `texels` more are written. Throws as `report_share`.
  void next(std::uint64_t texels);

 private:
  const Control& control_;
  double total_ = 0.0;
  double done_ = 0.0;
};

/// Writes a face as it lies in the file, unpacked.
void write_face(platform::WholeFile& file, const CubemapView& view, int face, TexelFormat format, TexelEncoder& encoder,
                TexelProgress& progress);

/// Writes a picture likewise.
void write_picture(const PictureJob& job, TexelEncoder& encoder);

}  // namespace welkin::files
