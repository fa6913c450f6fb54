#include "files/supercompression.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <new>
#define ZLIB_CONST  // it does not write through next_in
#include <zlib.h>
#include <zstd.h>

#include "files/stop.h"
#include "platform/file.h"

namespace welkin::files {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kBlock = std::size_t{1} << 20U;  // between two looks at the stop token

struct EndDeflate {
  void operator()(z_stream* stream) const noexcept { deflateEnd(stream); }
};
struct EndInflate {
  void operator()(z_stream* stream) const noexcept { inflateEnd(stream); }
};
struct FreeZstd {
  void operator()(ZSTD_CCtx* context) const noexcept { ZSTD_freeCCtx(context); }
};

/// The next block on either side, at most. Whether it is all that is left to read.
bool offer(z_stream& stream, const Bytes& from, Bytes& to) noexcept {
  const std::size_t left = from.size() - stream.total_in;
  stream.next_in = from.data() + stream.total_in;
  stream.avail_in = static_cast<uInt>(std::min(kBlock, left));
  stream.next_out = to.data() + stream.total_out;
  stream.avail_out = static_cast<uInt>(std::min(kBlock, to.size() - stream.total_out));
  return left <= kBlock;
}

Bytes pack_zlib(const Bytes& bytes, const std::stop_token& stop) {
  z_stream stream{};
  if (deflateInit(&stream, Z_DEFAULT_COMPRESSION) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, EndDeflate> end(&stream);
  Bytes packed(deflateBound(&stream, bytes.size()));
  int result = Z_OK;
  while (result == Z_OK) {
    throw_if_stopped(stop);
    const bool last = offer(stream, bytes, packed);
    result = deflate(&stream, last ? Z_FINISH : Z_NO_FLUSH);
  }
  if (result != Z_STREAM_END) throw std::bad_alloc();  // nothing else can go wrong: there is room for the worst case
  packed.resize(stream.total_out);
  return packed;
}

Bytes pack_zstd(const Bytes& bytes, const std::stop_token& stop) {
  const std::unique_ptr<ZSTD_CCtx, FreeZstd> context(ZSTD_createCCtx());
  if (!context || ZSTD_isError(ZSTD_CCtx_setPledgedSrcSize(context.get(), bytes.size())) != 0U) throw std::bad_alloc();
  Bytes packed(ZSTD_compressBound(bytes.size()));
  ZSTD_inBuffer from{bytes.data(), 0, 0};
  ZSTD_outBuffer to{packed.data(), packed.size(), 0};
  for (bool done = false; !done;) {
    throw_if_stopped(stop);
    from.size = std::min(from.pos + kBlock, bytes.size());
    const bool last = from.size == bytes.size();
    const std::size_t left = ZSTD_compressStream2(context.get(), &to, &from, last ? ZSTD_e_end : ZSTD_e_continue);
    if (ZSTD_isError(left) != 0U || (left != 0 && to.pos == to.size)) throw std::bad_alloc();
    done = last && left == 0;
  }
  packed.resize(to.pos);
  return packed;
}

[[noreturn]] void refuse(const std::filesystem::path& path, const char* library, const std::string& reason) {
  throw platform::file_error(ErrorCode::corrupt_file, path,
                             std::string("has a level that does not unpack: ") + library + " says \"" + reason +
                                 "\"; fetch or export it again");
}

void unpack_zlib(const Bytes& packed, const std::filesystem::path& path, Bytes& bytes, const std::stop_token& stop) {
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, EndInflate> end(&stream);
  int result = Z_OK;
  while (result == Z_OK) {
    throw_if_stopped(stop);
    offer(stream, packed, bytes);
    result = inflate(&stream, Z_NO_FLUSH);
  }
  if (result == Z_MEM_ERROR) throw std::bad_alloc();
  if (result == Z_BUF_ERROR) refuse(path, "zlib", "not the size that the level index says");
  if (result != Z_STREAM_END) refuse(path, "zlib", zError(result));
  if (stream.total_out != bytes.size()) refuse(path, "zlib", "shorter than the level index says");
}

void unpack_zstd(const Bytes& packed, const std::filesystem::path& path, Bytes& bytes) {
  const std::size_t size = ZSTD_decompress(bytes.data(), bytes.size(), packed.data(), packed.size());
  if (ZSTD_isError(size) != 0U) refuse(path, "Zstandard", ZSTD_getErrorName(size));
  if (size != bytes.size()) refuse(path, "Zstandard", "shorter than the level index says");
}

}  // namespace

Bytes pack(Supercompression supercompression, const Bytes& bytes, const std::stop_token& stop) {
  return supercompression == Supercompression::zlib ? pack_zlib(bytes, stop) : pack_zstd(bytes, stop);
}

void unpack(Supercompression supercompression, const Bytes& packed, const std::filesystem::path& path, Bytes& bytes,
            const std::stop_token& stop) {
  throw_if_stopped(stop);
  if (supercompression == Supercompression::zlib) {
    unpack_zlib(packed, path, bytes, stop);
  } else {
    unpack_zstd(packed, path, bytes);
  }
}

std::uint64_t most_unpacked(Supercompression supercompression, std::uint64_t packed_bytes) noexcept {
  // deflate: 1032 bytes of one (zlib's technical notes). Zstandard: a block of 128 KiB of the four bytes that say which
  // byte to repeat (RFC 8878, 3.1.1.2).
  const std::uint64_t ratio = supercompression == Supercompression::zlib ? 1032 : (128U << 10U) / 4;
  constexpr std::uint64_t most = std::numeric_limits<std::uint64_t>::max();
  return packed_bytes > most / ratio ? most : packed_bytes * ratio;
}

}  // namespace welkin::files
