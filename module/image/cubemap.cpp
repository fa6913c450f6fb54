// The pixels of a cubemap and its mips, one after another in one block.
#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "image/pixels.h"
#include "platform/memory.h"
#include "welkin/core.h"
#include "welkin/image.h"

namespace welkin::image {

CubemapView packed_cubemap(const float* pixels, int size) noexcept {
  const std::size_t face_values = std::size_t{3} * static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
  CubemapView view{{}, size, 0, PixelFormat::rgb32f};
  for (std::size_t face = 0; face < view.faces.size(); ++face) view.faces[face] = pixels + face * face_values;
  return view;
}

Cubemap shaped(Cubemap cubemap, int size, int levels, memory_resource* memory) {
  if (cubemap.size() == size && cubemap.levels() == levels) return cubemap;
  cubemap = {};  // freed before the next one is allocated
  return Cubemap(size, levels, memory);
}

std::array<float*, 6> faces_of(Cubemap& cubemap, int level) noexcept {
  std::array<float*, 6> faces{};
  for (std::size_t face = 0; face < faces.size(); ++face) faces[face] = cubemap.face(level, static_cast<int>(face));
  return faces;
}

}  // namespace welkin::image

namespace welkin {

void Cubemap::Free::operator()(float* pixels) const noexcept {
  if (memory != nullptr) return memory->deallocate(pixels, bytes, platform::kCacheLine);
  platform::give_working_memory({.data = pixels, .bytes = bytes, .alignment = platform::kHugePage});
}

Cubemap::Cubemap(int size, int levels, memory_resource* memory) : size_(size) {
  image::check_face_size(size);
  if (levels < 1 || levels > full_chain_levels(size)) {
    throw Error(ErrorCode::invalid_argument, "a cubemap of " + std::to_string(size) + " texels cannot have " +
                                                 std::to_string(levels) + " levels; pass 1 to " +
                                                 std::to_string(full_chain_levels(size)));
  }
  offsets_.reserve(static_cast<std::size_t>(levels));
  for (int level = 0; level < levels; ++level) {
    const auto edge = static_cast<std::size_t>(level_size(level));
    offsets_.push_back(values_);
    values_ += 6 * edge * edge * 3;
  }
  if (memory == nullptr) memory = get_default_resource();
  if (memory != new_delete_resource() || bytes() < platform::kMinOwnBlock) {
    pixels_ = {static_cast<float*>(memory->allocate(bytes(), platform::kCacheLine)), Free{memory, bytes()}};
    return;
  }
  // large cubemaps are kept between calls as working memory is, unless none is kept
  const platform::WorkingMemory block = platform::take_working_memory(bytes());
  const bool kept = block.alignment == platform::kHugePage;
  pixels_ = {static_cast<float*>(block.data), Free{kept ? nullptr : memory, block.bytes}};
}

Cubemap::Cubemap(int size, std::span<const float> pixels) : Cubemap(size) {
  if (pixels.size() != values_) {
    throw Error(ErrorCode::invalid_argument, "a cubemap of " + std::to_string(size) + " texels takes " +
                                                 std::to_string(values_) + " floats, not " +
                                                 std::to_string(pixels.size()));
  }
  std::copy(pixels.begin(), pixels.end(), pixels_.get());
}

Cubemap::Cubemap(const Cubemap& other) {
  if (other.levels() == 0) return;
  Cubemap copy(other.size(), other.levels());
  std::copy_n(other.pixels_.get(), other.values_, copy.pixels_.get());
  swap(copy);
}

void Cubemap::swap(Cubemap& other) noexcept {
  std::swap(size_, other.size_);
  std::swap(values_, other.values_);
  std::swap(offsets_, other.offsets_);
  std::swap(pixels_, other.pixels_);
}

CubemapView Cubemap::view(int level) const noexcept {
  if (offsets_.empty()) return {};
  return image::packed_cubemap(face(level, 0), level_size(level));
}

std::vector<CubemapView> Cubemap::views() const {
  std::vector<CubemapView> views;
  views.reserve(offsets_.size());
  for (int level = 0; level < levels(); ++level) views.push_back(view(level));
  return views;
}

}  // namespace welkin
