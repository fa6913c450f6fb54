#include "perf.h"
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

/// Returns two digits of a percentage; "0" below a millionth of one.
std::string percent(double share) {
  const double value = 100.0 * share;
  if (std::abs(value) < 1e-6) return "0";
  return number(std::abs(value) < 9.95 ? "%.2g" : "%.0f", value);
}

double smallest(const glm::dvec3& rgb) { return std::min({rgb.r, rgb.g, rgb.b}); }

std::vector<IrradianceError> errors_of(const Environment& environment, const SphericalHarmonics& radiance) {
  return irradiance_errors(environment.view(), radiance, kNormals);
}

/// The light without the sun, and the error of its irradiance by bands.
struct WithoutSun {
  Sun sun;
  std::vector<IrradianceError> errors;
  double share_of_rms = 0.0;  ///< rms irradiance of the remaining light relative to the whole
};

template <typename Image>
std::optional<WithoutSun> without_sun(Image image, const ProjectionOptions& options, const SphericalHarmonics& whole) {
  const std::optional<Sun> sun = extract_sun(image);
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

std::string errors_text(double rms, double maximum) { return percent(rms) + " / " + percent(maximum); }

void add_sun(Table& table, const Environment& environment, const ProjectionOptions& options, const std::string& name,
             const SphericalHarmonics& radiance, const std::vector<IrradianceError>& errors) {
  const std::optional<WithoutSun> rest = without_sun(environment, options, radiance);
  if (!rest) return;
  std::vector<std::string> cells{name,
                                 percent(luminance(rest->sun.irradiance) / luminance(rest->sun.total_radiance_before))};
  for (const int bands : kSunBands) {
    const IrradianceError& before = errors[static_cast<std::size_t>(bands - 1)];
    const IrradianceError& after = rest->errors[static_cast<std::size_t>(bands - 1)];
    cells.push_back(errors_text(before.rms, before.maximum));
    cells.push_back(errors_text(after.rms * rest->share_of_rms, after.maximum * rest->share_of_rms));
  }
  table.add(cells);
}

/// Returns the rms error over the reference's rms, and the largest error of a texel's channel over its own value.
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
  return errors_text(std::sqrt(squares / whole), largest);
}

/// Adds the errors of the irradiance cubemap of a bake, from bands and by default.
void add_cubemap(Table& table, const EnvironmentView& view, const std::string& name) {
  const Cubemap truth = direct_irradiance_cubemap(view, kCubemap);
  std::vector<std::string> cells{name};
  for (const IrradianceMethod method : {IrradianceMethod::harmonics, IrradianceMethod::automatic}) {
    BakeOptions options{.background = {}, .specular = {}, .brdf = {}};
    options.irradiance = IrradianceOptions{.size = kCubemap, .method = method};
    cells.push_back(error_text(*bake(view, options).irradiance, truth));
  }
  table.add(cells);
}

void add_windows(Table& table, const Environment& environment, const std::string& name,
                 const SphericalHarmonics& radiance, const glm::dvec3& mean) {
  SphericalHarmonics few(kWindowedBands);
  std::copy_n(radiance.coefficients().begin(), few.coefficients().size(), few.coefficients().begin());
  std::vector<std::string> cells{name};
  for (const Window window : kWindows) {
    const WindowResult windowed = apply_window(few, window);
    cells.push_back(percent(smallest(windowed.minimum_after / (std::numbers::pi * mean))));
    cells.push_back(percent(errors_of(environment, windowed.radiance).back().rms));
    if (window == Window::min_laplacian) cells.push_back(number("%.4f", windowed.parameter));
  }
  table.add(cells);
}

struct Tables {
  Table cubemaps{{"environment", "harmonics, 3 bands", "default"}};
  Table errors;
  Table windows;
  Table suns;

  void add(const std::filesystem::path& file) {
    const Environment environment = read_environment(file);
    const EnvironmentStatistics statistics = measure_environment(file);
    const std::string name = file.stem().string();
    ProjectionOptions options;
    options.bands = kBands[std::size(kBands) - 1];
    const SphericalHarmonics radiance = project(environment.view(), options).radiance;
    const std::vector<IrradianceError> found = errors_of(environment, radiance);
    std::vector<std::string> cells{
        name, number("%.0f", luminance(statistics.brightest) / luminance(glm::dvec3(statistics.mean)))};
    for (const int bands : kBands) {
      const IrradianceError& error = found[static_cast<std::size_t>(bands - 1)];
      cells.push_back(errors_text(error.rms, error.maximum) + " / " + percent(error.relative));
    }
    errors.add(cells);
    add_sun(suns, environment, options, name, radiance, found);
    add_cubemap(cubemaps, environment.view(), name);
    add_windows(windows, environment, name, radiance, statistics.mean);
  }
};

Tables empty_tables() {
  std::vector<std::string> errors{"environment", "contrast"};
  for (const int bands : kBands) errors.push_back(std::to_string(bands) + (bands > 1 ? " bands" : " band"));
  std::vector<std::string> windows{"environment"};
  for (const Window window : kWindows) windows.insert(windows.end(), {name(window), "rms"});
  windows.emplace_back("lambda");
  std::vector<std::string> suns{"environment", "sun's share of the light"};
  for (const int bands : kSunBands) suns.insert(suns.end(), {std::to_string(bands) + " bands", "and the sun"});
  return {.errors = Table(errors), .windows = Table(windows), .suns = Table(suns)};
}

}  // namespace

std::string irradiance_error_tables(const Paths& files) {
  Tables tables = empty_tables();
  for (const std::filesystem::path& file : files) {
    std::fprintf(stderr, "%s\n", file.filename().string().c_str());
    tables.add(file);
  }
  return "Error of the irradiance cubemap of a bake, rms / largest relative, percent\n\n" + tables.cubemaps.text() +
         "\nError of the irradiance: rms / maximum / largest relative, percent\n\n" + tables.errors.text() +
         "\nLeast irradiance with three bands, percent of the mean; rms error, percent\n\n" + tables.windows.text() +
         "\nError of the irradiance, rms / maximum, percent: of the bands alone, and with the sun as a light of its "
         "own\n\n" +
         tables.suns.text();
}

}  // namespace welkin::perf
