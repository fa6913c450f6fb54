// Computed skies.
#include "welkin/sky.h"

#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "call.h"
#include "files.h"
#include "results.h"
#include "welkin/bake_file.h"

namespace welkin::python {
namespace {

constexpr Named<SkyColour> kColours[] = {{"spectral", SkyColour::spectral}, {"linear-srgb", SkyColour::linear_srgb}};
constexpr Named<ScatteringLayout> kLayouts[] = {{"full", ScatteringLayout::full},
                                                {"compact", ScatteringLayout::compact}};
constexpr Named<SkyQuadrature> kQuadratures[] = {
    {"uniform", SkyQuadrature::uniform}, {"gauss", SkyQuadrature::gauss}, {"gauss-split", SkyQuadrature::gauss_split}};
constexpr Named<AerosolKind> kAerosols[] = {{"clear", AerosolKind::clear},
                                            {"hazy", AerosolKind::hazy},
                                            {"dusty", AerosolKind::dusty},
                                            {"polluted", AerosolKind::polluted}};

enum class Planet { earth, earth_bruneton, earth_hillaire, mars };
constexpr Named<Planet> kPlanets[] = {{"earth", Planet::earth},
                                      {"earth-bruneton", Planet::earth_bruneton},
                                      {"earth-hillaire", Planet::earth_hillaire},
                                      {"mars", Planet::mars}};

using SharedTables = std::shared_ptr<const SkyTables>;

/// A sky as it is seen from one altitude.
struct Sky {
  SkyView view;

