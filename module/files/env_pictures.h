// The small pictures inside an .env file: RGBA of 8 bits, in memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

namespace welkin::files {

/// A PNG of `size` x `size` texels, rows as they are given, without any word on colours: they are numbers, and no
/// viewer is to turn them. `stop` is looked at before each row. Throws `Error` (cancelled), `std::bad_alloc`.
[[nodiscard]] std::vector<std::uint8_t> encode_png_rgba(const std::vector<std::uint8_t>& rgba, int size,
                                                        const std::stop_token& stop = {});

/// Decodes a PNG or a WebP, told by its first bytes, which must be `size` x `size`, to 4 x size x size bytes. `what`
/// names it in messages. `stop` is looked at before each row of a PNG. Throws `Error`: corrupt_file, unsupported_file,
/// cancelled.
void decode_rgba(const std::vector<std::uint8_t>& picture, int size, const std::filesystem::path& path,
                 const std::string& what, std::uint8_t* rgba, const std::stop_token& stop = {});

}  // namespace welkin::files
