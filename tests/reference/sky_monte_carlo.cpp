#include "reference/sky_monte_carlo.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/geometric.hpp>
#include <numbers>

#include "jobs/tiles.h"
#include "math/elementary.h"
#include "reference/path_sampling.h"
#include "reference/reference_air.h"
#include "sky/air.h"
#include "sky/sky_geometry.h"

namespace welkin {
namespace {

using glm::dvec3;
using sky::AirRay;
using sky::PathRandom;
using sky::PathShells;
using sky::ReferenceAir;
using std::numbers::pi;

constexpr std::size_t kMaxWavelengths = 16;
using Spectrum = std::array<double, kMaxWavelengths>;

constexpr double kLongestPiece = 25e3;  ///< metres
constexpr double kMinShare = 1e-4;      ///< share that counts as sunlit where the guess is dark
constexpr double kEven = 1e-3;          ///< a smaller fall counts as none
constexpr double kSteepest = 8.0;       ///< maximum of a fall's logarithm along a piece
constexpr int kGuessHeights = 64;
constexpr int kGuessSuns = 128;
constexpr double kLowSun = 0.1;      ///< sine of an elevation below which directions are drawn towards the sun
constexpr double kNarrow = 0.85;     ///< asymmetry above which they are drawn so by day, too
constexpr double kTowardsSun = 0.5;  ///< share of directions drawn so
/// That share for a narrow lobe: every scattering that is not drawn towards the sun multiplies a path's weight by
/// 1 / (1 - share), and light that comes low through haze has been scattered many times.
constexpr double kTowardsNarrow = 0.25;
constexpr double kLittle = 0.02;  ///< fraction of a path's first weight below which most paths end
/// That fraction for a narrow lobe: a path drawn towards the sun has little weight, and yet all its light is to come.
constexpr double kLittleNarrow = 3e-4;
constexpr double kSunsetAsymmetry = 0.7;  ///< of the lobe of directions about the horizon below the sun
constexpr double kDeepSun = -0.1;         ///< sine of an elevation below which positions are drawn by the light there
constexpr double kDeepAsymmetry = 0.85;   ///< of the lobe about the horizon then
constexpr double kFullNight = -0.35;      ///< sine of an elevation below which they no longer are
constexpr double kDusk = 46.0;            ///< slope of the logarithm of light per radian of sun depth: 0.8 per degree

/// A point and a direction in the air.
struct PathPoint {
  double square;  ///< r^2 - R^2
  dvec3 up;
  dvec3 direction;
};

/// A piece of a ray, with how likely it is to be drawn.
struct Piece {
  std::size_t shell;
  double from;
  double to;
  double scatters;                  ///< estimate of what it scatters to the ray's start, sum over the wavelengths
  double lit;                       ///< the sunlit part of that
  double dusk;                      ///< relative amount of light there, at night
  double fall;                      ///< rate at which the logarithm of what it scatters to the start falls, 1/m
  sky::PathShells::Columns before;  ///< matter between the ray's start and `from`
};

class MonteCarlo {
 public:
  MonteCarlo(const ReferenceAir& air, const dvec3& sun, const PathTracingOptions& options)
      : air_(air), shells_(air), sun_(sun), options_(options) {
    const double level = std::sqrt(sun.x * sun.x + sun.z * sun.z);
    if (sun.y < kLowSun && level > 0.0) sunset_ = dvec3(sun.x / level, 0.0, sun.z / level);
    if (sun.y < kDeepSun) sunset_asymmetry_ = kDeepAsymmetry;
    if (sun.y >= kLowSun && air.drawn_asymmetry() > kNarrow) {
      sunset_ = sun;
      towards_sun_ = kTowardsNarrow;
      little_ = kLittleNarrow;
      narrow_ = true;
      sunset_asymmetry_ = air.drawn_asymmetry() * air.drawn_asymmetry();  // as light that was turned twice
    }
    guess_sunlight();
    for (const ReferenceAir::Matter& matter : air.matter()) {
      if (std::any_of(matter.scattering.begin(), matter.scattering.end(), [](double b) { return b > 0.0; })) {
        scatterers_.push_back(static_cast<std::size_t>(&matter - air.matter().data()));
      }
    }
  }

