// Light gathered along one ray for many suns: scratch of one worker.
#pragma once

#include <array>
#include <vector>

#include "simd/kernels.h"
#include "sky/air.h"
#include "sky/ray_nodes.h"
#include "sky/scattering_source.h"
#include "sky/sunlight.h"
#include "tables/aligned_buffer.h"

namespace welkin::sky {

/// What an atmosphere does to light of three wavelengths, computed together.
struct WavelengthGroup {
  Extinctions extinctions{};
  std::array<double, 3> rayleigh{};  ///< scattering, 1/m
  std::array<double, 3> aerosol{};
  std::array<double, 3> albedo{};
  std::array<double, 3> solar{};
};

/// Wavelengths 3 `group` and the next two; beyond the last: the last again.
[[nodiscard]] WavelengthGroup wavelength_group(const Air& air, std::size_t group);

class RayLight {
 public:
  /// For `count` suns of a ray, and sources of that shape.
  RayLight(const Air& air, const SourceShape& shape, std::size_t count);

  [[nodiscard]] std::size_t count() const noexcept { return count_; }
  /// The sun's zenith cosine at the ray's start, and its cosine with the ray.
  void set_sun(std::size_t i, double zenith_cosine, double angle_cosine) noexcept {
    zenith_cosine_.data()[i] = static_cast<float>(zenith_cosine);
    angle_cosine_.data()[i] = static_cast<float>(angle_cosine);
  }
  [[nodiscard]] double angle_cosine(std::size_t i) const noexcept {
    return static_cast<double>(angle_cosine_.data()[i]);
  }

  /// Places samples along a ray; what follows is about it.
  void place(const Air& air, const Ray& ray, const WavelengthGroup& group, double coarseness = 1.0) noexcept;

  /// Sunlight scattered once, without phase functions, coefficients and irradiance: metres. [count][8]: three channels
  /// of the molecules', a place left out, three of the aerosol's, another.
  const float* sunlight(const simd::Kernels& kernels, const Air& air, const Sunlight& light) noexcept;

  /// Light of a source: [count][4].
  const float* scattered(const simd::Kernels& kernels, const Air& air, const WavelengthGroup& group,
                         const ScatteringSource& source, const TableMapping& mapping) noexcept;

 private:
  [[nodiscard]] simd::SkySuns suns() const noexcept;

  std::size_t count_;
  std::size_t padded_;
  RayNodes nodes_;
  Ray ray_{};
  tables::AlignedBuffer<float> zenith_cosine_;
  tables::AlignedBuffer<float> angle_cosine_;
  tables::AlignedBuffer<std::int32_t> row_;
  tables::AlignedBuffer<float> row_fraction_;
  tables::AlignedBuffer<float> sums_;     ///< [padded][8]
  tables::AlignedBuffer<float> scratch_;  ///< a slice or a picture
};

}  // namespace welkin::sky
