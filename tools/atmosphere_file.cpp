#include "tools/atmosphere_file.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include "welkin/error.h"

namespace welkin::tool {
namespace {

constexpr std::size_t kLongestText = std::size_t{1} << 20U;  // sound ones have some kilobytes
constexpr int kDeepestNesting = 8;                           // sound ones have 5
constexpr std::size_t kMostElements = 4096;                  // of a list; what sense they make, `check` knows

/// What is wrong; the file's name is put before it where it is known.
struct Flaw {
  std::string message;
};

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

/// A member that an object may have, and what reads it.
struct Member {
  const char* name;
  std::function<void(const Json& value, const std::string& where)> read;
};

/// Reads an object's members; `where` names it in messages.
Flaw unknown_member(const std::string& where, const std::string& key, const std::string& known) {
  return {where + " has a member \"" + key + "\"; it can have " + known};
}

void read_object(const Json& object, const std::string& where, const std::vector<Member>& members) {
  if (!object.is_object()) throw Flaw{where + " is no object in braces"};
  for (const auto& [key, value] : object.items()) {
    const Member* found = nullptr;
    std::string known;
    for (const Member& member : members) {
      if (!known.empty()) known += ", ";
      known += member.name;
      if (key == member.name) found = &member;
    }
    if (found == nullptr) throw unknown_member(where, key, known);
    found->read(value, std::string(where).append(".").append(key));
  }
}

void read_list(const Json& list, const std::string& where,
               const std::function<void(const Json& element, const std::string& where)>& read) {
  if (!list.is_array()) throw Flaw{where + " is no list in brackets"};
  if (list.size() > kMostElements) throw Flaw{where + " has " + std::to_string(list.size()) + " elements"};
  for (std::size_t i = 0; i < list.size(); ++i) read(list[i], where + '[' + std::to_string(i) + ']');
}

Member number(const char* name, double& target) {
  return {name, [&target](const Json& value, const std::string& where) {
            if (!value.is_number()) throw Flaw{where + " is no number"};
            target = value.get<double>();
          }};
}

Member numbers(const char* name, std::vector<double>& target) {
  return {name, [&target](const Json& value, const std::string& where) {
            target.clear();
            read_list(value, where, [&](const Json& element, const std::string& at) {
              if (!element.is_number()) throw Flaw{at + " is no number"};
              target.push_back(element.get<double>());
            });
          }};
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

Member text(const char* name, std::string& target) {
  return {name, [&target](const Json& value, const std::string& where) {
            if (!value.is_string()) throw Flaw{where + " is no text in quotes"};
            target = value.get<std::string>();
          }};
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

std::string text_of(const std::filesystem::path& path) {
  std::error_code none;
  errno = 0;
  std::ifstream stream(path, std::ios::binary);
  if (!stream || std::filesystem::is_directory(path, none)) {
    throw Error(ErrorCode::file_access, path.string() + ": cannot be read (" +
                                            (errno != 0 ? std::strerror(errno) : "it is a directory") +
                                            "); 'welkin sky --print-atmosphere' writes one to begin with");
  }
  std::string text(kLongestText + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (text.size() > kLongestText) {
    throw Error(ErrorCode::limit_exceeded,
                path.string() + ": has more than a megabyte; an atmosphere has some kilobytes");
  }
  return text;
}

Json parsed(const std::string& text) {
  const auto not_too_deep = [](int depth, Json::parse_event_t /*event*/, Json& /*value*/) {
    if (depth > kDeepestNesting) throw Flaw{"nests deeper than an atmosphere does"};
    return true;
  };
  try {
    return Json::parse(text, not_too_deep);
  } catch (const Json::exception& flaw) {
    throw Flaw{std::string("is no JSON (") + flaw.what() + ")"};
  }
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
  const std::string text = text_of(path);
  try {
    Atmosphere atmosphere = atmosphere_of(parsed(text));
    check(atmosphere);
    return atmosphere;
  } catch (const Flaw& flaw) {
    throw Error(ErrorCode::corrupt_file, path.string() + ": " + flaw.message);
  } catch (const Error& error) {
    throw Error(ErrorCode::corrupt_file, path.string() + ": " + error.what());
  }
}

}  // namespace welkin::tool
