// Solid angles: the sum over the sphere, and each texel by itself (totals hide wrong parts).
#include "tables/texel_weights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/catch.h"
#include "tables/lat_long_weights.h"

namespace welkin::test {
namespace {

/// A(x, y) = atan2(xy, sqrt(x^2 + y^2 + 1)): solid angle of the rectangle from the face's centre to (x, y).
long double corner_area(long double x, long double y) { return std::atan2(x * y, std::sqrt(x * x + y * y + 1.0L)); }

long double solid_angle(int size, int column, int row) {
  const auto edge = [size](int index) { return 2.0L * index / size - 1.0L; };
  return corner_area(edge(column + 1), edge(row + 1)) - corner_area(edge(column), edge(row + 1)) -
         corner_area(edge(column + 1), edge(row)) + corner_area(edge(column), edge(row));
}

/// Calls `use(column, row, solid angle)` for all texels of the quadrant.
template <class Use>
void for_each_weight(const tables::TexelWeights& weights, const Use& use) {
  tables::AlignedBuffer<float> scratch(weights.scratch_size());
  constexpr double y00 = 0.28209479177387814;
  for (int index = 0; index < weights.chunk_count(); ++index) {
    const tables::QuadrantChunk chunk = weights.chunk(index);
    const float* const values = weights.chunk_weights(index, scratch.data());
    for (int row = 0; row < chunk.row_count; ++row) {
      for (int column = 0; column < chunk.column_count; ++column) {
        const int position = row * chunk.groups_per_row * simd::kLanes + column;
        use(chunk.first_column + column, chunk.first_row + row, static_cast<double>(values[position]) / y00);
      }
    }
  }
}

}  // namespace

TEST_CASE("Every texel has its own solid angle", "[tables]") {
  for (const int bands : {1, 3, 4}) {
    for (const int size : {1, 2, 3, 7, 31, 64, 100, 128, 129, 257, 512, 1024}) {
      if (bands == 4 && size > 300) continue;
      const tables::TexelWeights weights({size, bands, false, size});
      int texels = 0;
      double worst = 0.0;
      for_each_weight(weights, [&](int column, int row, double found) {
        ++texels;
        const auto expected = static_cast<double>(solid_angle(size, column, row));
        worst = std::max(worst, std::abs(found / expected - 1.0));
      });
      CAPTURE(size, bands);
      CHECK(texels == ((size + 1) / 2) * ((size + 1) / 2));
      CHECK(worst < 4e-7);
    }
  }
}

TEST_CASE("Solid angles add up to the sphere", "[tables]") {
  for (const int size : {1, 2, 3, 64, 257, 1000, 2048}) {
    const tables::TexelWeights weights({size, 3, false, size});
    double total = 0.0;
    for_each_weight(weights, [&](int column, int row, double found) {
      // Images under the mirrors; a middle row or column is its own.
      const int copies = (2 * column + 1 == size ? 1 : 2) * (2 * row + 1 == size ? 1 : 2);
      total += 6.0 * copies * found;
    });
    CHECK(total == Approx(4.0 * std::numbers::pi).epsilon(5e-8));
  }
}

TEST_CASE("A reduced face's solid angles are the full one's", "[tables]") {
  const int shapes[][2] = {{64, 8}, {100, 64}, {101, 64}, {64, 63},   {7, 3},
                           {7, 2},  {3, 1},    {300, 7},  {300, 128}, {512, 300}};
  for (const auto& [size, target] : shapes) {
    const tables::TexelWeights weights({size, 3, false, target});
    double worst = 0.0;
    for_each_weight(weights, [&](int column, int row, double found) {
      worst = std::max(worst, std::abs(found / static_cast<double>(solid_angle(size, column, row)) - 1.0));
    });
    CAPTURE(size, target, worst);
    CHECK(worst < 6e-7);
  }
}

TEST_CASE("A lat-long's solid angles add up to the sphere", "[tables]") {
  const int shapes[][3] = {{1, 1, 0},      {2, 1, 0},    {7, 5, 0},    {64, 32, 0},
                           {1024, 512, 0}, {100, 50, 8}, {101, 51, 8}, {64, 32, 100}};
  for (const auto& [width, height, target] : shapes) {
    for (const bool midpoint : {false, true}) {
      const tables::LatLongWeights weights({width, height, 3, midpoint, target});
      double columns = 0.0;
      for (int column = 0; column < weights.column_count(); ++column) {
        columns += static_cast<double>(weights.chunk_weights(column / simd::kChunk)[column % simd::kChunk]);
      }
      double rows = 0.0;
      for (int row = 0; row < height; ++row) rows += weights.row_weights(row)[0];
      const double both = weights.paired() ? 2.0 : 1.0;
      CHECK(both * columns * rows * 2.0 * std::sqrt(std::numbers::pi) == Approx(4.0 * std::numbers::pi).epsilon(1e-7));
    }
  }
}

TEST_CASE("Tables come from one cache", "[tables]") {
  const tables::TexelWeightsKey key{48, 3, false, 48};
  CHECK(tables::TexelWeights::get(key) == tables::TexelWeights::get(key));
  CHECK(tables::TexelWeights::get(key) != tables::TexelWeights::get({48, 3, true, 48}));
  const tables::LatLongWeightsKey lat_long{48, 24, 3, false, 0};
  CHECK(tables::LatLongWeights::get(lat_long) == tables::LatLongWeights::get(lat_long));
}

}  // namespace welkin::test
