// Packs and unpacks KTX2's levels with zlib.
#include <algorithm>
#include <memory>
#include <new>
#define ZLIB_CONST  // zlib does not write through next_in
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

/// Return the bytes read and written so far. (The stream's counts have 32 bits on Windows.)
std::size_t read_bytes(const z_stream& stream, const Bytes& from) noexcept {
  return static_cast<std::size_t>(stream.next_in - from.data());
}
std::size_t written_bytes(const z_stream& stream, const Bytes& to) noexcept {
  return static_cast<std::size_t>(stream.next_out - to.data());
}

/// Starts at the first byte on either side.
void begin(z_stream& stream, const Bytes& from, Bytes& to) noexcept {
  stream.next_in = from.data();
  stream.next_out = to.data();
}

/// Offers at most the next block on either side. Returns whether it is all that is left to read.
bool offer(z_stream& stream, const Bytes& from, const Bytes& to) noexcept {
  const std::size_t left = from.size() - read_bytes(stream, from);
  stream.avail_in = static_cast<uInt>(std::min(kPackedAtOnce, left));
  stream.avail_out = static_cast<uInt>(std::min(kPackedAtOnce, to.size() - written_bytes(stream, to)));
  return left <= kPackedAtOnce;
}

/// Returns the maximum packed size: as zlib's deflateBound for its default settings, in 64 bits.
std::size_t most_packed_bytes(std::size_t bytes) noexcept {
  return bytes + (bytes >> 12U) + (bytes >> 14U) + (bytes >> 25U) + 13;
}

}  // namespace

Bytes pack_zlib(const Bytes& bytes, const stop_token& stop) {
  z_stream stream{};
  if (deflateInit(&stream, Z_DEFAULT_COMPRESSION) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, EndDeflate> end(&stream);
  Bytes packed(most_packed_bytes(bytes.size()));
  begin(stream, bytes, packed);
  int result = Z_OK;
  while (result == Z_OK) {
    jobs::throw_if_cancelled(stop);
    const bool last = offer(stream, bytes, packed);
    result = deflate(&stream, last ? Z_FINISH : Z_NO_FLUSH);
  }
  if (result != Z_STREAM_END) throw std::bad_alloc();  // no other failure is possible: `packed` holds the worst case
  packed.resize(written_bytes(stream, packed));
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
  std::uint64_t bytes = 0;
  while (result == Z_OK && bytes < most) {
    stream.next_out = scratch.get();
    stream.avail_out = kAtOnce;
    result = inflate(&stream, Z_NO_FLUSH);
    bytes += kAtOnce - stream.avail_out;
  }
  if (result != Z_OK && result != Z_STREAM_END) return std::nullopt;
  return std::min(bytes, most);
}

void require_zlib(const Bytes& first, const std::filesystem::path& path) {
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, EndInflate> end(&stream);
  Bytes begin_of_level(kFirstPackedBytes);
  begin(stream, first, begin_of_level);
  offer(stream, first, begin_of_level);
  const int result = inflate(&stream, Z_SYNC_FLUSH);
  if (result == Z_MEM_ERROR) throw std::bad_alloc();
  if (result != Z_OK && result != Z_STREAM_END && result != Z_BUF_ERROR) {
    refuse_packed_level(path, "zlib", zError(result));
  }
}

void unpack_zlib(const Bytes& packed, const std::filesystem::path& path, Bytes& bytes, const stop_token& stop) {
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, EndInflate> end(&stream);
  begin(stream, packed, bytes);
  int result = Z_OK;
  while (result == Z_OK) {
    jobs::throw_if_cancelled(stop);
    offer(stream, packed, bytes);
    result = inflate(&stream, Z_NO_FLUSH);
  }
  if (result == Z_MEM_ERROR) throw std::bad_alloc();
  if (result == Z_BUF_ERROR) refuse_packed_level(path, "zlib", "not the size that the level index says");
  if (result != Z_STREAM_END) refuse_packed_level(path, "zlib", zError(result));
  if (written_bytes(stream, bytes) != bytes.size())
    refuse_packed_level(path, "zlib", "shorter than the level index says");
}

}  // namespace welkin::files
