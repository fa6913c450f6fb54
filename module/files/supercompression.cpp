#include <limits>
#include <string>

#include "files/textures.h"
#include "jobs/control.h"
#include "platform/file.h"

namespace welkin::files {
namespace {

using Bytes = std::vector<std::uint8_t>;

}  // namespace

void refuse_packed_level(const std::filesystem::path& path, const char* library, const std::string& reason) {
  throw platform::file_error(ErrorCode::corrupt_file, path,
                             std::string("has a level that does not unpack: ") + library + " says \"" + reason +
                                 "\"; fetch or export it again");
}

Bytes pack(Supercompression supercompression, const Bytes& bytes, const stop_token& stop) {
  return supercompression == Supercompression::zlib ? pack_zlib(bytes, stop) : pack_zstd(bytes, stop);
}

void unpack(Supercompression supercompression, const Bytes& packed, const std::filesystem::path& path, Bytes& bytes,
            const stop_token& stop) {
  jobs::throw_if_cancelled(stop);
  if (supercompression == Supercompression::zlib) {
    unpack_zlib(packed, path, bytes, stop);
  } else {
    unpack_zstd(packed, path, bytes);
  }
}

void require_unpacks(Supercompression supercompression, const Bytes& first, std::uint64_t unpacked_bytes,
                     const std::filesystem::path& path) {
  if (supercompression == Supercompression::zlib) return require_zlib(first, path);
  require_zstd(first, unpacked_bytes, path);
}

std::uint64_t most_unpacked(Supercompression supercompression, std::uint64_t packed_bytes) noexcept {
  // deflate: 1032 bytes of one (zlib's technical notes). Zstandard: a block of 128 KiB of the four bytes that say which
  // byte to repeat (RFC 8878, 3.1.1.2).
  const std::uint64_t ratio = supercompression == Supercompression::zlib ? 1032 : (128U << 10U) / 4;
  constexpr std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
  return packed_bytes > most / ratio ? most : packed_bytes * ratio;
}

}  // namespace welkin::files