  /// Scratch of one path.
  struct Scratch {
    std::vector<Piece> pieces;
  };

  /// Adds the light of the requested orders that arrives from a direction, times `weight`, to `radiance`.
  void trace(PathPoint point, double weight, PathRandom& random, Scratch& scratch, Spectrum& radiance) const {
    Spectrum weights;
    weights.fill(weight);
    for (int order = 1; order <= options_.highest_order; ++order) {
      const AirRay ray = ray_from(point);
      cut(ray, point, scratch.pieces);
      if (order >= options_.lowest_order) add_sunlight(ray, point, weights, random, scratch.pieces, radiance);
      if (order == options_.highest_order) return;
      if (!go_on(ray, point, weights, random, scratch.pieces)) return;
      const double most = *std::max_element(weights.begin(), weights.begin() + count());
      if (most < little_ * weight) {
        if (!(random.number() * little_ * weight < most)) return;
        for (double& value : weights) value *= little_ * weight / most;
      }
    }
  }

  /// Draws a direction above level ground by its cosine or towards the sun. Returns its cosine over its density.
  double draw_from_sky(dvec3& direction, PathRandom& random) const {
    return draw_upwards({0.0, 1.0, 0.0}, direction, random) * pi;
  }

  [[nodiscard]] std::ptrdiff_t count() const { return static_cast<std::ptrdiff_t>(air_.wavelengths()); }

 private:
  [[nodiscard]] AirRay ray_from(const PathPoint& point) const {
    const double slope = std::sqrt(air_.radius() * air_.radius() + point.square) * glm::dot(point.up, point.direction);
    const double below = slope * slope - point.square;
    if (slope < 0.0 && below > 0.0) {
      return {point.square, slope, point.square / (std::sqrt(below) - slope), true};
    }
    return air_.ray_to_top(point.square, slope);
  }

  [[nodiscard]] PathPoint moved(const PathPoint& point, const AirRay& ray, double s) const {
    const double radius = std::sqrt(air_.radius() * air_.radius() + point.square);
    return {std::max(0.0, ray.square + s * (2.0 * ray.slope + s)),
            glm::normalize(radius * point.up + s * point.direction), point.direction};
  }

  [[nodiscard]] double sun_share(const PathPoint& point) const {
    const double slope = std::sqrt(air_.radius() * air_.radius() + point.square) * glm::dot(point.up, sun_);
    return air_.visible_share(air_.sun_elevation(point.square, slope));
  }

  /// Computes the sunlight at a point: zero where the sun is down.
  void sunlight(const PathPoint& point, Spectrum& light) const {
    light.fill(0.0);
    const double share = sun_share(point);
    if (!(share > 0.0)) return;
    const double slope = std::sqrt(air_.radius() * air_.radius() + point.square) * glm::dot(point.up, sun_);
    const PathShells::Columns columns = shells_.columns(air_.sun_ray(point.square, slope));
    for (std::size_t i = 0; i < air_.wavelengths(); ++i) {
      light[i] = share * air_.atmosphere().solar_irradiance[i] * math::exponential(-air_.optical_depth(columns, i));
    }
  }

  // Guesses how much sunlight reaches a point. The guess is used to draw pieces and for nothing else, so that its error
  // is in no estimate.

  void guess_sunlight() {
    for (int h = 0; h < kGuessHeights; ++h) {
      const double square = guess_square(h / (kGuessHeights - 1.0));
      const double radius = std::sqrt(air_.radius() * air_.radius() + square);
      for (int k = 0; k < kGuessSuns; ++k) {
        const double above = k / (kGuessSuns - 1.0);  // the horizon, squared
        const double slope = radius * above * above - std::sqrt(square) * (1.0 - above * above);
        const PathShells::Columns columns = shells_.columns(air_.sun_ray(square, slope));
        double sum = 0.0;
        for (std::size_t i = 0; i < air_.wavelengths(); ++i) sum += math::exponential(-air_.optical_depth(columns, i));
        guess_.push_back(sum / static_cast<double>(air_.wavelengths()));
      }
    }
  }

