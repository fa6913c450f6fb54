#include "files/env_pictures.h"

#include <spng.h>
#include <webp/decode.h>

#include <array>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>

#include "files/stop.h"
#include "platform/file.h"

namespace welkin::files {
namespace {

using Bytes = std::vector<std::uint8_t>;

// Texts and profiles beside the pixels, which nobody here wants; beyond it the picture is refused.
constexpr std::size_t kMostOfAChunk = std::size_t{1} << 20U;

struct FreeContext {
  void operator()(spng_ctx* context) const noexcept { spng_ctx_free(context); }
};
using Context = std::unique_ptr<spng_ctx, FreeContext>;

Context make_context(int flags) {
  Context context(spng_ctx_new(flags));
  if (!context) throw std::bad_alloc();
  return context;
}

int append_bytes(spng_ctx* /*context*/, void* user, void* bytes, std::size_t count) noexcept {
  auto& to = *static_cast<Bytes*>(user);
  try {
    const auto* from = static_cast<const std::uint8_t*>(bytes);
    to.insert(to.end(), from, from + count);
    return 0;
  } catch (const std::bad_alloc&) {
    return SPNG_IO_ERROR;  // libspng knows no exceptions
  }
}

// All that can go wrong with sound arguments is memory.
void require_encoded(int result) {
  if (result != SPNG_OK) throw std::bad_alloc();
}

/// About one picture of a file.
struct Subject {
  const std::filesystem::path& path;
  const std::string& what;

  [[noreturn]] void refuse(ErrorCode code, const std::string& message) const {
    throw platform::file_error(code, path, what + " " + message);
  }

  void require_size(std::uint64_t width, std::uint64_t height, int size) const {
    const auto wanted = static_cast<std::uint64_t>(size);
    if (width == wanted && height == wanted) return;
    refuse(ErrorCode::corrupt_file, "is " + std::to_string(width) + " x " + std::to_string(height) +
                                        " texels; its level has " + std::to_string(size) + " x " +
                                        std::to_string(size));
  }
};

void decode_png(const Bytes& picture, int size, const Subject& subject, std::uint8_t* rgba,
                const std::stop_token& stop) {
  const auto require = [&subject](int result) {
    if (result == SPNG_OK) return;
    if (result == SPNG_EMEM) throw std::bad_alloc();
    subject.refuse(ErrorCode::corrupt_file, std::string("is a damaged PNG: libspng says \"") + spng_strerror(result) +
                                                "\"; fetch or export the file again");
  };
  const Context context = make_context(0);
  require(spng_set_chunk_limits(context.get(), kMostOfAChunk, kMostOfAChunk));
  require(spng_set_png_buffer(context.get(), picture.data(), picture.size()));
  spng_ihdr header{};
  require(spng_get_ihdr(context.get(), &header));
  subject.require_size(header.width, header.height, size);
  constexpr int flags = SPNG_DECODE_TRNS | SPNG_DECODE_PROGRESSIVE;
  require(spng_decode_image(context.get(), nullptr, 0, SPNG_FMT_RGBA8, flags));
  const std::size_t row_bytes = std::size_t{4} * header.width;
  for (int result = SPNG_OK; result != SPNG_EOI;) {  // an interlaced picture's rows come several times
    throw_if_stopped(stop);
    spng_row_info row{};
    require(spng_get_row_info(context.get(), &row));
    result = spng_decode_row(context.get(), rgba + row_bytes * row.row_num, row_bytes);
    if (result != SPNG_EOI) require(result);
  }
}

void decode_webp(const Bytes& picture, int size, const Subject& subject, std::uint8_t* rgba) {
  WebPBitstreamFeatures features{};
  if (WebPGetFeatures(picture.data(), picture.size(), &features) != VP8_STATUS_OK) {
    subject.refuse(ErrorCode::corrupt_file, "is a damaged WebP; fetch or export the file again");
  }
  if (features.has_animation != 0) subject.refuse(ErrorCode::unsupported_file, "is an animated WebP");
  subject.require_size(static_cast<std::uint64_t>(features.width), static_cast<std::uint64_t>(features.height), size);
  const std::size_t row_bytes = std::size_t{4} * static_cast<std::size_t>(size);
  const std::size_t bytes = row_bytes * static_cast<std::size_t>(size);
  if (WebPDecodeRGBAInto(picture.data(), picture.size(), rgba, bytes, static_cast<int>(row_bytes)) == nullptr) {
    subject.refuse(ErrorCode::corrupt_file, "is a damaged WebP; fetch or export the file again");
  }
}

}  // namespace

Bytes encode_png_rgba(const Bytes& rgba, int size, const std::stop_token& stop) {
  const Context context = make_context(SPNG_CTX_ENCODER);
  Bytes png;
  require_encoded(spng_set_png_stream(context.get(), append_bytes, &png));
  spng_ihdr header{};
  header.width = static_cast<std::uint32_t>(size);
  header.height = static_cast<std::uint32_t>(size);
  header.bit_depth = 8;
  header.color_type = SPNG_COLOR_TYPE_TRUECOLOR_ALPHA;
  require_encoded(spng_set_ihdr(context.get(), &header));
  constexpr int flags = SPNG_ENCODE_PROGRESSIVE | SPNG_ENCODE_FINALIZE;
  require_encoded(spng_encode_image(context.get(), nullptr, 0, SPNG_FMT_PNG, flags));
  const std::size_t row_bytes = std::size_t{4} * header.width;
  for (int row = 0, result = SPNG_OK; row < size; ++row) {
    throw_if_stopped(stop);
    result = spng_encode_row(context.get(), rgba.data() + row_bytes * static_cast<std::size_t>(row), row_bytes);
    if (result != SPNG_EOI) require_encoded(result);  // said of the last row
  }
  return png;
}

void decode_rgba(const Bytes& picture, int size, const std::filesystem::path& path, const std::string& what,
                 std::uint8_t* rgba, const std::stop_token& stop) {
  const Subject subject{path, what};
  if (picture.size() >= 8 && std::memcmp(picture.data(), "\x89PNG", 4) == 0) {
    decode_png(picture, size, subject, rgba, stop);
  } else if (picture.size() >= 12 && std::memcmp(picture.data(), "RIFF", 4) == 0 &&
             std::memcmp(picture.data() + 8, "WEBP", 4) == 0) {
    decode_webp(picture, size, subject, rgba);
  } else {
    subject.refuse(ErrorCode::unsupported_file, "is neither a PNG nor a WebP by its first bytes; fetch the file again");
  }
}

}  // namespace welkin::files
