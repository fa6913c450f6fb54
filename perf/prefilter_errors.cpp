#include "prefilter_errors.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <glm/geometric.hpp>
#include <map>
#include <optional>
#include <random>
#include <sstream>

#include "image/texel_geometry.h"
#include "welkin/environment_file.h"
#include "welkin/error.h"
#include "welkin/image.h"
#include "welkin/specular.h"

namespace welkin::perf {
namespace {

/// Truth below this share of a mip's mean counts as that much: what is black is not measured against 0.
constexpr double kFloor = 1e-6;

struct Settings {
  int texels = 256;
  int size = 512;
  int samples = 1024;
  std::vector<PrefilterMethod> methods{PrefilterMethod::automatic, PrefilterMethod::sampled};
};

struct Picture {
  std::string name;
  LatLongImage image;
};

std::string number(const char* format, double value) {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

Picture made_up(const std::string& name, const std::function<double(int, int)>& light) {
  Picture picture{name, {1024, 512, {}}};
  for (int row = 0; row < 512; ++row) {
    for (int column = 0; column < 1024; ++column) {
      const double value = light(column, row);
      for (const double tint : {1.0, 0.8, 0.6}) picture.image.pixels.push_back(static_cast<float>(tint * value));
    }
  }
  return picture;
}

std::vector<Picture> made_up_pictures() {
  std::mt19937 random(7);
  const auto noise = [&] { return static_cast<double>(random()) * 0x1p-32; };
  const auto blocks = [](double black, double white) {
    return [=](int column, int row) { return ((column / 128 + row / 128) & 1) != 0 ? white : black; };
  };
  std::vector<Picture> all;
  all.push_back(made_up("uniform", [](int, int) { return 1.0; }));
  all.push_back(made_up("sun of 1e6", [](int c, int r) { return c == 300 && r == 200 ? 1e6 : 1.0; }));
  all.push_back(made_up("sun of 1e5 over a gradient",
                        [](int c, int r) { return c == 700 && r == 130 ? 1e5 : 0.05 + 1.5 * (511 - r) / 511.0; }));
  all.push_back(made_up("sun of 5 x 5 texels", [](int c, int r) {
    return std::abs(c - 400) <= 2 && std::abs(r - 150) <= 2 ? 6e4 : 0.3 + 0.5 * (r < 256);
  }));
  all.push_back(made_up("noise", [&](int, int) { return noise(); }));
  all.push_back(made_up("black and white blocks", blocks(0.0, 1.0)));
  all.push_back(made_up("blocks of 0.01 and 10", blocks(0.01, 10.0)));
  return all;
}

/// Where a mip is looked at.
struct Probe {
  std::int64_t texel;
  double weight;  ///< of its square in the rms: the solid angle it stands for
};

/// All texels, or one of each of `count` equal runs and beside them the brightest and darkest: these have no weight in
/// the rms.
std::vector<Probe> probes_of(const CubemapChain& chain, int level, int count, std::mt19937& random) {
  const int size = chain.level_size(level);
  const std::int64_t texels = std::int64_t{6} * size * size;
  const auto solid_angle = [&](std::int64_t texel) {
    const double u = (2.0 * static_cast<double>(texel % size) + 1.0) / size - 1.0;
    const double v = (2.0 * static_cast<double>(texel / size % size) + 1.0) / size - 1.0;
    return std::pow(1.0 + u * u + v * v, -1.5);
  };
  std::vector<Probe> probes;
  if (texels <= count + 16) {
    for (std::int64_t k = 0; k < texels; ++k) probes.push_back({k, solid_angle(k)});
    return probes;
  }
  for (std::int64_t k = 0; k < count; ++k) {
    const std::int64_t first = texels * k / count;
    const std::int64_t length = texels * (k + 1) / count - first;
    const std::int64_t texel = first + static_cast<std::int64_t>(random()) % length;
    probes.push_back({texel, solid_angle(texel)});
  }
  const float* const rgb = chain.face(level, 0);
  std::vector<std::int64_t> order(static_cast<std::size_t>(texels));
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = static_cast<std::int64_t>(k);
  const auto less = [&](std::int64_t a, std::int64_t b) { return rgb[3 * a + 1] < rgb[3 * b + 1]; };
  std::nth_element(order.begin(), order.begin() + 8, order.end(), less);
  for (int k = 0; k < 8; ++k) probes.push_back({order[static_cast<std::size_t>(k)], 0.0});
  std::nth_element(order.begin(), order.end() - 8, order.end(), less);
  for (int k = 1; k <= 8; ++k) probes.push_back({*(order.end() - k), 0.0});
  return probes;
}

struct Errors {
  double rms = 0.0;
  double maximum = 0.0;
  double truth_there = 0.0;
  float least = 0.0F;
};

Errors errors_at(const CubemapChain& chain, int level, const std::vector<Probe>& probes,
                 const std::vector<glm::dvec3>& truth, const glm::dvec3& mean) {
  const float* const rgb = chain.face(level, 0);
  double squares = 0.0;
  double whole = 0.0;
  Errors errors;
  for (std::size_t k = 0; k < probes.size(); ++k) {
    for (int c = 0; c < 3; ++c) {
      const double got = static_cast<double>(rgb[3 * probes[k].texel + c]);
      const double error = std::abs(got - truth[k][c]);
      squares += probes[k].weight * error * error;
      whole += probes[k].weight * truth[k][c] * truth[k][c];
      const double relative = error / std::max(truth[k][c], kFloor * mean[c]);
      if (relative > errors.maximum) {
        errors.maximum = relative;
        errors.truth_there = truth[k][c] / mean[c];
      }
    }
  }
  errors.rms = std::sqrt(squares / whole);
  const std::int64_t values = std::int64_t{18} * chain.level_size(level) * chain.level_size(level);
  errors.least = *std::min_element(rgb, rgb + values);
  return errors;
}

std::string rows_of(const Picture& picture, const Settings& settings) {
  std::fprintf(stderr, "%s\n", picture.name.c_str());
  std::string rows;
  std::mt19937 random(11);
  std::map<int, std::vector<Probe>> probes;
  std::map<int, std::vector<glm::dvec3>> truths;
  for (const PrefilterMethod method : settings.methods) {
    PrefilterOptions options;
    options.size = settings.size;
    options.method = method;
    options.samples = settings.samples;
    const PrefilteredSpecular result = prefilter_specular(picture.image.view(), options);
    for (std::size_t level = 1; level < result.mips.size(); ++level) {
      const MipRecord& mip = result.mips[level];
      const auto key = static_cast<int>(level);
      if (probes.count(key) == 0) {
        probes[key] = probes_of(result.cubemap, key, settings.texels, random);
        std::vector<glm::dvec3> directions;
        for (const Probe& probe : probes[key]) {
          const std::int64_t texels = std::int64_t{mip.size} * mip.size;
          directions.push_back(image::face_direction(mip.size, static_cast<int>(probe.texel / texels),
                                                     static_cast<double>(probe.texel % mip.size) + 0.5,
                                                     static_cast<double>(probe.texel / mip.size % mip.size) + 0.5));
        }
        truths[key] = reference_specular(picture.image.view(), mip.roughness, directions);
      }
      const Errors errors = errors_at(result.cubemap, key, probes[key], truths[key], mip.mean);
      rows += "| " + picture.name + " | " + mip.method + " | " + std::to_string(level) + " | " +
              number("%.3f", mip.roughness) + " | " + std::to_string(mip.bands) + " | " +
              std::to_string(mip.bright_texels) + " | " + number("%.2g", 100.0 * errors.rms) + " | " +
              number("%.2g", 100.0 * errors.maximum) + " | " + number("%.2g", errors.truth_there) + " | " +
              number("%.2g", errors.least) + " | " + number("%.1f", mip.milliseconds) + " |\n";
    }
  }
  return rows;
}

Settings settings_of(std::vector<std::filesystem::path>& files, bool& synthetic) {
  Settings settings;
  std::vector<std::filesystem::path> kept;
  for (const std::filesystem::path& file : files) {
    const std::string word = file.string();
    const auto value = [&](const char* option) -> std::optional<std::string> {
      const std::string start = std::string(option) + "=";
      if (word.rfind(start, 0) != 0) return std::nullopt;
      return word.substr(start.size());
    };
    if (word == "--synthetic") {
      synthetic = true;
    } else if (const auto texels = value("--texels")) {
      settings.texels = std::atoi(texels->c_str());
    } else if (const auto size = value("--size")) {
      settings.size = std::atoi(size->c_str());
    } else if (const auto samples = value("--samples")) {
      settings.samples = std::atoi(samples->c_str());
    } else if (const auto methods = value("--methods")) {
      settings.methods.clear();
      std::stringstream list(*methods);
      for (std::string word_in_list; std::getline(list, word_in_list, ',');) {
        for (const auto method : {PrefilterMethod::automatic, PrefilterMethod::spectral, PrefilterMethod::sampled,
                                  PrefilterMethod::reference}) {
          if (word_in_list == name(method)) settings.methods.push_back(method);
        }
      }
    } else {
      kept.push_back(file);
    }
  }
  files = kept;
  return settings;
}

}  // namespace

std::string prefilter_error_tables(const std::vector<std::filesystem::path>& arguments) {
  std::vector<std::filesystem::path> files = arguments;
  bool synthetic = false;
  const Settings settings = settings_of(files, synthetic);
  std::string table =
      "| environment | method | mip | roughness | bands | bright texels | rms error, % | largest relative, % | where "
      "truth / mean is | least value | ms |\n|---|---|---|---|---|---|---|---|---|---|---|\n";
  if (synthetic) {
    for (const Picture& picture : made_up_pictures()) table += rows_of(picture, settings);
  }
  for (const std::filesystem::path& file : files) {
    const Environment environment = read_environment(file);
    if (environment.info.layout != Layout::lat_long) continue;
    const LatLongView view = environment.lat_long();
    if (view.width != 2 * view.height) continue;
    const float* const rgb = static_cast<const float*>(view.pixels);
    const auto count = std::size_t{3} * static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
    table += rows_of({file.stem().string(), {view.width, view.height, {rgb, rgb + count}}}, settings);
  }
  return table;
}

}  // namespace welkin::perf
