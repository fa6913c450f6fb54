#include "image/uastc_hdr_encoder.h"

#include <array>
#include <cstddef>
#include <cstdint>

#include "image/bc6h.h"
#include "image/uastc_hdr.h"
#include "image/uastc_hdr_kernels.h"

namespace welkin::image {
namespace {

using simd::kLanes;

/// Lines of 16 blocks as they are stored.
using StoredLines = std::array<std::array<UastcLine, kLanes>, 2>;

/// Stores the fitted ends of the first `lines` lines, and what they mean as logarithms.
void store(const BlockLines& fitted, int lines, UastcLines kind, StoredLines& stored, BlockLines& meant) {
  for (int line = 0; line < lines; ++line) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      std::array<std::array<float, 3>, 2> ends{};
      for (std::size_t end = 0; end < 2; ++end) {
        for (std::size_t c = 0; c < 3; ++c) ends[end][c] = fitted.ends[line][end][c][lane] / 16.0F;
      }
      const UastcLine& here = stored[static_cast<std::size_t>(line)][lane] = store_uastc_line(ends, kind);
      for (std::size_t end = 0; end < 2; ++end) {
        for (std::size_t c = 0; c < 3; ++c) {
          meant.ends[line][end][c][lane] = static_cast<float>(here.ends[end][c] * 16);
        }
      }
    }
  }
}

std::array<std::uint8_t, kBlockTexels> indices_of(const BlockIndices& blocks, std::size_t lane) {
  std::array<std::uint8_t, kBlockTexels> indices{};
  for (std::size_t k = 0; k < kBlockTexels; ++k) indices[k] = static_cast<std::uint8_t>(blocks.indices[k][lane]);
  return indices;
}

void encode_single_lines(BlockGroup& group, const BlockFormat& format, EncodedBlocks& to) {
  const UastcHdrKernels& kernels = uastc_hdr_kernels();
  std::array<std::int32_t, kLanes> flat;
  kernels.take_logarithms(group, flat.data());
  BlockLines fitted;
  BlockLines meant;
  StoredLines stored;
  BlockIndices found;
  const int turns = format.effort == Bc6hEffort::fast ? 1 : 2;
  for (int turn = 0; turn < turns; ++turn) {
    kernels.fit_single(group, turn == 0 ? nullptr : &meant, fitted);
    store(fitted, 1, UastcLines::single, stored, meant);
    kernels.index_single(group, meant, found);
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      if (turn > 0 && !(found.errors[lane] < to.errors[lane])) continue;
      std::array<std::uint8_t, kBlockBytes> block;
      if (flat[lane] != 0) {
        std::array<std::uint16_t, 3> halves{};
        for (std::size_t c = 0; c < 3; ++c) {
          halves[c] = half_of_logarithm(static_cast<std::int32_t>(group.values[c][lane]));
        }
        pack_uastc_flat(halves, block.data());
        to.set(lane, block.data(), 0.0F);
      } else {
        pack_uastc_single(stored[0][lane], indices_of(found, lane), block.data());
        to.set(lane, block.data(), found.errors[lane]);
      }
    }
  }
}

void encode_two_lines(const BlockGroup& group, const BlockFormat& format, EncodedBlocks& to) {
  const UastcHdrKernels& kernels = uastc_hdr_kernels();
  const int tried = format.partitions_tried();
  alignas(64) float partitions[kMostPartitionsTried][kLanes];
  kernels.rank_partitions(group, kUastcPartitions, tried, partitions);
  BlockLines fitted;
  BlockLines meant;
  StoredLines stored;
  BlockIndices found;
  for (int rank = 0; rank < tried; ++rank) {
    for (int turn = 0; turn < 2; ++turn) {
      kernels.fit_pairs(group, partitions[rank], turn == 0 ? nullptr : &meant, fitted);
      store(fitted, 2, UastcLines::pair, stored, meant);
      kernels.index_pairs(group, partitions[rank], meant, found);
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        if ((rank > 0 || turn > 0) && !(found.errors[lane] < to.errors[lane])) continue;
        std::array<std::uint8_t, kBlockBytes> block;
        pack_uastc_pair({stored[0][lane], stored[1][lane]}, static_cast<int>(partitions[rank][lane]),
                        indices_of(found, lane), block.data());
        to.set(lane, block.data(), found.errors[lane]);
      }
    }
  }
}

}  // namespace

EncodedLevels encode_uastc_hdr_pictures(std::span<const std::vector<LatLongView>> levels, Bc6hEffort effort,
                                        const Control& control) {
  return encode_pictures(levels, {effort, false, encode_single_lines, encode_two_lines}, control);
}

}  // namespace welkin::image
