// The images of .env files that are WebP, by libwebp.
#include <webp/decode.h>

#include "files/env.h"

namespace welkin::files {

void decode_webp_rgba(const EnvImageBytes& image, std::uint8_t* rgba) {
  WebPBitstreamFeatures features{};
  if (WebPGetFeatures(image.bytes.data(), image.bytes.size(), &features) != VP8_STATUS_OK) {
    image.refuse(ErrorCode::corrupt_file, "is a damaged WebP; fetch or export the file again");
  }
  if (features.has_animation != 0)
    image.refuse(ErrorCode::unsupported_file, "is an animated WebP; export it as a still image");
  image.require_size(static_cast<std::uint64_t>(features.width), static_cast<std::uint64_t>(features.height));
  const std::size_t row_bytes = std::size_t{4} * static_cast<std::size_t>(image.size);
  const std::size_t bytes = row_bytes * static_cast<std::size_t>(image.size);
  if (WebPDecodeRGBAInto(image.bytes.data(), image.bytes.size(), rgba, bytes, static_cast<int>(row_bytes)) == nullptr) {
    image.refuse(ErrorCode::corrupt_file, "is a damaged WebP; fetch or export the file again");
  }
}

}  // namespace welkin::files
