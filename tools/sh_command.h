// What `welkin sh` found, before it is put into words, JSON or C.
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
  Projection projection;           ///< its radiance in the axes below, after the window
  std::string axes;                ///< which axes directions and coefficients are in, for a person
  Engine engine = Engine::welkin;  ///< whose axes they are

  Window window = Window::none;
  WindowResult windowed;  ///< what the window did; minima also where there is none

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

// The forms.
using ShFormat = std::string (*)(const ShReport& report);
[[nodiscard]] std::string sh_json(const ShReport& report);
[[nodiscard]] std::string sh_table(const ShReport& report);
[[nodiscard]] std::string sh_text(const ShReport& report);      ///< a line a coefficient, # before remarks
[[nodiscard]] std::string sh_c_header(const ShReport& report);  ///< arrays of float, for an #include
[[nodiscard]] std::string sh_glsl(const ShReport& report);      ///< nine vec3 and the function that evaluates them
/// A class with a SphericalHarmonicsL2 for Unity. Throws `Error` (invalid_argument) if the report has not its form.
[[nodiscard]] std::string sh_c_sharp(const ShReport& report);

struct ShOptions {
  CommonOptions common;
  std::optional<std::string> input;  ///< none: the built-in sky
  bool sky = false;                  ///< `--sky`; the command wants either this or an input
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

/// --format and --json.
void add_format_options(Options& table, ShOptions& options);
void add_bands_option(Options& table, ShOptions& options);
/// --window and --window-width.
void add_window_options(Options& table, ShOptions& options);

/// Takes `report.projection.radiance` and the sun from the source's axes to the result's, and fills in what follows
/// from them and from the options: window, dominant light, irradiance, the forms of engines.
void complete(ShReport& report, const ShOptions& options, bool is_of_cubemap);

}  // namespace welkin::tool
