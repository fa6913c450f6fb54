#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <map>
#include <optional>
#include <random>
#include <sstream>

#include "benchmarks.h"
#include "perf/report/error_norms.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"

namespace welkin::perf {
namespace {

struct Settings {
  int texels = 256;
  int size = 512;
  int width = 1024;               ///< of pictures that are made up
  int face = 0;                   ///< texels along an edge of the cubemap that each picture is turned into; 0: it stays
  std::vector<double> roughness;  ///< of single mips, each of `size`; none: the default chain
  std::vector<PrefilterMethod> methods{PrefilterMethod::automatic};
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

/// `light` is of columns and rows of 1024 x 512.
Picture made_up(const std::string& name, int width, const std::function<double(int, int)>& light) {
  Picture picture{name, {width, width / 2, {}}};
  for (int row = 0; row < width / 2; ++row) {
    for (int column = 0; column < width; ++column) {
      const double value = light(column * 1024 / width, row * 1024 / width);
      for (const double tint : {1.0, 0.8, 0.6}) picture.image.pixels.push_back(static_cast<float>(tint * value));
    }
  }
  return picture;
}

std::vector<Picture> made_up_pictures(int width) {
  std::mt19937 random(7);
  const auto noise = [&] { return static_cast<double>(random()) * 0x1p-32; };
  const auto blocks = [](double black, double white) {
    return [=](int column, int row) { return ((column / 128 + row / 128) & 1) != 0 ? white : black; };
  };
  std::vector<Picture> all;
  const auto made_up_here = [width](const char* name, const std::function<double(int, int)>& light) {
    return made_up(name, width, light);
  };
  all.push_back(made_up_here("uniform", [](int, int) { return 1.0; }));
  all.push_back(made_up_here("sun of 1e6", [](int c, int r) { return c == 300 && r == 200 ? 1e6 : 1.0; }));
  all.push_back(made_up_here("sun of 1e5 over a gradient",
                             [](int c, int r) { return c == 700 && r == 130 ? 1e5 : 0.05 + 1.5 * (511 - r) / 511.0; }));
  all.push_back(made_up_here("sun of 5 x 5 texels", [](int c, int r) {
    return std::abs(c - 400) <= 2 && std::abs(r - 150) <= 2 ? 6e4 : 0.3 + 0.5 * (r < 256);
  }));
  all.push_back(made_up_here("noise", [&](int, int) { return noise(); }));
  all.push_back(made_up_here("black and white blocks", blocks(0.0, 1.0)));
  all.push_back(made_up_here("blocks of 0.01 and 10", blocks(0.01, 10.0)));
  return all;
}

float least_of(const Cubemap& chain, int level) {
  const float* const rgb = chain.face(level, 0);
  return *std::min_element(rgb, rgb + std::int64_t{18} * chain.level_size(level) * chain.level_size(level));
}

/// A row for each mip but those that are copies.
std::string rows_of(const Picture& picture, const EnvironmentView& view, const PrefilterOptions& chain,
                    const Settings& settings) {
  std::string rows;
  std::mt19937 random(11);
  std::map<int, std::vector<report::Probe>> probes;
  std::map<int, std::vector<glm::dvec3>> truths;
  for (const PrefilterMethod method : settings.methods) {
    PrefilterOptions options = chain;
    options.method = method;
    const PrefilteredSpecular result = prefilter_specular(view, options);
    for (std::size_t level = 0; level < result.mips.size(); ++level) {
      const MipRecord& mip = result.mips[level];
      if (mip.method == MipMethod::copy) continue;
      const auto key = static_cast<int>(level);
      if (probes.count(key) == 0) {
        probes[key] = report::probes_of(result.cubemap, key, settings.texels, random);
        truths[key] = reference_specular(view, mip.roughness, report::directions_of(probes[key], mip.size));
      }
      const report::ProbeErrors errors = report::errors_at(result.cubemap, key, probes[key], truths[key], mip.mean);
      rows += "| " + picture.name + " | " + name(mip.method) + " | " + std::to_string(level) + " | " +
              number("%.4g", mip.roughness) + " | " + std::to_string(mip.bands) + " | " +
              std::to_string(mip.bright_texels) + " | " + number("%.2g", 100.0 * errors.norms.rms) + " | " +
              (mip.error_estimate ? number("%.2g", 100.0 * *mip.error_estimate) : std::string("-")) + " | " +
              number("%.2g", 100.0 * errors.norms.maximum) + " | " + number("%.2g", errors.truth_there) + " | " +
              number("%.2g", least_of(result.cubemap, key)) + " | " + number("%.1f", mip.milliseconds) + " |\n";
    }
  }
  return rows;
}

std::string rows_of(const Picture& picture, const Settings& settings) {
  std::fprintf(stderr, "%s\n", picture.name.c_str());
  std::vector<PrefilterOptions> chains;
  for (const double roughness : settings.roughness)
    chains.push_back({.size = settings.size, .mips = 1, .roughness = {roughness}});
  if (chains.empty()) chains.push_back({.size = settings.size});
  std::string rows;
  for (const PrefilterOptions& chain : chains) {
    if (settings.face > 0) {
      const Cubemap cube = to_cubemap(picture.image.view(), settings.face);
      rows += rows_of(picture, cube.view(), chain, settings);
    } else {
      rows += rows_of(picture, picture.image.view(), chain, settings);
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
    } else if (const auto width = value("--width")) {
      settings.width = std::atoi(width->c_str());
    } else if (const auto face = value("--cubemap")) {
      settings.face = std::atoi(face->c_str());
    } else if (const auto roughness = value("--roughness")) {
      std::stringstream list(*roughness);
      for (std::string word_in_list; std::getline(list, word_in_list, ',');)
        settings.roughness.push_back(std::atof(word_in_list.c_str()));
    } else if (const auto methods = value("--methods")) {
      settings.methods.clear();
      std::stringstream list(*methods);
      for (std::string word_in_list; std::getline(list, word_in_list, ',');) {
        for (const auto method : {PrefilterMethod::automatic, PrefilterMethod::spectral, PrefilterMethod::reference}) {
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
      "| environment | method | mip | roughness | bands | bright texels | rms error, % | its estimate, % | largest "
      "relative, % | where "
      "truth / mean is | least value | ms |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  if (synthetic) {
    for (const Picture& picture : made_up_pictures(settings.width)) table += rows_of(picture, settings);
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
