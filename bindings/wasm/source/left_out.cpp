// Stand-ins for library functions that no entry of the module for files calls: they would be a third of its size. The
// linker meets these functions before the library's, of which it then takes none of the sources that they are in: it
// says so where one of them lacks a function here.
#include <memory>
#include <string>
#include <vector>

#include "files/row_source.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"

namespace welkin::files {
namespace {

[[noreturn]] void refuse(const char* what) {
  throw Error(ErrorCode::unsupported_file, std::string("WebAssembly's modules are built without ") + what);
}

}  // namespace

std::vector<FileInput> six_inputs(const FileInput& /*input*/) { refuse("cubemaps of six files"); }

std::unique_ptr<RowSource> open_six_files(const FileInput& /*input*/, const std::vector<FileInput>& /*inputs*/,
                                          const ReadOptions& /*options*/, const std::string& /*reason*/) {
  refuse("cubemaps of six files");
}

}  // namespace welkin::files