  [[nodiscard]] double guess_square(double x) const { return air_.square_of(air_.thickness() * x * x); }

  [[nodiscard]] double guess(const PathPoint& point) const {
    const double share = sun_share(point);
    if (!(share > 0.0)) return 0.0;
    const double radius = std::sqrt(air_.radius() * air_.radius() + point.square);
    const double horizon = std::sqrt(point.square);
    const double x = std::sqrt(std::clamp(air_.altitude_of(point.square) / air_.thickness(), 0.0, 1.0));
    const double above =
        std::sqrt(std::clamp((radius * glm::dot(point.up, sun_) + horizon) / (radius + horizon), 0.0, 1.0));
    const auto h = static_cast<std::size_t>(x * (kGuessHeights - 1) + 0.5);
    const auto k = static_cast<std::size_t>(above * (kGuessSuns - 1) + 0.5);
    return share * guess_[h * kGuessSuns + k];
  }

  /// Guesses how scattered light grows towards where the sun has set less deep.
  [[nodiscard]] double dusk(const PathPoint& point) const {
    const double elevation = std::asin(std::clamp(glm::dot(point.up, sun_), kFullNight, kDeepSun));
    return math::exponential(kDusk * (elevation - std::asin(kDeepSun)));
  }

  void cut(const AirRay& ray, const PathPoint& point, std::vector<Piece>& pieces) const {
    pieces.clear();
    PathShells::Columns before{};
    double from = 0.0;
    double lit_here = guess(point);
    for (sky::ShellWalk walk(shells_, ray);; walk.next()) {
      const int parts = std::max(1, static_cast<int>(std::ceil((walk.end() - from) / kLongestPiece)));
      const double step = (walk.end() - from) / parts;
      for (int part = 0; part < parts && step > 0.0; ++part) {
        const double low = from + part * step;
        add_piece(ray, point, {walk.shell(), low, low + step, 0.0, 0.0, 1.0, 0.0, before}, lit_here, before, pieces);
      }
      from = walk.end();
      if (walk.last()) return;
    }
  }

  void add_piece(const AirRay& ray, const PathPoint& point, Piece piece, double& lit_here, PathShells::Columns& before,
                 std::vector<Piece>& pieces) const {
    const double step = piece.to - piece.from;
    const PathShells::Columns inside = shells_.columns(ray, piece.shell, piece.from, piece.to);
    const double lit_before = lit_here;
    lit_here = guess(moved(point, ray, piece.to));
    const PathPoint middle = moved(point, ray, piece.from + 0.5 * step);
    const double lit = 0.25 * (lit_before + lit_here) + 0.5 * guess(middle);
    if (sun_.y < kDeepSun) piece.dusk = dusk(middle);
    PathShells::Columns start{};
    PathShells::Columns end{};
    shells_.densities(piece.shell, ray.square + piece.from * (2.0 * ray.slope + piece.from), start);
    shells_.densities(piece.shell, ray.square + piece.to * (2.0 * ray.slope + piece.to), end);
    double first = 0.0;
    double last = 0.0;
    for (std::size_t i = 0; i < air_.wavelengths(); ++i) {
      const double here = air_.optical_depth(inside, i);
      const double through = math::exponential(-air_.optical_depth(before, i));
      const double halfway = through * math::exponential(-0.5 * here);
      const double behind = through * math::exponential(-here);
      for (const std::size_t k : scatterers_) {
        piece.scatters += inside[k] * air_.matter()[k].scattering[i] * halfway;
        first += start[k] * air_.matter()[k].scattering[i] * through;
        last += end[k] * air_.matter()[k].scattering[i] * behind;
      }
    }
    if (narrow_ && first > 0.0 && last > 0.0) {
      piece.fall = std::clamp(math::logarithm(first / last), -kSteepest, kSteepest) / step;
    }
    piece.lit = piece.scatters * (lit + kMinShare);
    for (std::size_t k = 0; k < air_.matter().size(); ++k) before[k] += inside[k];
    pieces.push_back(piece);
  }

