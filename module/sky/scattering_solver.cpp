#include "sky/scattering_solver.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>

#include "jobs/tiles.h"
#include "math/basis.h"
#include "math/elementary.h"
#include "sky/air.h"
#include "sky/sky_geometry.h"
#include "sky/solver_worker.h"
#include "sky/table_sizes.h"
#include "sky/vertical_harmonics.h"

namespace welkin::sky {
namespace {

using solver::each, solver::fill, solver::index, solver::kSunBlock, solver::kZeniths;
using std::numbers::pi;

constexpr int kPhaseNodes = 513;
constexpr double kSmallestLobe = 0.05;   ///< below this sum no direction is near the lobe
constexpr std::size_t kKeptPanels = 96;  ///< of a ray's samples of scattered light

constexpr int kMinAzimuths = 8;  ///< along which the second order is followed; further ones use three quarters
constexpr int kMinHeights = 24;  ///< from which on only every other height carries further orders

// Estimating the light of orders beyond the last one.
constexpr int kRestOrders = 2;            ///< more that are followed, along half of the azimuths, ...
constexpr int kMaxRestOrders = 24;        ///< ... or, where the ratio of two orders still changes, up to so many
constexpr double kSettled = 1e-3;         ///< of all light: how far the sum may be wrong by that change
constexpr double kMaxRatioToMean = 1.25;  ///< of a node's ratio of two orders to that of all nodes, ...
constexpr double kMinLoss = 0.75;         ///< ... and min loss of light from one to the next, of that of all nodes
constexpr double kLargestRatio = 0.95;    ///< beyond which a sum would multiply errors by 20 and more

/// Light of order after order, summed over all nodes, at three wavelengths.
class OrderSums {
 public:
  /// Returns this order's fraction of all before it; 1 for the first.
  double add(const std::array<double, 3>& order) {
    before_ = last_ratio_;
    double sum = 0.0;
    double all = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      last_ratio_[c] = order_[c] > 0.0 ? order[c] / order_[c] : 0.0;
      sum += order[c];
      all += all_[c];
      all_[c] += order[c];
    }
    order_ = order;
    return all > 0.0 ? sum / all : 1.0;
  }

  /// Returns the possible error of a geometric series' sum, as a fraction of all light, if its ratio changes once more
  /// by as much as it did last: d/dr 1 / (1 - r) times that. Where there is no sum (`kLargestRatio`), all of it.
  [[nodiscard]] double doubt() const {
    double most = 0.0;
    for (std::size_t c = 0; c < 3; ++c) {
      if (!(all_[c] > 0.0)) continue;
      // The last order L and all after it add up to L / (1 - r). If the ratio changes by dr, that changes by
      // L dr / (1 - r)^2.
      const bool none = last_ratio_[c] > kLargestRatio;
      const double left = 1.0 - std::min(last_ratio_[c], kLargestRatio);
      const double change = std::abs(last_ratio_[c] - before_[c]);
      most = std::max(most, order_[c] / all_[c] * (none ? 1.0 : change / left) / left);
    }
    return most;
  }

 private:
  std::array<double, 3> order_{};
  std::array<double, 3> all_{};
  std::array<double, 3> last_ratio_{};
  std::array<double, 3> before_{};
};

}  // namespace

SourceSolver::SourceSolver(const AirModel& air, const TableMapping& mapping, const Sunlight& light,
                           const WavelengthGroup& group, const SourceShape& shape)
    : air_(air),
      mapping_(mapping),
      light_(light),
      group_(group),
      shape_(shape),
      azimuths_(index(shape.azimuths)),
      spectra_(phase_spectra(air.atmosphere(), group.asymmetry)),
      bands_(spectra_.front().bands),
      ones_(index(bands_), 1.0),
      with_aerosol_(scatters(air.atmosphere().aerosol)),
      axis_(sun_axis(mapping, shape.suns)),
      panels_(index(shape.heights) * kZeniths * kKeptPanels),
      panel_count_(index(shape.heights) * kZeniths),
      radiance_(index(shape.heights) * kZeniths * 3 * index(shape.azimuths) * index(shape.suns)),
      source_(shape, with_aerosol_),
      total_(shape, with_aerosol_),
      scalar_(index(shape.heights) * 3 * index(shape.suns)),
      order_irradiance_(scalar_.size()),
      irradiance_(scalar_.size()) {
  heights_.resize(index(shape.heights));
  std::iota(heights_.begin(), heights_.end(), std::size_t{0});
  followed_.assign(heights_.begin(), heights_.end());
  if (with_aerosol_ && shape.narrow) source_.glow = Glow(spectra_);
  total_.glow = source_.glow;
  set_rules();
}

