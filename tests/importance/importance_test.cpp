// Tables by which directions are picked in proportion to light.
#include "welkin/importance.h"

#include "image/geometry.h"
#include "support/catch.h"
#include "support/same_bits.h"
#include "support/sun_maps.h"
#include "support/thrown_error.h"
#include "welkin/core.h"
#include "welkin/resampling.h"

namespace welkin::test {

// Promise: directions come in proportion to the light of a texel's area, exactly as often as the density says, from
// images of any size, whatever is in them.

namespace {

/// Two numbers in [0, 1) that pick a direction.
struct Numbers {
  double across;
  double down;
};

constexpr double kPi = std::numbers::pi;

LatLongImage noise(int width, int height, unsigned seed = 1) {
  LatLongImage image = grey_lat_long(width, height, 0.0F);
  std::mt19937 engine(seed);
  for (float& value : image.pixels) value = static_cast<float>(engine()) * 0x1p-32F;
  return image;
}

void set_texel(LatLongImage& image, int column, int row, float value) {
  std::fill_n(image.pixels.begin() + std::ptrdiff_t{3} * (row * image.width + column), 3, value);
}

double luminance(const LatLongImage& image, int column, int row) {
  const float* const rgb = image.pixels.data() + std::ptrdiff_t{3} * (row * image.width + column);
  return 0.2126 * static_cast<double>(rgb[0]) + 0.7152 * static_cast<double>(rgb[1]) +
         0.0722 * static_cast<double>(rgb[2]);
}

/// The numbers that a path tracer would draw: a grid with a point at random in each cell.
std::vector<Numbers> stratified(int across, int down, unsigned seed) {
  std::vector<Numbers> points;
  std::mt19937 engine(seed);
  const auto jitter = [&] { return static_cast<double>(engine()) * 0x1p-32; };
  for (int y = 0; y < down; ++y) {
    for (int x = 0; x < across; ++x) points.push_back({(x + jitter()) / across, (y + jitter()) / down});
  }
  return points;
}

std::vector<Numbers> independent(int count, unsigned seed) {
  std::vector<Numbers> points;
  std::mt19937_64 engine(seed);
  const auto number = [&] { return static_cast<double>(engine() >> 11U) * 0x1p-53; };
  for (int k = 0; k < count; ++k) {
    const double x = number();
    points.push_back({x, number()});
  }
  return points;
}

/// Compares the bits of all that a table holds.
bool same(const ImportanceTable& a, const ImportanceTable& b) {
  return same_bytes<float>(a.function, b.function) && same_bytes<float>(a.row_cdf, b.row_cdf) &&
         same_bytes<float>(a.column_cdf, b.column_cdf) && a.integral == b.integral;
}

/// Pearson's statistic of counts against probabilities, with cells below 5 expected counts merged; and the number of
/// cells, less one.
struct ChiSquare {
  double statistic = 0.0;
  int degrees = -1;

  void add(double count, double expected) {
    count_ += count;
    expected_ += expected;
    if (expected_ < 5.0) return;
    statistic += (count_ - expected_) * (count_ - expected_) / expected_;
    ++degrees;
    count_ = expected_ = 0.0;
  }
  /// Five standard deviations of its distribution above the mean.
  [[nodiscard]] bool plausible() const { return statistic < degrees + 5.0 * std::sqrt(2.0 * degrees); }

