// The attributes of an OpenEXR header, walked before the OpenEXR library sees them.
#pragma once

#include <ImfHeader.h>

#include <string>
#include <vector>

#include "platform/file.h"

namespace welkin::files {

/// Walks the header's attributes from the current position (behind magic number and version) to their end,
/// and checks that what OpenEXR 3 will allocate for each is no more than the bytes that the file has for it.
///
/// The library allocates by the sizes it is told and for most types reads what the type takes, whatever
/// size was stated. So it can be led to read a value's bytes as the next attribute's header, and to allocate
/// gigabytes for a file of a few hundred bytes. Where every stated size is the one that is consumed, the
/// library's walk is this one. Throws `Error` (corrupt_file) naming the attribute.
void check_exr_attributes(platform::ByteFile& file);

// The parts of an OpenEXR file: all headers, checked before the library makes room for what they claim.

struct ExrPart {
  Imf::Header header;
  bool tiled = false;
  bool deep = false;   ///< holds samples at depths, or is of a type that is not known: no picture
  std::string name{};  ///< fit to be printed; empty in a single-part file that has none
};

struct ExrParts {
  std::vector<ExrPart> parts;  ///< at least one
  bool multi_part = false;
  std::uint64_t header_bytes = 0;  ///< of all headers in the file
};

/// Reads magic number, version and all headers. `file` stands at its beginning. Windows are not checked yet.
/// Throws `Error`: unsupported_file for a version that is not known, corrupt_file.
[[nodiscard]] ExrParts read_exr_parts(platform::ByteFile& file);

/// Checks what the library will allocate for every part when it opens the file: its tables of offsets, eight bytes a
/// chunk, which the file must be long enough to hold. Returns their bytes. `file` stands behind the headers.
/// Throws `Error`: corrupt_file.
std::uint64_t check_exr_tables(const ExrParts& parts, const platform::ByteFile& file);

/// The part by name or number that is asked for; if `asked_for` is empty, the first that holds colour (in `layer` if
/// that is not empty), else the first that holds luminance. Deep parts are skipped.
/// Throws `Error`: unsupported_file naming the parts.
[[nodiscard]] std::size_t choose_exr_part(const ExrParts& parts, const std::filesystem::path& path,
                                          const std::string& asked_for, const std::string& layer);

}  // namespace welkin::files
