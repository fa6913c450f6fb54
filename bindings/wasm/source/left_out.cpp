// What the library can and no entry of the modules asks for: it would be a third of what they weigh. The linker meets
// these functions before the library's, of which it then takes none of the sources that they are in: it says so where
// one of them lacks a function here.
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "files/row_source.h"
#include "image/bc6h_encoder.h"
#include "image/uastc_hdr_encoder.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"

namespace welkin {
namespace {

[[noreturn]] void refuse(const char* what) {
  throw Error(ErrorCode::unsupported_file, std::string("WebAssembly's modules are built without ") + what);
}

}  // namespace

namespace image {

std::vector<LatLongView> pictures_of(const CubemapView& /*view*/) { refuse("an encoder of BC6H"); }

Bc6hPictureLevels encode_bc6h_pictures(std::span<const std::vector<LatLongView>> /*levels*/,
                                       const Bc6hOptions& /*options*/, const Control& /*control*/) {
  refuse("an encoder of BC6H");
}

EncodedLevels encode_uastc_hdr_pictures(std::span<const std::vector<LatLongView>> /*levels*/, Bc6hEffort /*effort*/,
                                        const Control& /*control*/) {
  refuse("an encoder of UASTC HDR");
}

}  // namespace image

namespace files {

std::vector<FileInput> six_inputs(const FileInput& /*input*/) { refuse("cubemaps of six files"); }

std::unique_ptr<RowSource> open_six_files(const FileInput& /*input*/, const std::vector<FileInput>& /*inputs*/,
                                          const ReadOptions& /*options*/, const std::string& /*reason*/) {
  refuse("cubemaps of six files");
}

}  // namespace files
}  // namespace welkin