std::uint64_t SourceSolver::bytes(const SourceShape& shape, bool with_aerosol) noexcept {
  const std::uint64_t radiance =
      std::uint64_t{4} * index(shape.heights) * kZeniths * 3 * index(shape.azimuths) * index(shape.suns);
  const std::uint64_t sources =
      std::uint64_t{8} * (index(shape.heights) * shape.molecule_row() + (with_aerosol ? shape.size() : 0));
  const std::uint64_t panels =
      std::uint64_t{index(shape.heights)} * kZeniths * (kKeptPanels * sizeof(ScatteringPanel) + sizeof(std::size_t));
  const std::uint64_t nodes = std::uint64_t{shape.narrow ? 36U : 12U} * index(shape.zeniths) * shape.image();
  const std::uint64_t small =
      std::uint64_t{8} * index(shape.heights) * (21 * index(shape.suns) + kZeniths * (shape.narrow ? 410 : 220));
  return radiance + sources + nodes + panels + small;
}

void SourceSolver::set_rules() {
  const int bands = bands_;
  for (int k = 0; k < shape_.suns; ++k) {
    // For a sun in the zenith no azimuth matters: its node is placed half a degree off it.
    const double cosine = mapping_.smooth_sun_zenith_cosine(static_cast<double>(k) / (shape_.suns - 1));
    sun_cosines_.push_back(std::min(cosine, math::sine_cosine_of_turns(solver::kOffAxis).cosine));
    sun_sines_.push_back(std::sqrt(std::max(0.0, (1.0 - sun_cosines_.back()) * (1.0 + sun_cosines_.back()))));
  }
  legendre_.resize(index(shape_.heights) * kZeniths * pair_count(bands));
  RayPanels panels(air_);
  for (int h = 0; h < shape_.heights; ++h) {
    const double altitude = source_altitude(mapping_, shape_, index(h));
    rules_.push_back(direction_rule(horizon_cosine(air_.bottom_radius(), altitude)));
    for (std::size_t i = 0; i < kZeniths; ++i) {
      const double cosine = rules_.back().cosines[i];
      even_legendre(bands, cosine, legendre_.data() + (index(h) * kZeniths + i) * pair_count(bands));
      if (i >= index(DirectionRule::kGroundNodes)) continue;
      const double distance = distance_to_ground(air_.bottom_radius(), altitude, cosine);
      const PerConstituent lengths = lengths_along(air_, {altitude, cosine, true, distance}, panels);
      ground_distance_.push_back(distance);
      ground_transmittance_.emplace_back();
      for (std::size_t c = 0; c < 3; ++c) {
        ground_transmittance_.back()[c] = math::exponential(-optical_depth(group_.extinctions[c], lengths));
      }
    }
  }
  set_azimuths(shape_.azimuths);
  set_source_nodes();
  for (std::size_t lobe = 0; lobe < spectra_.size(); ++lobe) {
    for (int k = 0; k < kPhaseNodes; ++k) {
      const double cosine = math::sine_cosine_of_turns(0.5 * k / (kPhaseNodes - 1)).cosine;
      // A narrow lobe's swings below 0 are as large as what it scatters back: clamping them would double that.
      const std::vector<double>& moments = spectra_[lobe].aerosol;
      aerosol_phase_.push_back(source_.glow.any() ? math::sum_of_degrees(moments, cosine) : phase_of(moments, cosine));
    }
    set_lobe_scale(lobe);
  }
}

