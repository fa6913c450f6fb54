#include "image/cube_tiling.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "tables/trigonometry.h"

namespace welkin::image {
namespace {

double arc(double y, double x) noexcept { return tables::turns_of(y, x) * (2.0 * std::numbers::pi); }

double length(double u, double v) noexcept { return std::sqrt(1.0 + u * u + v * v); }

}  // namespace

CubeTiling::CubeTiling(int size) : size_(size), half_((size + 1) / 2) {
  for (int index = 0; index <= half_; ++index) longitudes_.push_back(arc(edge(index), 1.0));
}

// Along v = constant, y = v / sqrt(1 + u^2 + v^2) and d(longitude) = du / (1 + u^2): the integral of y over longitude
// is atan(u v / sqrt(1 + u^2 + v^2)).
void CubeTiling::side_heights(int line, double* heights) const noexcept {
  const double v = static_cast<double>(size_ - 2 * line) / size_;
  const auto integral = [&](int index) {
    const double u = edge(index);
    return arc(u * v, length(u, v));
  };
  double before = integral(0);
  for (int column = 0; column < half_; ++column) {
    const double after = integral(column + 1);
    heights[column] = -(after - before) / (longitude(column + 1) - longitude(column));
    before = after;
  }
}

CubeTiling::Border CubeTiling::border(int column) const noexcept {
  const auto integral = [](double u) { return arc(u, length(u, 1.0)); };
  const double u = 0.5 * (edge(column) + edge(column + 1));
  const double middle = arc(u, 1.0);
  const double at_middle = integral(u);
  return {middle, -(at_middle - integral(edge(column))) / (middle - longitude(column)),
          -(integral(edge(column + 1)) - at_middle) / (longitude(column + 1) - middle)};
}

PolarRow::PolarRow(const CubeTiling& tiling) : tiling_(tiling) {
  const auto count = static_cast<std::size_t>(tiling.half() + 2);
  for (Line* line : {&inner_, &outer_}) {
    for (auto* values :
         {&line->longitudes, &line->point_heights, &line->middles, &line->first_heights, &line->second_heights}) {
      values->resize(count);
    }
  }
  uprights_.resize(count);
  outer_ends_.resize(count);
}

// Along v = constant, y = 1 / sqrt(1 + u^2 + v^2) and d(longitude) = v du / (u^2 + v^2): the integral of y over
// longitude is atan(u / (v sqrt(1 + u^2 + v^2))).
void PolarRow::fill_line(int index, Line& line) const noexcept {
  const double v = tiling_.edge(index);
  struct Point {
    double longitude;
    double integral;
  };
  const auto point = [&](double u) { return Point{arc(u, v), arc(u, v * length(u, v))}; };
  const auto mean = [](const Point& a, const Point& b) {
    return -(b.integral - a.integral) / (b.longitude - a.longitude);
  };
  Point before{};
  for (int column = 0; column <= index; ++column) {
    const auto k = static_cast<std::size_t>(column);
    const double u = tiling_.edge(column);
    const Point here = point(u);
    line.longitudes[k] = here.longitude;
    line.point_heights[k] = -1.0 / length(u, v);
    if (column > 0) {
      const Point middle = point(0.5 * (u + tiling_.edge(column - 1)));
      line.middles[k - 1] = middle.longitude;
      line.first_heights[k - 1] = mean(before, middle);
      line.second_heights[k - 1] = mean(middle, here);
    }
    before = here;
  }
}

// Along u = constant, the integral of longitude over y is, by parts, [longitude y] less that of y over longitude, which
// is -atan(v / (u sqrt(1 + u^2 + v^2))).
void PolarRow::place(int row) {
  const bool pole = row == 0 && tiling_.size() % 2 != 0;
  if (row == row_ + 1) {
    std::swap(inner_, outer_);
  } else if (!pole) {
    fill_line(row, inner_);
  }
  fill_line(row + 1, outer_);
  const bool follows = row == row_ + 1 && row > 1;  // then all ends but the last are known
  row_ = row;
  if (pole) return;
  for (int column = 0; column <= row; ++column) {
    const auto k = static_cast<std::size_t>(column);
    const double u = tiling_.edge(column);
    const auto end_at = [&](double v) {
      const double r = length(u, v);
      return End{1.0 / r, arc(u, v) / r + arc(v, u * r)};
    };
    const auto mean = [&](const End& a, const End& b) {
      return u == 0.0 ? 0.0 : (b.integral - a.integral) / (b.y - a.y);
    };
    const End inner = follows && column < row ? outer_ends_[k] : end_at(tiling_.edge(row));
    const End middle = end_at(0.5 * (tiling_.edge(row) + tiling_.edge(row + 1)));
    const End outer = end_at(tiling_.edge(row + 1));
    uprights_[k] = {mean(inner, middle), mean(middle, outer), -middle.y};
    outer_ends_[k] = outer;
  }
}

int PolarRow::sides(int column, TileSide* sides) const noexcept {
  const auto left = static_cast<std::size_t>(column);
  const auto right = left + 1;
  TileSide* side = sides;
  const Upright& start = uprights_[left];
  if (column < row_) {
    const Upright& end = uprights_[right];
    const double outer_right = outer_.point_heights[right];
    *side++ = {inner_.longitudes[left], inner_.point_heights[left], inner_.first_heights[left]};
    *side++ = {inner_.middles[left], inner_.first_heights[left], inner_.second_heights[left]};
    *side++ = {inner_.longitudes[right], inner_.second_heights[left], inner_.point_heights[right]};
    *side++ = {end.inner_longitude, inner_.point_heights[right], end.middle_height};
    *side++ = {end.outer_longitude, end.middle_height, outer_right};
    *side++ = {outer_.longitudes[right], outer_right, outer_.second_heights[left]};
  } else {
    // On the diagonal: the lower and the right edge are the left and the upper one's mirror images; at the corner both
    // edges have the same height, and their ends cancel.
    const double quarter = 0.5 * std::numbers::pi;
    const double corner = outer_.point_heights[left];
    *side++ = {quarter - start.inner_longitude, inner_.point_heights[left], start.middle_height};
    *side++ = {quarter - start.outer_longitude, start.middle_height, corner};
    *side++ = {quarter - outer_.longitudes[left], corner, outer_.first_heights[left]};
    *side++ = {quarter - outer_.middles[left], outer_.first_heights[left], outer_.second_heights[left]};
  }
  *side++ = {outer_.middles[left], outer_.second_heights[left], outer_.first_heights[left]};
  *side++ = {outer_.longitudes[left], outer_.first_heights[left], outer_.point_heights[left]};
  *side++ = {start.outer_longitude, outer_.point_heights[left], start.middle_height};
  *side++ = {start.inner_longitude, start.middle_height, inner_.point_heights[left]};
  return static_cast<int>(side - sides);
}

}  // namespace welkin::image
