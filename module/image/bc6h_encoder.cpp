// Cubemaps and pictures to BC6H and back.
#include "image/bc6h_encoder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "image/bc6h.h"
#include "image/bc6h_balance.h"
#include "image/bc6h_kernels.h"
#include "image/block_pictures.h"
#include "image/pixels.h"
#include "jobs/tiles.h"
#include "platform/float_environment.h"
#include "welkin/image.h"

namespace welkin {
namespace {

/// A unit in a half's last place is 2^-10 / m of a value, with m from 1 to 2. This is the mean of 1 / m^2 over the
/// texels of seven pictures' chains, by what the errors came to. (Of evenly spread logarithms it would be 0.54.)
constexpr double kMeanSquareOfUnits = 0.51;

void encode_single_lines(image::BlockGroup& group, const image::BlockFormat& format, image::EncodedBlocks& to) {
  image::bc6h_kernels().single_lines(group, format.is_signed, format.effort != Bc6hEffort::fast, to);
}

void encode_two_lines(const image::BlockGroup& group, const image::BlockFormat& format, image::EncodedBlocks& to) {
  image::TwoLineBlocks pair;
  image::bc6h_kernels().two_lines(group, format.is_signed, format.partitions_tried(), pair);
  for (std::size_t lane = 0; lane < simd::kLanes; ++lane) {
    std::array<std::uint8_t, image::kBlockBytes> block;
    image::pack_bc6h(image::fields_of(pair, lane), block.data());
    image::set_block(to, lane, block.data(), pair.errors[lane]);
  }
}

/// Of six faces.
std::size_t block_bytes(int size) { return 6 * image::block_bytes(size, size); }

std::int64_t texels_of(int size) { return std::int64_t{6} * size * size; }

/// Sizes and bytes of what may come from elsewhere.
void check(const Bc6hCubemap& cubemap) {
  const auto refuse = [](const std::string& message) { throw Error(ErrorCode::invalid_argument, message); };
  if (cubemap.levels.empty()) refuse("a BC6H cubemap needs a level at least; it has none");
  const int size = cubemap.levels.front().size;
  if (size < 1 || size > image::kLargestFace) {
    refuse("level 0 of the BC6H cubemap has " + std::to_string(size) + " texels along an edge; from 1 to " +
           std::to_string(image::kLargestFace) + " there can be");
  }
  if (cubemap.levels.size() > static_cast<std::size_t>(full_chain_levels(size))) {
    refuse("the BC6H cubemap has " + std::to_string(cubemap.levels.size()) + " levels; from " + std::to_string(size) +
           " texels down there are " + std::to_string(full_chain_levels(size)));
  }
  for (std::size_t level = 0; level < cubemap.levels.size(); ++level) {
    const Bc6hLevel& here = cubemap.levels[level];
    const int wanted = std::max(1, size >> static_cast<int>(level));
    if (here.size != wanted || here.blocks.size() != block_bytes(wanted)) {
      refuse("level " + std::to_string(level) + " of the BC6H cubemap has " + std::to_string(here.size) +
             " texels along an edge and " + std::to_string(here.blocks.size()) + " bytes; it must have " +
             std::to_string(wanted) + " and " + std::to_string(block_bytes(wanted)));
    }
  }
}

/// The sum of the squares of a face's relative errors.
double face_squares(const CubemapView& given, const float* decoded, int face, bool is_signed) {
  // 2^-14, the least normal half: below it halves have a fixed step, and a relative error says nothing.
  constexpr double floor = 1.0 / 16384.0;
  const auto values = 3 * static_cast<std::size_t>(given.size);
  std::vector<float> row(values);
  const float least = is_signed ? -image::kLargestHalf : 0.0F;
  double sum = 0.0;
  for (int line = 0; line < given.size; ++line, decoded += values) {
    image::decode_texels(given.format, image::row_of(given, face, line), given.size, row.data());
    for (std::size_t k = 0; k < values; ++k) {
      // As the encoder clamps it, so that what a half cannot hold is no error of the blocks.
      const float held = row[k] >= least ? std::min(row[k], image::kLargestHalf) : row[k] < least ? least : 0.0F;
      const auto value = static_cast<double>(held);
      const double error = (static_cast<double>(decoded[k]) - value) / std::max(std::abs(value), floor);
      sum += error * error;
    }
  }
  return sum;
}

}  // namespace

namespace image {

Bc6hPictureLevels encode_bc6h_pictures(std::span<const std::vector<LatLongView>> levels, const Bc6hOptions& options,
                                       const Control& control) {
  const BlockFormat format{options.effort, options.is_signed, encode_single_lines, encode_two_lines, balance_bc6h};
  EncodedLevels encoded = encode_pictures(levels, format, control);
  Bc6hPictureLevels result{{}, encoded.values_clamped};
  for (std::size_t level = 0; level < levels.size(); ++level) {
    EncodedLevels::Level& here = encoded.levels[level];
    const double values = 3.0 * static_cast<double>(texels_of(levels[level]));
    // An error of n units is n 2^-10 / m of a value: mean square n^2 times mean 1 / m^2, taken as independent.
    result.levels.push_back({std::move(here.blocks), std::sqrt(here.squares * kMeanSquareOfUnits / values) / 1024.0});
  }
  return result;
}

}  // namespace image

Bc6hCubemap encode_bc6h(std::span<const CubemapView> mips, const Bc6hOptions& options, const Control& control) {
  const platform::FloatingPointScope floating_point;
  image::check_chain(mips);
  std::vector<std::vector<LatLongView>> levels;
  levels.reserve(mips.size());
  for (const CubemapView& view : mips) levels.push_back(image::pictures_of(view));
  image::Bc6hPictureLevels encoded = image::encode_bc6h_pictures(levels, options, control);
  Bc6hCubemap cubemap;
  cubemap.is_signed = options.is_signed;
  cubemap.values_clamped = encoded.values_clamped;
  cubemap.levels.reserve(mips.size());
  for (std::size_t level = 0; level < mips.size(); ++level) {
    image::Bc6hPictures& here = encoded.levels[level];
    cubemap.levels.push_back({mips[level].size, std::move(here.blocks), here.estimated_error});
  }
  return cubemap;
}

Cubemap decode_bc6h(const Bc6hCubemap& cubemap, const Control& control) {
  const platform::FloatingPointScope floating_point;
  check(cubemap);
  const auto levels = static_cast<int>(cubemap.levels.size());
  const int size = cubemap.levels.front().size;
  Cubemap chain(size, levels, control.memory);
  const auto range = cubemap.is_signed ? image::Bc6hRange::signed_values : image::Bc6hRange::positive;
  const jobs::Placement placement = jobs::placement_for(texels_of(size));
  jobs::run_tiles(static_cast<std::size_t>(6 * levels), placement, jobs::worker_count(placement), control,
                  [&](std::size_t tile, std::size_t) {
                    const auto face = static_cast<int>(tile % 6);
                    const auto level = static_cast<int>(tile / 6);
                    const std::vector<std::uint8_t>& blocks = cubemap.levels[tile / 6].blocks;
                    const int edge = chain.level_size(level);
                    image::decode_bc6h_rows(blocks.data() + blocks.size() / 6 * (tile % 6), range, edge, 0, edge,
                                            chain.face(level, face));
                  });
  return chain;
}

std::vector<double> bc6h_errors(const Bc6hCubemap& cubemap, std::span<const CubemapView> mips, const Control& control) {
  const platform::FloatingPointScope floating_point;
  image::check_chain(mips);
  check(cubemap);
  if (mips.size() != cubemap.levels.size() || mips.front().size != cubemap.levels.front().size) {
    throw Error(ErrorCode::invalid_argument,
                "the chain and the BC6H cubemap differ in size or levels; pass the chain that was encoded");
  }
  const Cubemap decoded = decode_bc6h(cubemap, {control.stop, {}});
  std::vector<double> squares(6 * mips.size());
  const jobs::Placement placement = jobs::placement_for(texels_of(mips.front().size));
  jobs::run_tiles(squares.size(), placement, jobs::worker_count(placement), control,
                  [&](std::size_t tile, std::size_t) {
                    const auto face = static_cast<int>(tile % 6);
                    const float* const texels = decoded.face(static_cast<int>(tile / 6), face);
                    squares[tile] = face_squares(mips[tile / 6], texels, face, cubemap.is_signed);
                  });
  std::vector<double> errors;
  for (std::size_t level = 0; level < mips.size(); ++level) {
    double sum = 0.0;
    for (std::size_t face = 0; face < 6; ++face) sum += squares[6 * level + face];
    errors.push_back(std::sqrt(sum / (3.0 * static_cast<double>(texels_of(mips[level].size)))));
  }
  return errors;
}

}  // namespace welkin
