// Which air: a preset, or a file; and what is changed of it.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "welkin/atmosphere.h"

namespace welkin::tool {

enum class AtmospherePreset { earth, earth_hillaire, mars, no_aerosol };

struct AtmosphereChoice {
  AtmospherePreset preset = AtmospherePreset::earth;
  std::optional<std::string> file;
  std::vector<double> wavelengths_nm;  ///< none: the preset's; folded to colours, Earth's are a spectrum
  std::optional<double> ground_albedo;
};

/// --preset, --atmosphere, --wavelengths, --ground-albedo.
void add_atmosphere_options(CLI::App& command, AtmosphereChoice& choice);

/// Throws `Error` as `read_atmosphere` and `check`, and invalid_argument for wavelengths of an atmosphere that has but
/// its own.
[[nodiscard]] Atmosphere chosen_atmosphere(const AtmosphereChoice& choice, SkyColour colour);

/// "spectral", "srgb".
[[nodiscard]] const char* name(SkyColour colour) noexcept;

}  // namespace welkin::tool
