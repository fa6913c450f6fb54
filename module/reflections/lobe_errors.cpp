#include "reflections/lobe_errors.h"

#include <algorithm>
#include <cmath>

#include "image/cube_symmetry.h"
#include "image/geometry.h"
#include "image/pixels.h"

namespace welkin::reflections {
namespace {

constexpr int kMostBlocks = 24;  ///< along an edge of a face
constexpr int kTexelsOfRecord = kRecordFloats / kRingImages;
constexpr int kRecords = LobeErrors::kTexels / kTexelsOfRecord;  ///< of a block
constexpr double kAlike = 2.0;  ///< over independent texels: an edge within a block gives two halves
constexpr double kPlaces = kRecords * kRecordFloats;  ///< that are looked at

/// Calls visit(block, texel) for all texels, both by their numbers, row by row.
template <class Visit>
void for_texels(const CubeBlocks& blocks, const Visit& visit) {
  const int edge = blocks.edge * blocks.size;
  std::size_t texel = 0;
  for (int line = 0; line < 6 * edge; ++line) {
    // faces lie below one another, of blocks as of texels
    const std::size_t first = static_cast<std::size_t>(line / blocks.edge) * static_cast<std::size_t>(blocks.size);
    for (int column = 0; column < edge; ++column, ++texel)
      visit(first + static_cast<std::size_t>(column / blocks.edge), texel);
  }
}

}  // namespace

CubeBlocks::CubeBlocks(int face_size) noexcept : size(face_size) {
  for (; size > kMostBlocks && size % 2 == 0; size /= 2) edge *= 2;
}

BlockLight::BlockLight(int face_size) : blocks_(face_size), means_(blocks_.count()), deviations_(blocks_.count()) {}

void BlockLight::read(const CubemapView& source) {
  for (std::size_t block = 0; block < means_.size(); ++block) means_[block] = {static_cast<std::uint32_t>(block), {}};
  std::fill(deviations_.begin(), deviations_.end(), 0.0F);
  const float share = 1.0F / static_cast<float>(blocks_.edge * blocks_.edge);
  // Of float sums: an estimate needs no more. Differences from the mean first, as their squares would be lost beside
  // those of the mean.
  const auto each = [&](const auto& visit) {
    for (int face = 0; face < 6; ++face) {
      for (int row = 0; row < source.size; ++row) {
        const auto* rgb = static_cast<const float*>(image::row_of(source, face, row));
        const int line = face * blocks_.size + row / blocks_.edge;
        std::size_t block = static_cast<std::size_t>(line) * static_cast<std::size_t>(blocks_.size);
        for (int column = 0; column < blocks_.size; ++column, ++block) {
          for (int k = 0; k < blocks_.edge; ++k, rgb += 3) visit(block, rgb);
        }
      }
    }
  };
  each([&](std::size_t block, const float* rgb) {
    for (int c = 0; c < 3; ++c) means_[block].weights[c] += share * rgb[c];
  });
  if (blocks_.edge == 1) return;
  each([&](std::size_t block, const float* rgb) {
    float sum = 0.0F;
    for (int c = 0; c < 3; ++c) {
      const float off = rgb[c] - means_[block].weights[c];
      sum += off * off;
    }
    deviations_[block] += share * sum;
  });
}

LobeErrors::LobeErrors(int face_size)
    : blocks_(face_size), scattered_(blocks_.count()), records_(kRecords * blocks_.count() * kRecordFloats) {
  std::fill_n(records_.data(), records_.size(), 0.0F);
}

void LobeErrors::add(int texel, const std::vector<double>& off) {
  std::vector<double> sums(blocks_.count());
  std::vector<double> squares(blocks_.count());
  for_texels(blocks_, [&](std::size_t block, std::size_t point) {
    sums[block] += off[point];
    squares[block] += off[point] * off[point];
  });
  const auto edge = static_cast<std::size_t>(blocks_.size);
  const std::size_t first = static_cast<std::size_t>(texel / kTexelsOfRecord) * blocks_.count();
  for (std::size_t block = 0; block < sums.size(); ++block) {
    const image::CubeTexel own{static_cast<int>(block / (edge * edge)), static_cast<int>(block % edge),
                               static_cast<int>(block / edge % edge)};
    for (int k = 0; k < kRingImages; ++k) {
      const image::CubeTexel at =
          image::texel_at(blocks_.size, moved(image::cube_image_of(k), image::point_of(blocks_.size, own)));
      const auto to = static_cast<std::size_t>((at.face * blocks_.size + at.row) * blocks_.size + at.column);
      const int place = kTexelsOfRecord * k + texel % kTexelsOfRecord;
      records_.data()[(first + to) * kRecordFloats + static_cast<std::size_t>(place)] = static_cast<float>(sums[block]);
      scattered_[to] += static_cast<float>(kAlike * squares[block] / kPlaces);
    }
  }
}

double LobeErrors::rms(const BlockLight& light) const {
  alignas(64) float sums[kTexelsOfGroup][kRecordFloats];
  const GroupTap* const taps = light.means().data();
  double square = 0.0;
  for (std::size_t k = 0; k < kRecords; ++k) {
    const float* const records = records_.data() + k * blocks_.count() * kRecordFloats;
    ring_kernels().sum_group_taps({records, taps, taps + light.means().size()}, sums);
    for (int c = 0; c < 3; ++c) {
      for (const float sum : sums[c]) square += static_cast<double>(sum) * static_cast<double>(sum) / kPlaces;
    }
  }
  for (std::size_t block = 0; block < scattered_.size(); ++block)
    square += static_cast<double>(scattered_[block]) * static_cast<double>(light.deviations()[block]);
  return std::sqrt(square);
}

std::size_t LobeErrors::bytes_for(int face_size) noexcept {
  return sizeof(LobeErrors) + CubeBlocks(face_size).count() * (kRecords * kRecordFloats + 1) * sizeof(float);
}

}  // namespace welkin::reflections
