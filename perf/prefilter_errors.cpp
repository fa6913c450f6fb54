#include "perf.h"
#include "support/chains.h"
#include "support/estimate_trials.h"
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
  int width = 1024;               ///< of synthetic images
  int face = 0;                   ///< edge of the cubemap, in texels, that each image becomes; 0: it stays a lat-long
  std::vector<double> roughness;  ///< of single mips, each of `size`; none: the default chain
  std::vector<PrefilterMethod> methods{PrefilterMethod::automatic};
};

struct Image {
  std::string name;
  LatLongImage image;
};

/// `light`: for columns and rows of 1024 x 512.
Image made_up(const std::string& name, int width, const std::function<double(int, int)>& light) {
  Image image{name, {width, width / 2, {}}};
  for (int row = 0; row < width / 2; ++row) {
    for (int column = 0; column < width; ++column) {
      const double value = light(column * 1024 / width, row * 1024 / width);
      for (const double tint : {1.0, 0.8, 0.6}) image.image.pixels.push_back(static_cast<float>(tint * value));
    }
  }
  return image;
}

std::vector<Image> made_up_images(int width) {
  std::mt19937 random(7);
  const auto noise = [&] { return static_cast<double>(random()) * 0x1p-32; };
  const auto blocks = [](double black, double white) {
    return [=](int column, int row) { return ((column / 128 + row / 128) & 1) != 0 ? white : black; };
  };
  std::vector<Image> all;
  const auto add = [&](const char* name, const std::function<double(int, int)>& light) {
    all.push_back(made_up(name, width, light));
  };
  add("uniform", [](int, int) { return 1.0; });
  add("sun of 1e6", [](int c, int r) { return c == 300 && r == 200 ? 1e6 : 1.0; });
  add("sun of 1e5 over a gradient",
      [](int c, int r) { return c == 700 && r == 130 ? 1e5 : 0.05 + 1.5 * (511 - r) / 511.0; });
  add("sun of 5 x 5 texels",
      [](int c, int r) { return std::abs(c - 400) <= 2 && std::abs(r - 150) <= 2 ? 6e4 : 0.3 + 0.5 * (r < 256); });
  add("noise", [&](int, int) { return noise(); });
  add("black and white blocks", blocks(0.0, 1.0));
  add("blocks of 0.01 and 10", blocks(0.01, 10.0));
  return all;
}

/// Adds a row for each mip that is not a copy.
void add_rows(Table& table, const Image& image, const EnvironmentView& view, const PrefilterOptions& chain,
              const Settings& settings) {
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
      const std::span<const float> values = test::level_values(result.cubemap, key);
      table.add({image.name, name(mip.method), std::to_string(level), number("%.4g", mip.roughness),
                 std::to_string(mip.bands), std::to_string(mip.bright_texels), number("%.2g", 100.0 * errors.norms.rms),
                 mip.error_estimate ? number("%.2g", 100.0 * *mip.error_estimate) : "-",
                 number("%.2g", 100.0 * errors.norms.maximum), number("%.2g", errors.truth_there),
                 number("%.2g", static_cast<double>(*std::min_element(values.begin(), values.end()))),
                 number("%.1f", mip.milliseconds)});
    }
  }
}

void add_rows(Table& table, const Image& image, const Settings& settings) {
  std::fprintf(stderr, "%s\n", image.name.c_str());
  std::vector<PrefilterOptions> chains;
  for (const double roughness : settings.roughness)
    chains.push_back({.size = settings.size, .mips = 1, .roughness = {roughness}});
  if (chains.empty()) chains.push_back({.size = settings.size});
  for (const PrefilterOptions& chain : chains) {
    if (settings.face > 0) {
      add_rows(table, image, to_cubemap(image.image.view(), settings.face).view(), chain, settings);
    } else {
      add_rows(table, image, image.image.view(), chain, settings);
    }
  }
}

