// As left_out.cpp, in the module without others' codecs: .env files, whose images are PNG.
#include <memory>

#include "files/env.h"
#include "platform/file.h"
#include "welkin/core.h"

namespace welkin::files {
namespace {

[[noreturn]] void refuse() {
  throw Error(ErrorCode::unsupported_file, "an .env takes libspng (PNG), which this module was built without");
}

}  // namespace

EnvManifest read_env_manifest(platform::ByteFile& /*file*/) { refuse(); }

bool is_env(platform::ByteFile& /*file*/) { return false; }

std::unique_ptr<RowSource> open_env(platform::ByteFile& /*file*/, const ReadOptions& /*options*/) { refuse(); }

}  // namespace welkin::files
