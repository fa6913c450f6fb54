// Blocks of OpenEXR files that unpack to less than their texels. The library (3.1) looks at the length of what most of
// its codecs give, but not of ZIP's, RLE's and uncompressed blocks: the rest of their texels would be whatever its
// memory held.
#include <ImfHeader.h>

#include <algorithm>
#include <string>

#include "files/exr.h"
#include "files/textures.h"

namespace welkin::files {
namespace {

/// How many of the positions first to last are multiples of `step`.
std::size_t samples(int first, int last, int step) {
  const auto below = [step](int position) {  // multiples up to this one, from an arbitrary one on
    return position >= 0 ? position / step : -((-position + step - 1) / step);
  };
  return static_cast<std::size_t>(below(last) - below(first - 1));
}

/// Of one row, all channels.
std::uint64_t row_bytes(const Imf::ChannelList& channels, int row, int first_column, int last_column) {
  std::uint64_t bytes = 0;
  for (auto channel = channels.begin(); channel != channels.end(); ++channel) {
    const Imf::Channel& one = channel.channel();
    if (samples(row, row, one.ySampling) == 0) continue;
    bytes += samples(first_column, last_column, one.xSampling) * (one.type == Imf::HALF ? 2U : 4U);
  }
  return bytes;
}

/// What OpenEXR's run lengths unpack to: a count below 0 stands before so many bytes, one from 0 on before a byte that
/// stands for one more than that (ImfRle.cpp).
std::uint64_t unpacked_rle_bytes(std::span<const char> packed) {
  std::uint64_t bytes = 0;
  for (std::size_t at = 0; at + 1 < packed.size();) {
    constexpr std::size_t kMinNegative = 128;  // of bytes that stand for numbers in two's complement
    const std::size_t count = static_cast<unsigned char>(packed[at]);
    const bool negative = count >= kMinNegative;
    const std::size_t length = negative ? 2 * kMinNegative - count : count + 1;
    bytes += length;
    at += negative ? 1 + length : 2;
  }
  return bytes;
}

}  // namespace

void ExrBlocks::check_rows(ExrStream& stream, int row) const {
  const std::optional<std::span<const char>> block = stream.take_block();
  if (!block) return;
  const Imath::Box2i& window = header_.dataWindow();
  const int first = row - (row - window.min.y) % picture_.unit_rows;
  std::uint64_t expected = 0;
  for (int each = first; each <= std::min(first + picture_.unit_rows - 1, window.max.y); ++each) {
    expected += row_bytes(header_.channels(), each, window.min.x, window.max.x);
  }
  check(*block, expected, "the block of row " + std::to_string(first));
}

void ExrBlocks::check_tile(ExrStream& stream, int column, int row) const {
  const std::optional<std::span<const char>> block = stream.take_block();
  if (!block) return;
  const Imf::TileDescription& tiles = header_.tileDescription();
  const auto width = static_cast<int>(tiles.xSize);
  const int columns = std::min(width, picture_.data_width - column * width);
  const int rows = std::min(picture_.unit_rows, picture_.data_height - row * picture_.unit_rows);
  const std::uint64_t expected = static_cast<std::uint64_t>(rows) * row_bytes(header_.channels(), 0, 0, columns - 1);
  check(*block, expected, "tile " + std::to_string(column) + ", " + std::to_string(row));
}

void ExrBlocks::check(std::span<const char> block, std::uint64_t expected, const std::string& what) const {
  std::optional<std::uint64_t> unpacked = block.size();
  if (block.size() < expected) {  // a longer one is not packed, whatever the header says
    switch (header_.compression()) {
      case Imf::NO_COMPRESSION: break;
      case Imf::RLE_COMPRESSION: unpacked = unpacked_rle_bytes(block); break;
      case Imf::ZIP_COMPRESSION:
      case Imf::ZIPS_COMPRESSION: unpacked = unpacked_zlib_bytes(block, expected); break;
      default: return;
    }
  }
  if (!unpacked || *unpacked >= expected) return;
  throw platform::file_error(ErrorCode::corrupt_file, picture_.info.path,
                             what + " unpacks to " + std::to_string(*unpacked) + " bytes, its texels take " +
                                 std::to_string(expected) + "; fetch or export it again");
}

}  // namespace welkin::files
