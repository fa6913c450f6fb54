// Blocks of ASTC with high dynamic range (Khronos Data Format Specification 1.3, "ASTC Compressed Texture Image
// Formats"), by the library astcenc.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "files/textures.h"
#include "welkin/bake_file.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::files {

/// Rows of texels out of blocks. Each thread has its own: it keeps astcenc's tables (3 MB, made in some 4 ms).
class AstcDecoder {
 public:
  AstcDecoder() = default;
  AstcDecoder(const AstcDecoder&) = delete;
  AstcDecoder& operator=(const AstcDecoder&) = delete;
  virtual ~AstcDecoder() = default;

  /// Packed RGB floats from what is at `row_byte_range` of the kind that it was made for. A block that the
  /// specification does not define gives NaN. Throws `std::bad_alloc`.
  virtual void decode_rows(const std::uint8_t* blocks, int width, int first_row, int rows, float* rgb) = 0;
};

/// `path` is for messages. Throws `Error` (unsupported_file) in a build without astcenc, `std::bad_alloc`.
[[nodiscard]] std::unique_ptr<AstcDecoder> make_astc_decoder(TexelKind kind, const std::filesystem::path& path);

/// Encodes the faces of each level, or the one picture of it. What halves cannot hold, and negatives, are clamped and
/// counted. The same bytes on any number of threads: blocks are encoded by themselves. Throws `Error`:
/// invalid_argument (the effort), cancelled; `std::bad_alloc`.
[[nodiscard]] BlockLevels encode_astc(std::span<const std::vector<LatLongView>> levels, TexelKind kind,
                                      AstcEffort effort, const Control& control);

}  // namespace welkin::files
