#include "sky/ray_nodes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "jobs/tiles.h"
#include "math/elementary.h"
#include "math/quadrature.h"
#include "math/table_cache.h"
#include "sky/sky_geometry.h"

namespace welkin::sky {
namespace {

/// A panel's length against its distance from the planet's centre: the sun's elevation changes by as much.
constexpr double kLongestAngle = 0.03;
/// A panel that dims the light by more is halved...
constexpr double kThickest = 0.8;
/// ... unless too little light comes from it and from behind it.
constexpr double kFaintest = 0.01;
constexpr double kDark = 1e-9;

/// Four Gauss nodes on [0, 1], and the integrals from 0 to each of them of the polynomials that are 1 at one node and 0
/// at the others: how much air lies before a node follows from densities at all four.
/// Integrals of the interpolant are the coefficients a_ij = Int_0^(c_i) l_j of the four-stage Gauss collocation method;
/// Butcher 1964, "Implicit Runge-Kutta Processes". They are exact for densities that are cubic along the panel.
struct Collocation {
  std::array<double, kPanelNodes> nodes;
  std::array<double, kPanelNodes> weights;
  std::array<std::array<double, kPanelNodes>, kPanelNodes> before;  ///< [node][polynomial]
};

/// The integral of polynomial j from 0 to x, by the same rule scaled: exact for its degree.
/// l_j has degree 3; Gauss's rule of four nodes is exact to degree 7.
double integral(const Collocation& rule, std::size_t j, double x) {
  double sum = 0.0;
  for (std::size_t k = 0; k < kPanelNodes; ++k) {
    const double at = x * rule.nodes[k];
    double value = 1.0;
    for (std::size_t i = 0; i < kPanelNodes; ++i) {
      if (i != j) value *= (at - rule.nodes[i]) / (rule.nodes[j] - rule.nodes[i]);
    }
    sum += rule.weights[k] * value;
  }
  return x * sum;
}

Collocation make_collocation() {
  const math::GaussRule gauss = math::gauss_legendre(static_cast<int>(kPanelNodes));
  Collocation rule{};
  for (std::size_t k = 0; k < kPanelNodes; ++k) {
    rule.nodes[k] = 0.5 + 0.5 * gauss.nodes[k];
    rule.weights[k] = 0.5 * gauss.weights[k];
  }
  for (std::size_t i = 0; i < kPanelNodes; ++i) {
    for (std::size_t j = 0; j < kPanelNodes; ++j) rule.before[i][j] = integral(rule, j, rule.nodes[i]);
  }
  return rule;
}

const Collocation& collocation() {
  static const Collocation rule = make_collocation();
  return rule;
}

}  // namespace

RayPanels::RayPanels(const AirModel& air) {
  ends_.reserve(2 * std::max(air.shells().size(), air.length_shells().size()) + 8);
  static_cast<void>(collocation());  // made here, where memory may run out, and not inside a tile
}

void RayPanels::add(double distance, double length) noexcept {
  // Ends that rounding cannot tell apart would make panels of no length; distances come in rising order.
  if (distance > ends_.back() + 1e-12 * length && distance < length * (1.0 - 1e-12)) ends_.push_back(distance);
}

// A sphere of altitude b is met where (R + b)^2 = r^2 + 2 r mu s + s^2, or s^2 + 2 (r mu) s - I = 0 with
// I = (b - h) (2 R + b + h) = (R + b)^2 - r^2: s = -r mu -+ sqrt((r mu)^2 + I). The product of both roots is -I. One of
// them cancels where r mu is large against I, and is computed as I over the other one's negative: on the way down
// (r mu < 0, I < 0) the nearer root is I / (r mu - sqrt(D)), on the way up with r mu > 0 the root ahead is
// I / (r mu + sqrt(D)). The way down passes spheres below the start, from the highest on, until one lies below the
// lowest point of the ray (D <= 0), as all further ones then do. The way up passes those above the lowest point, which
// is at s = -r mu and ends a panel too: the altitude has its least value there, and panels on either side of it are
// monotone.
void RayPanels::cut(const AirModel& air, const Ray& ray, const std::vector<double>& shells) noexcept {
  const double along = (air.bottom_radius() + ray.altitude) * ray.zenith_cosine;
  const auto inside = [&](double shell) {
    return (shell - ray.altitude) * (2.0 * air.bottom_radius() + shell + ray.altitude);
  };
  ends_.clear();
  ends_.push_back(0.0);
  if (along < 0.0) {
    for (std::size_t i = shells.size(); i-- > 0;) {
      const double below = inside(shells[i]);
      const double square = along * along + below;
      if (below >= 0.0) continue;
      if (!(square > 0.0)) break;
      add(below / (along - std::sqrt(square)), ray.length);
    }
    if (!ray.ground) add(-along, ray.length);
  }
  if (!ray.ground) {
    for (const double shell : shells) {
      const double above = inside(shell);
      const double square = along * along + above;
      if (!(square > 0.0) || (along >= 0.0 && above <= 0.0)) continue;
      const double root = std::sqrt(square);
      add(along > 0.0 ? above / (along + root) : root - along, ray.length);
    }
  }
  ends_.push_back(ray.length);
}

PerConstituent lengths_along(const AirModel& air, const Ray& ray, RayPanels& panels) noexcept {
  const Collocation& rule = collocation();
  panels.cut(air, ray, air.length_shells());
  PerConstituent sums{};
  std::array<double, kPanelNodes> altitudes;
  std::array<PerConstituent, kPanelNodes> density;
  for (std::size_t panel = 1; panel < panels.ends().size(); ++panel) {
    const double from = panels.ends()[panel - 1];
    const double size = panels.ends()[panel] - from;
    for (std::size_t k = 0; k < kPanelNodes; ++k) {
      altitudes[k] = altitude_along(air.bottom_radius(), ray.altitude, ray.zenith_cosine, from + size * rule.nodes[k]);
    }
    air.densities(altitudes, density);
    for (std::size_t k = 0; k < kPanelNodes; ++k) {
      for (std::size_t i = 0; i < air.constituents(); ++i) sums[i] += size * rule.weights[k] * density[k][i];
    }
  }
  return sums;
}

namespace {

constexpr std::size_t kKeptBytes = std::size_t{12} << 20U;  ///< full and compact tables
constexpr int kTileRays = 128;

/// All that lengths depend on.
struct Key {
  double bottom_radius;
  double thickness;
  std::vector<std::vector<DensityLayer>> densities;
  std::vector<double> shells;
  std::vector<Ray> rays;

