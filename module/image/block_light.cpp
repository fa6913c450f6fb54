#include "image/block_light.h"

#include <algorithm>
#include <cmath>

namespace welkin::image {

ChannelSums total_light(std::span<const BlockLight> lights) noexcept {
  ChannelSums total{};
  for (const BlockLight& light : lights) {
    for (std::size_t c = 0; c < 3; ++c) total[c] += static_cast<double>(light[c]);
  }
  return total;
}

std::vector<BlockShare> brightest_blocks(std::span<const BlockLight> lights, const ChannelSums& total) {
  constexpr double kMinShare = 0.01;
  ChannelSums scale{};
  for (std::size_t c = 0; c < 3; ++c) scale[c] = total[c] > 0.0 ? 1.0 / total[c] : 0.0;
  std::vector<BlockShare> shares;
  for (std::size_t block = 0; block < lights.size(); ++block) {
    double share = 0.0;
    for (std::size_t c = 0; c < 3; ++c) share = std::max(share, static_cast<double>(lights[block][c]) * scale[c]);
    if (share >= kMinShare) shares.push_back({share, block});
  }
  std::sort(shares.begin(), shares.end(), [](const BlockShare& a, const BlockShare& b) {
    return a.share != b.share ? a.share > b.share : a.block < b.block;
  });
  return shares;
}

double excess_of_mean(double off, double total) noexcept {
  return total > 0.0 ? std::max(0.0, std::abs(off) / total - kMeanTolerance) : 0.0;
}

double excess_of_means(const ChannelSums& off, const ChannelSums& total) noexcept {
  double sum = 0.0;
  for (std::size_t c = 0; c < 3; ++c) sum += excess_of_mean(off[c], total[c]);
  return sum;
}

}  // namespace welkin::image
