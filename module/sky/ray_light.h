// Light scattered again in the air, over height, direction and sun.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "platform/memory.h"
#include "sky/air.h"
#include "sky/ray_nodes.h"
#include "sky/sky_kernels.h"
#include "sky/sunlight.h"
#include "sky/table_mapping.h"

namespace welkin::sky {

/// Nodes of a source. Heights and suns as in tables; zenith angles and angles between direction and sun evenly from 0
/// to 180 degrees. All at least 2. Heights of air that lies low in a thick shell are bent: y of the tables' x becomes
/// (1 + b) y / (y + b), such that the second node lies no higher than four scale heights.
struct SourceShape {
  int heights = 32;
  int zeniths = 33;
  int angles = 25;
  int suns = 48;             ///< a multiple of 16
  int azimuths = 16;         ///< of half the circle, from which light is gathered
  bool narrow = false;       ///< the aerosol's lobe: its light is held relative to a glow
  double height_bend = 0.0;  ///< b; 0: not bent

  /// Returns texels over angles and suns.
  [[nodiscard]] std::size_t image() const noexcept {
    return static_cast<std::size_t>(angles) * static_cast<std::size_t>(suns);
  }
  /// Returns fine steps of suns, padded to a multiple of 16.
  [[nodiscard]] std::size_t sun_steps() const noexcept {
    return (static_cast<std::size_t>((suns - 1) * kSunSteps + 1) + 15) / 16 * 16;
  }
  /// Returns floats of the aerosol's source.
  [[nodiscard]] std::size_t size() const noexcept {
    return static_cast<std::size_t>(heights) * static_cast<std::size_t>(zeniths) * 4 * image();
  }
  /// Returns floats of the molecules' source at one height.
  [[nodiscard]] std::size_t molecule_row() const noexcept {
    return static_cast<std::size_t>(kMoleculeTerms) * 4 * static_cast<std::size_t>(suns);
  }
};

/// Distribution about the sun of light that a narrow lobe has deflected more than once, in the solver's bands. It falls
/// off from the sun's direction about as fast as that light, which nodes 6 to 7 degrees apart do not resolve. Sources
/// of the aerosol are held relative to it.
class Glow {
 public:
  Glow() = default;
  /// Takes one spectrum for all channels, or one per channel (`phase_spectra`).
  explicit Glow(const std::vector<PhaseSpectrum>& spectra);

  [[nodiscard]] bool any() const noexcept { return !values_.empty(); }
  [[nodiscard]] double at(std::size_t channel, double cosine) const noexcept;

 private:
  std::vector<std::vector<double>> values_;  ///< over evenly spaced angles
};

/// Radiance arriving from everywhere, folded with a phase function: what a unit of scattering sends in a direction.
struct ScatteringSource {
  SourceShape shape;
  Glow glow;  ///< the aerosol's is relative to it, if there is any
  /// Bands 0 and 2, all that their phase function has, of every direction: [heights][kMoleculeTerms][suns][4].
  std::vector<float> rayleigh;
  std::vector<float> aerosol;  ///< [heights][zeniths][angles][suns][4]; empty: nothing but molecules scatters

  /// Mean over all directions and channels: [heights][suns].
  std::vector<double> brightness;
  /// `brightness` resampled between suns (`resample_log_cubic`): [heights][sun_steps()]. Lookups between suns
  /// interpolate the source relative to it, which changes little where light falls by decades.
  std::vector<float> steps;

  explicit ScatteringSource(const SourceShape& nodes, bool with_aerosol)
      : shape(nodes),
        rayleigh(static_cast<std::size_t>(nodes.heights) * nodes.molecule_row()),
        aerosol(with_aerosol ? nodes.size() : 0),
        brightness(static_cast<std::size_t>(nodes.heights) * static_cast<std::size_t>(nodes.suns)) {}