  bool operator==(const Key&) const = default;
};

std::shared_ptr<const RayLengths> compute(const AirModel& air, const std::vector<Ray>& rays, const Control& control) {
  const auto lengths = std::make_shared<RayLengths>();
  lengths->amounts.resize(rays.size());
  const std::size_t workers = jobs::worker_count(jobs::Placement::arena);
  std::vector<RayPanels> panels;
  for (std::size_t i = 0; i < workers; ++i) panels.emplace_back(air);
  jobs::run_rows(static_cast<int>(rays.size()), kTileRays, jobs::Placement::arena, workers, control,
                 [&](int row, std::size_t worker) {
                   const auto k = static_cast<std::size_t>(row);
                   lengths->amounts[k] = lengths_along(air, rays[k], panels[worker]);
                 });
  return lengths;
}

}  // namespace

std::shared_ptr<const RayLengths> lengths_of(const AirModel& air, std::vector<Ray> rays, const Control& control) {
  static auto& kept = *new math::TableCache<Key, RayLengths>(kKeptBytes);
  const Key key{air.bottom_radius(), air.thickness(), air.profiles(), air.length_shells(), std::move(rays)};
  if (std::shared_ptr<const RayLengths> found = kept.find(key)) return found;
  // Computed outside of the cache, whose lock a thread that waits for its tiles could come to again by other work.
  const std::shared_ptr<const RayLengths> computed = compute(air, key.rays, control);
  return kept.get(key, [&] { return computed; });
}

double optical_depth(const PerConstituent& extinction, const PerConstituent& lengths) noexcept {
  double sum = 0.0;
  for (std::size_t i = 0; i < kMaxConstituents; ++i) sum += extinction[i] * lengths[i];
  return sum;
}

RayNodes::RayNodes(const AirModel& air) : panels_(air), nodes_(kMaxRayNodes) { pending_.reserve(128); }

// Fills in four nodes from `count_` on and says whether they will do.
bool RayNodes::try_panel(const AirModel& air, const Ray& ray, const Extinctions& extinctions, double from, double to,
                         bool last_chance) noexcept {
  const Collocation& rule = collocation();
  const double size = to - from;
  const double radius = air.bottom_radius() + ray.altitude;
  // size / r' is the angle by which the local vertical rotates along the panel at most, and so the change of the sun's
  // elevation.
  if (!last_chance && size > kLongestAngle * radius_along(radius, ray.zenith_cosine, 0.5 * (from + to))) {
    return false;
  }
  RayNode* const nodes = nodes_.data() + count_;
  std::array<double, kPanelNodes> altitudes;
  std::array<PerConstituent, kPanelNodes> density;
  for (std::size_t k = 0; k < kPanelNodes; ++k) {
    RayNode& node = nodes[k];
    node.distance = from + size * rule.nodes[k];
    node.weight = size * rule.weights[k];
    node.altitude = std::clamp(altitude_along(air.bottom_radius(), ray.altitude, ray.zenith_cosine, node.distance), 0.0,
                               air.thickness());
    altitudes[k] = node.altitude;
  }
  air.densities(altitudes, density);
  PerConstituent whole{};
  for (std::size_t k = 0; k < kPanelNodes; ++k) {
    nodes[k].density = density[k];
    for (std::size_t i = 0; i < air.constituents(); ++i) whole[i] += nodes[k].weight * density[k][i];
  }
  std::array<double, 4> after{};
  for (std::size_t c = 0; c < 3; ++c) {
    // Only a channel of which more than kFaintest is left counts: the others' samples may be coarse.
    const double depth = optical_depth(extinctions[c], whole);
    after[c] = -depth;
    if (!last_chance && depth > kThickest && transmittance_[c] > kFaintest) return false;
  }
  math::exponentials(after);
  for (std::size_t c = 0; c < 3; ++c) {
    std::array<double, kPanelNodes> through;
    for (std::size_t k = 0; k < kPanelNodes; ++k) {
      double depth = 0.0;
      for (std::size_t i = 0; i < air.constituents(); ++i) {
        double before = 0.0;
        // The depth before node k is size Int_0^(x_k) of the cubic through the four densities. It may come out negative
        // by what the cubic swings below 0 where a density ends, hence the clamp below: a transmittance must not exceed
        // that of the panel's start.
        for (std::size_t j = 0; j < kPanelNodes; ++j) before += rule.before[k][j] * density[j][i];
        depth += extinctions[c][i] * before;
      }
      through[k] = -std::max(0.0, size * depth);
    }
    math::exponentials(through);
    for (std::size_t k = 0; k < kPanelNodes; ++k) nodes[k].transmittance[c] = transmittance_[c] * through[k];
    transmittance_[c] *= after[c];
  }
  count_ += kPanelNodes;
  return true;
}

void RayNodes::place(const AirModel& air, const Ray& ray, const Extinctions& extinctions) noexcept {
  panels_.cut(air, ray, air.shells());
  const std::vector<double>& ends = panels_.ends();
  count_ = 0;
  transmittance_ = {1.0, 1.0, 1.0};
  for (std::size_t panel = 1; panel < ends.size(); ++panel) {
    double from = ends[panel - 1];
    pending_.assign(1, ends[panel]);
    while (!pending_.empty()) {
      // Light from behind is at most kDark of what it would be without the air before it.
      if (*std::max_element(transmittance_.begin(), transmittance_.end()) < kDark) return;
      // Panels are halved from the far end of a stack, so that they come out in order and `transmittance_` is always
      // that of `from`. `left` is the number of panels that are still certain to come: when they would fill what is
      // left of `kMaxPanels`, or a stack of 48 halvings is not enough, panels are taken as they are.
      const std::size_t left = ends.size() - panel + pending_.size();
      const double to = pending_.back();
      const bool full = count_ / kPanelNodes + left + 1 >= kMaxPanels || pending_.size() >= 48;
      if (count_ + kPanelNodes > kMaxRayNodes) return;
      if (try_panel(air, ray, extinctions, from, to, full)) {
        from = to;
        pending_.pop_back();
      } else {
        pending_.push_back(from + 0.5 * (to - from));
      }
    }
  }
}

}  // namespace welkin::sky
