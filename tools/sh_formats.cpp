// The forms of harmonics that `welkin sh` prints.
#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string_view>

#include "platform/text.h"
#include "tools/engine_folders.h"
#include "tools/json.h"
#include "tools/sh_command.h"
#include "tools/text.h"
#include "welkin/core.h"

namespace welkin::tool {

// For a person: plain ASCII, in 80 columns except for reasons from the library.

namespace {

constexpr std::size_t kLabelWidth = 13;
constexpr std::size_t kNumberWidth = 10;
constexpr std::size_t kPassWidth = 10;
constexpr int kNamedBands = 4;

/// The polynomial in (x, y, z) to which Y(l, m) is proportional; for higher bands the Legendre function of z and the
/// wave around the z axis (p = atan2(y, x)) whose product it is.
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
      "  The irradiance on a surface facing n is the sum of e(l,m) Y(l,m)(n).\n"
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

std::string source_lines(const ShReport& report) {
  const Source& source = report.source;
  std::string text = printable(source.path) + ": ";
  if (source.width > 0) {
    text += std::to_string(source.width) + " x " + std::to_string(source.height) + ' ' + source.layout + ", ";
  }
  text += source.format + "\n  (" + source.detail + ")\n";
  if (report.sky) text += sky_lines(*report.sky);
  for (const std::string& note : source.notes) text += "  note: " + printable(note) + '\n';
  return text;
}

/// Returns the text's lines, each after `prefix`.
std::string prefixed(const std::string& prefix, const std::string& text) {
  return prefix + replaced(text, "\n", "\n" + prefix) + '\n';
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
  return text + prefixed("  ", light.formula);
}

/// Returns the lines about an engine that takes no harmonics.
std::string no_form_lines(const ShReport& report) {
  if (has_engine_light(report.engine)) return "";
  const Convention& engine = convention(report.engine);
  std::string text =
      std::string("\n") + engine.title + " does not read harmonics; the following is for your own shaders.";
  if (has_folder(report.engine)) text += "\n'welkin bake --for " + std::string(engine.name) + "' writes what it loads.";
  return text + '\n';
}

std::string window_lines(const ShReport& report) {
  const WindowResult& windowed = report.windowed;
  const std::string heading = "\nMinimum irradiance over all normals  ";
  if (report.window == Window::none) {
    const glm::dvec3& value = windowed.minimum_before;
    const bool negative = value.x < 0.0 || value.y < 0.0 || value.z < 0.0;
    return heading + significant(value) +
           (negative ? "\n  negative, because few bands ring; --window min-laplacian avoids that" : "") + '\n';
  }
  std::string text = heading + significant(windowed.minimum_before) + " before the window,\n  " +
                     significant(windowed.minimum_after) + " after it (" + name(report.window) + ", " +
                     (report.window == Window::min_laplacian ? "lambda " : "width ") + significant(windowed.parameter) +
                     "; bands times";
  for (const double factor : windowed.factors) text += ' ' + significant(factor, 4);
  return text + ")\n";
}

bool z_is_up(const ShReport& report) { return convention(report.engine).from_welkin[1].z > 0.5; }

std::string dominant_lines(const ShReport& report) {
  if (!report.dominant) return "\nDominant light: none, the light has no direction\n";
  return "\nDominant light" + std::string(report.sun ? " of what is left" : "") + "\n  towards     " +
         direction_text(report.dominant->direction, z_is_up(report)) + "\n  irradiance  " +
         significant(report.dominant->irradiance) + "  on a surface facing it\n";
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
  if (!report.options.pixels.clamp) return "no clamp was requested";
  const std::string limit = "the clamp at " + significant(report.options.pixels.clamp->maximum);
  if (diagnostics.texels_clamped == 0) return limit + " changed no texel";
  const double before = diagnostics.total_radiance_before_clamp.x + diagnostics.total_radiance_before_clamp.y +
                        diagnostics.total_radiance_before_clamp.z;
  const double after = diagnostics.total_radiance.x + diagnostics.total_radiance.y + diagnostics.total_radiance.z;
  return limit + " changed " + counted(diagnostics.texels_clamped, "texel") + " and removed " +
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
  text += "  total radiance (integral over the sphere) " + significant(diagnostics.total_radiance) + '\n';
  text += "  estimated relative error of the coefficients " + significant(diagnostics.error_estimate, 2) + '\n';
  std::size_t width = kPassWidth;
  for (const PassRecord& pass : diagnostics.passes) width = std::max(width, pass.name.size() + 1);
  for (const PassRecord& pass : diagnostics.passes) {
    text += "  pass " + pad_right(pass.name, width) + pad_right(name(pass.action), 6) +
            pad_left(duration(pass.milliseconds), 9) + "  " + pass.reason + '\n';
  }
  return text;
}

}  // namespace

std::string sh_table(const ShReport& report) {
  const SphericalHarmonics& radiance = report.projection.radiance;
  std::string text = source_lines(report) + convention_lines(radiance.bands()) +
                     prefixed("  ", "Axes: " + report.axes) + coefficient_lines(radiance, report.irradiance);
  text += no_form_lines(report) +
          engine_lines(report.engine_light ? *report.engine_light : engine_light_unrotated(radiance, Engine::welkin));
  return text + "\nAverage colour (mean radiance of the sphere)  " + significant(mean_radiance(radiance)) + '\n' +
         window_lines(report) + (report.sun_wanted ? '\n' + sun_text(report.sun, z_is_up(report)) : "") +
         dominant_lines(report) + irradiance_error_lines(report) + diagnostics_lines(report);
}

// JSON. Members are only ever added: programs read this.

namespace {

Json source_json(const Source& source) {
  return {{"path", source.path},     {"layout", source.layout}, {"width", source.width},
          {"height", source.height}, {"format", source.format}, {"notes", source.notes}};
}

Json coefficients_json(const SphericalHarmonics& harmonics) { return json_list(harmonics.coefficients(), json_triple); }

Json babylon_json(const BabylonPolynomial& polynomial) {
  return {{"x", json_triple(polynomial.x)},   {"y", json_triple(polynomial.y)},   {"z", json_triple(polynomial.z)},
          {"xx", json_triple(polynomial.xx)}, {"yy", json_triple(polynomial.yy)}, {"zz", json_triple(polynomial.zz)},
          {"yz", json_triple(polynomial.yz)}, {"zx", json_triple(polynomial.zx)}, {"xy", json_triple(polynomial.xy)}};
}

Json settings_json(const ShReport& report) {
  const ProjectionOptions& options = report.options;
  Json settings = {{"quadrature", quadrature_name(report)},
                   {"target_size", options.target_size.value_or(0)},
                   {"clamp", nullptr},
                   {"preserve_clamped", options.pixels.clamp && options.pixels.clamp->preserve_colour},
                   {"gamma", options.pixels.gamma}};
  if (options.pixels.clamp) settings["clamp"] = options.pixels.clamp->maximum;
  return settings;
}

Json diagnostics_json(const ShReport& report) {
  const ProjectionDiagnostics& diagnostics = report.projection.diagnostics;
  const Json passes = json_list(diagnostics.passes, [](const PassRecord& pass) -> Json {
    return {{"name", pass.name}, {"action", name(pass.action)}, {"reason", pass.reason}, {"ms", pass.milliseconds}};
  });
  return {{"texels", diagnostics.texels},
          {"replaced", diagnostics.nans_replaced + diagnostics.infinities_replaced + diagnostics.negatives_replaced},
          {"nans_replaced", diagnostics.nans_replaced},
          {"infinities_replaced", diagnostics.infinities_replaced},
          {"negatives_replaced", diagnostics.negatives_replaced},
          {"clamped", diagnostics.texels_clamped},
          {"total_radiance_before_clamp", json_triple(diagnostics.total_radiance_before_clamp)},
          {"total_radiance", json_triple(diagnostics.total_radiance)},
          {"average", json_triple(mean_radiance(report.projection.radiance))},
          {"error_estimate", diagnostics.error_estimate},
          {"settings", settings_json(report)},
          {"passes", passes}};
}

Json axes_json(const ShReport& report) { return {{"engine", convention(report.engine).name}, {"words", report.axes}}; }

Json window_json(const ShReport& report) {
  const WindowResult& windowed = report.windowed;
  return {{"name", name(report.window)},
          {"parameter", windowed.parameter},
          {"factors", windowed.factors},
          {"minimum_irradiance_before", json_triple(windowed.minimum_before)},
          {"minimum_irradiance_after", json_triple(windowed.minimum_after)}};
}

Json engine_json(const EngineLight& light) {
  Json terms = Json::object();
  for (const EngineTerm& term : light.terms) terms[term.name] = json_triple(term.rgb);
  Json json = {
      {"name", convention(light.engine).name}, {"form", light.form}, {"formula", light.formula}, {"terms", terms}};
  for (const auto& [name, value] : light.vectors) json["vectors"][name] = {value.x, value.y, value.z, value.w};
  return json;
}

/// Returns all engines' forms, each with its axes.
Json engines_json(const std::vector<EngineLight>& lights) {
  Json list = Json::array();
  for (const EngineLight& light : lights) {
    list.push_back(engine_json(light));
    list.back()["axes"] = convention(light.engine).axes;
  }
  return list;
}

Json dominant_json(const std::optional<DominantLight>& light) {
  if (!light) return nullptr;
  return {{"direction", json_triple(light->direction)}, {"irradiance", json_triple(light->irradiance)}};
}

Json sun_json(const std::optional<Sun>& sun) {
  if (!sun) return nullptr;
  return {{"direction", json_triple(sun->direction)},
          {"irradiance", json_triple(sun->irradiance)},
          {"radiance", json_triple(sun->radiance)},
          {"solid_angle", sun->solid_angle},
          {"angular_radius_degrees", sun->angular_radius_degrees},
          {"texels", sun->texels},
          {"total_radiance_before", json_triple(sun->total_radiance_before)},
          {"total_radiance_after", json_triple(sun->total_radiance_after)}};
}

Json irradiance_errors_json(const std::vector<IrradianceError>& errors) {
  return json_list(errors, [](const IrradianceError& error) -> Json {
    return {{"bands", error.bands}, {"rms", error.rms}, {"maximum", error.maximum}, {"relative", error.relative}};
  });
}

}  // namespace

std::string sh_json(const ShReport& report) {
  Json json = {{"source", source_json(report.source)},
               {"axes", axes_json(report)},
               {"bands", report.projection.radiance.bands()},
               {"radiance", coefficients_json(report.projection.radiance)},
               {"irradiance", coefficients_json(report.irradiance)},
               {"babylon", babylon_json(report.polynomial)},
               {"engine", report.engine_light ? engine_json(*report.engine_light) : Json(nullptr)},
               {"window", window_json(report)},
               {"dominant_light", dominant_json(report.dominant)}};
  if (!report.engine_lights.empty()) json["engines"] = engines_json(report.engine_lights);
  if (report.sky) json["sky"] = sky_json(*report.sky);
  if (report.sun_wanted) json["sun"] = sun_json(report.sun);
  if (!report.irradiance_errors.empty()) json["irradiance_errors"] = irradiance_errors_json(report.irradiance_errors);
  json["diagnostics"] = diagnostics_json(report);
  return json_text(json);
}

// One line per coefficient, all digits, remarks after #. For awk, spreadsheets and people.

namespace {

/// Returns whether an engine's form is printed in place of the canonical coefficients, which are Welkin's own.
bool asks_for_form(const ShReport& report) { return report.engine_light && report.engine != Engine::welkin; }

std::string remark(const std::string& text) { return prefixed("# ", text); }

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

std::string engine_remarks(const EngineLight& light) {
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

std::string sun_remarks(const Sun& sun) {
  return remark(
             "the sun, which is not in the harmonics: unit direction towards it, irradiance on a surface that faces "
             "it") +
         term_line("sun.direction", sun.direction) + term_line("sun.irradiance", sun.irradiance) + "sun.solid_angle " +
         all_digits(sun.solid_angle) + '\n';
}

}  // namespace

std::string sh_text(const ShReport& report) {
  std::string text = remark(printable(report.source.path) + "; r g b behind each name; axes: " + report.axes);
  text += asks_for_form(report) ? engine_remarks(*report.engine_light) : harmonics_of_both(report);
  if (report.sun) text += sun_remarks(*report.sun);
  return text;
}

// A header for C and C++.

namespace {

/// Returns the file's stem as a C identifier: "city-at noon.exr" as "city_at_noon".
std::string identifier(const std::string& path) {
  std::string name;
  for (const char c : platform::utf8(platform::path_of(path).stem())) {
    name += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  }
  if (name.empty() || std::isdigit(static_cast<unsigned char>(name.front())) != 0) name.insert(0, "environment_");
  return name;
}

/// Returns the shortest C constant that reads back as the same float. C has none for values beyond all floats.
std::string float_constant(double value, const char* suffix = "f") {
  if (!(std::abs(value) <= static_cast<double>(std::numeric_limits<float>::max()))) {
    throw Error(ErrorCode::limit_exceeded,
                "a number of the light is " + significant(value) +
                    ", which exceeds the range of floats; lower the exposure of the image, clamp it "
                    "with --clamp, or use the JSON, which holds doubles");
  }
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), static_cast<float>(value)).ptr;
  std::string text(buffer.data(), end);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text + suffix;
}

std::string triple(const glm::dvec3& value, const char* suffix = "f") {
  return float_constant(value.x, suffix) + ", " + float_constant(value.y, suffix) + ", " +
         float_constant(value.z, suffix);
}

/// Returns the text with nothing that could end the comment around it.
std::string in_comment(const std::string& text) { return replaced(text, "*/", "* /"); }

std::string comment(const std::string& text) { return "/* " + replaced(in_comment(text), "\n", "\n * ") + " */\n"; }

std::string row(const std::string& numbers, const std::string& name) {
  return "  {" + numbers + "}, /* " + in_comment(name) + " */\n";
}

std::string row(const glm::dvec3& rgb, const std::string& name) { return row(triple(rgb), name); }

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
  for (const EngineVector& vector : light.vectors) {
    text += row(triple(glm::dvec3(vector.value)) + ", " + float_constant(vector.value.w), vector.name);
  }
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

/// Returns the arrays of a header of this name.
std::string arrays(const std::string& name, const ShReport& report) {
  std::string text = asks_for_form(report)
                         ? engine_array(name + '_' + convention(report.engine).name, *report.engine_light)
                         : harmonics_arrays(name, report);
  for (const EngineLight& light : report.engine_lights) {
    text += comment(std::string(convention(light.engine).title) + ", axes: " + convention(light.engine).axes) +
            engine_array(name + '_' + convention(light.engine).name, light);
  }
  if (report.sun) text += sun_arrays(name, *report.sun);
  return text;
}

/// Returns the comment at the head of a file, with the `remark` in it.
std::string head(const ShReport& report, const std::string& remark) {
  return comment("Light of " + printable(portable_path(report.source.path)) +
                 ", by welkin " WELKIN_VERSION_STRING ".\nAxes: " + report.axes + remark);
}

}  // namespace

