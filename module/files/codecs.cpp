// The formats that this build can read and write, and refusals for codecs that it was built without.
// WELKIN_EXR, WELKIN_PNG, WELKIN_WEBP, WELKIN_ZLIB, WELKIN_ZSTD, WELKIN_ASTC and WELKIN_JPEG are 1 or 0; no other
// source reads them.
#include "files/codecs.h"

#include <array>
#include <limits>

#include "files/env.h"
#include "files/textures.h"
#include "files/write_environment.h"
#include "jobs/control.h"

namespace welkin::files {
namespace {

struct Description {
  bool built_in;
  const char* library;
  const char* option;
};

// Indexed by Codec.
constexpr std::array kCodecs{
    Description{WELKIN_EXR != 0, "OpenEXR", "WELKIN_EXR"},
    Description{WELKIN_PNG != 0, "libspng (PNG)", "WELKIN_PNG"},
    Description{WELKIN_WEBP != 0, "libwebp (WebP)", "WELKIN_WEBP"},
    Description{WELKIN_ZLIB != 0, "zlib", "WELKIN_ZLIB"},
    Description{WELKIN_ZSTD != 0, "Zstandard", "WELKIN_ZSTD"},
    Description{WELKIN_ASTC != 0, "astcenc (ASTC)", "WELKIN_ASTC"},
    Description{WELKIN_JPEG != 0, "libjpeg (JPEG)", "WELKIN_JPEG"},
};

constexpr const char* kSaveUnpacked = "save it without supercompression";

}  // namespace

void require_codec(Codec codec, const std::filesystem::path& path, const std::string& remedy) {
  const Description& description = kCodecs[static_cast<std::size_t>(codec)];
  if (description.built_in) return;
  throw platform::file_error(ErrorCode::unsupported_file, path,
                             std::string("takes ") + description.library + ", which this Welkin was built without; " +
                                 remedy + ", or build Welkin with " + description.option + "=ON");
}

Codec codec_of(Supercompression supercompression) noexcept {
  return supercompression == Supercompression::zlib ? Codec::zlib : Codec::zstd;
}

// Supercompression, by the library of each scheme.

void refuse_packed_level(const std::filesystem::path& path, const char* library, const std::string& reason) {
  throw platform::file_error(ErrorCode::corrupt_file, path,
                             std::string("has a level that does not unpack: ") + library + " says \"" + reason +
                                 "\"; fetch or export it again");
}

std::vector<std::uint8_t> pack(Supercompression supercompression, const std::vector<std::uint8_t>& bytes,
                               const stop_token& stop) {
  const Codec codec = codec_of(supercompression);
  require_codec(codec, "a KTX2", "leave the supercompression out");
  if constexpr (WELKIN_ZLIB != 0) {
    if (codec == Codec::zlib) return pack_zlib(bytes, stop);
  }
  if constexpr (WELKIN_ZSTD != 0) return pack_zstd(bytes, stop);
  return {};
}

void unpack(Supercompression supercompression, const std::vector<std::uint8_t>& packed,
            const std::filesystem::path& path, std::vector<std::uint8_t>& bytes, const stop_token& stop) {
  const Codec codec = codec_of(supercompression);
  jobs::throw_if_cancelled(stop);
  require_codec(codec, path, kSaveUnpacked);
  if constexpr (WELKIN_ZLIB != 0) {
    if (codec == Codec::zlib) return unpack_zlib(packed, path, bytes, stop);
  }
  if constexpr (WELKIN_ZSTD != 0) unpack_zstd(packed, path, bytes);
}

void require_unpacks(Supercompression supercompression, const std::vector<std::uint8_t>& first,
                     std::uint64_t unpacked_bytes, const std::filesystem::path& path) {
  const Codec codec = codec_of(supercompression);
  require_codec(codec, path, kSaveUnpacked);
  if constexpr (WELKIN_ZLIB != 0) {
    if (codec == Codec::zlib) return require_zlib(first, path);
  }
  if constexpr (WELKIN_ZSTD != 0) require_zstd(first, unpacked_bytes, path);
}

std::uint64_t most_unpacked(Supercompression supercompression, std::uint64_t packed_bytes) noexcept {
  // deflate: 1032 bytes of one (zlib's technical notes). Zstandard: a block of 128 KiB of the four bytes that say which
  // byte to repeat (RFC 8878, 3.1.1.2).
  const std::uint64_t ratio = supercompression == Supercompression::zlib ? 1032 : (128U << 10U) / 4;
  constexpr std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
  return packed_bytes > most / ratio ? most : packed_bytes * ratio;
}

// The refusals below are reached only where `require_codec` was not called before; the linker needs them.

#if !WELKIN_EXR
std::unique_ptr<RowSource> open_exr(platform::ByteFile& file, const ReadOptions& /*options*/) {
  require_codec(Codec::exr, file.path(), "convert it to Radiance .hdr or PFM");
  return nullptr;
}
std::uint64_t write_exr(const OutputImage& /*image*/, const WriteJob& job) {
  require_codec(Codec::exr, job.file.path(), "write .hdr or .pfm");
  return 0;
}
std::uint64_t write_exr_cube(const TextureJob& job) {
  require_codec(Codec::exr, job.file.path(), "write .ktx2 or .dds");
  return 0;
}
#endif

#if !WELKIN_PNG
std::unique_ptr<RowSource> open_png(platform::ByteFile& file, const ReadOptions& /*options*/) {
  require_codec(Codec::png, file.path(), "convert it to Radiance .hdr or PFM");
  return nullptr;
}
std::uint64_t write_png(const OutputImage& /*image*/, const WriteJob& job) {
  require_codec(Codec::png, job.file.path(), "write .hdr or .pfm");
  return 0;
}
void write_png_quickly(platform::WholeFile& file, const std::vector<std::uint8_t>& /*rgb*/, int /*width*/) {
  require_codec(Codec::png, file.path(), "pass --no-previews");
}
std::vector<std::uint8_t> encode_png_rgba(const std::vector<std::uint8_t>& /*rgba*/, int /*size*/,
                                          const stop_token& /*stop*/) {
  require_codec(Codec::png, "an .env", "write .ktx2 or .dds");
  return {};
}
void decode_png_rgba(const EnvImageBytes& image, std::uint8_t* /*rgba*/, const stop_token& /*stop*/) {
  require_codec(Codec::png, image.path, "use the image that the .env was made from");
}
#endif

#if !WELKIN_JPEG
std::unique_ptr<RowSource> open_jpeg(platform::ByteFile& file, const ReadOptions& /*options*/) {
  require_codec(Codec::jpeg, file.path(), "convert it to OpenEXR or Radiance .hdr");
  return nullptr;
}
#endif

#if !WELKIN_WEBP
void decode_webp_rgba(const EnvImageBytes& image, std::uint8_t* /*rgba*/) {
  require_codec(Codec::webp, image.path, "export it again with PNG images");
}
#endif

#if !WELKIN_ZLIB
std::optional<std::uint64_t> unpacked_zlib_bytes(std::span<const char> /*packed*/, std::uint64_t /*most*/) {
  return std::nullopt;
}
#endif

#if !WELKIN_ASTC
AstcDecoder make_astc_decoder(TexelKind /*kind*/, const std::filesystem::path& path) {
  require_codec(Codec::astc, path, "save it in another format");
  return {};
}
BlockLevels encode_astc(std::span<const std::vector<LatLongView>> /*levels*/, TexelKind /*kind*/, AstcEffort /*effort*/,
                        const Control& /*control*/) {
  require_codec(Codec::astc, "a KTX2", "pass bc6h_ufloat or another format");
  return {};
}
#endif

}  // namespace welkin::files
