#include "tools/atmosphere_file.h"

#include <string>
#include <utility>
#include <vector>

#include "tools/json_members.h"
#include "welkin/error.h"

namespace welkin::tool {
namespace {

Json layers_json(const std::vector<DensityLayer>& layers) {
  Json list = Json::array();
  for (const DensityLayer& layer : layers) {
    list.push_back({{"thickness_m", layer.thickness_m},
                    {"exponential_term", layer.exponential_term},
                    {"exponential_scale_per_m", layer.exponential_scale_per_m},
                    {"linear_term_per_m", layer.linear_term_per_m},
                    {"constant_term", layer.constant_term}});
  }
  return list;
}

Json constituent_json(const Constituent& constituent) {
  return {{"density", layers_json(constituent.density)},
          {"scattering_per_m", constituent.scattering_per_m},
          {"absorption_per_m", constituent.absorption_per_m}};
}

Member layers(const char* name, std::vector<DensityLayer>& target) {
  return {name, [&target](const Json& value, const std::string& where) {
            target.clear();
            read_list(value, where, [&](const Json& element, const std::string& at) {
              DensityLayer& layer = target.emplace_back();
              read_object(
                  element, at,
                  {number("thickness_m", layer.thickness_m), number("exponential_term", layer.exponential_term),
                   number("exponential_scale_per_m", layer.exponential_scale_per_m),
                   number("linear_term_per_m", layer.linear_term_per_m), number("constant_term", layer.constant_term)});
            });
          }};
}

void read_constituent(const Json& value, const std::string& where, Constituent& target) {
  target = {};
  read_object(value, where,
              {layers("density", target.density), numbers("scattering_per_m", target.scattering_per_m),
               numbers("absorption_per_m", target.absorption_per_m)});
}

Member constituent(const char* name, Constituent& target) {
  return {name, [&target](const Json& value, const std::string& where) { read_constituent(value, where, target); }};
}

void read_phase(const Json& value, const std::string& where, AerosolPhase& target) {
  for (const AerosolPhase phase : {AerosolPhase::cornette_shanks, AerosolPhase::henyey_greenstein}) {
    if (value.is_string() && value.get<std::string>() == name(phase)) {
      target = phase;
      return;
    }
  }
  throw Flaw{where + R"( is neither "cornette-shanks" nor "henyey-greenstein")"};
}

Atmosphere atmosphere_of(const Json& json) {
  Atmosphere air;
  read_object(json, "the atmosphere",
              {text("name", air.name),
               numbers("wavelengths_nm", air.wavelengths_nm),
               number("bottom_radius_m", air.bottom_radius_m),
               number("top_radius_m", air.top_radius_m),
               constituent("rayleigh", air.rayleigh),
               constituent("aerosol", air.aerosol),
               {"aerosol_phase",
                [&](const Json& value, const std::string& where) { read_phase(value, where, air.aerosol_phase); }},
               number("aerosol_asymmetry", air.aerosol_asymmetry),
               {"absorbers",
                [&](const Json& value, const std::string& where) {
                  air.absorbers.clear();
                  read_list(value, where, [&](const Json& element, const std::string& at) {
                    read_constituent(element, at, air.absorbers.emplace_back());
                  });
                }},
               numbers("ground_albedo", air.ground_albedo),
               numbers("solar_irradiance", air.solar_irradiance),
               number("sun_angular_radius_degrees", air.sun_angular_radius_degrees)});
  return air;
}

}  // namespace

const char* name(AerosolPhase phase) noexcept {
  return phase == AerosolPhase::cornette_shanks ? "cornette-shanks" : "henyey-greenstein";
}

Json atmosphere_json(const Atmosphere& atmosphere) {
  Json absorbers = Json::array();
  for (const Constituent& absorber : atmosphere.absorbers) absorbers.push_back(constituent_json(absorber));
  return {{"name", atmosphere.name},
          {"wavelengths_nm", atmosphere.wavelengths_nm},
          {"bottom_radius_m", atmosphere.bottom_radius_m},
          {"top_radius_m", atmosphere.top_radius_m},
          {"rayleigh", constituent_json(atmosphere.rayleigh)},
          {"aerosol", constituent_json(atmosphere.aerosol)},
          {"aerosol_phase", name(atmosphere.aerosol_phase)},
          {"aerosol_asymmetry", atmosphere.aerosol_asymmetry},
          {"absorbers", absorbers},
          {"ground_albedo", atmosphere.ground_albedo},
          {"solar_irradiance", atmosphere.solar_irradiance},
          {"sun_angular_radius_degrees", atmosphere.sun_angular_radius_degrees}};
}

Atmosphere read_atmosphere(const std::filesystem::path& path) {
  constexpr const char* kOneToBeginWith = "'welkin sky --print-atmosphere' writes one to begin with";
  try {
    Atmosphere atmosphere = atmosphere_of(read_json_file(path, kOneToBeginWith));
    check(atmosphere);
    return atmosphere;
  } catch (const Flaw& flaw) {
    throw Error(ErrorCode::corrupt_file, path.string() + ": " + flaw.message);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::invalid_argument) throw;
    throw Error(ErrorCode::corrupt_file, path.string() + ": " + error.what());
  }
}

}  // namespace welkin::tool