  /// Draws a piece by its share. `chance` is the probability of that.
  template <class Share>
  static const Piece* draw_piece(const std::vector<Piece>& pieces, const Share& share, PathRandom& random,
                                 double& chance) {
    double all = 0.0;
    for (const Piece& piece : pieces) all += share(piece);
    if (!(all > 0.0)) return nullptr;
    double left = random.number() * all;
    const Piece* drawn = nullptr;
    for (const Piece& piece : pieces) {
      if (!(share(piece) > 0.0)) continue;
      drawn = &piece;
      left -= share(piece);
      if (left < 0.0) break;
    }
    chance = share(*drawn) / all;
    return drawn;
  }

  /// Draws a position in a piece as its scattering falls along it; `chance` is multiplied by the density, 1/m.
  static double draw_position(const Piece& piece, PathRandom& random, double& chance) {
    const double length = piece.to - piece.from;
    const double fall = piece.fall * length;
    const double number = random.number();
    if (std::abs(fall) < kEven) {
      chance /= length;
      return piece.from + number * length;
    }
    const double gone = 1.0 - math::exponential(-fall);
    const double left = 1.0 - number * gone;
    chance *= piece.fall * left / gone;
    return piece.from + std::clamp(-math::logarithm(left) / piece.fall, 0.0, length);
  }

  /// Computes the transmittance to a position in a piece, and the densities there.
  void reach(const AirRay& ray, const Piece& piece, double s, Spectrum& through, PathShells::Columns& densities) const {
    PathShells::Columns columns = shells_.columns(ray, piece.shell, piece.from, s);
    for (std::size_t k = 0; k < air_.matter().size(); ++k) columns[k] += piece.before[k];
    for (std::size_t i = 0; i < air_.wavelengths(); ++i) {
      through[i] = math::exponential(-air_.optical_depth(columns, i));
    }
    shells_.densities(piece.shell, ray.square + s * (2.0 * ray.slope + s), densities);
  }

  void add_sunlight(const AirRay& ray, const PathPoint& point, const Spectrum& weights, PathRandom& random,
                    const std::vector<Piece>& pieces, Spectrum& radiance) const {
    Spectrum light;
    double chance = 0.0;
    if (const Piece* const piece = draw_piece(
            pieces, [](const Piece& p) { return p.lit; }, random, chance)) {
      const double s = draw_position(*piece, random, chance);
      sunlight(moved(point, ray, s), light);
      Spectrum through;
      PathShells::Columns densities{};
      reach(ray, *piece, s, through, densities);
      const double cosine = std::clamp(glm::dot(point.direction, sun_), -1.0, 1.0);
      for (const std::size_t k : scatterers_) {
        for (std::size_t i = 0; i < air_.wavelengths(); ++i) {
          const double part = densities[k] * air_.phase(air_.matter()[k], i, cosine) / chance;
          radiance[i] += weights[i] * part * air_.matter()[k].scattering[i] * through[i] * light[i];
        }
      }
    }
    if (!ray.ground) return;
    const PathPoint end = moved(point, ray, ray.length);
    const double level = glm::dot(end.up, sun_);
    if (!(level > 0.0)) return;
    sunlight({0.0, end.up, end.direction}, light);
    const Spectrum through = ground_transmittance(ray, pieces);
    for (std::size_t i = 0; i < air_.wavelengths(); ++i) {
      radiance[i] += weights[i] * through[i] * air_.atmosphere().ground_albedo[i] / pi * level * light[i];
    }
  }

  [[nodiscard]] Spectrum ground_transmittance(const AirRay& ray, const std::vector<Piece>& pieces) const {
    Spectrum through;
    through.fill(1.0);
    if (pieces.empty()) return through;
    PathShells::Columns densities{};
    reach(ray, pieces.back(), pieces.back().to, through, densities);
    return through;
  }

