#include "sh/cosine_texels.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "image/texel_geometry.h"
#include "tables/texel_weights.h"
#include "tables/trigonometry.h"

namespace welkin::sh {
namespace {

constexpr double kPi = std::numbers::pi;

/// Cells along a texel's edge: 4, and more where fewer than 256 texels see a quarter of the horizon.
int cells_along(int texels_around) { return std::max(4, (1024 + texels_around - 1) / texels_around); }

/// With u the longitude and v the latitude, d = (sin u cos v, sin v, cos u cos v), dw = cos v du dv. Over a texel with
/// centre (u, v) and half-widths (a, b):
///   Int sin u du = 2 sin a sin u,   Int cos^2 v dv = b + sin b cos b cos 2v,   Int sin v cos v dv = sin b cos b sin
///   2v.
class LatLongTexels final : public CosineTexels {
 public:
  LatLongTexels(int width, int height)
      : width_(width), height_(height), across_(cells_along(width)), down_(cells_along(2 * height)) {
    for (int i = 0; i < width; ++i) columns_.push_back(tables::sine_cosine_of_turns(0.5 - (i + 0.5) / width));
    const int cells = width * across_;
    for (int i = 0; i < cells; ++i) cells_.push_back(tables::sine_cosine_of_turns(0.5 - (i + 0.5) / cells));
  }

  [[nodiscard]] int rows() const noexcept override { return height_; }
  [[nodiscard]] int columns() const noexcept override { return width_; }

  void fill(int row, MomentRow& moments) const override {
    const tables::SineCosine twice = tables::sine_cosine_of_turns(0.5 - (row + 0.5) / height_);  // 2v
    const tables::SineCosine half_row = tables::sine_cosine_of_turns(0.25 / height_);            // b
    const double skew = half_row.sine * half_row.cosine;
    const double ring = kPi / (2.0 * height_) + skew * twice.cosine;  // Int cos^2 v dv
    const double column = 2.0 * tables::sine_cosine_of_turns(0.5 / width_).sine;
    const double height = 2.0 * kPi / width_ * skew * twice.sine;
    // From the moment's direction no point of the texel is farther than this angle.
    const double radius = kPi / height_ + kPi / width_;
    const double horizon = radius * image::lat_long_texel_solid_angle(width_, height_, row);
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      moments.x[i] = columns_[i].sine * column * ring;
      moments.y[i] = height;
      moments.z[i] = columns_[i].cosine * column * ring;
      moments.horizon[i] = horizon;
    }
  }

  [[nodiscard]] double clipped(int row, int column, const glm::dvec3& normal) const noexcept override {
    const int cell_rows = height_ * down_;
    const double width = 2.0 * kPi / (static_cast<double>(width_) * across_);
    const double height = 2.0 * tables::sine_cosine_of_turns(0.25 / cell_rows).sine;  // times cos v: its integral
    double sum = 0.0;
    for (int j = row * down_; j < (row + 1) * down_; ++j) {
      const tables::SineCosine v = tables::sine_cosine_of_turns(0.25 - (j + 0.5) / (2.0 * cell_rows));
      const double up = normal.y * v.sine;
      double along = 0.0;
      for (int i = column * across_; i < (column + 1) * across_; ++i) {
        const tables::SineCosine& u = cells_[static_cast<std::size_t>(i)];
        along += std::max(0.0, up + v.cosine * (normal.x * u.sine + normal.z * u.cosine));
      }
      sum += along * v.cosine;
    }
    return sum * width * height;
  }

 private:
  int width_;
  int height_;
  int across_;
  int down_;
  std::vector<tables::SineCosine> columns_;
  std::vector<tables::SineCosine> cells_;
};

/// With d = (u, v, 1) / r in the face's frame and dw = du dv / r^3, a moment is Int (u, v, 1) r^-4 du dv, by a Gauss
/// rule that is exact to rounding.
class CubemapTexels final : public CosineTexels {
 public:
  explicit CubemapTexels(int size) : size_(size), cells_(cells_along(4 * size)) {}

  [[nodiscard]] int rows() const noexcept override { return 6 * size_; }
  [[nodiscard]] int columns() const noexcept override { return size_; }

  void fill(int row, MomentRow& moments) const override {
    const image::Frame& frame = image::face_frame(row / size_);
    const simd::GaussRule rule = tables::texel_rule(size_);
    const double half = 1.0 / size_;
    const double v0 = (2.0 * (row % size_) + 1.0) * half - 1.0;
    for (int column = 0; column < size_; ++column) {
      const double u0 = (2.0 * column + 1.0) * half - 1.0;
      glm::dvec3 local(0.0);
      double solid_angle = 0.0;
      for (int j = 0; j < rule.order; ++j) {
        for (int i = 0; i < rule.order; ++i) {
          const double u = u0 + half * rule.nodes[i];
          const double v = v0 + half * rule.nodes[j];
          const double q = 1.0 / (1.0 + u * u + v * v);
          const double weight = rule.weights[i] * rule.weights[j] * half * half * q;
          local += weight * q * glm::dvec3(u, v, 1.0);
          solid_angle += weight * std::sqrt(q);
        }
      }
      const glm::dvec3 moment = local.x * frame.u + local.y * frame.v + local.z * frame.normal;
      const auto i = static_cast<std::size_t>(column);
      moments.x[i] = moment.x;
      moments.y[i] = moment.y;
      moments.z[i] = moment.z;
      // The diagonal, on a plane at distance 1 or more, is longer than any chord of the texel.
      moments.horizon[i] = 2.0 * std::numbers::sqrt2 * half * solid_angle;
    }
  }

  [[nodiscard]] double clipped(int row, int column, const glm::dvec3& normal) const noexcept override {
    const image::Frame& frame = image::face_frame(row / size_);
    const double a = glm::dot(normal, frame.u);
    const double b = glm::dot(normal, frame.v);
    const double c = glm::dot(normal, frame.normal);
    const double step = 2.0 / (static_cast<double>(size_) * cells_);
    double sum = 0.0;
    for (int j = (row % size_) * cells_; j < (row % size_ + 1) * cells_; ++j) {
      const double v = (j + 0.5) * step - 1.0;
      for (int i = column * cells_; i < (column + 1) * cells_; ++i) {
        const double u = (i + 0.5) * step - 1.0;
        const double q = 1.0 / (1.0 + u * u + v * v);
        sum += std::max(0.0, u * a + v * b + c) * q * q;
      }
    }
    return sum * step * step;
  }

 private:
  int size_;
  int cells_;
};

}  // namespace

std::unique_ptr<CosineTexels> cosine_texels_of_lat_long(int width, int height) {
  return std::make_unique<LatLongTexels>(width, height);
}

std::unique_ptr<CosineTexels> cosine_texels_of_cubemap(int size) { return std::make_unique<CubemapTexels>(size); }

}  // namespace welkin::sh
