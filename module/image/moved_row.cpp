#include <algorithm>
#include <cmath>
#include <limits>

#include "image/resampling.h"

namespace welkin::image {
namespace {

struct Range {
  double least;
  double largest;
};

/// The range of the four texels around a position; `texel` is the one before it.
Range range_at(const double* texel) noexcept {
  return {std::min(std::min(texel[-1], texel[0]), std::min(texel[1], texel[2])),
          std::max(std::max(texel[-1], texel[0]), std::max(texel[1], texel[2]))};
}

}  // namespace

MovedRow::MovedRow(int width, double share)
    : width_(width), share_(share), texels_(static_cast<std::size_t>(width + 2 * kBorder + 1)) {
  for (std::vector<double>* const values : {&linear_, &flux_, &rise_, &fall_}) {
    values->resize(static_cast<std::size_t>(width + kBorder + 1));
  }
}

void MovedRow::wrap() noexcept {
  for (int i = 0; i < kBorder; ++i) texel(i - kBorder) = texel((width_ * kBorder + i - kBorder) % width_);
  for (int i = 0; i <= kBorder; ++i) texel(width_ + i) = texel(i % width_);
}

void MovedRow::interpolate() noexcept {
  const double p = 0.5 * share_ * (1.0 - share_) * (1.0 - share_);
  const double q = 0.5 * share_ * share_ * (1.0 - share_);
  for (int i = 0; i < width_ + kBorder + 1; ++i) {
    const double* const texel = texels_.data() + i;
    const double flux = p * (texel[0] - texel[1]) + q * (texel[1] - texel[2]);
    const auto at = static_cast<std::size_t>(i);
    linear_[at] = (1.0 - share_) * texel[0] + share_ * texel[1];
    flux_[at] = std::abs(flux) <= std::numeric_limits<double>::max() ? flux : 0.0;
  }
}

void MovedRow::limit() noexcept {
  for (int i = 1; i < width_ + kBorder + 1; ++i) {
    const auto at = static_cast<std::size_t>(i);
    const Range range = range_at(texels_.data() + i);
    const double in = std::max(flux_[at], 0.0) + std::max(-flux_[at - 1], 0.0);
    const double out = std::max(-flux_[at], 0.0) + std::max(flux_[at - 1], 0.0);
    rise_[at] = in > 0.0 ? std::min(1.0, (range.largest - linear_[at]) / in) : 0.0;
    fall_[at] = out > 0.0 ? std::min(1.0, (linear_[at] - range.least) / out) : 0.0;
  }
  for (int i = 1; i < width_ + kBorder; ++i) {
    const auto at = static_cast<std::size_t>(i);
    flux_[at] *= flux_[at] > 0.0 ? std::min(rise_[at], fall_[at + 1]) : std::min(fall_[at], rise_[at + 1]);
  }
}

void MovedRow::write(float* results, int step) noexcept {
  wrap();
  interpolate();
  limit();
  for (int i = 0; i < width_; ++i) {
    const auto at = static_cast<std::size_t>(i + kBorder);
    const Range range = range_at(texels_.data() + at);
    const double value = linear_[at] + (flux_[at] - flux_[at - 1]);
    results[std::ptrdiff_t{i} * step] = static_cast<float>(std::min(std::max(value, range.least), range.largest));
  }
}

}  // namespace welkin::image
