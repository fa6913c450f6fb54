// `welkin sh --format text`: one line a coefficient, every digit, remarks behind #. For awk, spreadsheets and people.
#include "tools/number_text.h"
#include "tools/printable_text.h"
#include "tools/sh_report.h"

namespace welkin::tool {
namespace {

std::string remark(const std::string& text) {
  std::string lines = "# ";
  for (const char c : text) {
    lines += c;
    if (c == '\n') lines += "# ";
  }
  return lines + '\n';
}

std::string term_line(const std::string& name, const glm::dvec3& rgb) {
  return name + ' ' + all_digits(rgb.x) + ' ' + all_digits(rgb.y) + ' ' + all_digits(rgb.z) + '\n';
}

std::string harmonics_lines(const std::string& name, const SphericalHarmonics& harmonics) {
  std::string text;
  for (int l = 0; l < harmonics.bands(); ++l) {
    for (int m = -l; m <= l; ++m) {
      text += term_line(name + '[' + std::to_string(l) + ',' + std::to_string(m) + ']', harmonics.at(l, m));
    }
  }
  return text;
}

std::string engine_lines(const EngineLight& light) {
  std::string text = remark(light.form + "\n" + light.formula);
  for (const EngineTerm& term : light.terms) text += term_line(term.name, term.rgb);
  if (!light.vectors.empty()) text += remark("the same for the shader: x y z w behind each name");
  for (const EngineVector& vector : light.vectors) {
    text += term_line(vector.name, glm::dvec3(vector.value));
    text.back() = ' ';
    text += all_digits(vector.value.w) + '\n';
  }
  return text;
}

std::string harmonics_of_both(const ShReport& report) {
  return remark("radiance[l,m] = integral over the sphere of L Y(l,m); Y real, orthonormal, no Condon-Shortley phase") +
         harmonics_lines("radiance", report.projection.radiance) +
         remark("irradiance[l,m] = A(l) radiance[l,m], A = pi, 2pi/3, pi/4, 0, -pi/24, ...") +
         harmonics_lines("irradiance", report.irradiance);
}

std::string sun_lines(const Sun& sun) {
  return remark(
             "the sun, which is not in the harmonics: unit direction towards it, irradiance on a surface that faces "
             "it") +
         term_line("sun.direction", sun.direction) + term_line("sun.irradiance", sun.irradiance) + "sun.solid_angle " +
         all_digits(sun.solid_angle) + '\n';
}

}  // namespace

std::string sh_text(const ShReport& report) {
  std::string text = remark(printable(report.source.path) + "; r g b behind each name; axes: " + report.axes);
  text += report.engine_light ? engine_lines(*report.engine_light) : harmonics_of_both(report);
  if (report.sun) text += sun_lines(*report.sun);
  return text;
}

}  // namespace welkin::tool
