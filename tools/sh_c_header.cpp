// `welkin sh --format c`: the numbers as a header for C and C++.
#include <array>
#include <cctype>
#include <charconv>
#include <filesystem>

#include "tools/number_text.h"
#include "tools/printable_text.h"
#include "tools/sh_report.h"
#include "welkin/version.h"

namespace welkin::tool {
namespace {

/// The file's stem as a C identifier: "city-at noon.exr" to "city_at_noon".
std::string identifier(const std::string& path) {
  std::string name;
  for (const char c : std::filesystem::path(path).stem().string()) {
    name += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  }
  if (name.empty() || std::isdigit(static_cast<unsigned char>(name.front())) != 0) name.insert(0, "environment_");
  return name;
}

/// Shortest text that reads back as the same float, as a C constant.
std::string float_constant(double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), static_cast<float>(value)).ptr;
  std::string text(buffer.data(), end);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text + 'f';
}

/// Nothing in it can end the comment that it stands in.
std::string in_comment(std::string text) {
  for (std::size_t i = 0; (i = text.find("*/", i)) != std::string::npos;) text.replace(i, 2, "* /");
  return text;
}

std::string comment(const std::string& text) {
  std::string lines = "/* ";
  for (const char c : in_comment(text)) {
    lines += c;
    if (c == '\n') lines += " * ";
  }
  return lines + " */\n";
}

std::string row(const glm::dvec4& value, const std::string& name) {
  return "  {" + float_constant(value.x) + ", " + float_constant(value.y) + ", " + float_constant(value.z) + ", " +
         float_constant(value.w) + "}, /* " + in_comment(name) + " */\n";
}

std::string row(const glm::dvec3& rgb, const std::string& name) {
  return "  {" + float_constant(rgb.x) + ", " + float_constant(rgb.y) + ", " + float_constant(rgb.z) + "}, /* " +
         in_comment(name) + " */\n";
}

std::string array_start(const std::string& name, std::size_t count, int numbers = 3) {
  return "static const float " + name + '[' + std::to_string(count) + "][" + std::to_string(numbers) + "] = {\n";
}

std::string harmonics_array(const std::string& name, const SphericalHarmonics& harmonics) {
  std::string text = array_start(name, harmonics.coefficients().size());
  for (int l = 0; l < harmonics.bands(); ++l) {
    for (int m = -l; m <= l; ++m) text += row(harmonics.at(l, m), std::to_string(l) + ", " + std::to_string(m));
  }
  return text + "};\n";
}

std::string engine_array(const std::string& name, const EngineLight& light) {
  std::string text = comment(light.form + "\n" + light.formula) + array_start(name, light.terms.size());
  for (const EngineTerm& term : light.terms) text += row(term.rgb, term.name);
  text += "};\n";
  if (light.vectors.empty()) return text;
  text += comment("The same for the shader: each row is x, y, z, w.") +
          array_start(name + "_vectors", light.vectors.size(), 4);
  for (const EngineVector& vector : light.vectors) text += row(vector.value, vector.name);
  return text + "};\n";
}

std::string harmonics_arrays(const std::string& name, const ShReport& report) {
  return comment(
             "Coefficient (l, m) at l (l + 1) + m: integral over the sphere of radiance times Y(l, m);\n"
             "Y real, orthonormal, without Condon-Shortley phase; Y(1, -1..1) ~ y, z, x.") +
         harmonics_array(name + "_radiance", report.projection.radiance) +
         comment(
             "A(l) times that, A = pi, 2pi/3, pi/4, 0, -pi/24, ...; the sum over all coefficients times\n"
             "Y(l, m)(n) is the irradiance on a surface that faces n.") +
         harmonics_array(name + "_irradiance", report.irradiance);
}

std::string sun_arrays(const std::string& name, const Sun& sun) {
  return comment(
             "The sun, which is not in the harmonics: unit direction towards it, irradiance on a surface that faces "
             "it.") +
         array_start(name + "_sun", 2) + row(sun.direction, "direction") + row(sun.irradiance, "irradiance") + "};\n";
}

}  // namespace

std::string sh_c_header(const ShReport& report) {
  const std::string name = identifier(report.source.path);
  std::string text = comment("Light of " + printable(report.source.path) +
                             ", by welkin " WELKIN_VERSION_STRING ".\nAxes: " + report.axes +
                             "\nEach row is r, g, b where nothing else is said.") +
                     "#ifndef WELKIN_" + name + "_H\n#define WELKIN_" + name + "_H\n\n";
  text += report.engine_light ? engine_array(name + '_' + convention(report.engine).name, *report.engine_light)
                              : harmonics_arrays(name, report);
  for (const EngineLight& light : report.engine_lights) {
    text += comment(std::string(convention(light.engine).title) + ", axes: " + convention(light.engine).axes) +
            engine_array(name + '_' + convention(light.engine).name, light);
  }
  if (report.sun) text += sun_arrays(name, *report.sun);
  return text + "\n#endif\n";
}

}  // namespace welkin::tool