// cos(m phi_j) at midpoints phi_j = pi (j + 1/2) / n of half the circle, which integrate cos(k phi) exactly for all
// k < 2 n.
void SourceSolver::set_azimuths(int count) {
  azimuths_ = index(count);
  ray_azimuths_.clear();
  azimuth_cosines_.clear();
  for (int m = 0; m < std::max(bands_, 2); ++m) {
    for (int j = 0; j < count; ++j) {
      const double cosine = math::sine_cosine_of_turns(m * (j + 0.5) / (2.0 * count)).cosine;
      azimuth_cosines_.push_back(static_cast<float>(cosine));
      if (m == 1) ray_azimuths_.push_back(cosine);
    }
  }
}

// A lobe narrower than the spacing of directions would be counted too often or too seldom. The sum of the phase
// function over the directions is made 1, as it is over the sphere (Wiscombe 1976).
void SourceSolver::set_lobe_scale(std::size_t lobe) {
  const std::size_t suns = index(shape_.suns);
  for (std::size_t h = 0; h < rules_.size(); ++h) {
    for (std::size_t s = 0; s < suns; ++s) {
      double sum = 0.0;
      for (std::size_t i = 0; i < kZeniths; ++i) {
        const double cosine = rules_[h].cosines[i];
        const double sine = std::sqrt(std::max(0.0, (1.0 - cosine) * (1.0 + cosine)));
        const double weight = rules_[h].weights[i] * 2.0 * pi / static_cast<double>(azimuths_);
        for (const double azimuth : ray_azimuths_) {
          const double nu = std::clamp(cosine * sun_cosines_[s] + sine * sun_sines_[s] * azimuth, -1.0, 1.0);
          sum += weight * aerosol_phase(lobe, nu);
        }
      }
      // The sum is what the directions hold of a unit of light that is scattered once. Where all of them are far from a
      // narrow lobe it is small and no measure of the lobe, which is then left as it is.
      lobe_scale_.push_back(sum > kSmallestLobe ? 1.0 / sum : 1.0);
    }
  }
}

// Linear in the angle between 513 nodes: arccos by atan2, whose digits do not suffer near 0.
double SourceSolver::aerosol_phase(std::size_t lobe, double cosine) const noexcept {
  // 1 - cosine^2 as a product keeps its digits next to the vertical.
  const double sine = std::sqrt(std::max(0.0, (1.0 - cosine) * (1.0 + cosine)));
  const auto [node, part] = between(2.0 * math::turns_of(sine, cosine) * (kPhaseNodes - 1), kPhaseNodes);
  const double* const phase = aerosol_phase_.data() + lobe * kPhaseNodes;
  return phase[node] + part * (phase[node + 1] - phase[node]);
}

std::size_t SourceSolver::radiance_index(std::size_t height, std::size_t zenith, std::size_t channel) const noexcept {
  return ((height * kZeniths + zenith) * 3 + channel) * azimuths_ * index(shape_.suns);
}

void SourceSolver::solve(const Options& options, const Control& control) {
  const bool rest = options.rest && options.orders > 1;
  const int last = options.orders + (rest ? kRestOrders : 0);
  const double steps = 2.0 * last - 1.0;  // an order's rays, and between two orders the source
  // Orders that turn out to be needed beyond those halve what is left.
  // done(step) = 1 - 2^(steps - 1 - step) / steps beyond the planned steps: 1 - 1 / steps before the last one, and half
  // of the rest with each that follows, so that progress rises and never reaches 1 early.
  const auto done = [&](int step) { return step < steps ? step / steps : 1.0 - std::exp2(steps - 1.0 - step) / steps; };
  const auto part = [&](int step) { return jobs::part_of(control, done(step), done(step + 1)); };
  OrderSums sums;
  for (int order = 1; order <= options.orders; ++order) {
    if (order > 1) next_source(part(2 * order - 3));
    if (order > 1 && !shape_.narrow) follow_less(order);
    march(order == 1, part(2 * order - 2));
    measure();
    add_order({}, {});
    orders_ = order;
    last_change_ = sums.add(scattered());
    if (order > 1 && last_change_ < options.convergence_threshold) break;
  }
  for (int order = orders_ + 1; rest; ++order) {
    next_source(part(2 * order - 3));
    // Both are kept from before the order is followed: a node's ratio is that of this order to the one before.
    const std::vector<double> scalar = scalar_;
    const std::vector<double> irradiance = order_irradiance_;
    follow_less(order);
    march(false, part(2 * order - 2));
    measure();
    sums.add(scattered());
    const int followed = order - orders_;
    doubt_ = sums.doubt();
    const bool at_last = followed >= kMaxRestOrders || (followed >= kRestOrders && doubt_ < kSettled);
    add_order(at_last ? sums_of_series(scalar, scalar_) : std::vector<double>{},
              at_last ? sums_of_series(irradiance, order_irradiance_) : std::vector<double>{});
    if (at_last) break;
  }
  total_.set_steps();
  if (control.progress) control.progress(1.0);
}

