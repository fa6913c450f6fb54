#include "tools/sky_report.h"

#include <algorithm>
#include <cmath>

#include "tools/atmosphere_file.h"
#include "tools/number_text.h"
#include "tools/printable_text.h"
#include "tools/sky_atmosphere.h"

namespace welkin::tool {
namespace {

std::string list_text(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + significant(value);
  return text;
}

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
          {"lowest_sun_degrees", tables.lowest_sun_degrees},
          {"orders_asked_for", tables.orders},
          {"until_change", tables.until_change},
          {"bytes", report.table_bytes}};
}

Json quadrature_json(const SkyReport& report) {
  if (!report.quadrature) return nullptr;
  return {{"name", welkin::name(report.quadrature->quadrature)},
          {"directions", report.directions},
          {"zeniths", report.quadrature->zeniths},
          {"azimuths", report.quadrature->azimuths}};
}

std::string sun_place(double elevation) {
  return significant(std::abs(elevation)) + (elevation < 0.0 ? " degrees below the horizon" : " degrees up");
}

}  // namespace

std::string sky_unit(const SkyReport& report) {
  if (report.tables.colour == SkyColour::linear_srgb) return "cd/m2, linear sRGB";
  return "W/m2/sr/nm at " + list_text(report.atmosphere.wavelengths_nm) + " nm";
}

Json sky_json(const SkyReport& report) {
  return {{"atmosphere", report.atmosphere.name},
          {"unit", sky_unit(report)},
          {"colour", tool::name(report.tables.colour)},
          {"sun_elevation_degrees", report.sun_elevation_degrees},
          {"sun_azimuth_degrees", report.sun_azimuth_degrees},
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
  const auto [least, most] = air.ground_albedo.empty()
                                 ? std::pair{0.0, 0.0}
                                 : std::pair{*std::min_element(air.ground_albedo.begin(), air.ground_albedo.end()),
                                             *std::max_element(air.ground_albedo.begin(), air.ground_albedo.end())};
  std::string text = "  " + printable(air.name) + "; sun " + sun_place(report.sun_elevation_degrees) + ", azimuth " +
                     significant(report.sun_azimuth_degrees) + "; altitude " + significant(report.altitude_m) + " m\n";
  text += "  " + counted(static_cast<std::uint64_t>(report.orders), "order") + " of scattering, the last added " +
          significant(100.0 * report.last_change, 2) + " %; ground albedo " + significant(least) +
          (most > least ? " to " + significant(most) : "") + (report.ground ? "" : ", not seen") + '\n';
  text += "  tables " + size_text(report.tables) + ", " + name(report.tables.layout) + ", " +
          grouped(report.table_bytes >> 10U) + " KiB\n";
  text += "  r, g, b: " + sky_unit(report) + '\n';
  return text + "  irradiance of the sky on the ground  " + significant(report.sky_irradiance) + '\n';
}

}  // namespace welkin::tool
