#include "image/sampler.h"

#include <algorithm>
#include <cmath>

#include "image/texel_geometry.h"
#include "tables/trigonometry.h"

namespace welkin::image {
namespace {

void add_weighted(const float* rgb, double weight, glm::dvec3& sum) noexcept {
  sum.x += weight * static_cast<double>(rgb[0]);
  sum.y += weight * static_cast<double>(rgb[1]);
  sum.z += weight * static_cast<double>(rgb[2]);
}

int wrapped(int column, int width) noexcept {
  const int rest = column % width;
  return rest < 0 ? rest + width : rest;
}

/// The texel before a place, and how far on the place is.
struct Between {
  int before;
  double share;  // of the texel after it
};

Between between(double place) noexcept {
  const double whole = std::floor(place);
  return {static_cast<int>(whole), place - whole};
}

}  // namespace

void LatLongSampler::add_from_row(int row, double column, double weight, glm::dvec3& sum) const noexcept {
  if (row < 0 || row >= height_) {
    row = row < 0 ? 0 : height_ - 1;
    column += 0.5 * width_;
  }
  const Between place = between(column);
  add_weighted(plane_.texel(wrapped(place.before, width_), row), weight * (1.0 - place.share), sum);
  add_weighted(plane_.texel(wrapped(place.before + 1, width_), row), weight * place.share, sum);
}

void LatLongSampler::add(const glm::dvec3& direction, double weight, glm::dvec3& sum) const noexcept {
  const double longitude = tables::turns_of(direction.x, direction.z);
  const double horizontal = std::sqrt(direction.x * direction.x + direction.z * direction.z);
  const double latitude = tables::turns_of(direction.y, horizontal);
  const double column = (0.5 - longitude) * width_ - 0.5;
  const Between row = between((0.25 - latitude) * 2.0 * height_ - 0.5);
  add_from_row(row.before, column, weight * (1.0 - row.share), sum);
  add_from_row(row.before + 1, column, weight * row.share, sum);
}

CubemapSampler::CubemapSampler(const CubemapView& view)
    : planes_{FloatPlane(view, 0), FloatPlane(view, 1), FloatPlane(view, 2),
              FloatPlane(view, 3), FloatPlane(view, 4), FloatPlane(view, 5)},
      size_(view.size) {}

void CubemapSampler::add_texel(const CubeTexel& texel, double weight, glm::dvec3& sum) const noexcept {
  const CubeTexel nearest{texel.face, std::clamp(texel.column, 0, size_ - 1), std::clamp(texel.row, 0, size_ - 1)};
  const bool beside = nearest.column != texel.column;
  const bool above = nearest.row != texel.row;
  if (beside && above) {
    const double third = weight / 3.0;
    add_weighted(inside(nearest), third, sum);
    add_weighted(inside(across_edge(size_, {texel.face, texel.column, nearest.row})), third, sum);
    add_weighted(inside(across_edge(size_, {texel.face, nearest.column, texel.row})), third, sum);
  } else {
    add_weighted(inside(beside || above ? across_edge(size_, texel) : texel), weight, sum);
  }
}

void CubemapSampler::add(const glm::dvec3& direction, double weight, glm::dvec3& sum) const noexcept {
  const int face = face_of(direction);
  const Frame& frame = face_frame(face);
  const double scale = 0.5 * size_ / glm::dot(direction, frame.normal);
  const double middle = 0.5 * (size_ - 1);
  const Between column = between(middle + scale * glm::dot(direction, frame.u));
  const Between row = between(middle + scale * glm::dot(direction, frame.v));
  // Rounding may lead a hair beyond the edge: the outermost pair of texels is -1 and 0, or size - 1 and size.
  const int left = std::clamp(column.before, -1, size_ - 1);
  const int top = std::clamp(row.before, -1, size_ - 1);
  const double upper = weight * (1.0 - row.share);
  const double lower = weight * row.share;
  add_texel({face, left, top}, upper * (1.0 - column.share), sum);
  add_texel({face, left + 1, top}, upper * column.share, sum);
  add_texel({face, left, top + 1}, lower * (1.0 - column.share), sum);
  add_texel({face, left + 1, top + 1}, lower * column.share, sum);
}

}  // namespace welkin::image
