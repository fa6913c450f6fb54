// KTX2's levels by zlib.
#include <algorithm>
#include <memory>
#include <new>
#define ZLIB_CONST  // it does not write through next_in
#include <zlib.h>

#include "files/textures.h"
#include "jobs/control.h"

namespace welkin::files {
namespace {

using Bytes = std::vector<std::uint8_t>;

struct EndDeflate {
  void operator()(z_stream* stream) const noexcept { deflateEnd(stream); }
};
struct EndInflate {
  void operator()(z_stream* stream) const noexcept { inflateEnd(stream); }
};

/// The next block on either side, at most. Whether it is all that is left to read.
bool offer(z_stream& stream, const Bytes& from, Bytes& to) noexcept {
  const std::size_t left = from.size() - stream.total_in;
  stream.next_in = from.data() + stream.total_in;
  stream.avail_in = static_cast<uInt>(std::min(kPackedAtOnce, left));
  stream.next_out = to.data() + stream.total_out;
  stream.avail_out = static_cast<uInt>(std::min(kPackedAtOnce, to.size() - stream.total_out));
  return left <= kPackedAtOnce;
}

}  // namespace

Bytes pack_zlib(const Bytes& bytes, const stop_token& stop) {
  z_stream stream{};
  if (deflateInit(&stream, Z_DEFAULT_COMPRESSION) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, EndDeflate> end(&stream);
  Bytes packed(deflateBound(&stream, bytes.size()));
  int result = Z_OK;
  while (result == Z_OK) {
    jobs::throw_if_cancelled(stop);
    const bool last = offer(stream, bytes, packed);
    result = deflate(&stream, last ? Z_FINISH : Z_NO_FLUSH);
  }
  if (result != Z_STREAM_END) throw std::bad_alloc();  // nothing else can go wrong: there is room for the worst case
  packed.resize(stream.total_out);
  return packed;
}

std::optional<std::uint64_t> unpacked_zlib_bytes(std::span<const char> packed, std::uint64_t most) {
  constexpr std::size_t kAtOnce = std::size_t{1} << 16U;
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, EndInflate> end(&stream);
  const auto scratch = std::make_unique<Bytef[]>(kAtOnce);
  stream.next_in = reinterpret_cast<const Bytef*>(packed.data());
  stream.avail_in = static_cast<uInt>(packed.size());  // OpenEXR's blocks state their length in 31 bits
  int result = Z_OK;
  while (result == Z_OK && stream.total_out < most) {
    stream.next_out = scratch.get();
    stream.avail_out = kAtOnce;
    result = inflate(&stream, Z_NO_FLUSH);
  }
  if (result != Z_OK && result != Z_STREAM_END) return std::nullopt;
  return std::min<std::uint64_t>(stream.total_out, most);
}

void unpack_zlib(const Bytes& packed, const std::filesystem::path& path, Bytes& bytes, const stop_token& stop) {
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, EndInflate> end(&stream);
  int result = Z_OK;
  while (result == Z_OK) {
    jobs::throw_if_cancelled(stop);
    offer(stream, packed, bytes);
    result = inflate(&stream, Z_NO_FLUSH);
  }
  if (result == Z_MEM_ERROR) throw std::bad_alloc();
  if (result == Z_BUF_ERROR) refuse_packed_level(path, "zlib", "not the size that the level index says");
  if (result != Z_STREAM_END) refuse_packed_level(path, "zlib", zError(result));
  if (stream.total_out != bytes.size()) refuse_packed_level(path, "zlib", "shorter than the level index says");
}

}  // namespace welkin::files