  /// Moves to where light of the next order comes from and draws a direction; returns false if there is none.
  bool go_on(const AirRay& ray, PathPoint& point, Spectrum& weights, PathRandom& random,
             const std::vector<Piece>& pieces) const {
    double air = 0.0;
    for (const Piece& piece : pieces) air += piece.scatters;
    double ground = 0.0;
    Spectrum through{};
    if (ray.ground && !air_.atmosphere().ground_albedo.empty()) {
      through = ground_transmittance(ray, pieces);
      for (std::size_t i = 0; i < air_.wavelengths(); ++i) {
        through[i] *= air_.atmosphere().ground_albedo[i];
        ground += through[i];
      }
    }
    if (!(air + ground > 0.0)) return false;
    if (random.number() * (air + ground) < ground) {
      point = moved(point, ray, ray.length);
      point.square = 0.0;
      const double up = draw_upwards(point.up, point.direction, random);
      for (std::size_t i = 0; i < air_.wavelengths(); ++i) weights[i] *= through[i] * up * (air + ground) / ground;
      return up > 0.0;
    }
    double chance = 0.0;
    const Piece* const piece = draw_piece(
        pieces, [](const Piece& p) { return p.scatters * p.dusk; }, random, chance);
    if (piece == nullptr) return false;
    const double s = draw_position(*piece, random, chance);
    PathShells::Columns densities{};
    reach(ray, *piece, s, through, densities);
    point = moved(point, ray, s);
    chance *= air / (air + ground);
    return scatter(densities, through, chance, point, weights, random);
  }

  /// Draws a direction by the cosine or towards the sun. Returns its cosine / (pi density), or 0 if it points down.
  double draw_upwards(const dvec3& up, dvec3& direction, PathRandom& random) const {
    const bool low = sunset_ != dvec3(0.0);
    const bool towards = low && random.number() < towards_sun_;
    direction = towards ? sky::turned(sunset_, sky::draw_henyey_greenstein(sunset_asymmetry_, random), random)
                        : sky::turned(up, std::sqrt(random.number()), random);
    const double cosine = glm::dot(up, direction);
    if (!(cosine > 0.0)) return 0.0;
    if (!low) return 1.0;
    const double density = (1.0 - towards_sun_) * cosine / pi +
                           towards_sun_ * sky::henyey_greenstein_phase(sunset_asymmetry_, glm::dot(sunset_, direction));
    return cosine / pi / density;
  }

  /// Draws a new direction by the phase functions or towards the sun.
  bool scatter(const PathShells::Columns& densities, const Spectrum& through, double chance, PathPoint& point,
               Spectrum& weights, PathRandom& random) const {
    std::array<double, ReferenceAir::kMaxConstituents> shares{};
    double all = 0.0;
    for (const std::size_t k : scatterers_) {
      for (std::size_t i = 0; i < air_.wavelengths(); ++i) {
        shares[k] += weights[i] * through[i] * densities[k] * air_.matter()[k].scattering[i];
      }
      all += shares[k];
    }
    if (!(all > 0.0)) return false;
    const bool low = sunset_ != dvec3(0.0);
    const dvec3 old = point.direction;
    point.direction = low && random.number() < towards_sun_
                          ? sky::turned(sunset_, sky::draw_henyey_greenstein(sunset_asymmetry_, random), random)
                          : drawn_by_phase(shares, all, old, random);
    const double cosine = std::clamp(glm::dot(old, point.direction), -1.0, 1.0);
    double density = 0.0;
    for (const std::size_t k : scatterers_) density += shares[k] / all * air_.drawn_phase(air_.matter()[k], cosine);
    if (low) {
      density = (1.0 - towards_sun_) * density +
                towards_sun_ * sky::henyey_greenstein_phase(sunset_asymmetry_, glm::dot(sunset_, point.direction));
    }
    for (std::size_t i = 0; i < air_.wavelengths(); ++i) {
      double scattered = 0.0;
      for (const std::size_t k : scatterers_) {
        scattered += densities[k] * air_.phase(air_.matter()[k], i, cosine) * air_.matter()[k].scattering[i];
      }
      weights[i] *= through[i] * scattered / (density * chance);
    }
    return true;
  }