// The irradiance of the ground by the last order enters the source of the order after the next.
void SourceSolver::next_source(const Control& control) {
  gather(control);
  direct_ground_ = false;
  for (std::size_t c = 0; c < 3; ++c) {
    ground_before_[c] =
        resample_log_cubic(std::span(order_irradiance_).subspan(c * index(shape_.suns), index(shape_.suns)));
  }
}

// Returns 1 / (1 - ratio): what an order and all that follow it add up to if the ratio of each to the one before stays
// the same. The ratio is each node's own, for light at night dies out more slowly than by day. Where light has only
// begun to arrive, the ratio predicts nothing about later orders, so that it is held near the mean of all nodes. In air
// so thick that hardly any light is lost between two orders, a sum would be a multiple of the order's errors: there is
// none. The ratio may exceed that of all nodes by a factor 1.25, but 1 - r must be at least 0.75 of theirs: the second
// bound is the stricter one for mean ratios above 1/2 (1.25 m = 1 - 0.75 (1 - m) there), where a factor on r alone
// could reach 1.
std::vector<double> SourceSolver::sums_of_series(const std::vector<double>& before,
                                                 const std::vector<double>& last) const {
  const std::size_t suns = index(shape_.suns);
  std::array<double, 3> sums_before{};
  std::array<double, 3> sums{};
  for (std::size_t i = 0; i < last.size(); ++i) {
    sums_before[i / suns % 3] += before[i];
    sums[i / suns % 3] += last[i];
  }
  std::vector<double> factors(last.size(), 1.0);
  for (std::size_t i = 0; i < last.size(); ++i) {
    const std::size_t c = i / suns % 3;
    if (!(before[i] > 0.0 && sums_before[c] > 0.0) || sums[c] > kLargestRatio * sums_before[c]) continue;
    const double mean = sums[c] / sums_before[c];
    const double most = std::min(kMaxRatioToMean * mean, 1.0 - kMinLoss * (1.0 - mean));
    factors[i] = 1.0 / (1.0 - std::min(last[i] / before[i], most));
  }
  return factors;
}

// Adds an order times factors per height, channel and sun; no factors: 1.
void SourceSolver::add_order(const std::vector<double>& factors, const std::vector<double>& irradiance_factors) {
  for (std::size_t i = 0; i < irradiance_.size(); ++i) {
    irradiance_[i] += (irradiance_factors.empty() ? 1.0 : irradiance_factors[i]) * order_irradiance_[i];
  }
  if (direct_ground_) return;  // the first order has no source
  const std::size_t suns = index(shape_.suns);
  std::vector<float> rows(index(shape_.heights) * 4 * suns, 1.0F);  // of all heights: tiles allocate nothing
  for (std::size_t i = 0; i < factors.size(); ++i) {
    rows[(i / suns / 3 * suns + i % suns) * 4 + i / suns % 3] = static_cast<float>(factors[i]);
  }
  each(heights_, [&](std::size_t height) { add_order_at(height, factors, rows.data() + height * 4 * suns); });
}

