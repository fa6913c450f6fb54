// As left_out.cpp, in the module without others' codecs: .env files, whose pictures are PNG.
#include <cstddef>
#include <memory>
#include <vector>

#include "env_file.h"
#include "files/env.h"
#include "files/env_manifest.h"
#include "platform/file.h"
#include "welkin/core.h"

namespace welkin {
namespace {

[[noreturn]] void refuse() {
  throw Error(ErrorCode::unsupported_file, "an .env takes libspng (PNG), which this module was built without");
}

}  // namespace

namespace files {

EnvManifest read_env_manifest(platform::ByteFile& /*file*/) { refuse(); }

bool is_env(platform::ByteFile& /*file*/) { return false; }

std::unique_ptr<RowSource> open_env(platform::ByteFile& /*file*/, const ReadOptions& /*options*/) { refuse(); }

}  // namespace files

namespace wasm {

std::vector<std::byte> env_file(const Pixels& /*picture*/, const Options& /*options*/, int /*first*/,
                                const PixelPolicy& /*policy*/, const SphericalHarmonics& /*radiance*/,
                                const Control& /*control*/) {
  refuse();
}

}  // namespace wasm
}  // namespace welkin
