// `welkin sh` for a person: plain ASCII, in 80 columns but for the reasons that the library gives.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <string_view>

#include "tools/number_text.h"
#include "tools/sh_report.h"
#include "welkin/instruction_set.h"

namespace welkin::tool {
namespace {

constexpr std::size_t kLabelWidth = 13;
constexpr std::size_t kNumberWidth = 10;
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
      "  Y is real and orthonormal, without Condon-Shortley phase; y is up:\n"
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

std::string source_lines(const Source& source) {
  return source.path + ": " + std::to_string(source.width) + " x " + std::to_string(source.height) + ' ' +
         source.layout + ", " + source.format + "\n  (" + source.detail + ")\n";
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
  text += "  " + counted(diagnostics.texels, "texel") + " projected, " + quadrature_name(report.options.quadrature) +
          " quadrature, " + counted(static_cast<std::uint64_t>(report.threads), "thread") + ", " +
          name(active_instruction_set()) + '\n';
  text += "  " + replaced_sentence(diagnostics) + '\n';
  text += "  " + clamp_sentence(report) + '\n';
  text += "  total flux (integral over the sphere) " + significant(diagnostics.flux) + '\n';
  text += "  estimated relative error of the coefficients " + significant(diagnostics.error_estimate, 2) + '\n';
  for (const PassRecord& pass : diagnostics.passes) {
    text += "  pass " + pad_right(pass.name, 10) + pad_right(pass.action, 6) +
            pad_left(duration(pass.milliseconds), 9) + "  " + pass.reason + '\n';
  }
  return text;
}

}  // namespace

std::string sh_table(const ShReport& report) {
  const SphericalHarmonics& radiance = report.projection.radiance;
  return source_lines(report.source) + convention_lines(radiance.bands()) +
         coefficient_lines(radiance, report.irradiance) + babylon_lines(report.polynomial) +
         "\nAverage colour (mean radiance of the sphere)  " + significant(average_radiance(radiance)) + '\n' +
         diagnostics_lines(report);
}

}  // namespace welkin::tool
