// What `welkin sh` found, before it is put into words or JSON.
#pragma once

#include <string>

#include "welkin/babylon.h"
#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::tool {

/// Where the light came from.
struct Source {
  std::string path;
  std::string layout;
  int width = 0;
  int height = 0;
  std::string format;
  std::string detail;  ///< what a person may want to know besides: channel type, compression, what told the layout
};

struct ShReport {
  Source source;
  ProjectionOptions options;
  Projection projection;
  SphericalHarmonics irradiance;
  BabylonPolynomial polynomial;
  int threads = 1;
};

[[nodiscard]] const char* quadrature_name(Quadrature quadrature) noexcept;

[[nodiscard]] std::string sh_json(const ShReport& report);
[[nodiscard]] std::string sh_table(const ShReport& report);

}  // namespace welkin::tool