void SourceSolver::add_order_at(std::size_t height, const std::vector<double>& factors, const float* row) {
  const std::size_t suns = index(shape_.suns);
  for (std::size_t s = 0; s < suns; ++s) {
    // The mean of the channels' factors. The brightness only divides the source and multiplies it again
    // (solver_kernels.cpp), so that it need not be the mean of the products.
    double mean = 1.0;
    for (std::size_t c = 0; c < 3 && !factors.empty(); ++c) {
      mean += (factors[(height * 3 + c) * suns + s] - 1.0) / 3.0;
    }
    total_.brightness[height * suns + s] += mean * source_.brightness[height * suns + s];
  }
  const auto add = [&](const std::vector<float>& from, std::vector<float>& to) {
    const std::size_t size = from.size() / index(shape_.heights);
    for (std::size_t i = height * size; i < (height + 1) * size; i += 4 * suns) {
      for (std::size_t k = 0; k < 4 * suns; ++k) to[i + k] += row[k] * from[i + k];
    }
  };
  add(source_.rayleigh, total_.rayleigh);
  add(source_.aerosol, total_.aerosol);
}

// Light that was scattered twice is smooth: half of the azimuths carry it, and every other height what it leaves for
// the next orders. (Half of those azimuths for the third and on moved Mars by 6e-3 and the deepest twilight by 1e-2.)
void SourceSolver::follow_less(int order) {
  const int half = std::max(shape_.azimuths / 2, std::min(shape_.azimuths, kMinAzimuths));
  set_azimuths(order == 2 || shape_.narrow ? half : 3 * half / 4);
  if (shape_.narrow || shape_.height_bend > 0.0 || shape_.heights < kMinHeights || !skipped_.empty()) return;
  followed_.clear();
  for (const std::size_t height : heights_) {
    (height % 2 == 0 || height + 1 == heights_.size() ? followed_ : skipped_).push_back(height);
  }
}

void SourceSolver::march(bool single, const Control& control) {
  const std::size_t workers = jobs::worker_count(jobs::Placement::arena);
  std::vector<Worker> scratch;
  for (std::size_t i = 0; i < workers; ++i) scratch.emplace_back(air_, shape_, azimuths_, bands_);
  // Rays of about one zenith angle see the same images of the source: one after the other they find them in the
  // cache.
  const std::size_t heights = followed_.size();
  jobs::run_tiles(heights * kZeniths, jobs::Placement::arena, workers, control,
                  [&](std::size_t tile, std::size_t worker) {
                    march_ray(single, followed_[tile % heights], tile / heights, scratch[worker]);
                  });
}

void SourceSolver::march_ray(bool single, std::size_t height, std::size_t zenith, Worker& worker) {
  const double altitude = source_altitude(mapping_, shape_, height);
  const double cosine = rules_[height].cosines[zenith];
  const bool ground = zenith < index(DirectionRule::kGroundNodes);
  const double length = ground ? distance_to_ground(air_.bottom_radius(), altitude, cosine)
                               : distance_to_top(air_.bottom_radius(), air_.thickness(), altitude, cosine);
  const double sine = std::sqrt(std::max(0.0, (1.0 - cosine) * (1.0 + cosine)));
  const std::size_t suns = index(shape_.suns);
  RayLight& ray = worker.light;
  for (std::size_t j = 0; j < azimuths_; ++j) {
    const double azimuth = ray_azimuths_[j];
    for (std::size_t s = 0; s < suns; ++s) {
      ray.set_sun(j * suns + s, sun_cosines_[s],
                  std::clamp(cosine * sun_cosines_[s] + sine * sun_sines_[s] * azimuth, -1.0, 1.0));
    }
  }
  if (single) {
    ray.place(air_, {altitude, cosine, ground, length}, group_);
    const std::span<const ScatteringPanel> panels = ray.panels(air_, group_, shape_, mapping_);
    const std::size_t ray_index = height * kZeniths + zenith;
    panel_count_[ray_index] = panels.size();
    if (panels.size() <= kKeptPanels) {
      std::copy(panels.begin(), panels.end(), panels_.begin() + static_cast<std::ptrdiff_t>(ray_index * kKeptPanels));
    }
    add_sunlit(height, zenith, worker);
  } else {
    add_scattered(height, zenith, {altitude, cosine, ground, length}, worker);
  }
}

