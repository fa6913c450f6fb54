// As left_out.cpp, in the module with others' codecs, which reads OpenEXR and writes none.
#include <cstdint>

#include "files/textures.h"
#include "files/write_environment.h"
#include "welkin/core.h"

namespace welkin::files {
namespace {

[[noreturn]] void refuse() {
  throw Error(ErrorCode::unsupported_file, "WebAssembly's modules are built without a writer of OpenEXR");
}

}  // namespace

std::uint64_t write_exr(const OutputPicture& /*picture*/, const WriteJob& /*job*/) { refuse(); }

std::uint64_t write_exr_cube(const TextureJob& /*job*/) { refuse(); }

}  // namespace welkin::files
