#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <span>

#include "benchmarks.h"
#include "perf/report/error_norms.h"
#include "perf/report/passes.h"
#include "subjects.h"
#include "welkin/bake_file.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"
#include "welkin/reflections.h"

namespace welkin::perf {
namespace {

struct NamedEffort {
  const char* name;
  Bc6hEffort effort;
};
constexpr std::array kEfforts{NamedEffort{"fast", Bc6hEffort::fast}, NamedEffort{"normal", Bc6hEffort::normal},
                              NamedEffort{"slow", Bc6hEffort::slow}};

Cubemap whole_chain(const LatLongView& picture, int size) {
  PrefilterOptions options;
  options.size = size;
  options.mips = full_chain_levels(size);
  return prefilter_specular(picture, options).cubemap;
}

double texels_of(const Cubemap& chain) { return static_cast<double>(chain.bytes()) / (3.0 * sizeof(float)); }

std::string percent(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", 100.0 * value);
  return text;
}

/// The most that a channel's mean over a level is off.
double largest_bias(const Cubemap& decoded, const Cubemap& given, int level) {
  const auto edge = static_cast<std::size_t>(given.level_size(level));
  std::array<double, 3> sums{};
  std::array<double, 3> wanted{};
  for (std::size_t k = 0; k < 18 * edge * edge; ++k) {
    sums[k % 3] += static_cast<double>(decoded.face(level, 0)[k]);
    wanted[k % 3] += std::clamp(static_cast<double>(given.face(level, 0)[k]), 0.0, 65504.0);
  }
  double largest = 0.0;
  for (std::size_t c = 0; c < 3; ++c) largest = std::max(largest, std::abs(sums[c] / wanted[c] - 1.0));
  return largest;
}

std::string row_of(const std::string& name, const Cubemap& chain, const report::BlockWay& way) {
  const auto bytes = report::texture_bytes(chain, way.options);
  if (!bytes) return "";
  const Cubemap decoded = read_texture({*bytes, "chain.ktx2"}).cubemap;
  const auto values = [](const Cubemap& of, int level) {
    const auto edge = static_cast<std::size_t>(of.level_size(level));
    return std::span<const float>(of.face(level, 0), 18 * edge * edge);
  };
  std::string mips;
  double squares = 0.0;
  double bias = 0.0;
  for (int level = 0; level < chain.levels(); ++level) {
    const double error = report::relative_errors(values(decoded, level), values(chain, level)).rms;
    mips += (level == 0 ? "" : ", ") + percent(error);
    squares += error * error * std::pow(chain.level_size(level), 2);
    if (chain.level_size(level) < 16) continue;
    bias = std::max(bias, largest_bias(decoded, chain, level));
  }
  const double all = std::sqrt(squares / (texels_of(chain) / 6.0));
  return "| " + name + " | " + way.format + " " + way.effort + " | " + percent(all) + " | " + mips + " | " +
         percent(bias) + " |\n";
}

}  // namespace

void add_bc6h(const std::vector<int>& thread_counts) {
  const auto chain = [](int size) {
    return std::make_shared<const Cubemap>(
        whole_chain(sky_picture({.grain = 0.3, .ripples = 0.0, .tinted = true, .sun = 500.0}).view(), size));
  };
  for (const int threads : thread_counts) {
    for (const int size : {256, 512}) {
      const double texels = 6.0 * (4.0 * size * size - 1.0) / 3.0;
      for (const NamedEffort& effort : kEfforts) {
        add_benchmark("EncodeBc6h", effort.name, std::to_string(size), threads, texels, 0.0,
                      [=]() -> std::function<void()> {
                        return [given = chain(size), effort] {
                          benchmark::DoNotOptimize(encode_bc6h(given->views(), {effort.effort}));
                        };
                      });
      }
      add_benchmark("DecodeBc6h", "floats", std::to_string(size), threads, texels, 0.0, [=]() -> std::function<void()> {
        auto blocks = std::make_shared<const Bc6hCubemap>(encode_bc6h(chain(size)->views()));
        return [blocks] { benchmark::DoNotOptimize(decode_bc6h(*blocks)); };
      });
    }
  }
}

std::string block_error_table(const std::vector<std::filesystem::path>& arguments) {
  int size = 256;
  std::string table =
      "| environment | format, effort | rms error, % | by mip | largest bias of a channel's mean over a mip from 16 "
      "texels on, % |\n"
      "|---|---|---|---|---|\n";
  for (const std::filesystem::path& argument : arguments) {
    const std::string text = argument.string();
    if (text.starts_with("--size=")) {
      size = std::stoi(text.substr(7));
      continue;
    }
    const Environment environment = read_environment(argument);
    if (environment.info.layout != Layout::lat_long) continue;
    const Cubemap chain = whole_chain(environment.lat_long(), size);
    for (const report::BlockWay& way : report::block_ways()) table += row_of(argument.stem().string(), chain, way);
  }
  return table;
}

}  // namespace welkin::perf