  /// `steps` of the brightness.
  void set_steps();
};

[[nodiscard]] SunAxis sun_axis(const TableMapping& mapping, int nodes) noexcept;

/// Returns metres above the ground of a node of heights.
[[nodiscard]] double source_altitude(const TableMapping& mapping, const SourceShape& shape, std::size_t node) noexcept;
/// Returns the position among a source's heights, 0 to heights - 1, for a tables' coordinate of heights.
[[nodiscard]] double source_height(const SourceShape& shape, double height_coordinate) noexcept;

// Light gathered along one ray for many suns: scratch of one worker.

/// Coefficients of an atmosphere at three wavelengths, which are computed together.
struct WavelengthGroup {
  Extinctions extinctions{};
  std::array<double, 3> rayleigh{};      ///< scattering, 1/m
  std::array<double, 3> aerosol{};       ///< scattering, 1/m, without the part that goes straight on
  std::array<double, 3> aerosol_once{};  ///< all of the scattering, for the first order
  std::array<double, 3> asymmetry{};     ///< g of the aerosol
  std::array<double, 3> albedo{};
  std::array<double, 3> solar{};
};

/// Returns wavelengths 3 `group` and the next two, the last one repeated beyond the end. A wavelength's fraction
/// `forward` of what the aerosol scatters (`forward_shares`; none: 0) counts neither as scattered nor as extinction.
[[nodiscard]] WavelengthGroup wavelength_group(const AirModel& air, std::size_t group, std::span<const double> forward);

/// Scattering along a stretch of a ray over which light is nearly the same: one sample at the centroid of the
/// scattering, exact for sources that vary linearly along it. It depends on no sun, and is kept from order to order.
struct ScatteringPanel {
  float start_ratio, distance_ratio;  ///< as a sample's (sky_kernels.h)
  float view_cosine;
  std::int32_t height, zenith;  ///< of a source's nodes, the one below
  float height_fraction, zenith_fraction;
  bool scatters[2];     ///< whether molecules and aerosol do
  float weights[2][3];  ///< of molecules and aerosol, at each wavelength
};

class RayLight {
 public:
  /// For `count` suns of a ray, and sources of that shape.
  RayLight(const AirModel& air, const SourceShape& shape, std::size_t count);

  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  /// Sets the sun's zenith cosine at the ray's start, and its cosine with the ray.
  void set_sun(std::size_t i, double zenith_cosine, double angle_cosine) noexcept {
    zenith_cosine_.data()[i] = static_cast<float>(zenith_cosine);
    angle_cosine_.data()[i] = static_cast<float>(angle_cosine);
  }
  [[nodiscard]] double angle_cosine(std::size_t i) const noexcept {
    return static_cast<double>(angle_cosine_.data()[i]);
  }

  /// Places samples along a ray, to which the functions below refer.
  void place(const AirModel& air, const Ray& ray, const WavelengthGroup& group) noexcept;

  /// Returns sunlight scattered once, without phase functions, coefficients and irradiance: metres. [count][8]: three
  /// channels of the molecules', one unused, three of the aerosol's, one unused.
  const float* sunlight(const SolverKernels& kernels, const AirModel& air, const Sunlight& light) noexcept;

  /// Returns the ray's samples of light that was scattered before, in the ray's direction. Valid until the next call.
  std::span<const ScatteringPanel> panels(const AirModel& air, const WavelengthGroup& group, const SourceShape& shape,
                                          const TableMapping& mapping) noexcept;

  /// Light of a source, [count][4] each: all of it, or that of molecules and aerosol apart where a glow is seen in the
  /// aerosol's.
  struct Scattered {
    const float* light;
    const float* aerosol;  ///< null: in the other
  };
  Scattered scattered(const SolverKernels& kernels, std::span<const ScatteringPanel> panels,
                      const ScatteringSource& source, const SunAxis& axis) noexcept;

 private:
  [[nodiscard]] SkySuns suns() const noexcept;
  void fold_pairs(float* sums) const noexcept;
  [[nodiscard]] std::size_t nodes_of_panel(const AirModel& air, const SourceShape& shape, const TableMapping& mapping,
                                           std::size_t first) const noexcept;
  void multiply_glow(const Glow& glow, float* light) const noexcept;

  std::size_t count_;
  std::size_t padded_;
  RayNodes nodes_;
  Ray ray_{};
  std::vector<ScatteringPanel> panels_;
  platform::AlignedBuffer<float> zenith_cosine_;
  platform::AlignedBuffer<float> angle_cosine_;
  platform::AlignedBuffer<std::int32_t> row_;
  platform::AlignedBuffer<float> row_fraction_;
  platform::AlignedBuffer<float> sums_;     ///< [padded][12]
  platform::AlignedBuffer<float> scratch_;  ///< a slice or an image
};

}  // namespace welkin::sky
