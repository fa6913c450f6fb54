#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>

#include "benchmarks.h"
#include "perf/report/error_norms.h"
#include "welkin/bake.h"
#include "welkin/environment_file.h"
#include "welkin/projection.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::perf {
namespace {

constexpr int kBands[] = {1, 2, 3, 4, 5, 7};
constexpr Window kWindows[] = {Window::none, Window::hanning, Window::lanczos, Window::min_laplacian};
constexpr int kWindowedBands = 3;
constexpr int kSunBands[] = {2, 3, 5};
constexpr int kNormals = 500;
constexpr int kCubemap = 9;  ///< texels along an edge: 486 normals

std::string number(const char* format, double value) {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

/// Two digits of a percentage; "0" for what is less than a millionth of one.
std::string percent(double share) {
  const double value = 100.0 * share;
  if (std::abs(value) < 1e-6) return "0";
  return number(std::abs(value) < 9.95 ? "%.2g" : "%.0f", value);
}

double smallest(const glm::dvec3& rgb) { return std::min({rgb.r, rgb.g, rgb.b}); }

std::vector<IrradianceError> errors_of(const Environment& environment, const SphericalHarmonics& radiance) {
  return irradiance_errors(environment.view(), radiance, kNormals);
}

/// What is left without the sun, and how far its irradiance is from that of its bands.
struct WithoutSun {
  Sun sun;
  std::vector<IrradianceError> errors;
  double share_of_rms = 0.0;  ///< rms irradiance of what is left over that of the whole
};

template <typename Image>
std::optional<WithoutSun> without_sun(Image image, const ProjectionOptions& options, const SphericalHarmonics& whole) {
  const std::optional<Sun> sun = take_out_sun(image);
  if (!sun) return std::nullopt;
  const SphericalHarmonics rest = project(image.view(), options).radiance;
  return WithoutSun{*sun, irradiance_errors(image.view(), rest, kNormals),
                    report::rms_of_irradiance(rest) / report::rms_of_irradiance(whole)};
}

std::optional<WithoutSun> without_sun(const Environment& environment, const ProjectionOptions& options,
                                      const SphericalHarmonics& whole) {
  const float* const rgb = environment.pixels.get();
  const auto count = [](int width, int height) {
    return std::size_t{3} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  };
  if (environment.info.layout != Layout::lat_long) {
    const int size = environment.face_size();
    return without_sun(Cubemap(size, {rgb, count(size, 6 * size)}), options, whole);
  }
  const LatLongView view = environment.lat_long();
  return without_sun(LatLongImage{view.width, view.height, {rgb, rgb + count(view.width, view.height)}}, options,
                     whole);
}

double luminance(const glm::dvec3& rgb) { return 0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b; }

/// One environment's rows in the tables.
struct Rows {
  std::string errors;
  std::string windows;
  std::string suns;  ///< empty without a sun
  std::string cubemaps;
};

std::string sun_row(const Environment& environment, const ProjectionOptions& options, const std::string& name,
                    const SphericalHarmonics& radiance, const std::vector<IrradianceError>& errors) {
  const std::optional<WithoutSun> rest = without_sun(environment, options, radiance);
  if (!rest) return "";
  std::string row =
      "| " + name + " | " + percent(luminance(rest->sun.irradiance) / luminance(rest->sun.total_radiance_before));
  for (const int bands : kSunBands) {
    const IrradianceError& before = errors[static_cast<std::size_t>(bands - 1)];
    const IrradianceError& after = rest->errors[static_cast<std::size_t>(bands - 1)];
    row += " | " + percent(before.rms) + " / " + percent(before.maximum) + " | " +
           percent(after.rms * rest->share_of_rms) + " / " + percent(after.maximum * rest->share_of_rms);
  }
  return row + " |\n";
}

/// Rms over the rms of the truth, and the largest error of a texel's channel over its own value.
std::string error_text(const Cubemap& found, const Cubemap& truth) {
  double squares = 0.0;
  double whole = 0.0;
  double largest = 0.0;
  for (std::size_t k = 0; k < truth.pixels().size(); ++k) {
    const auto wanted = static_cast<double>(truth.pixels()[k]);
    const double difference = static_cast<double>(found.pixels()[k]) - wanted;
    squares += difference * difference;
    whole += wanted * wanted;
    if (difference != 0.0) largest = std::max(largest, std::abs(difference / wanted));
  }
  return percent(std::sqrt(squares / whole)) + " / " + percent(largest);
}

/// The irradiance cubemap of a bake, from bands and by default.
std::string cubemap_row(const EnvironmentView& view, const std::string& name) {
  const Cubemap truth = direct_irradiance_cubemap(view, kCubemap);
  std::string row = "| " + name + " |";
  for (const IrradianceMethod method : {IrradianceMethod::harmonics, IrradianceMethod::automatic}) {
    BakeOptions options{.background = {}, .specular = {}, .brdf = {}};
    options.irradiance = IrradianceOptions{.size = kCubemap, .method = method};
    row += " " + error_text(*bake(view, options).irradiance, truth) + " |";
  }
  return row;
}

Rows rows_of(const std::filesystem::path& file) {
  const Environment environment = read_environment(file);
  const EnvironmentStatistics statistics = measure_environment(file);
  ProjectionOptions options;
  options.bands = kBands[std::size(kBands) - 1];
  const SphericalHarmonics radiance = project(environment.view(), options).radiance;
  const glm::dvec3 mean = statistics.mean;

  Rows rows;
  rows.errors =
      "| " + file.stem().string() + " | " + number("%.0f", luminance(statistics.brightest) / luminance(mean)) + " |";
  const std::vector<IrradianceError> errors = errors_of(environment, radiance);
  for (const int bands : kBands) {
    const IrradianceError& error = errors[static_cast<std::size_t>(bands - 1)];
    rows.errors += " " + percent(error.rms) + " / " + percent(error.maximum) + " / " + percent(error.relative) + " |";
  }

  rows.suns = sun_row(environment, options, file.stem().string(), radiance, errors);

  rows.cubemaps = cubemap_row(environment.view(), file.stem().string());

  SphericalHarmonics few(kWindowedBands);
  std::copy_n(radiance.coefficients().begin(), few.coefficients().size(), few.coefficients().begin());
  rows.windows = "| " + file.stem().string() + " |";
  for (const Window window : kWindows) {
    const Windowed windowed = apply_window(few, window);
    rows.windows += " " + percent(smallest(windowed.minimum_after / (std::numbers::pi * mean))) + " |";
    rows.windows += " " + percent(errors_of(environment, windowed.radiance).back().rms) + " |";
    if (window == Window::min_laplacian) rows.windows += " " + number("%.4f", windowed.parameter) + " |";
  }
  return rows;
}

}  // namespace

std::string irradiance_error_tables(const std::vector<std::filesystem::path>& files) {
  std::string errors =
      "Error of the irradiance: rms / maximum / largest relative, percent\n\n| environment | contrast |";
  std::string rule = "|---|---|";
  for (const int bands : kBands) {
    errors += " " + std::to_string(bands) + (bands > 1 ? " bands |" : " band |");
    rule += "---|";
  }
  errors += "\n" + rule + "\n";
  std::string windows = "Least irradiance with three bands, percent of the mean; rms error, percent\n\n| environment |";
  rule = "|---|";
  for (const Window window : kWindows) {
    windows += std::string(" ") + name(window) + " | rms |";
    rule += "---|---|";
  }
  windows += " lambda |\n" + rule + "---|\n";
  std::string suns =
      "Error of the irradiance, rms / maximum, percent: of the bands alone, and with the sun as a light of its own\n\n"
      "| environment | sun's share of the light |";
  rule = "|---|---|";
  for (const int bands : kSunBands) {
    suns += " " + std::to_string(bands) + " bands | and the sun |";
    rule += "---|---|";
  }
  suns += "\n" + rule + "\n";
  std::string cubemaps =
      "Error of the irradiance cubemap of a bake, rms / largest relative, percent\n\n"
      "| environment | harmonics, 3 bands | default |\n|---|---|---|\n";
  for (const std::filesystem::path& file : files) {
    std::fprintf(stderr, "%s\n", file.filename().string().c_str());
    const Rows rows = rows_of(file);
    errors += rows.errors + "\n";
    windows += rows.windows + "\n";
    suns += rows.suns;
    cubemaps += rows.cubemaps + "\n";
  }
  return cubemaps + "\n" + errors + "\n" + windows + "\n" + suns;
}

}  // namespace welkin::perf