std::string sh_c_header(const ShReport& report) try {
  const std::string name = identifier(report.source.path);
  return head(report, "\nRows are r, g, b unless stated otherwise.") + "#ifndef WELKIN_" + name +
         "_H\n#define WELKIN_" + name + "_H\n\n" + arrays(name, report) + "\n#endif\n";
} catch (const Error& error) {
  throw Error(error.code(), printable(report.source.path) + ": " + error.what());
}

std::string sh_glsl(const ShReport& report) try {
  const EngineLight light = engine_light_unrotated(report.projection.radiance, Engine::welkin);
  std::string text = head(report, "") + "const vec3 sh[9] = vec3[9](\n";
  for (const EngineTerm& term : light.terms) {
    text += "  vec3(" + triple(term.rgb, "") + (&term == &light.terms.back() ? "));\n" : "),\n");
  }
  if (report.sun) {
    text +=
        "/* The sun, which is not in sh: unit direction towards it, irradiance on a surface that faces it. */\n"
        "const vec3 sun_direction = vec3(" +
        triple(report.sun->direction, "") + ");\nconst vec3 sun_irradiance = vec3(" +
        triple(report.sun->irradiance, "") + ");\n";
  }
  return text + light.formula + '\n';
} catch (const Error& error) {
  throw Error(error.code(), printable(report.source.path) + ": " + error.what());
}

