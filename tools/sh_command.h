// The results of `welkin sh`, before they are printed as text, JSON or C.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tools/arguments.h"
#include "tools/input.h"
#include "tools/sky_model.h"
#include "welkin/engines.h"
#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::tool {

struct ShReport {
  Source source;
  ProjectionOptions options;
  Projection projection;           ///< its radiance is in the axes below, after the window
  std::string axes;                ///< the axes of directions and coefficients, for a person
  Engine engine = Engine::welkin;  ///< the engine that has these axes

  Window window = Window::none;
  WindowResult windowed;  ///< the window's effect; minima also without a window

  std::optional<SkyReport> sky;  ///< of a computed one

  bool sun_wanted = false;
  std::optional<Sun> sun;                 ///< extracted, or never in the pixels; none if there is none
  std::optional<DominantLight> dominant;  ///< of the remaining light, before the window
  std::optional<EngineLight> engine_light;
  std::vector<EngineLight> engine_lights;          ///< if requested, of every engine with a form, in its own axes
  std::vector<IrradianceError> irradiance_errors;  ///< if requested, by number of bands

  SphericalHarmonics irradiance;
  BabylonPolynomial polynomial;
  int threads = 1;
};

/// Returns the harmonics' quadrature: how texels are integrated, or the directions along which a sky is evaluated.
[[nodiscard]] const char* quadrature_name(const ShReport& report) noexcept;

// The forms.
using ShFormat = std::string (*)(const ShReport& report);
[[nodiscard]] std::string sh_json(const ShReport& report);
[[nodiscard]] std::string sh_table(const ShReport& report);
[[nodiscard]] std::string sh_text(const ShReport& report);      ///< one line per coefficient, # before remarks
[[nodiscard]] std::string sh_c_header(const ShReport& report);  ///< arrays of float, for an #include
[[nodiscard]] std::string sh_glsl(const ShReport& report);      ///< nine vec3 and the function that evaluates them
/// Returns a class with a SphericalHarmonicsL2 for Unity. Throws `Error` (invalid_argument) without Unity's form.
[[nodiscard]] std::string sh_c_sharp(const ShReport& report);

struct ShOptions {
  CommonOptions common;
  std::optional<std::string> input;  ///< none: the built-in sky
  bool sky = false;                  ///< `--sky`; the command needs either this or an input
  ShFormat format = sh_table;
  ProjectionOptions projection;
  int target_size = 0;  ///< 0: none
  ClampChoice clamp;
  OrientationOptions orientation;
  SunChoice sun;
  Window window = Window::none;
  double window_width = 0.0;
  bool irradiance_error = false;
};

/// Adds --format and --json.
void add_format_options(Options& table, ShOptions& options);
void add_bands_option(Options& table, ShOptions& options);
/// Adds --window and --window-width.
void add_window_options(Options& table, ShOptions& options);

/// Transforms `report.projection.radiance` and the sun from the source's axes to the result's, and adds the members
/// that depend on them and on the options: window, dominant light, irradiance, the forms of engines.
void complete(ShReport& report, const ShOptions& options, bool is_of_cubemap);

}  // namespace welkin::tool
