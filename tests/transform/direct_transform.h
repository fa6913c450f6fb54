// The spherical harmonic transform by its definition, in double: slow, and sharing no table with the fast one.
#pragma once

#include "math/quadrature.h"
#include "support/catch.h"
#include "transform/spectrum.h"
#include "welkin/image.h"

namespace welkin::test {

using Coefficients = std::vector<std::complex<double>>;  ///< [l (l + 1) / 2 + m][channel]

inline std::size_t coefficient(int l, int m, int channel) {
  return static_cast<std::size_t>(3 * (l * (l + 1) / 2 + m) + channel);
}

/// P(l, m) of one angle for all l < bands, orthonormal, without Condon-Shortley phase, 0 below m: the unscaled
/// recurrence, upwards in l, in double.
inline std::vector<double> legendre_column(int m, int bands, double theta) {
  std::vector<double> column(static_cast<std::size_t>(bands), 0.0);
  double here = std::sqrt(0.25 / std::numbers::pi);
  for (int k = 1; k <= m; ++k) here *= std::sin(theta) * std::sqrt((2.0 * k + 1.0) / (2.0 * k));
  double before = 0.0;
  const double square = static_cast<double>(m) * m;
  for (int l = m; l < bands; ++l) {
    column[static_cast<std::size_t>(l)] = here;
    const double next_square = (l + 1.0) * (l + 1.0);
    const double a = std::sqrt((4.0 * next_square - 1.0) / (next_square - square));
    const double b = l > m ? std::sqrt((2.0 * l + 3.0) * (static_cast<double>(l) * l - square) /
                                       ((2.0 * l - 1.0) * (next_square - square)))
                           : 0.0;
    const double next = a * std::cos(theta) * here - b * before;
    before = here;
    here = next;
  }
  return column;
}

/// Int P(l, m) sin(theta) over rows, [l (l + 1) / 2 + m][row].
inline std::vector<double> row_integrals(int rows, int bands) {
  std::vector<double> integrals(static_cast<std::size_t>(bands * (bands + 1) / 2 * rows));
  const math::GaussRule rule = math::gauss_legendre(12);
  const int parts = 1 + bands / (2 * rows);  // few waves in each
  for (int row = 0; row < rows; ++row) {
    for (int part = 0; part < parts; ++part) {
      for (int k = 0; k < rule.order; ++k) {
        const double at = row + (part + 0.5 + 0.5 * rule.nodes[k]) / parts;
        const double theta = std::numbers::pi * at / rows;
        const double weight = rule.weights[k] * 0.5 * std::numbers::pi / (rows * parts) * std::sin(theta);
        for (int m = 0; m < bands; ++m) {
          const std::vector<double> functions = legendre_column(m, bands, theta);
          for (int l = m; l < bands; ++l) {
            integrals[static_cast<std::size_t>((l * (l + 1) / 2 + m) * rows + row)] +=
                weight * functions[static_cast<std::size_t>(l)];
          }
        }
      }
    }
  }
  return integrals;
}

/// c(l, m) of texels taken as areas.
inline Coefficients direct_analysis(const LatLongImage& image, int bands) {
  const std::vector<double> integrals = row_integrals(image.height, bands);
  Coefficients result(coefficient(bands, 0, 0));
  const double step = 2.0 * std::numbers::pi / image.width;
  std::vector<std::complex<double>> waves(static_cast<std::size_t>(image.width));
  for (int m = 0; m < bands; ++m) {
    for (int column = 0; column < image.width; ++column) {
      const double longitude = std::numbers::pi - (column + 0.5) * step;
      waves[static_cast<std::size_t>(column)] =
          std::polar(m == 0 ? step : 2.0 * std::sin(0.5 * m * step) / m, -m * longitude);
    }
    for (int row = 0; row < image.height; ++row) {
      for (int channel = 0; channel < 3; ++channel) {
        std::complex<double> sum = 0.0;
        for (int column = 0; column < image.width; ++column) {
          const float value = image.pixels[static_cast<std::size_t>(3 * (row * image.width + column) + channel)];
          sum += static_cast<double>(value) * waves[static_cast<std::size_t>(column)];
        }
        for (int l = m; l < bands; ++l) {
          result[coefficient(l, m, channel)] +=
              sum * integrals[static_cast<std::size_t>((l * (l + 1) / 2 + m) * image.height + row)];
        }
      }
    }
  }
  return result;
}

/// f of one channel at a direction.
inline double direct_value(const Coefficients& c, const std::vector<double>& zonal, int channel, double theta,
                           double longitude) {
  double sum = 0.0;
  const int bands = static_cast<int>(zonal.size());
  for (int m = 0; m < bands; ++m) {
    const std::vector<double> functions = legendre_column(m, bands, theta);
    std::complex<double> order = 0.0;
    for (int l = m; l < bands; ++l) {
      const auto degree = static_cast<std::size_t>(l);
      order += zonal[degree] * functions[degree] * c[coefficient(l, m, channel)];
    }
    sum += (m > 0 ? 2.0 : 1.0) * (order * std::polar(1.0, m * longitude)).real();
  }
  return sum;
}

inline Coefficients coefficients_of(const transforms::Spectrum& spectrum) {
  Coefficients result(coefficient(spectrum.bands(), 0, 0));
  for (int l = 0; l < spectrum.bands(); ++l) {
    for (int m = 0; m <= l; ++m) {
      for (int channel = 0; channel < 3; ++channel) result[coefficient(l, m, channel)] = spectrum.value(l, m, channel);
    }
  }
  return result;
}

inline double largest(const Coefficients& c) {
  double most = 0.0;
  for (const std::complex<double>& value : c) most = std::max(most, std::abs(value));
  return most;
}

inline double largest_difference(const Coefficients& a, const Coefficients& b) {
  double most = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) most = std::max(most, std::abs(a[k] - b[k]));
  return most;
}

}  // namespace welkin::test
