// Bytes from the fuzzer, as a file for the library.
#pragma once

#include <cstddef>
#include <cstdint>

namespace welkin::fuzz {

/// Does with the bytes, as a file in memory, all that a user of `environment_file.h` can: looks at it, reads it whole,
/// measures it, projects it, in both layouts; and reads it as a texture and as an .env. Whatever but an `Error` comes
/// out ends the process.
void use_as_file(const std::uint8_t* bytes, std::size_t count);

}  // namespace welkin::fuzz
