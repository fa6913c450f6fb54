#include "target_sizes.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <functional>
#include <glm/geometric.hpp>
#include <numbers>

#include "image/texel_geometry.h"
#include "sh/frame_transform.h"
#include "simd/kernels.h"
#include "welkin/environment_file.h"
#include "welkin/instruction_set.h"
#include "welkin/projection.h"

namespace welkin::perf {
namespace {

constexpr int kSize = 1024;
constexpr int kTargets[] = {8, 16, 32, 64, 128, 256, 512, 0};
constexpr int kRuns = 7;

struct Level {
  int size;
  std::vector<float> pixels;

  [[nodiscard]] CubemapView view() const {
    CubemapView result{.faces = {}, .size = size, .row_stride_bytes = 0, .format = PixelFormat::rgb_f32};
    const std::size_t face_floats = pixels.size() / 6;
    for (std::size_t face = 0; face < 6; ++face) result.faces[face] = pixels.data() + face * face_floats;
    return result;
  }
};

/// The lat-long's texel that a direction falls into.
const float* texel_at(const Environment& environment, const glm::dvec3& direction) {
  const double longitude = std::atan2(direction.x, direction.z);
  const double latitude = std::asin(std::clamp(direction.y, -1.0, 1.0));
  const int width = environment.info.width;
  const int height = environment.info.height;
  const int column = std::clamp(static_cast<int>((0.5 - longitude / (2.0 * std::numbers::pi)) * width), 0, width - 1);
  const int row = std::clamp(static_cast<int>((0.5 - latitude / std::numbers::pi) * height), 0, height - 1);
  return environment.pixels.get() + (static_cast<std::ptrdiff_t>(row) * width + column) * 3;
}

Level sample_cubemap(const Environment& environment) {
  Level level{kSize, {}};
  level.pixels.reserve(std::size_t{6} * kSize * kSize * 3);
  for (int face = 0; face < 6; ++face) {
    const image::Frame& frame = image::face_frame(face);
    for (int row = 0; row < kSize; ++row) {
      for (int column = 0; column < kSize; ++column) {
        const double u = (2.0 * column + 1.0) / kSize - 1.0;
        const double v = (2.0 * row + 1.0) / kSize - 1.0;
        const float* const rgb = texel_at(environment, glm::normalize(u * frame.u + v * frame.v + frame.normal));
        level.pixels.insert(level.pixels.end(), rgb, rgb + 3);
      }
    }
  }
  return level;
}

/// The next level as engines make it: a plain box of four.
Level halve(const Level& level) {
  Level half{level.size / 2, {}};
  for (int row = 0; row < 6 * half.size; ++row) {
    for (int column = 0; column < half.size; ++column) {
      for (int c = 0; c < 3; ++c) {
        const auto at = [&](int r, int k) {
          return level.pixels[static_cast<std::size_t>(((2 * row + r) * level.size + 2 * column + k) * 3 + c)];
        };
        half.pixels.push_back(0.25F * ((at(0, 0) + at(0, 1)) + (at(1, 0) + at(1, 1))));
      }
    }
  }
  return half;
}

double relative_error(const SphericalHarmonics& found, const SphericalHarmonics& truth) {
  double difference = 0.0;
  double total = 0.0;
  for (std::size_t k = 0; k < truth.coefficients().size(); ++k) {
    const glm::dvec3 d = found.coefficients()[k] - truth.coefficients()[k];
    difference += glm::dot(d, d);
    total += glm::dot(truth.coefficients()[k], truth.coefficients()[k]);
  }
  return std::sqrt(difference / total);
}

double fastest_milliseconds(const std::function<void()>& work) {
  double fastest = 1e300;
  for (int run = 0; run < kRuns; ++run) {
    const auto start = std::chrono::steady_clock::now();
    work();
    const std::chrono::duration<double, std::milli> time = std::chrono::steady_clock::now() - start;
    fastest = std::min(fastest, time.count());
  }
  return fastest;
}

std::string number(const char* format, double value) {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

/// One way to a smaller size: a column of the table.
struct Way {
  const char* name;
  Quadrature quadrature;
  bool from_chain;
};

constexpr Way kWays[] = {{"exact", Quadrature::exact, false},
                         {"midpoint (as Babylon.js)", Quadrature::midpoint, false},
                         {"exact, mip chain", Quadrature::exact, true}};

std::string header() {
  std::string text = "| environment | method |";
  std::string rule = "|---|---|";
  for (const int target : kTargets) {
    text += target > 0 ? " " + std::to_string(target) + " |" : std::string(" full |");
    rule += "---|";
  }
  return text + "\n" + rule + "\n";
}

}  // namespace

std::string target_size_table(const std::vector<std::filesystem::path>& files) {
  std::string errors = header();
  std::vector<std::vector<double>> times(std::size(kWays), std::vector<double>(std::size(kTargets), 1e300));
  double reading = 1e300;
  for (const std::filesystem::path& file : files) {
    std::fprintf(stderr, "%s\n", file.filename().string().c_str());
    std::vector<Level> chain{sample_cubemap(read_environment(file))};
    while (chain.back().size > 1) chain.push_back(halve(chain.back()));
    std::vector<CubemapView> views;
    for (const Level& level : chain) views.push_back(level.view());
    const SphericalHarmonics truth = reference_projection(views[0]);
    const auto groups = static_cast<std::int64_t>(chain[0].pixels.size() / 16);
    volatile float sum = 0.0F;
    reading = std::min(
        reading, fastest_milliseconds([&] { sum = simd::active_kernels().read_all(chain[0].pixels.data(), groups); }));
    for (std::size_t way = 0; way < std::size(kWays); ++way) {
      errors += "| " + file.stem().string() + " | " + kWays[way].name + " |";
      for (std::size_t column = 0; column < std::size(kTargets); ++column) {
        ProjectionOptions options;
        options.quadrature = kWays[way].quadrature;
        options.target_size = kTargets[column];
        Projection found{};
        const double time = fastest_milliseconds(
            [&] { found = kWays[way].from_chain ? project(views, options) : project(views[0], options); });
        times[way][column] = std::min(times[way][column], time);
        errors += " " + number("%.0e", relative_error(found.radiance, truth)) + " |";
      }
      errors += "\n";
    }
  }
  std::string text = "Relative error of the 27 coefficients\n\n" + errors +
                     "\nTime, as a multiple of reading the cubemap once (" + number("%.2f", reading) +
                     " ms, one thread, " + name(active_instruction_set()) + ")\n\n" + header();
  for (std::size_t way = 0; way < std::size(kWays); ++way) {
    text += std::string("| all | ") + kWays[way].name + " |";
    for (const double time : times[way]) text += " " + number("%.3g", time / reading) + " |";
    text += "\n";
  }
  return text;
}

}  // namespace welkin::perf
