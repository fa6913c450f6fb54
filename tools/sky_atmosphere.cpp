#include "tools/sky_atmosphere.h"

#include "tools/atmosphere_file.h"
#include "tools/options.h"
#include "welkin/error.h"

namespace welkin::tool {
namespace {

// What the eye sees: 15 wavelengths, five times three. The red end that is left out holds less than 1 % of luminance.
constexpr double kShortest = 400.0;
constexpr double kStep = 20.0;
constexpr int kSamples = 15;

std::vector<double> visible_spectrum() {
  std::vector<double> wavelengths;
  wavelengths.reserve(kSamples);
  for (int i = 0; i < kSamples; ++i) wavelengths.push_back(kShortest + kStep * i);
  return wavelengths;
}

bool is_earth(AtmospherePreset preset) {
  return preset == AtmospherePreset::earth || preset == AtmospherePreset::no_aerosol;
}

Atmosphere earth_of(const AtmosphereChoice& choice, SkyColour colour) {
  if (!choice.wavelengths_nm.empty()) return earth(choice.wavelengths_nm);
  return colour == SkyColour::linear_srgb ? earth(visible_spectrum()) : earth();
}

Atmosphere atmosphere_before_changes(const AtmosphereChoice& choice, SkyColour colour) {
  if (choice.file) return read_atmosphere(*choice.file);
  switch (choice.preset) {
    case AtmospherePreset::earth_hillaire: return earth_hillaire();
    case AtmospherePreset::mars: return mars();
    case AtmospherePreset::no_aerosol: return without_aerosol(earth_of(choice, colour));
    case AtmospherePreset::earth: break;
  }
  return earth_of(choice, colour);
}

}  // namespace

void add_atmosphere_options(CLI::App& command, AtmosphereChoice& choice) {
  CLI::Option* preset = add_choice<AtmospherePreset>(
      command, "--preset", choice.preset,
      {{"earth", AtmospherePreset::earth},
       {"earth-hillaire", AtmospherePreset::earth_hillaire},
       {"mars", AtmospherePreset::mars},
       {"no-aerosol", AtmospherePreset::no_aerosol}},
      "Whose air: earth (default; the constants of Bruneton 2017), earth-hillaire (those of Hillaire 2020), mars, "
      "no-aerosol (earth with nothing but gases)");
  command
      .add_option("--atmosphere", choice.file,
                  "Air from a JSON file, such as --print-atmosphere writes; every number is checked")
      ->type_name("FILE")
      ->excludes(preset);
  command
      .add_option("--wavelengths", choice.wavelengths_nm,
                  "Of earth and no-aerosol: wavelengths in nm, commas between them; three for r, g and b (default "
                  "680,550,440), with --colour srgb 3 to 96 (default 400 to 680 by 20)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("LIST");
  command
      .add_option("--ground-albedo", choice.ground_albedo,
                  "How much light the ground reflects, 0 to 1; default: as the air's preset has it, earth 0.1")
      ->check(finite_between(0.0, 1.0))
      ->type_name("A");
}

Atmosphere chosen_atmosphere(const AtmosphereChoice& choice, SkyColour colour) {
  if (!choice.wavelengths_nm.empty() && (choice.file || !is_earth(choice.preset))) {
    throw Error(ErrorCode::invalid_argument,
                "--wavelengths is for the presets earth and no-aerosol; the others and files have their own");
  }
  Atmosphere atmosphere = atmosphere_before_changes(choice, colour);
  if (choice.ground_albedo) atmosphere = with_ground_albedo(std::move(atmosphere), *choice.ground_albedo);
  check(atmosphere);
  const std::size_t wavelengths = atmosphere.wavelengths_nm.size();
  if (colour == SkyColour::spectral && wavelengths != 3) {
    throw Error(ErrorCode::invalid_argument,
                std::to_string(wavelengths) +
                    " wavelengths make no red, green and blue of their own; give three, or --colour srgb, which "
                    "folds them to colours");
  }
  return atmosphere;
}

const char* name(SkyColour colour) noexcept { return colour == SkyColour::spectral ? "spectral" : "srgb"; }

}  // namespace welkin::tool
