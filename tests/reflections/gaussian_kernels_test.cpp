// The kernels of Gaussians over a lat-long against the same sums in double.
#include "reflections/gaussian_kernels.h"

#include <cmath>
#include <cstddef>
#include <vector>

#include "platform/memory.h"
#include "support/catch.h"
#include "welkin/core.h"

namespace welkin::test {
namespace {

using namespace reflections;
constexpr int kLanes = simd::kLanes;

double uneven(int k) { return 0.5 + 0.5 * std::sin(1.0 + 7.3 * k + 0.01 * k * k); }

/// Of two Gaussians about directions on the equator: [2 rows + 1][2 columns][16].
struct Weighed {
  static constexpr int rows = 2;
  static constexpr int columns = 3;

  explicit Weighed(const GaussianKernels& kernels)
      : lines(std::size_t{64} * (rows + columns + 2)), weights(std::size_t{kLanes} * (2 * rows + 1) * 2 * columns) {
    lobe.count = 2;
    for (int g = 0; g < 2; ++g) {
      lobe.root[g] = g == 0 ? 1.1F : 4.0F;
      lobe.weight[g] = g == 0 ? 0.3F : 0.2F;
      reach.rows[g] = rows;
      reach.columns[g] = columns;
    }
    group.down = 1.0F;
    for (int k = 0; k < kLanes; ++k) {
      group.from_line[k] = static_cast<float>(uneven(k) - 0.5);
      group.part_row[k] = static_cast<float>(uneven(k + 40));
      group.across[k] = 1.0F;
      group.tangent[k] = 0.0F;
    }
    kernels.weigh(lobe, reach, group, rows, columns, lines.data(), weights.data(), sums);
  }

  /// What a line between texels has on its lower side; all beyond a window's ends.
  [[nodiscard]] static double below(double line, double place, double root, bool end) {
    return end ? (line < place ? -1.0 : 1.0) : std::erf((line - place) * root);
  }
  /// In double, without what meridians that converge change: the kernel counts that from a row's distance on.
  [[nodiscard]] double share(int row, int column, int lane) const {
    const auto x = static_cast<double>(group.from_line[lane]);
    const auto y = static_cast<double>(group.part_row[lane]);
    double sum = 0.0;
    for (int g = 0; g < 2; ++g) {
      const auto root = static_cast<double>(lobe.root[g]);
      const int i = column - columns;
      const int j = row - rows;
      sum += static_cast<double>(lobe.weight[g]) *
             (below(i + 1, x, root, i + 1 == columns) - below(i, x, root, i == -columns)) *
             (below(j + 1, y, root, j == rows) - below(j, y, root, j == -rows));
    }
    return sum;
  }

  GaussianLobe lobe{};
  GaussianReach reach{};
  GaussianGroup group{};
  platform::AlignedBuffer<float> lines;
  platform::AlignedBuffer<float> weights;
  alignas(64) float sums[kLanes] = {};
};

}  // namespace

TEST_CASE("Gaussians' shares of texels are products of error functions", "[specular][narrow][kernels]") {
  // the smaller the texels beside the sphere, the less the meridians converge; the roots are of texels
  const InstructionSet set = active_instruction_set();
  GaussianKernels kernels = gaussian_kernels(set);
  Weighed weighed(kernels);
  constexpr float small = 1e-3F;
  for (int g = 0; g < 2; ++g) weighed.lobe.root[g] /= small;
  weighed.group.down = small;
  for (float& across : weighed.group.across) across = small;
  for (float& sum : weighed.sums) sum = 0.0F;
  kernels.weigh(weighed.lobe, weighed.reach, weighed.group, Weighed::rows, Weighed::columns, weighed.lines.data(),
                weighed.weights.data(), weighed.sums);
  for (int g = 0; g < 2; ++g) weighed.lobe.root[g] *= small;
  for (int lane = 0; lane < kLanes; ++lane) {
    double all = 0.0;
    for (int row = 0; row <= 2 * Weighed::rows; ++row) {
      for (int column = 0; column < 2 * Weighed::columns; ++column) {
        const float weight = weighed.weights.data()[(row * 2 * Weighed::columns + column) * kLanes + lane];
        CHECK(std::abs(static_cast<double>(weight) - weighed.share(row, column, lane)) < 3e-6);
        all += static_cast<double>(weight);
      }
    }
    CHECK(static_cast<double>(weighed.sums[lane]) == Approx(all).epsilon(1e-6));
  }
}

TEST_CASE("Windows add up weights times texels, mirrored and not", "[specular][narrow][kernels][bits]") {
  constexpr int rows = 2 * Weighed::rows + 1;
  constexpr int columns = 2 * Weighed::columns;
  constexpr int width = 40;
  std::vector<float> texels(std::size_t{3} * width * rows);
  for (std::size_t k = 0; k < texels.size(); ++k) texels[k] = static_cast<float>(uneven(static_cast<int>(k)));
  std::vector<const float*> lines;
  for (int row = 0; row < rows; ++row) lines.push_back(texels.data() + std::ptrdiff_t{3} * width * row);
  const std::ptrdiff_t floats = spread_floats(rows, columns);
  std::vector<float> first;
  for (const InstructionSet set : available_instruction_sets()) {
    const GaussianKernels& kernels = gaussian_kernels(set);
    const Weighed weighed(kernels);
    platform::AlignedBuffer<float> plain(static_cast<std::size_t>(floats / 3 * kLanes));
    platform::AlignedBuffer<float> spread(static_cast<std::size_t>(floats * kLanes));
    std::vector<float> results;
    for (const bool mirrored : {false, true}) {
      kernels.spread(weighed.weights.data(), rows, columns, mirrored, plain.data(), spread.data());
      for (int windows = 1; windows <= 4; ++windows) {
        for (const bool upward : {false, true}) {
          const int lane = 3 * windows;
          alignas(64) float sums[5][kWindowFloats] = {};
          const std::ptrdiff_t offsets[4] = {0, 3, 30, 90};
          const WindowRows own{lines.data() + (upward ? rows - 1 : 0), upward ? -1 : 1, rows, 1};
          kernels.add_windows(own, offsets, windows, spread.data() + floats * lane, sums);
          float rgb[4][3] = {};
          float* pixels[4] = {rgb[0], rgb[1], rgb[2], rgb[3]};
          const float scales[4] = {1.0F, 2.0F, 0.5F, 1.0F};
          kernels.fold(sums, windows, scales, 0.0F, pixels);
          for (int window = 0; window < windows; ++window) {
            for (int c = 0; c < 3; ++c) {
              double truth = 0.0;
              for (int row = 0; row < rows; ++row) {
                for (int column = 0; column < columns; ++column) {
                  const int from = mirrored ? columns - 1 - column : column;
                  const float* const line = lines[static_cast<std::size_t>(upward ? rows - 1 - row : row)];
                  truth += static_cast<double>(weighed.weights.data()[(row * columns + from) * kLanes + lane]) *
                           static_cast<double>(line[offsets[window] + 3 * column + c]);
                }
              }
              CHECK(static_cast<double>(rgb[window][c]) ==
                    Approx(truth * static_cast<double>(scales[window])).epsilon(2e-6));
              results.push_back(rgb[window][c]);
            }
          }
        }
      }
    }
    if (first.empty()) first = results;
    CHECK(results == first);
  }
}

}  // namespace welkin::test
