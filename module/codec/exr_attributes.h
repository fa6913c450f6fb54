// The attributes of an OpenEXR header, walked before the OpenEXR library sees them.
#pragma once

#include "codec/byte_file.h"

namespace welkin::codec {

/// Walks the header's attributes from the current position (behind magic number and version) to their end,
/// and checks that what OpenEXR 3 will allocate for each is no more than the bytes that the file has for it.
///
/// The library allocates by the sizes it is told and for most types reads what the type takes, whatever
/// size was stated. So it can be led to read a value's bytes as the next attribute's header, and to allocate
/// gigabytes for a file of a few hundred bytes. Where every stated size is the one that is consumed, the
/// library's walk is this one. Throws `Error` (corrupt_file) naming the attribute.
void check_exr_attributes(ByteFile& file);

}  // namespace welkin::codec
