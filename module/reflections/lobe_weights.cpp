#include "reflections/lobe_weights.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "image/geometry.h"
#include "reflections/lobe.h"

namespace welkin::reflections {
namespace {

constexpr double kNearest = 3.0;             ///< steps of a level to the nearest points that it is used for
constexpr double kBent = 12.0;               ///< steps within which the fourth differences count
constexpr double kOfFourth = 41.0 / 2400.0;  ///< of them is lost at a quarter of a step: 1.25 0.25 0.75 1.75 / 24
constexpr double kOfKink = 1e-5;             ///< of light on one side of the horizon, which may reach the other
constexpr double kKinked = 0.4;              ///< of the lobe's slope there and a step's square: what reaches it
constexpr double kNegligible = 1e-3;         ///< of the lobe: differences of less are left out

constexpr double kNothing = 2e-7;    ///< as well as these
constexpr double kKinkSeen = 1e-6;   ///< of the slope and the square of a texel: where a rule has more points about it
constexpr double kCutParts = 100.0;  ///< that a face's half is cut into there

double square(double value) { return value * value; }

}  // namespace

LobeWeights::LobeWeights(const std::vector<CubeLevel>& levels, double alpha)
    : alpha_(alpha),
      scale_(1.0 / lobe_integral(alpha)),
      width_square_(std::min(1.0, 4.0 * square(alpha) / std::max(1e-9, (1.0 - alpha) * (1.0 + alpha)))),
      kink_(scale_ * lobe(1e-6, alpha) * 1e6),
      smooth_(scale_ * lobe(1.0, alpha) * square(square(alpha))),
      rule_(math::gauss_legendre(3)) {
  for (const CubeLevel& shape : levels) {
    Level level;
    level.shape = shape;
    levels_.push_back(std::move(level));
  }
  choose_levels();
  place_points();
  spread_even_light();
}

/// A lobe of width w changes over sqrt(w^2 + d^2) at the distance d.
void LobeWeights::choose_levels() {
  constexpr double most = 1.2;  // of the open part, 1.1 radians
  double finer = 0.0;
  for (std::size_t k = 1; k < levels_.size(); ++k) {
    Level& level = levels_[k];
    level.step = 2.0 / level.shape.size;
    level.open = square(kNearest * level.step);
    level.strip = kink_ * square(level.step) * kKinked > kOfKink ? 0.75 * level.step : 0.0;
    if (level.open - width_square_ > most) break;
    // what finer levels lose of it is added here too
    finer = 1.0 + finer / 16.0;
    level.fourth = kOfFourth * finer;
    top_ = k;
  }
  levels_.resize(top_ + 1);
}

void LobeWeights::place_points() {
  for (Level& level : levels_) {
    const int edge = level.shape.edge();
    level.places.reserve(level.shape.points());
    for (int face = 0; face < 6; ++face) {
      for (int row = 0; row < edge; ++row) {
        for (int column = 0; column < edge; ++column) {
          level.places.push_back(image::face_direction(level.shape.size, face, column - level.shape.margin + 0.5,
                                                       row - level.shape.margin + 0.5));
        }
      }
    }
    for (int row = 0; row < edge; ++row) {
      for (int column = 0; column < edge; ++column)
        level.shrunk.push_back(1.0 / (1.0 + square(level.shape.place(row)) + square(level.shape.place(column))));
    }
    level.values.resize(level.places.size());
    level.known.resize(level.places.size());
  }
}

void LobeWeights::spread_even_light() {
  const int size = levels_.front().shape.size;
  std::vector<double> row(static_cast<std::size_t>(size));
  std::vector<float> rgb;
  for (int k = 0; k < size; ++k) {
    image::cubemap_row_solid_angles(k, row);
    for (const double value : row) {
      levels_.front().light.push_back(static_cast<float>(value));
      for (int c = 0; c < 3; ++c) rgb.push_back(static_cast<float>(value));
    }
  }
  for (std::size_t k = 1; k < levels_.size(); ++k) {
    const CubeLevel& finer = levels_[k - 1].shape;
    const CubeLevel& shape = levels_[k].shape;
    std::vector<float> room(coarsening_floats(finer, shape));
    std::vector<float> next(shape.points() / 2);
    coarsen(finer, rgb.data(), shape, next.data(), room.data());
    rgb = std::move(next);
    for (std::size_t i = 0; i < rgb.size(); i += 3) levels_[k].light.push_back(rgb[i]);
  }
}

bool LobeWeights::is_open(const Level& level, std::size_t point) const {
  const double cosine = glm::dot(level.places[point], direction_);
  const double shrunk = level.shrunk[point % level.shrunk.size()];
  const double open = level.open * shrunk - width_square_;
  return 2.0 - 2.0 * cosine < open;
}

bool LobeWeights::is_cut(const Level& level, std::size_t point) const {
  return level.strip > 0.0 && std::abs(glm::dot(level.places[point], direction_)) < level.strip;
}

/// The mean of the lobe over a texel of the finest level about a point of any level.
double LobeWeights::lobe_over(std::size_t which, std::size_t point) const {
  const Level& level = levels_[which];
  const double cosine = glm::dot(level.places[point], direction_);
  const double step = 2.0 / levels_.front().shape.size;
  const double near = std::sqrt(width_square_ + 2.0 - 2.0 * cosine);
  int parts = std::clamp(static_cast<int>(std::ceil(3.0 * step / near)), 1, 24);
  const bool cut = kink_ * square(step) > kKinkSeen && std::abs(cosine) < step;
  if (cut) parts = std::max(parts, static_cast<int>(std::ceil(kCutParts * step)));
  if (!cut && cosine < -1.5 * step) return 0.0;
  const math::GaussRule& rule = rule_;
  const int edge = level.shape.edge();
  const auto on_face = static_cast<int>(point % static_cast<std::size_t>(edge * edge));
  const image::Frame& frame = image::face_frame(static_cast<int>(point / static_cast<std::size_t>(edge * edge)));
  const double u0 = level.shape.place(on_face % edge);
  const double v0 = level.shape.place(on_face / edge);
  const double along_u = glm::dot(frame.u, direction_);
  const double along_v = glm::dot(frame.v, direction_);
  const double along_normal = glm::dot(frame.normal, direction_);
  const double part = step / parts;
  double sum = 0.0;
  double area = 0.0;
  for (int i = 0; i < parts * rule.order; ++i) {
    const int across = i / rule.order;
    const double u = u0 - 0.5 * step + part * (across + 0.5 + 0.5 * rule.nodes[i % rule.order]);
    const double of_u = along_normal + u * along_u;
    for (int j = 0; j < parts * rule.order; ++j) {
      const int down = j / rule.order;
      const double v = v0 - 0.5 * step + part * (down + 0.5 + 0.5 * rule.nodes[j % rule.order]);
      const double inverse_square = 1.0 / (1.0 + u * u + v * v);
      const double inverse = std::sqrt(inverse_square);
      const double weight = rule.weights[i % rule.order] * rule.weights[j % rule.order] * inverse * inverse_square;
      sum += weight * lobe((of_u + v * along_v) * inverse, alpha_);
      area += weight;
    }
  }
  return scale_ * sum / area;
}

/// At a place of a face's plane, with the sign of the cosine beyond the horizon: differences over it see no kink. The
/// lobe is cosine / (1 - (1 - alpha^2) h^2)^2, h^2 = (1 + cosine) / 2.
double LobeWeights::lobe_at(const image::Frame& frame, double u, double v) const {
  const double along =
      glm::dot(frame.normal, direction_) + u * glm::dot(frame.u, direction_) + v * glm::dot(frame.v, direction_);
  const double cosine = along / std::sqrt(1.0 + u * u + v * v);
  return smooth_ * cosine / square(square(alpha_) * 0.5 * (1.0 + cosine) + 0.5 * (1.0 - cosine));
}

/// What a point's value is to be for those between it and its neighbours to be right: four points lose a share of the
/// fourth differences there.
double LobeWeights::wanted(std::size_t which, std::size_t point) const {
  const double mean = lobe_over(which, point);
  const Level& level = levels_[which];
  const double cosine = glm::dot(level.places[point], direction_);
  if (which == 0 || width_square_ + 2.0 - 2.0 * cosine > square(kBent * level.step) || cosine <= 0.0) return mean;
  const int edge = level.shape.edge();
  const auto on_face = static_cast<int>(point % static_cast<std::size_t>(edge * edge));
  const image::Frame& frame = image::face_frame(static_cast<int>(point / static_cast<std::size_t>(edge * edge)));
  const double u = level.shape.place(on_face % edge);
  const double v = level.shape.place(on_face / edge);
  const double one = lobe_at(frame, u - level.step, v) + lobe_at(frame, u + level.step, v) +
                     lobe_at(frame, u, v - level.step) + lobe_at(frame, u, v + level.step);
  const double two = lobe_at(frame, u - 2.0 * level.step, v) + lobe_at(frame, u + 2.0 * level.step, v) +
                     lobe_at(frame, u, v - 2.0 * level.step) + lobe_at(frame, u, v + 2.0 * level.step);
  return mean + level.fourth * (two - 4.0 * one + 12.0 * lobe_at(frame, u, v));
}

double LobeWeights::interpolated(std::size_t which, std::size_t point) {
  const CubeLevel& shape = levels_[which].shape;
  const CubeLevel& coarser = levels_[which + 1].shape;
  const auto edge = static_cast<std::size_t>(shape.edge());
  const auto coarse_edge = static_cast<std::size_t>(coarser.edge());
  const LevelShares rows(shape, coarser, static_cast<int>(point / edge % edge));
  const LevelShares columns(shape, coarser, static_cast<int>(point % edge));
  const std::size_t first = (point / (edge * edge) * coarse_edge + static_cast<std::size_t>(rows.first)) * coarse_edge +
                            static_cast<std::size_t>(columns.first);
  double sum = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    double along = 0.0;
    for (std::size_t j = 0; j < 4; ++j) along += columns.share[j] * value(which + 1, first + i * coarse_edge + j);
    sum += rows.share[i] * along;
  }
  return sum;
}

