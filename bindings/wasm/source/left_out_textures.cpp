// As left_out.cpp, in the module of textures: the encoder of BC6H. UASTC HDR serves the GPUs that read BC6H.
#include <span>
#include <vector>

#include "image/block_images.h"
#include "welkin/core.h"

namespace welkin::image {

EncodedLevels encode_bc6h_images(std::span<const std::vector<LatLongView>> /*levels*/, const Bc6hOptions& /*options*/,
                                 const Control& /*control*/) {
  throw Error(ErrorCode::unsupported_file, "WebAssembly's modules are built without an encoder of BC6H");
}

}  // namespace welkin::image