void SourceSolver::add_sunlit(std::size_t height, std::size_t zenith, Worker& worker) {
  RayLight& ray = worker.light;
  const std::size_t suns = index(shape_.suns);
  const float* const sums = ray.sunlight(solver_kernels(), air_, light_);
  for (std::size_t i = 0; i < ray.count(); ++i) {
    const double nu = ray.angle_cosine(i);
    std::array<double, 3> aerosol{};
    for (std::size_t c = 0; c < 3; ++c) {
      aerosol[c] = c < spectra_.size()
                       ? lobe_scale_[(c * rules_.size() + height) * suns + i % suns] * aerosol_phase(c, nu)
                       : aerosol[0];
      // The solver's first order has the aerosol as scaled by delta-M, with the bands that it keeps; the tables' has
      // all of it (sky_tables.cpp). `lobe_scale_` makes the discrete sum of the lobe over directions 1.
      const double value =
          group_.solar[c] * (group_.rayleigh[c] * rayleigh_phase(nu) * static_cast<double>(sums[8 * i + c]) +
                             group_.aerosol[c] * aerosol[c] * static_cast<double>(sums[8 * i + 4 + c]));
      radiance_[radiance_index(height, zenith, c) + i] = static_cast<float>(value);
    }
  }
}

void SourceSolver::add_scattered(std::size_t height, std::size_t zenith, const Ray& ray, Worker& worker) {
  RayLight& light = worker.light;
  const std::size_t ray_index = height * kZeniths + zenith;
  std::span<const ScatteringPanel> panels(panels_.data() + ray_index * kKeptPanels,
                                          std::min(panel_count_[ray_index], kKeptPanels));
  if (panel_count_[ray_index] > kKeptPanels) {
    light.place(air_, ray, group_);
    panels = light.panels(air_, group_, shape_, mapping_);
  }
  const RayLight::Scattered sums = light.scattered(solver_kernels(), panels, source_, axis_);
  for (std::size_t c = 0; c < 3; ++c) {
    float* const radiance = radiance_.data() + radiance_index(height, zenith, c);
    for (std::size_t i = 0; i < light.count(); ++i) {
      radiance[i] = sums.light[4 * i + c];
      if (sums.aerosol != nullptr) radiance[i] += sums.aerosol[4 * i + c];
    }
  }
}

// Computes the last order's irradiance from above, and its mean over all directions.
void SourceSolver::measure() {
  each(followed_, [&](std::size_t height) { measure_at(height); });
  for (const std::size_t height : skipped_) {
    fill(height, heights_.size(), scalar_);
    fill(height, heights_.size(), order_irradiance_);
  }
}

void SourceSolver::measure_at(std::size_t height) {
  const std::size_t suns = index(shape_.suns);
  std::fill_n(order_irradiance_.begin() + static_cast<std::ptrdiff_t>(height * 3 * suns), 3 * suns, 0.0);
  std::fill_n(scalar_.begin() + static_cast<std::ptrdiff_t>(height * 3 * suns), 3 * suns, 0.0);
  for (std::size_t i = 0; i < kZeniths; ++i) {
    // Mean: (1 / (4 pi)) w_i (2 pi / n) Sum_j L = w_i / (2 n) Sum_j L. Irradiance: w_i (2 pi / n) mu Sum_j L, 4 pi mu
    // times that.
    const double weight = rules_[height].weights[i] / (2.0 * static_cast<double>(azimuths_));
    const double upward = 4.0 * pi * std::max(0.0, rules_[height].cosines[i]) * weight;
    for (std::size_t c = 0; c < 3; ++c) {
      const float* const rays = radiance_.data() + radiance_index(height, i, c);
      for (std::size_t s = 0; s < suns; ++s) {
        double sum = 0.0;
        for (std::size_t j = 0; j < azimuths_; ++j) sum += static_cast<double>(rays[j * suns + s]);
        scalar_[(height * 3 + c) * suns + s] += weight * sum;
        order_irradiance_[(height * 3 + c) * suns + s] += upward * sum;
      }
    }
  }
}

// Returns per wavelength the mean radiance of the last order summed over all heights and suns.
std::array<double, 3> SourceSolver::scattered() const noexcept {
  std::array<double, 3> sums{};
  for (std::size_t i = 0; i < scalar_.size(); ++i) sums[i / index(shape_.suns) % 3] += scalar_[i];
  return sums;
}

}  // namespace welkin::sky