std::string sh_c_sharp(const ShReport& report) try {
  std::vector<EngineLight> lights = report.engine_lights;
  if (report.engine_light) lights.push_back(*report.engine_light);
  const auto unity = std::ranges::find(lights, Engine::unity, &EngineLight::engine);
  if (unity == lights.end()) {
    throw Error(ErrorCode::invalid_argument, "C# is a SphericalHarmonicsL2 of Unity's; add --for unity");
  }
  std::string text = head(report, "") +
                     "using UnityEngine;\nusing UnityEngine.Rendering;\n\npublic static class WelkinLight {\n" +
                     "  /// For RenderSettings.ambientProbe, with RenderSettings.ambientMode = AmbientMode.Custom.\n"
                     "  public static SphericalHarmonicsL2 Probe() {\n"
                     "    var sh = new SphericalHarmonicsL2();\n"
                     "    for (int i = 0; i < 9; ++i) {\n"
                     "      for (int channel = 0; channel < 3; ++channel) sh[channel, i] = rgb[i, channel];\n"
                     "    }\n    return sh;\n  }\n\n  static readonly float[,] rgb = {\n";
  for (const EngineTerm& term : unity->terms) text += "    {" + triple(term.rgb) + "},\n";
  text += "  };\n";
  if (report.sun) {
    text +=
        "\n  /// The sun, which is not in the probe: towards it, and irradiance on a surface that faces it.\n"
        "  public static readonly Vector3 SunDirection = new Vector3(" +
        triple(report.sun->direction) + ");\n  public static readonly Vector3 SunIrradiance = new Vector3(" +
        triple(report.sun->irradiance) + ");\n";
  }
  return text + "}\n";
} catch (const Error& error) {
  throw Error(error.code(), printable(report.source.path) + ": " + error.what());
}

}  // namespace welkin::tool
