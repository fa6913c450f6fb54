#include "reflections/mirrored_texels.h"

#include <cmath>
#include <cstddef>
#include <glm/vec3.hpp>

#include "math/elementary.h"

namespace welkin::reflections {
namespace {

/// What makes six faces of a quarter of +z, or of +Y: of a cap half the turns, because its mirrors do the others.
std::vector<image::CubeImage> images_of(bool cap) {
  std::vector<image::CubeImage> images;
  for (const bool below : {false, true}) {
    for (const bool mirrored : {false, true}) {
      for (int turns = 0; turns < 4; turns += cap ? 2 : 1) images.push_back({(4 - turns) % 4, mirrored, below});
    }
  }
  return images;
}

}  // namespace

MirroredTexels::MirroredTexels(int size, int columns) : size_(size), half_((size + 1) / 2) {
  for (const bool cap : {false, true}) {
    if (columns % 4 == 0) {
      sets_.push_back({cap, {}, images_of(cap)});
      continue;
    }
    for (const image::CubeImage& own : images_of(cap)) {
      if (!own.below) sets_.push_back({cap, own, {own, {own.quarter, own.mirrored, true}}});
    }
  }
}

SpherePlace MirroredTexels::place(const Set& set, const Original& original) const {
  const double across = static_cast<double>(steps(original.across)) / size_;
  const double along = static_cast<double>(steps(original.along)) / size_;
  const double scale = 1.0 / std::sqrt(1.0 + across * across + along * along);
  SpherePlace place{};
  if (set.cap) {
    const double flat = std::sqrt(across * across + along * along);
    place = {math::turns_of(1.0, flat), math::turns_of(across, along), scale, flat * scale};
  } else {
    const double level = std::sqrt(1.0 + across * across);
    place = {math::turns_of(along, level), math::turns_of(across, 1.0), along * scale, level * scale};
  }
  if (set.own.mirrored) place.longitude = -place.longitude;
  place.longitude += 0.25 * turns_of(set.own);
  if (place.longitude > 0.5) place.longitude -= 1.0;
  return place;
}

image::CubeTexel MirroredTexels::texel(const Set& set, const Original& original,
                                       const image::CubeImage& image) const noexcept {
  const int across = steps(original.across);
  const int along = steps(original.along);
  const glm::ivec3 point(across, set.cap ? size_ : along, set.cap ? along : size_);
  return image::texel_at(size_, moved(image, point));
}

}  // namespace welkin::reflections