double LobeWeights::value(std::size_t which, std::size_t point) {
  Level& level = levels_[which];
  if (level.known[point] != call_) {
    level.values[point] = interpolated(which, point);
    level.known[point] = call_;
  }
  return level.values[point];
}

void LobeWeights::add(std::size_t which, std::size_t point, double value) {
  const Level& level = levels_[which];
  const auto light = static_cast<double>(level.light[point % level.light.size()]);
  even_ += value * light;
  weights_.push_back({static_cast<std::uint32_t>(which), static_cast<std::uint32_t>(point), value});
}

void LobeWeights::start(std::vector<std::uint32_t>& open) {
  Level& level = levels_[top_];
  open.clear();
  for (std::size_t point = 0; point < level.places.size(); ++point) {
    double value = 0.0;
    if (top_ > 0 && is_open(level, point)) {
      open.push_back(static_cast<std::uint32_t>(point));
    } else {
      if (is_cut(level, point)) open.push_back(static_cast<std::uint32_t>(point));
      value = wanted(top_, point);
      if (value != 0.0) add(top_, point, value);
    }
    level.values[point] = value;
    level.known[point] = call_;
  }
}

/// The points whose value some open parent takes part in.
void LobeWeights::refine(std::size_t which, const std::vector<std::uint32_t>& parents,
                         std::vector<std::uint32_t>& open) {
  Level& level = levels_[which];
  const CubeLevel& shape = level.shape;
  const CubeLevel& coarser = levels_[which + 1].shape;
  const int edge = shape.edge();
  const int coarse_edge = coarser.edge();
  open.clear();
  for (const std::uint32_t parent : parents) {
    const int face = static_cast<int>(parent) / (coarse_edge * coarse_edge);
    const int first_row =
        2 * (static_cast<int>(parent) / coarse_edge % coarse_edge - coarser.margin) - 3 + shape.margin;
    const int first_column = 2 * (static_cast<int>(parent) % coarse_edge - coarser.margin) - 3 + shape.margin;
    for (int row = std::max(0, first_row); row < std::min(edge, first_row + 8); ++row) {
      for (int column = std::max(0, first_column); column < std::min(edge, first_column + 8); ++column) {
        const auto point = static_cast<std::size_t>((face * edge + row) * edge + column);
        if (level.known[point] == call_) continue;
        const double coarse = this->value(which, point);
        if (which > 0 && is_open(level, point)) {
          open.push_back(static_cast<std::uint32_t>(point));
          continue;
        }
        if (which > 0 && is_cut(level, point)) open.push_back(static_cast<std::uint32_t>(point));
        const double value = wanted(which, point);
        if (std::abs(value - coarse) <= std::max(kNegligible * std::abs(value), kNothing)) continue;
        level.values[point] = value;
        add(which, point, value - coarse);
      }
    }
  }
}

const std::vector<LobeWeights::Weight>& LobeWeights::about(const glm::dvec3& direction) {
  direction_ = direction;
  ++call_;
  even_ = 0.0;
  weights_.clear();
  start(open_);
  for (std::size_t level = top_; level-- > 0 && !open_.empty();) {
    refine(level, open_, next_open_);
    std::swap(open_, next_open_);
  }
  for (Weight& weight : weights_) weight.value /= even_;
  return weights_;
}

const std::vector<double>& LobeWeights::errors() {
  const Level& texels = levels_.front();
  errors_.resize(texels.places.size());
  double whole = 0.0;  // 1, but for what the rules lose of it
  for (std::size_t point = 0; point < errors_.size(); ++point) {
    errors_[point] = lobe_over(0, point) * static_cast<double>(texels.light[point % texels.light.size()]);
    whole += errors_[point];
  }
  for (std::size_t point = 0; point < errors_.size(); ++point) {
    const auto light = static_cast<double>(texels.light[point % texels.light.size()]);
    errors_[point] = value(0, point) / even_ * light - errors_[point] / whole;
  }
  return errors_;
}

}  // namespace welkin::reflections