 private:
  double count_ = 0.0;
  double expected_ = 0.0;
};

constexpr std::array<std::array<int, 2>, 8> kSizes{
    {{1, 1}, {2, 1}, {1, 3}, {3, 2}, {7, 5}, {64, 32}, {257, 129}, {5, 64}}};

}  // namespace

TEST_CASE("importance: a texel's function is its weight times its solid angle", "[importance]") {
  for (const auto& [width, height] : kSizes) {
    const LatLongImage image = noise(width, height);
    const ImportanceTable table = importance_table(image.view());
    CAPTURE(width, height);
    REQUIRE(table.width == width);
    REQUIRE(table.height == height);
    double sum = 0.0;
    bool right = true;
    for (int row = 0; row < height; ++row) {
      const double solid_angle = image::lat_long_texel_solid_angle(width, height, row);
      for (int column = 0; column < width; ++column) {
        const double value = static_cast<double>(table.function[static_cast<std::size_t>(row * width + column)]);
        right = right && std::abs(value / (luminance(image, column, row) * solid_angle) - 1.0) < 1e-6;
        sum += value;
      }
    }
    CHECK(right);
    CHECK(sum == Approx(table.integral).epsilon(1e-12));
    CHECK(table.row_cdf.front() == 0.0F);
    CHECK(table.row_cdf.back() == 1.0F);
    CHECK(std::ranges::is_sorted(table.row_cdf));
    for (int row = 0; row < height; ++row) {
      const auto first = table.column_cdf.begin() + std::ptrdiff_t{row} * (width + 1);
      REQUIRE(*first == 0.0F);
      REQUIRE(first[width] == 1.0F);
      REQUIRE(std::is_sorted(first, first + width + 1));
    }
  }
}

TEST_CASE("importance: the density integrates to 1 and is what samples say", "[importance]") {
  for (const auto& [width, height] : kSizes) {
    const ImportanceTable table = importance_table(noise(width, height).view());
    CAPTURE(width, height);
    double sum = 0.0;
    for (int row = 0; row < height; ++row) {
      const double solid_angle = image::lat_long_texel_solid_angle(width, height, row);
      for (int column = 0; column < width; ++column) {
        sum += table.density(image::lat_long_direction(width, height, column + 0.5, row + 0.5)) * solid_angle;
      }
    }
    CHECK(sum == Approx(1.0).epsilon(1e-6));
    for (const Numbers& number : stratified(16, 16, 3)) {
      const ImportanceSample sample = table.sample(number.across, number.down);
      CHECK(glm::length(sample.direction) == Approx(1.0).epsilon(1e-14));
      CHECK(sample.density > 0.0);
      CHECK(table.density(3.0 * sample.direction) == Approx(sample.density).epsilon(1e-9));
    }
  }
}

TEST_CASE("importance: directions are picked as often as the density says", "[importance]") {
  const int width = 48;
  const int height = 24;
  LatLongImage image = noise(width, height, 9);
  set_texel(image, 10, 3, 40.0F);
  for (int column = 0; column < width; ++column) set_texel(image, column, 20, 0.0F);
  for (const bool compensated : {false, true}) {
    const ImportanceTable table = importance_table(image.view(), {.mis_compensation = compensated});
    const int samples = 400'000;
    std::vector<double> counts(table.function.size(), 0.0);
    bool inside = true;
    for (const Numbers& number : independent(samples, 5)) {
      const ImportanceSample sample = table.sample(number.across, number.down);
      // Counted where the direction lies, and not where the table says that it does.
      const double column = (0.5 - std::atan2(sample.direction.x, sample.direction.z) / (2.0 * kPi)) * width;
      const double row = std::acos(sample.direction.y) / kPi * height;
      inside = inside && std::abs(column - sample.column - 0.5) < 0.5001 && std::abs(row - sample.row - 0.5) < 0.5001;
      ++counts[static_cast<std::size_t>(std::clamp(static_cast<int>(row), 0, height - 1) * width +
                                        std::clamp(static_cast<int>(column), 0, width - 1))];
    }
    CHECK(inside);
    ChiSquare test;
    for (std::size_t k = 0; k < counts.size(); ++k) {
      test.add(counts[k], samples * static_cast<double>(table.function[k]) / table.integral);
    }
    CAPTURE(compensated, test.statistic, test.degrees);
    CHECK(test.degrees > 100);
    CHECK(test.plausible());
    for (int column = 0; column < width; ++column) {
      CHECK(counts[static_cast<std::size_t>(20 * width + column)] == 0.0);
    }
  }
}

TEST_CASE("importance: within a texel directions are even by solid angle", "[importance]") {
  // Two rows: over uniform directions of either hemisphere the mean of |y| is 1/2.
  LatLongImage image = grey_lat_long(2, 2, 0.0F);
  set_texel(image, 1, 0, 1.0F);
  const ImportanceTable table = importance_table(image.view());
  dvec3 mean{};
  const std::vector<Numbers> numbers = stratified(256, 256, 11);
  for (const Numbers& number : numbers)
    mean += table.sample(number.across, number.down).direction / static_cast<double>(numbers.size());
  CHECK(mean.y == Approx(0.5).margin(1e-4));
  CHECK(mean.x == Approx(-0.5).margin(1e-4));
  CHECK(mean.z == Approx(0.0).margin(1e-4));
}

TEST_CASE("importance: estimates agree with the integral and vary as predicted", "[importance]") {
  LatLongImage image = noise(64, 32, 21);
  for (int k = 0; k < 20; ++k) set_texel(image, 3 * k, k, 30.0F);
  double total = 0.0;
  for (int row = 0; row < 32; ++row) {
    for (int column = 0; column < 64; ++column) {
      total += luminance(image, column, row) * image::lat_long_texel_solid_angle(64, 32, row);
    }
  }
  // Coarser than the image, so that there is variance left.
  for (const auto& [width, height] : {std::array{16, 8}, std::array{13, 7}}) {
    const ImportanceTable table = importance_table(image.view(), {.width = width, .height = height});
    CHECK(table.integral == Approx(total).epsilon(1e-6));
    const ImportanceVariance variance = importance_variance(image.view(), table);
    double sum = 0.0;
    double squares = 0.0;
    const int samples = 300'000;
    for (const Numbers& number : independent(samples, 8)) {
      const ImportanceSample sample = table.sample(number.across, number.down);
      const double column = (0.5 - std::atan2(sample.direction.x, sample.direction.z) / (2.0 * kPi)) * 64;
      const double row = std::acos(sample.direction.y) / kPi * 32;
      const double value =
          luminance(image, std::clamp(static_cast<int>(column), 0, 63), std::clamp(static_cast<int>(row), 0, 31)) /
          sample.density / total;
      sum += value / samples;
      squares += value * value / samples;
    }
    CAPTURE(width, height, variance.table, variance.uniform);
    CHECK(sum == Approx(1.0).margin(5.0 * std::sqrt(variance.table / samples)));
    CHECK(squares - sum * sum == Approx(variance.table).epsilon(0.05));
    CHECK(variance.table < variance.uniform);
  }
}

TEST_CASE("importance: compensation takes the mean away", "[importance]") {
  LatLongImage image = grey_lat_long(32, 16, 1.0F);
  set_texel(image, 5, 5, 11.0F);
  const ImportanceTable table = importance_table(image.view(), {.mis_compensation = true});
  const double sun = image::lat_long_texel_solid_angle(32, 16, 5);
  const double mean = 1.0 + 10.0 * sun / (4.0 * kPi);
  for (std::size_t k = 0; k < table.function.size(); ++k) {
    const double expected = k == 5 * 32 + 5 ? (11.0 - mean) * sun : 0.0;
    CHECK(static_cast<double>(table.function[k]) == Approx(expected).epsilon(1e-5));
  }
  CHECK(importance_variance(image.view(), table).table == std::numeric_limits<double>::infinity());
  // Nothing lies above an even image's mean: its table stays even.
  const LatLongImage flat = grey_lat_long(33, 17, 0.7F);
  CHECK(same(importance_table(flat.view(), {.mis_compensation = true}), importance_table(flat.view())));
}

TEST_CASE("importance: alias tables and pyramids hold the table's probabilities", "[importance]") {
  for (const auto& [width, height] : kSizes) {
    LatLongImage image = noise(width, height, 17);
    set_texel(image, 0, 0, 20.0F);
    set_texel(image, width - 1, height - 1, 0.0F);
    const ImportanceTable table = importance_table(image.view());
    CAPTURE(width, height);

    const AliasTable alias = alias_table(table);
    const auto probabilities = [](std::span<const AliasEntry> entries) {
      std::vector<double> result(entries.size(), 0.0);
      for (std::size_t k = 0; k < entries.size(); ++k) {
        const double keep = static_cast<double>(entries[k].own);
        REQUIRE(keep >= 0.0);
        REQUIRE(keep <= 1.0);
        result[k] += keep / static_cast<double>(entries.size());
        result.at(entries[k].other) += (1.0 - keep) / static_cast<double>(entries.size());
      }
      return result;
    };
    const std::vector<double> rows = probabilities(alias.rows);
    const auto columns = static_cast<std::size_t>(width);
    double largest = 0.0;
    for (std::size_t row = 0; row < rows.size(); ++row) {
      const std::vector<double> within = probabilities(std::span(alias.columns).subspan(row * columns, columns));
      for (std::size_t k = 0; k < columns; ++k) {
        const double expected = static_cast<double>(table.function[row * columns + k]) / table.integral;
        largest = std::max(largest, std::abs(rows[row] * within[k] - expected));
      }
    }
    // A lone row without light has uniform columns.
    if (height > 1 || width > 1) CHECK(largest < 1e-7);

    const ImportancePyramid pyramid = importance_pyramid(table);
    REQUIRE(pyramid.levels.front().width == width);
    REQUIRE(pyramid.levels.back().probabilities.size() == 1);
    for (const ImportancePyramid::Level& level : pyramid.levels) {
      double sum = 0.0;
      for (const float value : level.probabilities) sum += static_cast<double>(value);
      CHECK(sum == Approx(1.0).epsilon(1e-6));
    }
    for (std::size_t n = 1; n < pyramid.levels.size(); ++n) {
      const ImportancePyramid::Level& below = pyramid.levels[n];
      const ImportancePyramid::Level& finer = pyramid.levels[n - 1];
      REQUIRE(below.width == (finer.width + 1) / 2);
      REQUIRE(below.height == (finer.height + 1) / 2);
    }
  }
}

TEST_CASE("importance: weights are luminance, mean or the largest channel, and never negative", "[importance]") {
  LatLongImage image = grey_lat_long(2, 1, 1.0F);
  image.pixels = {-1.0F, 2.0F, 4.0F, -3.0F, -1.0F, -2.0F};
  const auto first = [&](ImportanceWeight weight) {
    const ImportanceTable table = importance_table(image.view(), {.weight = weight});
    CHECK(table.function[1] == 0.0F);
    CHECK(table.sample(0.99, 0.5).column == 0);
    CHECK(table.density({0.0, 0.0, 1.0}) >= 0.0);
    return static_cast<double>(table.function[0]) / (2.0 * kPi);
  };
  CHECK(first(ImportanceWeight::luminance) == Approx(-0.2126 + 2.0 * 0.7152 + 4.0 * 0.0722).epsilon(1e-6));
  CHECK(first(ImportanceWeight::mean) == Approx(5.0 / 3.0).epsilon(1e-6));
  CHECK(first(ImportanceWeight::largest) == Approx(4.0).epsilon(1e-6));
}

TEST_CASE("importance: what no distribution can hold does no harm", "[importance]") {
  // Black: even over the sphere.
  const ImportanceTable black = importance_table(grey_lat_long(8, 4, 0.0F).view());
  CHECK(black.integral == Approx(4.0 * kPi).epsilon(1e-6));
  CHECK(black.density({0.3, -0.2, 0.9}) == Approx(1.0 / (4.0 * kPi)).epsilon(1e-6));
  CHECK(importance_variance(grey_lat_long(8, 4, 0.0F).view(), black).table == 0.0);

  LatLongImage odd = grey_lat_long(4, 2, 1.0F);
  odd.pixels[0] = std::numeric_limits<float>::quiet_NaN();
  odd.pixels[3] = std::numeric_limits<float>::infinity();
  odd.pixels[6] = std::numeric_limits<float>::max();
  const ImportanceTable replaced = importance_table(odd.view());
  CHECK(std::ranges::all_of(replaced.function, [](float value) { return std::isfinite(value) && value >= 0.0F; }));
  CHECK(std::isfinite(replaced.sample(0.7, 0.2).density));
  CHECK(thrown_by([&] {
          static_cast<void>(importance_table(odd.view(), {.pixels = {.nan = NonFinitePolicy::reject}}));
        }).code == ErrorCode::rejected_pixel);
  const ImportanceTable table = importance_table(noise(4, 2).view());
  for (const double number : {-1.0, 1.0, 2.0, std::numeric_limits<double>::quiet_NaN()}) {
    const ImportanceSample sample = table.sample(number, number);
    CHECK(sample.density > 0.0);
    CHECK(sample.column >= 0);
    CHECK(sample.column < 4);
  }
}

TEST_CASE("importance: bad requests are told", "[importance]") {
  const LatLongImage image = noise(8, 4);
  CHECK(thrown_by([&] { static_cast<void>(importance_table(image.view(), {.width = 9})); }).says("width is 9"));
  CHECK(thrown_by([&] { static_cast<void>(importance_table(image.view(), {.height = -1})); }).says("height is -1"));
  CHECK(thrown_by([&] { static_cast<void>(importance_table(LatLongView{})); }).code == ErrorCode::invalid_argument);
  std::vector<float> few(3);
  CHECK(thrown_by([&] {
          static_cast<void>(importance_table(image.view(), ImportanceTargets{few, few, few}));
        }).says("must have 32"));
  ImportanceTable table = importance_table(image.view());
  CHECK(thrown_by([&] { static_cast<void>(table.density({0.0, 0.0, 0.0})); }).code == ErrorCode::invalid_argument);
  CHECK(
      thrown_by([&] { static_cast<void>(importance_variance(noise(4, 4).view(), table)); }).says("must not be larger"));
  table.row_cdf.pop_back();
  CHECK(thrown_by([&] { static_cast<void>(table.sample(0.5, 0.5)); }).code == ErrorCode::invalid_argument);
}

}  // namespace welkin::test
