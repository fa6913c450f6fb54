// What `welkin sh` found, before it is put into words, JSON or C.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/input.h"
#include "tools/sky_model.h"
#include "welkin/engines.h"
#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::tool {

struct ShReport {
  Source source;
  ProjectionOptions options;
  Projection projection;           ///< its radiance in the axes below, after the window
  std::string axes;                ///< which axes directions and coefficients are in, for a person
  Engine engine = Engine::welkin;  ///< whose axes they are

  Window window = Window::none;
  Windowed windowed;  ///< what the window did; minima also where there is none

  std::optional<SkyReport> sky;  ///< of a computed one

  bool sun_wanted = false;
  std::optional<Sun> sun;                 ///< that was taken out or never in, if there is one
  std::optional<DominantLight> dominant;  ///< of what is left, before the window
  std::optional<EngineLight> engine_light;
  std::vector<EngineLight> engine_lights;          ///< of every engine that has a form, each in its own axes, if wanted
  std::vector<IrradianceError> irradiance_errors;  ///< by number of bands, if they were asked for

  SphericalHarmonics irradiance;
  BabylonPolynomial polynomial;
  int threads = 1;
};

/// Of the harmonics: how texels are integrated, or along which directions a sky is looked at.
[[nodiscard]] const char* quadrature_name(const ShReport& report) noexcept;

[[nodiscard]] std::string sh_json(const ShReport& report);
[[nodiscard]] std::string sh_table(const ShReport& report);
[[nodiscard]] std::string sh_text(const ShReport& report);      ///< a line a coefficient, # before remarks
[[nodiscard]] std::string sh_c_header(const ShReport& report);  ///< arrays of float, for an #include
[[nodiscard]] std::string sh_glsl(const ShReport& report);      ///< nine vec3 and the function that evaluates them
/// A class with a SphericalHarmonicsL2 for Unity, whose form the report must have.
[[nodiscard]] std::string sh_c_sharp(const ShReport& report);

}  // namespace welkin::tool
