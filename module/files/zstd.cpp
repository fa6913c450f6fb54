// Packs and unpacks KTX2's levels with Zstandard.
#include <zstd.h>
#include <zstd_errors.h>

#include <algorithm>
#include <memory>
#include <new>

#include "files/textures.h"
#include "jobs/control.h"

namespace welkin::files {
namespace {

using Bytes = std::vector<std::uint8_t>;

struct FreeZstd {
  void operator()(ZSTD_CCtx* context) const noexcept { ZSTD_freeCCtx(context); }
};

}  // namespace

Bytes pack_zstd(const Bytes& bytes, const stop_token& stop) {
  const std::unique_ptr<ZSTD_CCtx, FreeZstd> context(ZSTD_createCCtx());
  if (!context || ZSTD_isError(ZSTD_CCtx_setPledgedSrcSize(context.get(), bytes.size())) != 0U) throw std::bad_alloc();
  Bytes packed(ZSTD_compressBound(bytes.size()));
  ZSTD_inBuffer from{bytes.data(), 0, 0};
  ZSTD_outBuffer to{packed.data(), packed.size(), 0};
  for (bool done = false; !done;) {
    jobs::throw_if_cancelled(stop);
    from.size = std::min(from.pos + kPackedAtOnce, bytes.size());
    const bool last = from.size == bytes.size();
    const std::size_t left = ZSTD_compressStream2(context.get(), &to, &from, last ? ZSTD_e_end : ZSTD_e_continue);
    if (ZSTD_isError(left) != 0U || (left != 0 && to.pos == to.size)) throw std::bad_alloc();
    done = last && left == 0;
  }
  packed.resize(to.pos);
  return packed;
}

void require_zstd(const Bytes& first, std::uint64_t unpacked_bytes, const std::filesystem::path& path) {
  const unsigned long long stated = ZSTD_getFrameContentSize(first.data(), first.size());
  if (stated == ZSTD_CONTENTSIZE_ERROR) refuse_packed_level(path, "Zstandard", "no frame of its own");
  // A frame may leave its size out, and a level may have several frames.
  if (stated != ZSTD_CONTENTSIZE_UNKNOWN && stated > unpacked_bytes) {
    refuse_packed_level(path, "Zstandard", "longer than the level index says");
  }
  Bytes begin(ZSTD_BLOCKSIZE_MAX);
  const std::size_t result = ZSTD_decompress(begin.data(), begin.size(), first.data(), first.size());
  const ZSTD_ErrorCode error = ZSTD_getErrorCode(result);
  // The second block does not fit, or is cut off here.
  const bool sound = error == ZSTD_error_no_error || error == ZSTD_error_dstSize_tooSmall ||
                     (error == ZSTD_error_srcSize_wrong && first.size() == kFirstPackedBytes);
  if (!sound) refuse_packed_level(path, "Zstandard", ZSTD_getErrorName(result));
}

void unpack_zstd(const Bytes& packed, const std::filesystem::path& path, Bytes& bytes) {
  const std::size_t size = ZSTD_decompress(bytes.data(), bytes.size(), packed.data(), packed.size());
  if (ZSTD_isError(size) != 0U) refuse_packed_level(path, "Zstandard", ZSTD_getErrorName(size));
  if (size != bytes.size()) refuse_packed_level(path, "Zstandard", "shorter than the level index says");
}

}  // namespace welkin::files
