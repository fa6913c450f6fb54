#include "tools/sky_model.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <utility>

#include "platform/text.h"
#include "tools/terminal.h"
#include "tools/text.h"
#include "welkin/bake_file.h"
#include "welkin/core.h"

namespace welkin::tool {
namespace {

const char* name(AerosolPhase phase) noexcept {
  return phase == AerosolPhase::cornette_shanks ? "cornette-shanks" : "henyey-greenstein";
}

Member layer(const char* name, DensityLayer& target) {
  return object(name, target,
                {number("thickness_m", target.thickness_m), number("exponential_term", target.exponential_term),
                 number("exponential_scale_per_m", target.exponential_scale_per_m),
                 number("linear_term_per_m", target.linear_term_per_m), number("constant_term", target.constant_term)});
}

Member constituent(const char* name, Constituent& target) {
  return object(name, target,
                {list("density", target.density, layer), numbers("scattering_per_m", target.scattering_per_m),
                 numbers("absorption_per_m", target.absorption_per_m)});
}

Member phase(const char* member, AerosolPhase& target) {
  const auto read = [&target](const Json& value, const std::string& where) {
    for (const AerosolPhase known : {AerosolPhase::cornette_shanks, AerosolPhase::henyey_greenstein}) {
      if (!value.is_text() || value.text() != name(known)) continue;
      target = known;
      return;
    }
    throw Flaw{where + R"( is neither "cornette-shanks" nor "henyey-greenstein")"};
  };
  return {member, read, [&target] { return name(target); }};
}

std::vector<Member> members_of(Atmosphere& air) {
  return {text("name", air.name),
          numbers("wavelengths_nm", air.wavelengths_nm),
          number("bottom_radius_m", air.bottom_radius_m),
          number("top_radius_m", air.top_radius_m),
          constituent("rayleigh", air.rayleigh),
          constituent("aerosol", air.aerosol),
          phase("aerosol_phase", air.aerosol_phase),
          number("aerosol_asymmetry", air.aerosol_asymmetry),
          numbers("aerosol_asymmetries", air.aerosol_asymmetries),
          list("absorbers", air.absorbers, constituent),
          numbers("ground_albedo", air.ground_albedo),
          numbers("solar_irradiance", air.solar_irradiance),
          number("sun_angular_radius_degrees", air.sun_angular_radius_degrees),
          number("night_zenith_luminance", air.night_zenith_luminance)};
}

/// Throws the errors of `chosen_atmosphere`.
Atmosphere read_atmosphere(const std::filesystem::path& path) {
  constexpr const char* kOneToBeginWith = "'welkin sky --print-atmosphere' writes one to begin with";
  try {
    Atmosphere atmosphere;
    read_object(read_json_file(path, kOneToBeginWith, kMaxJsonBytes, Pipes::read), "the atmosphere",
                members_of(atmosphere));
    check(atmosphere);
    return atmosphere;
  } catch (const Flaw& flaw) {
    throw Error(ErrorCode::corrupt_file, platform::utf8(path) + ": " + flaw.message + "; correct the file");
  } catch (const Error& error) {
    if (error.code() != ErrorCode::invalid_argument) throw;
    throw Error(ErrorCode::corrupt_file, platform::utf8(path) + ": " + error.what());
  }
}

}  // namespace

Json atmosphere_json(Atmosphere atmosphere) { return json_object(members_of(atmosphere)); }

namespace {

// The visible spectrum: 15 wavelengths, five times three. The omitted red end holds less than 1 % of luminance.
constexpr double kShortest = 400.0;
constexpr double kStep = 20.0;
constexpr int kSamples = 15;

std::vector<double> visible_spectrum() {
  std::vector<double> wavelengths;
  wavelengths.reserve(kSamples);
  for (int i = 0; i < kSamples; ++i) wavelengths.push_back(kShortest + kStep * i);
  return wavelengths;
}

std::vector<double> wavelengths_of(const AtmosphereChoice& choice, SkyColour colour) {
  if (!choice.wavelengths_nm.empty()) return choice.wavelengths_nm;
  return colour == SkyColour::linear_srgb ? visible_spectrum() : Atmosphere{}.wavelengths_nm;
}

Atmosphere atmosphere_before_changes(const AtmosphereChoice& choice, SkyColour colour) {
  if (choice.file) return read_atmosphere(platform::path_of(*choice.file));
  const std::vector<double> wavelengths = wavelengths_of(choice, colour);
  const AerosolKind kind = choice.preset.aerosol;
  switch (choice.preset.air) {
    case Air::earth: break;
    case Air::earth_without_aerosol: return without_aerosol(earth(wavelengths));
    case Air::earth_bruneton: return earth_bruneton(wavelengths);
    case Air::earth_hillaire: return earth_hillaire();
    case Air::mars: return mars();
  }
  if (!choice.aerosol_depth) return earth(wavelengths, kind);
  AerosolModel aerosol = aerosol_model(kind);
  aerosol.optical_depth = *choice.aerosol_depth;
  return with_aerosol(earth(wavelengths, kind), aerosol);
}

/// Throws for choices that a preset or file does not offer.
void check_choice(const AtmosphereChoice& choice) {
  const Air air = choice.preset.air;
  if (!choice.wavelengths_nm.empty() && (choice.file || air == Air::earth_hillaire || air == Air::mars)) {
    throw Error(ErrorCode::invalid_argument,
                "--wavelengths is for the presets earth, hazy, dusty, polluted, no-aerosol and earth-bruneton; the "
                "others and files have their own");
  }
  if (choice.aerosol_depth && (choice.file || air != Air::earth)) {
    throw Error(ErrorCode::invalid_argument,
                "--aerosol is for the presets earth, hazy, dusty and polluted; the others and files have their own");
  }
}

}  // namespace

void add_atmosphere_options(Options& table, AtmosphereChoice& choice) {
  constexpr const char* kPreset = "--preset";
  table.push_back(tool::choice<AtmospherePreset>(
      kPreset, choice.preset,
      {{"earth", {Air::earth, AerosolKind::clear}},
       {"clear", {Air::earth, AerosolKind::clear}},
       {"hazy", {Air::earth, AerosolKind::hazy}},
       {"dusty", {Air::earth, AerosolKind::dusty}},
       {"polluted", {Air::earth, AerosolKind::polluted}},
       {"no-aerosol", {Air::earth_without_aerosol}},
       {"earth-bruneton", {Air::earth_bruneton}},
       {"earth-hillaire", {Air::earth_hillaire}},
       {"mars", {Air::mars}}},
      "Whose air; default earth: earth or clear (a clear day as measured), hazy, dusty, polluted, no-aerosol (nothing "
      "but "
      "gases), earth-bruneton and earth-hillaire (the constants of Bruneton 2017 and Hillaire 2020: almost no "
      "aerosol), "
      "mars"));
  add_option(table, "--aerosol", &choice.aerosol_depth, "DEPTH",
             "The aerosol of earth, hazy, dusty and polluted: its vertical "
             "optical depth at 550 nm, 0 to 100 (a clear day has 0.05 to 0.15, a hazy one 0.3, dust 0.5 "
             "and more)",
             {.bounds = number_between(0.0, 100.0)});
  add_option(table, "--atmosphere", &choice.file, "FILE",
             "An atmosphere from a JSON file, as --print-atmosphere writes it; every number is checked",
             {.excludes = {kPreset}});
  add_option(table, "--wavelengths", &choice.wavelengths_nm, "LIST",
             "For earths but earth-hillaire: wavelengths in nm, separated by commas; three for r, g and b "
             "(default 680,550,440), with --colour srgb 3 to 96 (default 400 to 680 by 20)",
             {.list = List::commas});
  add_option(table, "--ground-albedo", &choice.ground_albedo, "A",
             "Albedo of the ground, 0 to 1; default that of the preset, earth 0.1",
             {.bounds = number_between(0.0, 1.0)});
  add_option(table, "--night", &choice.night_luminance, "CD",
             "Add the light of a night without a moon (airglow, stars): the zenith's luminance in cd/m2, 0 "
             "to 1; a dark place has 2e-4. Default: none",
             {.bounds = number_between(0.0, 1.0)});
}

Atmosphere chosen_atmosphere(const AtmosphereChoice& choice, SkyColour colour) {
  check_choice(choice);
  Atmosphere atmosphere = atmosphere_before_changes(choice, colour);
  if (choice.ground_albedo) atmosphere = with_ground_albedo(std::move(atmosphere), *choice.ground_albedo);
  if (choice.night_luminance) atmosphere.night_zenith_luminance = *choice.night_luminance;
  check(atmosphere);
  const std::size_t wavelengths = atmosphere.wavelengths_nm.size();
  if (colour == SkyColour::spectral && wavelengths != 3) {
    throw Error(ErrorCode::invalid_argument, std::to_string(wavelengths) +
                                                 " wavelengths make no red, green and blue of their own; give three, "
                                                 "or --colour srgb, which folds them to colours");
  }
  return atmosphere;
}

const char* name(SkyColour colour) noexcept { return colour == SkyColour::spectral ? "spectral" : "srgb"; }

namespace {

const char* name(ScatteringLayout layout) { return layout == ScatteringLayout::full ? "full" : "compact"; }

std::string size_text(const SkyTableOptions& tables) {
  std::string text = std::to_string(tables.heights) + " x " + std::to_string(tables.view_zeniths) + " x " +
                     std::to_string(tables.sun_zeniths);
  return tables.layout == ScatteringLayout::full ? text + " x " + std::to_string(tables.sun_angles) : text;
}

Json tables_json(const SkyReport& report) {
  const SkyTableOptions& tables = report.tables;
  return {{"layout", name(tables.layout)},
          {"heights", tables.heights},
          {"view_zeniths", tables.view_zeniths},
          {"sun_zeniths", tables.sun_zeniths},
          {"sun_angles", tables.layout == ScatteringLayout::full ? Json(tables.sun_angles) : Json(nullptr)},
          {"minimum_sun_elevation_degrees", tables.minimum_sun_elevation_degrees},
          {"orders_asked_for", tables.orders},
          {"convergence_threshold", tables.convergence_threshold},
          {"truncate_orders", tables.truncate_orders},
          {"bytes", report.table_bytes}};
}

Json quadrature_json(const SkyReport& report) {
  if (!report.quadrature) return nullptr;
  return {{"name", welkin::name(report.quadrature->quadrature)},
          {"directions", report.directions},
          {"zeniths", report.quadrature->zeniths},
          {"azimuths", report.quadrature->azimuths}};
}

std::string sun_lookup(double elevation) {
  return significant(std::abs(elevation)) + (elevation < 0.0 ? " degrees below the horizon" : " degrees up");
}

}  // namespace

std::string sky_unit(const SkyReport& report) {
  if (report.tables.colour == SkyColour::linear_srgb) return "cd/m2, linear sRGB";
  return "W/m2/sr/nm at " + listed(report.atmosphere.wavelengths_nm, [](double value) { return significant(value); }) +
         " nm";
}

Json sky_json(const SkyReport& report) {
  Json dated;
  if (report.dated) {
    const SunObserver& observer = report.dated->observer;
    dated = {{"date", report.dated->date},
             {"latitude_degrees", observer.latitude_degrees},
             {"longitude_degrees", observer.longitude_degrees},
             {"north_azimuth_degrees", observer.north_azimuth_degrees},
             {"compass_degrees", report.dated->position.compass_degrees},
             {"refraction_degrees", report.dated->position.refraction_degrees},
             {"distance_au", report.dated->position.distance_au}};
  }
  return {{"atmosphere", report.atmosphere.name},
          {"unit", sky_unit(report)},
          {"colour", tool::name(report.tables.colour)},
          {"sun_elevation_degrees", report.sun_elevation_degrees},
          {"sun_azimuth_degrees", report.sun_azimuth_degrees},
          {"sun_by_date", std::move(dated)},
          {"altitude_m", report.altitude_m},
          {"orders", report.orders},
          {"last_change", report.last_change},
          {"ground", report.ground},
          {"sky_irradiance", json_triple(report.sky_irradiance)},
          {"quadrature", quadrature_json(report)},
          {"tables", tables_json(report)},
          {"parameters", atmosphere_json(report.atmosphere)}};
}

std::string sky_lines(const SkyReport& report) {
  const Atmosphere& air = report.atmosphere;
  const auto [minimum, maximum] =
      air.ground_albedo.empty() ? std::pair{0.0, 0.0}
                                : std::pair{*std::min_element(air.ground_albedo.begin(), air.ground_albedo.end()),
                                            *std::max_element(air.ground_albedo.begin(), air.ground_albedo.end())};
  std::string text = "  " + printable(air.name) + "; sun " + sun_lookup(report.sun_elevation_degrees) + ", azimuth " +
                     significant(report.sun_azimuth_degrees) + "; altitude " + significant(report.altitude_m) + " m\n";
  if (report.dated) {
    const auto& [date, observer, sun] = *report.dated;
    text += "  " + printable(date) + " at latitude " + significant(observer.latitude_degrees) + ", longitude " +
            significant(observer.longitude_degrees) + "; " + significant(sun.compass_degrees) +
            " degrees from north through east" + (observer.refraction ? ", raised by refraction" : "") + '\n';
  }
  text += "  " + counted(static_cast<std::uint64_t>(report.orders), "order") + " of scattering, the last added " +
          significant(100.0 * report.last_change, 2) + " %; ground albedo " + significant(minimum) +
          (maximum > minimum ? " to " + significant(maximum) : "") + (report.ground ? "" : ", not seen") + '\n';
  text += "  tables " + size_text(report.tables) + ", " + name(report.tables.layout) + ", " +
          grouped(report.table_bytes >> 10U) + " KiB\n";
  text += "  r, g, b: " + sky_unit(report) + '\n';
  return text + "  irradiance of the sky on the ground  " + significant(report.sky_irradiance) + '\n';
}

namespace {

/// Tables of a sky: from a file if they match, else computed and saved there.
struct ReadyTables {
  std::shared_ptr<const SkyTables> tables;
  PassRecord pass;  ///< "reuse" or "run", with the reason
};

/// Returns whether tables match. The memory limit bounds the work and changes no table.
bool fit(const SkyTables& tables, const Atmosphere& atmosphere, const SkyTableOptions& options) {
  SkyTableOptions theirs = tables.options;
  theirs.memory_limit_bytes = options.memory_limit_bytes;
  return tables.atmosphere == atmosphere && theirs == options;
}

/// Returns tables. Without a file they are computed. From an existing file they are loaded if its atmosphere and
/// options match; else they are computed and saved over it. A file that holds no tables is kept, and is an error:
/// corrupt_file, unsupported_file. Throws the errors of `precompute_sky`, `load_sky_tables` and `save_sky_tables`.
ReadyTables ready_tables(const Atmosphere& atmosphere, const SkyTableOptions& options,
                         const std::optional<std::string>& file, const Control& control) {
  const auto start = std::chrono::steady_clock::now();
  const auto pass = [&](PassAction action, const std::string& reason) -> PassRecord {
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    return {"tables", action, reason, took.count()};
  };
  std::error_code none;
  std::string reason = "there is no --tables file";
  if (file) {
    const bool is_there = std::filesystem::exists(platform::path_of(*file), none);
    if (is_there) {
      auto loaded =
          std::make_shared<const SkyTables>(load_sky_tables(platform::path_of(*file), options.memory_limit_bytes));
      if (fit(*loaded, atmosphere, options)) return {loaded, pass(PassAction::reuse, "loaded from " + *file)};
    }
    reason = (is_there ? "those in the file had other parameters; now saved to " : "saved to ") + *file;
  }
  auto made = std::make_shared<const SkyTables>(precompute_sky(atmosphere, options, control));
  if (file) save_sky_tables(*made, platform::path_of(*file));
  return {made, pass(PassAction::run, reason)};
}

constexpr int kBuiltInHeight = 512;
constexpr double kTables = 0.9;  // of the progress; the rest is the image

/// Small tables, so that the command's first image is quick.
SkyParameters built_in_parameters() {
  SkyParameters parameters;
  parameters.sun_azimuth_degrees = 25.0;
  parameters.tables.heights = 8;
  parameters.tables.view_zeniths = 64;
  parameters.tables.sun_zeniths = 16;
  return parameters;
}

}  // namespace

Sky make_sky(const SkyParameters& parameters, const Control& control) {
  Atmosphere atmosphere = chosen_atmosphere(parameters.atmosphere, parameters.tables.colour);
  const ReadyTables ready = ready_tables(atmosphere, parameters.tables, parameters.tables_file, control);
  Sky sky{SkyView(ready.tables, parameters.altitude_m, parameters.view),
          sun_direction(parameters.sun_elevation_degrees, parameters.sun_azimuth_degrees),
          {},
          {ready.pass}};
  if (ready.pass.action == PassAction::run) {
    sky.passes.insert(sky.passes.end(), ready.tables->passes.begin(), ready.tables->passes.end());
  }
  SkyReport& report = sky.report;
  report.atmosphere = std::move(atmosphere);
  report.sun_elevation_degrees = parameters.sun_elevation_degrees;
  report.sun_azimuth_degrees = parameters.sun_azimuth_degrees;
  report.dated = parameters.dated;
  report.altitude_m = parameters.altitude_m;
  report.ground = parameters.view.ground;
  report.tables = ready.tables->options;
  report.table_bytes = ready.tables->bytes();
  report.orders = ready.tables->orders;
  report.last_change = ready.tables->last_change;
  report.sky_irradiance = sky.view.irradiance(sky.sun);
  return sky;
}

ComputedImage sky_image(const Sky& sky, int height, bool sun_disc, const Control& control) {
  ComputedImage image;
  image.image = sky_lat_long(sky.view, sky.sun, height, {.sun_disc = sun_disc}, control);
  image.source = {
      "sky", name(Layout::lat_long), image.image.width, image.image.height, "computed", "from tables of the scattering",
      {}};
  image.sky = sky.report;
  if (!sun_disc) image.sun = sky.view.sun_light(sky.sun);
  return image;
}

ComputedImage built_in_sky(const Control& control) {
  const Sky sky = make_sky(built_in_parameters(), part_of(control, 0.0, kTables));
  ComputedImage image = sky_image(sky, kBuiltInHeight, true, part_of(control, kTables, 1.0));
  image.source.path = "built-in sky";
  image.source.detail = "computed, as --sky asks";
  return image;
}

}  // namespace welkin::tool