  [[nodiscard]] const SkyTables& tables() const { return *view.tables(); }
};

Atmosphere read_atmosphere(const std::string& planet, Options& options) {
  const auto kind = value_of<Planet>("planet", planet, kPlanets);
  AerosolKind aerosol = AerosolKind::clear;
  std::optional<std::vector<double>> wavelengths;
  std::optional<double> albedo;
  double night = 0.0;
  const bool has_aerosol = static_cast<bool>(options.take("aerosol"));
  options.read("aerosol", aerosol, kAerosols);
  options.read("wavelengths", wavelengths);
  options.read("ground_albedo", albedo);
  options.read("night_zenith_luminance", night);
  if (kind != Planet::earth && has_aerosol) {
    throw Error(ErrorCode::invalid_argument, "sky(aerosol=...) is for the planet \"earth\"");
  }
  if (wavelengths && kind != Planet::earth && kind != Planet::earth_bruneton) {
    throw Error(ErrorCode::invalid_argument,
                "sky(wavelengths=...) is for the planets \"earth\" and \"earth-bruneton\"");
  }
  const std::vector<double> at = wavelengths.value_or(std::vector{680.0, 550.0, 440.0});
  Atmosphere air;
  switch (kind) {
    case Planet::earth: air = earth(at, aerosol); break;
    case Planet::earth_bruneton: air = earth_bruneton(at); break;
    case Planet::earth_hillaire: air = earth_hillaire(); break;
    case Planet::mars: air = mars(); break;
  }
  if (albedo) air = with_ground_albedo(std::move(air), *albedo);
  air.night_zenith_luminance = night;
  return air;
}

SkyTableOptions read_tables(Options& options) {
  SkyTableOptions how;
  how.colour = SkyColour::linear_srgb;
  options.read("colour", how.colour, kColours);
  options.read("table_layout", how.layout, kLayouts);
  options.read("heights", how.heights);
  options.read("view_zeniths", how.view_zeniths);
  options.read("sun_zeniths", how.sun_zeniths);
  options.read("sun_angles", how.sun_angles);
  options.read("orders", how.orders);
  options.read("minimum_sun_elevation", how.minimum_sun_elevation_degrees);
  options.read("memory_limit", how.memory_limit_bytes);
  return how;
}

SkyViewOptions read_view(Options& options) {
  SkyViewOptions how;
  options.read("ground", how.ground);
  return how;
}

Sky make_sky(const std::string& planet, const py::kwargs& given) {
  Options options("sky", given);
  const Atmosphere air = read_atmosphere(planet, options);
  const SkyTableOptions how = read_tables(options);
  const SkyViewOptions seen = read_view(options);
  double altitude = 0.0;
  options.read("altitude", altitude);
  Call call("sky", options);
  options.finish();
  return call.run([&](const Control& control) {
    auto tables = std::make_shared<const SkyTables>(precompute_sky(air, how, control));
    return Sky{SkyView(std::move(tables), altitude, seen)};
  });
}

Sky load_sky(const py::object& file, const py::kwargs& given) {
  Options options("load_sky", given);
  const FileInput input = input_of(file);
  const SkyViewOptions seen = read_view(options);
  double altitude = 0.0;
  options.read("altitude", altitude);
  options.finish();
  const py::gil_scoped_release released;
  return {SkyView(std::make_shared<const SkyTables>(load_sky_tables(input)), altitude, seen)};
}

Sky seen_from(const Sky& sky, double altitude, bool ground) {
  const py::gil_scoped_release released;
  return {SkyView(sky.view.tables(), altitude, {.ground = ground})};
}

py::array radiance_at(const Sky& sky, const py::object& directions, const py::object& sun) {
  const Directions asked = directions_of(directions, "directions");
  const dvec3 towards = vector_of(sun, "sun");
  std::vector<vec3> list(asked.count());
  for (std::size_t index = 0; index < list.size(); ++index) list[index] = vec3(asked.at(index));
  py::array_t<float> values(asked.shape);
  static_assert(sizeof(vec3) == 3 * sizeof(float));
  const std::span<vec3> rgb(reinterpret_cast<vec3*>(values.mutable_data()), list.size());
  const py::gil_scoped_release released;
  sky.view.radiance(list, towards, rgb);
  return values;
}

py::dict sun_of(const Sky& sky, const py::object& sun) {
  const Sun found = sky.view.sun_light(vector_of(sun, "sun"));
  py::dict all;
  all["direction"] = array_of(found.direction);
  all["irradiance"] = array_of(found.irradiance);
  all["radiance"] = array_of(found.radiance);
  all["solid_angle"] = found.solid_angle;
  all["angular_radius_degrees"] = found.angular_radius_degrees;
  return all;
}

SkyHarmonicsOptions harmonics_options(Options& options, SkyHarmonicsOptions how) {
  options.read("quadrature", how.quadrature, kQuadratures);
  options.read("zeniths", how.zeniths);
  options.read("azimuths", how.azimuths);
  return how;
}

SphericalHarmonics harmonics_at(const Sky& sky, const py::object& sun, const py::kwargs& given) {
  Options options("Sky.harmonics", given);
  SkyHarmonicsOptions how = harmonics_options(options, {});
  options.read("bands", how.bands);
  options.finish();
  const dvec3 towards = vector_of(sun, "sun");
  const py::gil_scoped_release released;
  return SkyProjector(sky.view, how).project(towards);
}

SkyCurve curve_of(const Sky& sky, const py::kwargs& given) {
  Options options("Sky.curve", given);
  SkyCurveOptions how;
  options.read("bands", how.bands);
  options.read("nodes", how.nodes);
  how.projection = harmonics_options(options, how.projection);
  Call call("curve", options);
  options.finish();
  return call.run([&](const Control& control) { return SkyCurve(sky.view, how, control); });
}

py::array cubemap_of(const Sky& sky, const py::object& sun, int size, const py::kwargs& given) {
  Options options("Sky.cubemap", given);
  SkyImageOptions how;
  options.read("sun_disc", how.sun_disc);
  Call call("sky", options);
  options.finish();
  const dvec3 towards = vector_of(sun, "sun");
  return array_of(call.run([&](const Control& control) { return sky_cubemap(sky.view, towards, size, how, control); }));
}

py::array lat_long_of(const Sky& sky, const py::object& sun, int height, const py::kwargs& given) {
  Options options("Sky.lat_long", given);
  SkyImageOptions how;
  options.read("sun_disc", how.sun_disc);
  Call call("sky", options);
  options.finish();
  const dvec3 towards = vector_of(sun, "sun");
  return array_of(
      call.run([&](const Control& control) { return sky_lat_long(sky.view, towards, height, how, control); }));
}

/// The tables, read only, on their own memory.
py::dict tables_of(const Sky& sky) {
  const SharedTables& tables = sky.view.tables();
  const SkyTableOptions& how = tables->options;
  const py::capsule owner = keeper(tables);
  const auto table = [&](const std::vector<float>& values, std::vector<py::ssize_t> shape) -> py::object {
    if (values.empty()) return py::none();
    return shown(std::move(shape), values.data(), owner, false);
  };
  std::vector<py::ssize_t> scattering{how.heights, how.view_zeniths, how.sun_angles, how.sun_zeniths, 4};
  if (how.layout == ScatteringLayout::compact) scattering.erase(scattering.begin() + 2);
  py::dict all;
  all["transmittance"] = table(tables->transmittance, {how.transmittance_heights, how.transmittance_zeniths, 3});
  all["scattering"] = table(tables->scattering, scattering);
  all["single_mie"] = table(tables->single_mie, scattering);
  all["irradiance"] = table(tables->irradiance, {how.irradiance_heights, how.irradiance_sun_zeniths, 3});
  return all;
}

void bind_curve(py::module_& module) {
  py::class_<SkyCurve>(module, "SkyCurve",
                       "A sky's coefficients as a function of the sun's elevation. A lookup\n"
                       "takes microseconds.")
      .def_property_readonly("bands", &SkyCurve::bands, "How many.")
      .def_property_readonly("nbytes", &SkyCurve::bytes, "Memory.")
      .def(
          "__call__", [](const SkyCurve& self, const py::object& sun) { return self.at(vector_of(sun, "sun")); },
          py::arg("sun"),
          "__call__(self, sun)\n"
          "--\n\n"
          "Returns `SphericalHarmonics` of radiance for a direction towards the sun, without its disc.")
      .def(
          "sun_irradiance",
          [](const SkyCurve& self, const py::object& sun) {
            return array_of(self.sun_irradiance(vector_of(sun, "sun")));
          },
          py::arg("sun"),
          "sun_irradiance(self, sun)\n"
          "--\n\n"
          "Returns the irradiance of direct sunlight on a surface that faces the sun: (3,).")
      .def("__repr__", [](const SkyCurve& self) {
        return "<welkin.SkyCurve: " + counted(static_cast<std::size_t>(self.bands()), "band") + ", " +
               std::to_string(self.bytes() / 1024) + " KiB" + ">";
      });
}

void bind_sky_class(py::module_& module) {
  py::class_<Sky>(module, "Sky",
                  "A computed sky, seen from one altitude. `sun`: a direction towards the sun, y\n"
                  "up.")
      .def_property_readonly(
          "name", [](const Sky& self) { return self.tables().atmosphere.name; }, "Of the atmosphere.")
      .def_property_readonly(
          "altitude", [](const Sky& self) { return self.view.altitude_m(); }, "Metres above the ground.")
      .def_property_readonly(
          "tables", &tables_of,
          "The precomputed tables by name, read-only: \"transmittance\", \"scattering\", \"single_mie\" (or None),\n"
          "\"irradiance\".")
      .def("at_altitude", &seen_from, py::arg("altitude"), py::arg("ground") = true,
           "at_altitude(self, altitude, ground=True)\n"
           "--\n\n"
           "Returns the same sky from another altitude in metres. Takes milliseconds.")
      .def("radiance", &radiance_at, py::arg("directions"), py::arg("sun"),
           "radiance(self, directions, sun)\n"
           "--\n\n"
           "Returns radiance from unit directions (..., 3), without the sun's disc: (..., 3) float32, cd/m2 in\n"
           "linear sRGB, or W/m2/sr/nm for a spectral sky. 50 ns per direction.")
      .def("sun", &sun_of, py::arg("sun"),
           "sun(self, sun)\n"
           "--\n\n"
           "Returns the sun as a directional light: direction, irradiance, radiance, solid_angle,\n"
           "angular_radius_degrees.")
      .def(
          "irradiance",
          [](const Sky& self, const py::object& sun) { return array_of(self.view.irradiance(vector_of(sun, "sun"))); },
          py::arg("sun"),
          "irradiance(self, sun)\n"
          "--\n\n"
          "Returns the irradiance of the sky on level ground, without direct sunlight: (3,).")
      .def("harmonics", &harmonics_at, py::arg("sun"),
           "harmonics(self, sun, *, bands=3, quadrature='gauss-split', zeniths=16, azimuths=16)\n"
           "--\n\n"
           "Returns `SphericalHarmonics` of radiance, without the sun's disc.")
      .def("curve", &curve_of,
           "curve(self, *, bands=3, nodes=256, quadrature='gauss-split', zeniths=32, azimuths=32, progress=None,\n"
           "      threads=None)\n"
           "--\n\n"
           "Computes the harmonics for all elevations of the sun. Returns a `SkyCurve`.")
      .def("cubemap", &cubemap_of, py::arg("sun"), py::arg("size"),
           "cubemap(self, sun, size, *, sun_disc=False, progress=None, threads=None)\n"
           "--\n\n"
           "Returns an image of the sky: (6, size, size, 3) float32.")
      .def("lat_long", &lat_long_of, py::arg("sun"), py::arg("height"),
           "lat_long(self, sun, height, *, sun_disc=False, progress=None, threads=None)\n"
           "--\n\n"
           "Returns an image of the sky: (height, 2 height, 3) float32.")
      .def(
          "save",
          [](const Sky& self, const std::filesystem::path& path) {
            const py::gil_scoped_release released;
            save_sky_tables(self.tables(), path);
          },
          py::arg("path"),
          "save(self, path)\n"
          "--\n\n"
          "Saves the tables to a file. `load_sky` restores the same bits.")
      .def("__repr__", [](const Sky& self) {
        return "<welkin.Sky: " + self.tables().atmosphere.name + " at " +
               std::to_string(static_cast<long>(self.view.altitude_m())) + " m, " +
               std::to_string(self.tables().bytes() >> 20U) + " MiB of tables>";
      });
}

/// Seconds from 1970: a number, text, or a datetime that knows its time zone.
double seconds_of(const py::object& date) {
  if (py::isinstance<py::str>(date)) return unix_seconds(date.cast<std::string>());
  if (!py::hasattr(date, "timestamp")) return date.cast<double>();
  if (date.attr("tzinfo").is_none()) {
    throw Error(ErrorCode::invalid_argument, "sun_position: the datetime has no time zone; pass one with tzinfo");
  }
  return date.attr("timestamp")().cast<double>();
}

py::dict sun_at(const py::object& date, double latitude, double longitude, const py::kwargs& given) {
  Options options("sun_position", given);
  SunObserver observer{.latitude_degrees = latitude, .longitude_degrees = longitude};
  options.read("north", observer.north_azimuth_degrees);
  options.read("refraction", observer.refraction);
  options.read("pressure", observer.pressure_hpa);
  options.read("temperature", observer.temperature_celsius);
  options.finish();
  const SunPosition sun = sun_position(seconds_of(date), observer);
  py::dict made;
  made["elevation"] = sun.elevation_degrees;
  made["azimuth"] = sun.azimuth_degrees;
  made["compass"] = sun.compass_degrees;
  made["refraction"] = sun.refraction_degrees;
  made["distance"] = sun.distance_au;
  made["direction"] = array_of(sun.direction);
  return made;
}

}  // namespace

void bind_sky(py::module_& module) {
  bind_curve(module);
  bind_sky_class(module);
  module.def(
      "sky", &make_sky, py::arg("planet") = "earth",
      "sky(planet='earth', *, altitude=0.0, aerosol='clear', wavelengths=None, ground_albedo=None,\n"
      "    night_zenith_luminance=0.0, ground=True, colour='linear-srgb', table_layout='full', heights=32,\n"
      "    view_zeniths=64, sun_zeniths=64, sun_angles=8, orders=4, minimum_sun_elevation=-30.0,\n"
      "    memory_limit=4294967296, progress=None, threads=None)\n"
      "--\n\n"
      "Computes the tables of a sky and a view of it. Returns a `Sky`. Takes 2 s of CPU time at the default\n"
      "sizes. Planets: \"earth\", \"earth-bruneton\", \"earth-hillaire\", \"mars\". `aerosol` of \"earth\": "
      "\"clear\",\n"
      "\"hazy\", \"dusty\", \"polluted\". `colour`: \"linear-srgb\", cd/m2, or \"spectral\", W/m2/sr/nm at three\n"
      "wavelengths. `altitude` in metres, `wavelengths` in nm.");
  module.def("load_sky", &load_sky, py::arg("file"),
             "load_sky(file, *, altitude=0.0, ground=True)\n"
             "--\n\n"
             "Loads a sky that `Sky.save` wrote.");
  module.def(
      "sun_direction", [](double elevation, double azimuth) { return array_of(sun_direction(elevation, azimuth)); },
      py::arg("elevation"), py::arg("azimuth") = 0.0,
      "sun_direction(elevation, azimuth=0.0)\n"
      "--\n\n"
      "Returns the unit direction (3,) towards a sun, in degrees; azimuth from +z towards +x.");
  module.def(
      "sun_position", &sun_at, py::arg("date"), py::arg("latitude"), py::arg("longitude"),
      "sun_position(date, latitude, longitude, *, north=180.0, refraction=False, pressure=1010.0, temperature=10.0)\n"
      "--\n\n"
      "Computes the sun's position by date and place, 1900 to 2099. `date`: text such as\n"
      "\"2026-06-21T20:30+02:00\", a datetime with a time zone, or seconds since 1970. Degrees, positive in the\n"
      "north and the east. `north`: its azimuth; 180 is -z, and east +x. Returns elevation, azimuth, compass,\n"
      "refraction (degrees), distance (astronomical units) and direction (3,).");
}

}  // namespace welkin::python
