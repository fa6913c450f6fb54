#include "welkin/cubemap_chain.h"

#include <string>

#include "tables/huge_pages.h"
#include "welkin/error.h"

namespace welkin {

CubemapChain::CubemapChain(int size, int levels) : size_(size) {
  constexpr int largest = 16384;
  if (size < 1 || size > largest) {
    throw Error(ErrorCode::invalid_argument,
                "a cubemap chain's size is " + std::to_string(size) + "; pass 1 to " + std::to_string(largest));
  }
  if (levels < 1 || levels > full_chain_levels(size)) {
    throw Error(ErrorCode::invalid_argument, "a chain from " + std::to_string(size) + " texels cannot have " +
                                                 std::to_string(levels) + " levels; pass 1 to " +
                                                 std::to_string(full_chain_levels(size)));
  }
  offsets_.reserve(static_cast<std::size_t>(levels));
  for (int level = 0; level < levels; ++level) {
    const auto edge = static_cast<std::size_t>(level_size(level));
    offsets_.push_back(values_);
    values_ += 6 * edge * edge * 3;
  }
  pixels_ = std::make_unique_for_overwrite<float[]>(values_);
  tables::advise_huge_pages(pixels_.get(), bytes());
}

CubemapView CubemapChain::view(int level) const noexcept {
  CubemapView view{{}, level_size(level), 0, PixelFormat::rgb_f32};
  for (int side = 0; side < 6; ++side) view.faces[static_cast<std::size_t>(side)] = face(level, side);
  return view;
}

std::vector<CubemapView> CubemapChain::views() const {
  std::vector<CubemapView> views;
  views.reserve(offsets_.size());
  for (int level = 0; level < levels(); ++level) views.push_back(view(level));
  return views;
}

}  // namespace welkin