Settings settings_of(const Arguments& arguments) {
  Settings settings;
  settings.texels = arguments.count("--texels", settings.texels);
  settings.size = arguments.count("--size", settings.size);
  settings.width = arguments.count("--width", settings.width);
  settings.face = arguments.count("--cubemap", settings.face);
  for (const std::string& word : arguments.list("--roughness")) settings.roughness.push_back(std::atof(word.c_str()));
  if (arguments.has("--methods")) settings.methods.clear();
  for (const std::string& word : arguments.list("--methods")) {
    for (const auto method : {PrefilterMethod::automatic, PrefilterMethod::spectral, PrefilterMethod::reference}) {
      if (word == name(method)) settings.methods.push_back(method);
    }
  }
  return settings;
}

}  // namespace

std::string prefilter_error_tables(const Paths& words) {
  const Arguments arguments(words,
                            {"--synthetic", "--texels", "--size", "--width", "--cubemap", "--roughness", "--methods"});
  const Settings settings = settings_of(arguments);
  Table table({"environment", "method", "mip", "roughness", "bands", "bright texels", "rms error, %", "its estimate, %",
               "largest relative, %", "where truth / mean is", "least value", "ms"});
  if (arguments.has("--synthetic")) {
    for (const Image& image : made_up_images(settings.width)) add_rows(table, image, settings);
  }
  for (const std::filesystem::path& file : arguments.files) {
    const Environment environment = read_environment(file);
    if (environment.info.layout != Layout::lat_long) continue;
    const LatLongView view = environment.lat_long();
    if (view.width != 2 * view.height) continue;
    const float* const rgb = static_cast<const float*>(view.pixels);
    const auto count = std::size_t{3} * static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
    add_rows(table, {file.stem().string(), {view.width, view.height, {rgb, rgb + count}}}, settings);
  }
  return table.text();
}

namespace {

constexpr int kImageSize = 64;
constexpr int kAtATime = 100;  ///< environments between tables

std::string table_of(const test::EstimateTrials& trials) {
  Table table(
      {"result", "estimates", "true <= estimate", "median of estimate / true", "worst true / estimate", "worst case"});
  for (const auto& [kind, honesty] : trials) {
    table.add({kind, std::to_string(honesty->count()), number("%.1f %%", 100.0 * honesty->share()),
               number("%.2g", honesty->median()), number("%.2g", honesty->worst()), honesty->worst_case()});
  }
  return table.text();
}

}  // namespace

std::string estimate_table(const Paths& words) {
  const Arguments arguments(words, {"--seed", "--rms-error"});
  const auto seed = static_cast<std::uint32_t>(arguments.count("--seed", 1));
  test::RoughnessSpan of{0.02, 1.0};
  of.rms_error = arguments.value("--rms-error", of.rms_error);
  int count = 10'000;
  std::vector<Cubemap> images;
  for (const std::filesystem::path& file : arguments.files) {
    const std::string word = file.string();
    if (word.find_first_not_of("0123456789") == std::string::npos) {
      count = std::atoi(word.c_str());
    } else {
      images.push_back(to_cubemap(read_environment(file).view(), kImageSize));
    }
  }
  test::EstimateTrials trials;
  int refused = 0;
  for (int done = 0; done < count;) {
    const int some = std::min(kAtATime, count - done);
    const auto first = seed + static_cast<std::uint32_t>(done);
    test::add_estimate_trials(first, some / 2, of, images, trials);
    test::add_family_trials(first + static_cast<std::uint32_t>(some / 2), some - some / 2, of, true, trials);
    refused += test::add_lobe_trials(first, some / 2, images, trials);
    done += some;
    if (done < count) std::fprintf(stderr, "%d environments\n%s\n", done, table_of(trials).c_str());
  }
  return table_of(trials) + "\n" + std::to_string(refused) + " of " + std::to_string(count / 2) +
         " mips of other lobes than GGX were refused.\n";
}

}  // namespace welkin::perf