  dvec3 drawn_by_phase(const std::array<double, ReferenceAir::kMaxConstituents>& shares, double all, const dvec3& old,
                       PathRandom& random) const {
    double left = random.number() * all;
    std::size_t kind = scatterers_.front();
    for (const std::size_t k : scatterers_) {
      kind = k;
      left -= shares[k];
      if (left < 0.0) break;
    }
    const Atmosphere& atmosphere = air_.atmosphere();
    const double cosine = air_.matter()[kind].rayleigh
                              ? sky::draw_rayleigh(random)
                              : sky::draw_aerosol(atmosphere.aerosol_phase, air_.drawn_asymmetry(), random);
    return sky::turned(old, cosine, random);
  }

  const ReferenceAir& air_;
  PathShells shells_;
  dvec3 sun_;
  dvec3 sunset_{0.0};
  double sunset_asymmetry_ = kSunsetAsymmetry;
  double towards_sun_ = kTowardsSun;
  double little_ = kLittle;
  bool narrow_ = false;  ///< by day: positions are also drawn by how the scattering falls along a piece
  PathTracingOptions options_;
  std::vector<std::size_t> scatterers_;
  std::vector<double> guess_;
};

constexpr std::size_t kParts = 128;  ///< of the paths, whose differences give the standard errors

/// `start(random, weight)` returns a path's first point.
template <class Start>
TracedLight run(const MonteCarlo& tracer, std::size_t wavelengths, const PathTracingOptions& options,
                const Start& start) {
  std::array<Spectrum, kParts> means{};
  const std::int64_t paths = std::max<std::int64_t>(1, options.paths / static_cast<std::int64_t>(kParts));
  const jobs::Placement placement = jobs::Placement::arena;
  jobs::run_tiles(kParts, placement, jobs::worker_count(placement), {}, [&](std::size_t part, std::size_t) {
    MonteCarlo::Scratch scratch;
    for (std::int64_t path = 0; path < paths; ++path) {
      PathRandom random(options.seed,
                        static_cast<std::uint64_t>(part) * 0x100000000U + static_cast<std::uint64_t>(path));
      double weight = 1.0;
      const PathPoint point = start(random, weight);
      if (weight > 0.0) tracer.trace(point, weight, random, scratch, means[part]);
    }
    for (double& value : means[part]) value /= static_cast<double>(paths);
  });
  TracedLight light;
  for (std::size_t i = 0; i < wavelengths; ++i) {
    double sum = 0.0;
    double squares = 0.0;
    for (const Spectrum& mean : means) sum += mean[i];
    for (const Spectrum& mean : means) squares += (mean[i] - sum / kParts) * (mean[i] - sum / kParts);
    light.value.push_back(sum / kParts);
    light.standard_error.push_back(std::sqrt(squares / (kParts * (kParts - 1.0))));
  }
  return light;
}

}  // namespace

TracedLight trace_sky_radiance(const Atmosphere& atmosphere, double altitude_m, const glm::dvec3& direction,
                               const glm::dvec3& sun, const PathTracingOptions& options) {
  const ReferenceAir air(atmosphere);
  const MonteCarlo tracer(air, sun, options);
  const PathPoint point{air.square_of(altitude_m), {0.0, 1.0, 0.0}, direction};
  return run(tracer, air.wavelengths(), options, [&](PathRandom&, double&) { return point; });
}

TracedLight trace_sky_irradiance(const Atmosphere& atmosphere, double altitude_m, const glm::dvec3& sun,
                                 const PathTracingOptions& options) {
  const ReferenceAir air(atmosphere);
  const MonteCarlo tracer(air, sun, options);
  return run(tracer, air.wavelengths(), options, [&](PathRandom& random, double& weight) {
    PathPoint point{air.square_of(altitude_m), {0.0, 1.0, 0.0}, {}};
    weight = tracer.draw_from_sky(point.direction, random);
    return point;
  });
}

}  // namespace welkin
