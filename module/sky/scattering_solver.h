// Light scattered many times: the source that each order leaves for the next.
//
// At every node of height and sun, the radiance that the order before sends from a few hundred directions, and what the
// ground reflects of the order before that, is projected to spherical harmonics about the vertical, in which folding
// with a phase function is a product: no integral over directions for each direction. The source so found, over height,
// direction and sun, is integrated along the rays of those few hundred directions for the next order; tables get the
// sum of all sources at once.
//
// The light of further orders is estimated unless the caller declines: two more orders, or as many as it takes for the
// ratio of two to settle, and after the last of them the sum of a geometric series for each height, wavelength and sun
// (`sums_of_series`).
#pragma once

#include <array>
#include <vector>

#include "sky/air.h"
#include "sky/ray_light.h"
#include "sky/sky_geometry.h"
#include "welkin/core.h"

namespace welkin::sky {

/// Nodes of the aerosol's source over the angle between direction and sun. A node that no direction at its zenith angle
/// reaches holds what interpolation between zenith angles, angles and suns needs: the light at the nearest angle that a
/// direction reaches, extrapolated by its change up to there from an angle as far inside as the node lies outside.
struct SourceNodes {
  std::vector<float> azimuths;      ///< cos phi of the node or the nearest
  std::vector<float> inside;        ///< ... and of the one inside; with `slopes`
  std::vector<float> slopes;        ///< steps by which the node lies beyond; 0 of a node that directions reach
  std::vector<float> inverse_glow;  ///< [nodes][2][3] of both; empty: no glow
};

class SourceSolver {
 public:
  struct Options {
    int orders = 4;
    double convergence_threshold = 0.0;
    bool rest = false;  ///< further orders are estimated, if there is more than one
  };

  /// `air`, `mapping` and `light` must outlive it.
  SourceSolver(const AirModel& air, const TableMapping& mapping, const Sunlight& light, const WavelengthGroup& group,
               const SourceShape& shape);

  /// Returns the bytes that a solver needs, the sources included.
  [[nodiscard]] static std::uint64_t bytes(const SourceShape& shape, bool with_aerosol) noexcept;

  /// Throws `Error` (cancelled).
  void solve(const Options& options, const Control& control);

  /// Returns the sum of the sources of orders 2 and up.
  [[nodiscard]] const ScatteringSource& source() const noexcept { return total_; }
  [[nodiscard]] bool any() const noexcept { return orders_ > 1; }
  /// Returns the irradiance on a horizontal surface facing up by all orders: [heights][3][suns].
  [[nodiscard]] const std::vector<double>& irradiance() const noexcept { return irradiance_; }
  [[nodiscard]] int orders() const noexcept { return orders_; }
  [[nodiscard]] double last_change() const noexcept { return last_change_; }
  /// Returns the possible error of the estimate of further orders, as a fraction of all light; 0 without an estimate.
  [[nodiscard]] double doubt() const noexcept { return doubt_; }

 private:
  struct Worker;
  [[nodiscard]] std::size_t radiance_index(std::size_t height, std::size_t zenith, std::size_t channel) const noexcept;
  void set_rules();
  void set_source_nodes();
  void add_source_node(double zenith, std::size_t sun, double angle);
  void set_azimuths(int count);
  void next_source(const Control& control);
  void add_order(const std::vector<double>& factors, const std::vector<double>& irradiance_factors);
  [[nodiscard]] std::vector<double> sums_of_series(const std::vector<double>& before,
                                                   const std::vector<double>& last) const;
  void set_lobe_scale(std::size_t lobe);
  [[nodiscard]] double aerosol_phase(std::size_t lobe, double cosine) const noexcept;
  void follow_less(int order);
  void march(bool single, const Control& control);
  void march_ray(bool single, std::size_t height, std::size_t zenith, Worker& worker);
  void add_sunlit(std::size_t height, std::size_t zenith, Worker& worker);
  void add_scattered(std::size_t height, std::size_t zenith, const Ray& ray, Worker& worker);
  void gather(const Control& control);
  void project(std::size_t height, std::size_t first_sun, Worker& worker);
  void measure();
  void measure_at(std::size_t height);
  void add_order_at(std::size_t height, const std::vector<double>& factors, const float* row);
  void add_ground(std::size_t height, std::size_t zenith, std::size_t first_sun, Worker& worker) const;
  void multiply_lobes(Worker& worker) const;
  void fold(std::size_t height, std::size_t first_sun, Worker& worker);
  void fold_molecules(std::size_t height, std::size_t first_sun, const Worker& worker);
  void go_on_outside(const float* inside, std::size_t first, float* texels) const;
  [[nodiscard]] std::array<double, 3> ground_light(double sun_zenith_cosine) const noexcept;
  [[nodiscard]] std::array<double, 3> scattered() const noexcept;

  const AirModel& air_;
  const TableMapping& mapping_;
  const Sunlight& light_;
  WavelengthGroup group_;
  SourceShape shape_;
  std::size_t azimuths_;                ///< of the order in hand
  std::vector<PhaseSpectrum> spectra_;  ///< one, or one of each wavelength where their lobes differ
  int bands_;                           ///< of all of them
  std::vector<double> ones_;            ///< as many
  bool with_aerosol_;

  std::vector<DirectionRule> rules_;  ///< [heights]
  std::vector<double> sun_cosines_;   ///< [suns]
  std::vector<double> sun_sines_;
  std::vector<double> legendre_;                             ///< of the rules: [heights][zeniths][pairs of l and m]
  std::vector<double> source_legendre_;                      ///< of the source's zeniths
  std::vector<float> azimuth_cosines_;                       ///< of the rules: [bands][azimuths], cos(m phi)
  std::vector<double> ray_azimuths_;                         ///< cos phi
  SourceNodes source_nodes_;                                 ///< [zeniths][angles][suns]
  std::vector<double> aerosol_phase_;                        ///< over evenly spaced angles: [spectra][nodes]
  std::vector<double> lobe_scale_;                           ///< of it: [spectra][heights][suns]
  std::vector<std::array<double, 3>> ground_transmittance_;  ///< [heights][ground nodes]
  std::vector<double> ground_distance_;

  std::vector<std::size_t> heights_;   ///< all of them
  std::vector<std::size_t> followed_;  ///< those at which the order in hand is computed
  std::vector<std::size_t> skipped_;   ///< ... and those that have it by interpolation

  SunAxis axis_;                          ///< of the source
  std::vector<ScatteringPanel> panels_;   ///< of rays that have few enough: [heights][zeniths][kKeptPanels]
  std::vector<std::size_t> panel_count_;  ///< [heights][zeniths]; beyond kKeptPanels they are recomputed

  std::vector<float> radiance_;  ///< of the last order: [heights][zeniths][3][azimuths][suns]
  ScatteringSource source_;
  ScatteringSource total_;
  std::vector<double> scalar_;  ///< mean radiance of the last order: [heights][3][suns]
  std::vector<double> order_irradiance_;
  std::vector<double> irradiance_;
  std::array<std::vector<float>, 3>
      ground_before_;          ///< irradiance of the ground by the order before the last, in steps
  bool direct_ground_ = true;  ///< ... or by the sun
  int orders_ = 0;
  double last_change_ = 0.0;
  double doubt_ = 0.0;
};

}  // namespace welkin::sky
