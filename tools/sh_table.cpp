// `welkin sh` for a person: plain ASCII, in 80 columns but for the reasons that the library gives.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <string_view>

#include "tools/direction_text.h"
#include "tools/number_text.h"
#include "tools/printable_text.h"
#include "tools/sh_report.h"
#include "tools/sun_options.h"
#include "welkin/instruction_set.h"

namespace welkin::tool {
namespace {

constexpr std::size_t kLabelWidth = 13;
constexpr std::size_t kNumberWidth = 10;
constexpr std::size_t kPassWidth = 10;
constexpr int kNamedBands = 4;

/// The polynomial in (x, y, z) that Y(l, m) is a multiple of; for higher bands the Legendre function of z
/// and the wave around the z axis (p = atan2(y, x)) whose product it is.
std::string harmonic_name(int l, int m) {
  constexpr std::array<std::string_view, kNamedBands* kNamedBands> kPolynomials = {
      "1",                                                          //
      "y",           "z",   "x",                                    //
      "xy",          "yz",  "3zz - 1",    "xz",         "xx - yy",  //
      "y(3xx - yy)", "xyz", "y(5zz - 1)", "z(5zz - 3)", "x(5zz - 1)", "z(xx - yy)", "x(xx - 3yy)"};
  if (l < kNamedBands) return std::string(kPolynomials.at(SphericalHarmonics::index(l, m)));
  const std::string order = std::to_string(std::abs(m));
  std::string product = "P";
  product += std::to_string(l) + ',' + order;
  if (m != 0) product += (m < 0 ? " sin " : " cos ") + order + 'p';
  return product;
}

std::string convention_lines(int bands) {
  std::string text =
      "\n"
      "  radiance    c(l,m) = integral over the sphere of L(d) Y(l,m)(d)\n"
      "  irradiance  e(l,m) = A(l) c(l,m),  A = pi, 2pi/3, pi/4, 0, -pi/24, ...\n"
      "  The irradiance on a surface that faces n is the sum of e(l,m) Y(l,m)(n).\n"
      "  Y is real and orthonormal, without Condon-Shortley phase:\n"
      "    0.282095;  0.488603 y, z, x;\n"
      "    1.092548 xy, yz, xz;  0.315392 (3zz - 1);  0.546274 (xx - yy)\n";
  if (bands > kNamedBands) text += "  From l = 4 on: Pl,m is the Legendre function of z, and p = atan2(y, x).\n";
  return text;
}

double largest_coefficient(const SphericalHarmonics& harmonics) {
  double largest = 0.0;
  for (const glm::dvec3& rgb : harmonics.coefficients()) largest = std::max(largest, largest_magnitude(rgb));
  return largest;
}

std::string coefficient_lines(const SphericalHarmonics& radiance, const SphericalHarmonics& irradiance) {
  const NumberColumn radiance_column(largest_coefficient(radiance));
  const NumberColumn irradiance_column(largest_coefficient(irradiance));
  std::string text = "\n   l   m  " + pad_right("Y ~", kLabelWidth) +
                     pad_right("  radiance r, g, b", 3 * kNumberWidth) + "  irradiance r, g, b\n";
  for (int l = 0; l < radiance.bands(); ++l) {
    for (int m = -l; m <= l; ++m) {
      text += pad_left(std::to_string(l), 4) + pad_left(std::to_string(m), 4) + "  " +
              pad_right(harmonic_name(l, m), kLabelWidth) + radiance_column.cells(radiance.at(l, m), kNumberWidth) +
              irradiance_column.cells(irradiance.at(l, m), kNumberWidth) + '\n';
    }
  }
  return text;
}

std::string babylon_lines(const BabylonPolynomial& polynomial) {
  struct Term {
    std::string_view name;
    const glm::dvec3& rgb;
  };
  const std::array<Term, 9> terms = {{{"x", polynomial.x},
                                      {"y", polynomial.y},
                                      {"z", polynomial.z},
                                      {"xx", polynomial.xx},
                                      {"yy", polynomial.yy},
                                      {"zz", polynomial.zz},
                                      {"yz", polynomial.yz},
                                      {"zx", polynomial.zx},
                                      {"xy", polynomial.xy}}};
  double largest = 0.0;
  for (const Term& term : terms) largest = std::max(largest, largest_magnitude(term.rgb));
  const NumberColumn column(largest);
  std::string text = "\nBabylon.js SphericalPolynomial (irradiance / pi; its signs and constants)\n";
  for (const Term& term : terms) text += "  " + pad_right(term.name, 4) + column.cells(term.rgb) + '\n';
  return text;
}

std::string source_lines(const ShReport& report) {
  const Source& source = report.source;
  std::string text = source.path + ": ";
  if (source.width > 0) {
    text += std::to_string(source.width) + " x " + std::to_string(source.height) + ' ' + source.layout + ", ";
  }
  text += source.format + "\n  (" + source.detail + ")\n";
  if (report.sky) text += sky_lines(*report.sky);
  for (const std::string& note : source.notes) text += "  note: " + printable(note) + '\n';
  return text;
}

std::string indented(const std::string& text) {
  std::string lines = "  ";
  for (const char c : text) {
    lines += c;
    if (c == '\n') lines += "  ";
  }
  return lines + '\n';
}

std::string engine_lines(const EngineLight& light) {
  double largest = 0.0;
  std::size_t width = 0;
  for (const EngineTerm& term : light.terms) {
    largest = std::max(largest, largest_magnitude(term.rgb));
    width = std::max(width, term.name.size());
  }
  for (const EngineVector& vector : light.vectors) width = std::max(width, vector.name.size());
  const NumberColumn column(largest);
  std::string text = std::string("\n") + convention(light.engine).title + ": " + light.form + '\n';
  for (const EngineTerm& term : light.terms) {
    text += "  " + pad_right(term.name, width + 1) + column.cells(term.rgb) + '\n';
  }
  for (const EngineVector& vector : light.vectors) {
    text += "  " + pad_right(vector.name, width + 1) + column.cells(glm::dvec3(vector.value)) +
            column.cell(vector.value.w) + '\n';
  }
  return text + indented(light.formula);
}

std::string window_lines(const ShReport& report) {
  const Windowed& windowed = report.windowed;
  const std::string least = "\nLeast irradiance over all normals  ";
  if (report.window == Window::none) {
    const glm::dvec3& value = windowed.minimum_before;
    const bool negative = value.x < 0.0 || value.y < 0.0 || value.z < 0.0;
    return least + significant(value) +
           (negative ? "\n  negative: the few bands ring; --window least mends that" : "") + '\n';
  }
  std::string text = least + significant(windowed.minimum_before) + " before the window,\n  " +
                     significant(windowed.minimum_after) + " after it (" + name(report.window) + ", " +
                     (report.window == Window::least ? "lambda " : "width ") + significant(windowed.parameter) +
                     "; bands times";
  for (const double factor : windowed.factors) text += ' ' + significant(factor, 4);
  return text + ")\n";
}

bool z_is_up(const ShReport& report) { return convention(report.engine).from_welkin[1].z > 0.5; }

std::string dominant_lines(const ShReport& report) {
  if (!report.dominant) return "\nDominant light: none, the light has no direction\n";
  return "\nDominant light" + std::string(report.sun ? " of what is left" : "") + "\n  towards     " +
         direction_text(report.dominant->direction, z_is_up(report)) + "\n  irradiance  " +
         significant(report.dominant->irradiance) + "  on a surface that faces it\n";
}

std::string irradiance_error_lines(const ShReport& report) {
  if (report.irradiance_errors.empty()) return "";
  std::string text = std::string("\nIrradiance") + (report.sun ? " of what is left" : "") +
                     " against direct cosine integration, relative to its rms\n  bands   rms       maximum\n";
  for (const IrradianceError& error : report.irradiance_errors) {
    text += pad_left(std::to_string(error.bands), 7) + "   " + pad_right(significant(error.rms, 3), 10) +
            significant(error.maximum, 3) + '\n';
  }
  return text;
}

std::string replaced_sentence(const ProjectionDiagnostics& diagnostics) {
  if (diagnostics.nans_replaced + diagnostics.infinities_replaced + diagnostics.negatives_replaced == 0) {
    return "no pixel value had to be replaced";
  }
  return "replaced: " + counted({{diagnostics.nans_replaced, "NaN"},
                                 {diagnostics.infinities_replaced, "infinite value"},
                                 {diagnostics.negatives_replaced, "negative value"}});
}

std::string clamp_sentence(const ShReport& report) {
  const ProjectionDiagnostics& diagnostics = report.projection.diagnostics;
  if (!report.options.clamp) return "no clamp was asked for";
  const std::string limit = "the clamp at " + significant(report.options.clamp->maximum);
  if (diagnostics.texels_clamped == 0) return limit + " changed no texel";
  const double before =
      diagnostics.flux_before_clamp.x + diagnostics.flux_before_clamp.y + diagnostics.flux_before_clamp.z;
  const double after = diagnostics.flux.x + diagnostics.flux.y + diagnostics.flux.z;
  return limit + " changed " + counted(diagnostics.texels_clamped, "texel") + " and took away " +
         significant(100.0 * (before - after) / before, 3) + " % of the light";
}

std::string diagnostics_lines(const ShReport& report) {
  const ProjectionDiagnostics& diagnostics = report.projection.diagnostics;
  std::string text = "\nDiagnostics\n";
  const bool texels = !(report.sky && report.sky->quadrature);
  text += "  " + counted(diagnostics.texels, texels ? "texel" : "direction") + (texels ? " projected, " : " asked, ") +
          quadrature_name(report) + " quadrature, " + counted(static_cast<std::uint64_t>(report.threads), "thread") +
          ", " + name(active_instruction_set()) + '\n';
  text += "  " + replaced_sentence(diagnostics) + '\n';
  text += "  " + clamp_sentence(report) + '\n';
  text += "  total flux (integral over the sphere) " + significant(diagnostics.flux) + '\n';
  text += "  estimated relative error of the coefficients " + significant(diagnostics.error_estimate, 2) + '\n';
  std::size_t width = kPassWidth;
  for (const PassRecord& pass : diagnostics.passes) width = std::max(width, pass.name.size() + 1);
  for (const PassRecord& pass : diagnostics.passes) {
    text += "  pass " + pad_right(pass.name, width) + pad_right(pass.action, 6) +
            pad_left(duration(pass.milliseconds), 9) + "  " + pass.reason + '\n';
  }
  return text;
}

}  // namespace

std::string sh_table(const ShReport& report) {
  const SphericalHarmonics& radiance = report.projection.radiance;
  std::string text = source_lines(report) + convention_lines(radiance.bands()) + indented("Axes: " + report.axes) +
                     coefficient_lines(radiance, report.irradiance);
  text += report.engine_light ? engine_lines(*report.engine_light) : babylon_lines(report.polynomial);
  return text + "\nAverage colour (mean radiance of the sphere)  " + significant(average_radiance(radiance)) + '\n' +
         window_lines(report) + (report.sun_wanted ? '\n' + sun_text(report.sun, z_is_up(report)) : "") +
         dominant_lines(report) + irradiance_error_lines(report) + diagnostics_lines(report);
}

}  // namespace welkin::tool
