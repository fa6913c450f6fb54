// Octahedral maps: where directions lie, what borders hold, and what texels are.
#include "image/geometry.h"
#include "image/resampling.h"
#include "support/catch.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/resampling.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::test {
namespace {

std::vector<dvec3> many_directions() {
  std::vector<dvec3> directions;
  for (int face = 0; face < 6; ++face) {
    for (int row = 0; row < 9; ++row) {
      for (int column = 0; column < 9; ++column)
        directions.push_back(image::face_direction(8, face, column, row));  // edges and corners too
    }
  }
  return directions;
}

/// Returns what a shader reads, bilinearly, at a position in the square without its border.
dvec3 looked_up(const OctahedralMap& map, int level, const std::array<double, 2>& position) {
  const int size = map.level_size(level);
  const int border = map.border >> level;
  const double x = position[0] * (size - 2 * border) + border - 0.5;
  const double y = position[1] * (size - 2 * border) + border - 0.5;
  const int column = static_cast<int>(std::floor(x));
  const int row = static_cast<int>(std::floor(y));
  dvec3 sum(0.0);
  for (int j = 0; j < 2; ++j) {
    for (int i = 0; i < 2; ++i) {
      REQUIRE((column + i >= 0 && column + i < size && row + j >= 0 && row + j < size));
      const float* const rgb = map.levels[static_cast<std::size_t>(level)].data() + 3 * ((row + j) * size + column + i);
      const double weight = (i == 0 ? 1.0 - (x - column) : x - column) * (j == 0 ? 1.0 - (y - row) : y - row);
      sum += weight * dvec3(rgb[0], rgb[1], rgb[2]);
    }
  }
  return sum;
}

/// Returns the solid angles of the texels of a map of `inner` texels without a border; relative error 1e-4.
std::vector<double> octahedral_solid_angles(int inner) {
  constexpr int parts = 8;
  std::vector<double> steradians(static_cast<std::size_t>(inner) * static_cast<std::size_t>(inner));
  const int samples = parts * inner;
  for (int row = 0; row < samples; ++row) {
    for (int column = 0; column < samples; ++column) {
      const double x = std::abs((2.0 * column + 1.0) / samples - 1.0);
      const double y = std::abs((2.0 * row + 1.0) / samples - 1.0);
      const double z = 1.0 - x - y;
      const dvec3 point = z >= 0.0 ? dvec3(x, y, z) : dvec3(1.0 - y, 1.0 - x, z);
      const double square = glm::dot(point, point);
      steradians[static_cast<std::size_t>(row / parts * inner + column / parts)] +=
          4.0 / (static_cast<double>(samples) * samples * square * std::sqrt(square));
    }
  }
  return steradians;
}

Cubemap chain_of(Content content, int size) { return build_mips(make_cubemap(content, size, 3, 5).view()); }

}  // namespace

TEST_CASE("Directions go to octahedral places and back", "[octahedral]") {
  for (const dvec3& direction : many_directions()) {
    const auto position = octahedral_encode(3.7 * direction);
    CAPTURE(direction.x, direction.y, direction.z, position[0], position[1]);
    CHECK((position[0] >= 0.0 && position[0] <= 1.0 && position[1] >= 0.0 && position[1] <= 1.0));
    CHECK(glm::length(octahedral_decode(position[0], position[1]) - direction) < 1e-14);
  }
  const auto same = [](const std::array<double, 2>& position, double column, double row) {
    return std::abs(position[0] - column) + std::abs(position[1] - row) < 1e-15;
  };
  CHECK(same(octahedral_encode({0, 0, 1}), 0.5, 0.5));
  CHECK(same(octahedral_encode({1, 0, 0}), 1.0, 0.5));
  CHECK(same(octahedral_encode({0, -1, 0}), 0.5, 0.0));
  CHECK(same(octahedral_encode({1, 1, -2}), 0.875, 0.875));
}

TEST_CASE("Beyond an edge of the octahedral square the sphere goes on", "[octahedral]") {
  for (const double along : {0.03, 0.4, 0.71, 0.98}) {
    for (const double beyond : {1e-9, 0.1, 0.8}) {
      CHECK(glm::length(octahedral_decode(-beyond, along) - octahedral_decode(beyond, 1.0 - along)) < 1e-14);
      CHECK(glm::length(octahedral_decode(1.0 + beyond, along) - octahedral_decode(1.0 - beyond, 1.0 - along)) < 1e-14);
      CHECK(glm::length(octahedral_decode(along, -beyond) - octahedral_decode(1.0 - along, beyond)) < 1e-14);
      CHECK(glm::length(octahedral_decode(along, 1.0 + beyond) - octahedral_decode(1.0 - along, 1.0 - beyond)) < 1e-14);
    }
    CHECK(glm::length(octahedral_decode(along, -1e-9) - octahedral_decode(along, 1e-9)) < 1e-7);
  }
}

TEST_CASE("Border texels of octahedral maps are those beyond the edge", "[octahedral]") {
  for (const auto& [size, border, levels] : {std::array{20, 4, 3}, {8, 1, 1}, {7, 3, 1}, {12, 2, 2}, {3, 1, 1}}) {
    CAPTURE(size, border, levels);
    const OctahedralMap map =
        to_octahedral(chain_of(Content::random, 16), {.size = size, .levels = levels, .border = border});
    REQUIRE(map.levels.size() == static_cast<std::size_t>(levels));
    for (int level = 0; level < levels; ++level) {
      const int edge = map.level_size(level);
      const int margin = map.border >> level;
      const int inner = edge - 2 * margin;
      const auto texel = [&](int column, int row) {
        const float* const rgb = map.levels[static_cast<std::size_t>(level)].data() + 3 * (row * edge + column);
        return std::array{rgb[0], rgb[1], rgb[2]};
      };
      for (int row = 0; row < edge; ++row) {
        for (int column = 0; column < edge; ++column) {
          // the texel inside whose centre is the same direction
          const dvec3 direction = octahedral_decode((column - margin + 0.5) / inner, (row - margin + 0.5) / inner);
          const bool folded_twice = column - margin < -inner || column - margin >= 2 * inner || row - margin < -inner ||
                                    row - margin >= 2 * inner;
          if (folded_twice) continue;
          const auto position = octahedral_encode(direction);
          const int at_column = std::clamp(static_cast<int>(position[0] * inner), 0, inner - 1) + margin;
          const int at_row = std::clamp(static_cast<int>(position[1] * inner), 0, inner - 1) + margin;
          REQUIRE(texel(column, row) == texel(at_column, at_row));
        }
      }
    }
  }
}

TEST_CASE("Octahedral maps show what the cubemap shows", "[octahedral]") {
  const Cubemap chain = chain_of(Content::smooth, 64);
  const OctahedralMap map = to_octahedral(chain, {.size = 256, .levels = 4});
  CHECK(map.border == 8);
  for (int level = 0; level < 4; ++level) {
    const image::CubemapSampler cube(chain.view(level));
    double squares = 0.0;
    double whole = 0.0;
    for (const dvec3& direction : many_directions()) {
      dvec3 expected(0.0);
      cube.add(direction, 1.0, expected);
      const dvec3 got = looked_up(map, level, octahedral_encode(direction));
      squares += glm::dot(got - expected, got - expected);
      whole += glm::dot(expected, expected);
    }
    CAPTURE(level, std::sqrt(squares / whole));
    CHECK(std::sqrt(squares / whole) < 2e-3 * (1 << level));  // both are bilinear, on other grids
  }
}

TEST_CASE("An octahedral map has the light of each of the cubemap's texels", "[octahedral]") {
  for (const auto& [size, inner] : {std::array{64, 32}, {64, 64}, {64, 128}, {256, 64}, {63, 31}, {33, 63}, {65, 99}}) {
    const std::vector<double> steradians = octahedral_solid_angles(inner);
    std::vector<double> of_row(static_cast<std::size_t>(size));
    const int half = size / 2;
    const int quarter = size / 4;
    for (const auto& [face, column, row] :
         {std::array{5, 5, 15}, {0, 0, 0}, {1, size - 1, quarter}, {2, half, half}, {3, quarter, 1}, {4, half, 0}}) {
      Cubemap chain(size, 1);
      for (int each = 0; each < 6; ++each) std::fill_n(chain.face(0, each), 3 * size * size, 0.0F);
      chain.face(0, face)[3 * (row * size + column) + 1] = 1000.0F;
      const OctahedralMap map = to_octahedral(chain, {.size = inner + 2, .border = 1});
      double light = 0.0;
      for (int k = 0; k < inner * inner; ++k) {
        const int texel = (k / inner + 1) * (inner + 2) + k % inner + 1;
        light += steradians[static_cast<std::size_t>(k)] *
                 static_cast<double>(map.levels[0][static_cast<std::size_t>(3 * texel + 1)]);
      }
      image::cubemap_row_solid_angles(row, of_row);
      CAPTURE(size, inner, face, column, row, light);
      CHECK(std::abs(light / (1000.0 * of_row[static_cast<std::size_t>(column)]) - 1.0) < 0.006);
    }
  }
}

TEST_CASE("A texel of an octahedral map is the mean of bilinear interpolation over its area", "[octahedral]") {
  // Texels of odd maps lie across the edges of octants.
  for (const auto& [size, inner] : {std::array{20, 16}, {20, 17}, {7, 24}, {1, 5}, {2, 1}}) {
    const Cubemap chain = chain_of(Content::random, size);
    const image::CubemapSampler cube(chain.view(0));
    const OctahedralMap map = to_octahedral(chain, {.size = inner + 2, .border = 1});
    const int parts = 480 / inner;
    double worst = 0.0;
    for (int k = 0; k < inner * inner; ++k) {
      dvec3 sum(0.0);
      double steradians = 0.0;
      for (int part = 0; part < parts * parts; ++part) {
        const double column = k % inner + (part % parts + 0.5) / parts;
        const double row = k / inner + (part / parts + 0.5) / parts;
        const dvec3 direction = octahedral_decode(column / inner, row / inner);
        const double size_of = std::abs(direction.x) + std::abs(direction.y) + std::abs(direction.z);
        cube.add(direction, size_of * size_of * size_of, sum);
        steradians += size_of * size_of * size_of;
      }
      const dvec3 got = looked_up(map, 0, {(k % inner + 0.5) / inner, (k / inner + 0.5) / inner});
      worst = std::max(worst, glm::length(got - sum / steradians) / glm::length(got));
    }
    CAPTURE(size, inner, worst);
    CHECK(worst < 2e-3);
  }
}

TEST_CASE("Coefficients are at an octahedral map's centres", "[octahedral]") {
  SphericalHarmonics harmonics(3);
  for (std::size_t i = 0; i < 9; ++i)
    harmonics.coefficients()[i] = dvec3(1.0 / (1.0 + static_cast<double>(i)), 0.2 * static_cast<double>(i), 1.0);
  const OctahedralMap map = to_octahedral(harmonics, {.size = 9});
  for (int row = 0; row < 9; ++row) {
    for (int column = 0; column < 9; ++column) {
      const dvec3 expected = evaluate(harmonics, octahedral_decode((column - 0.5) / 7.0, (row - 0.5) / 7.0));
      const float* const rgb = map.levels[0].data() + 3 * (row * 9 + column);
      CHECK(glm::length(dvec3(rgb[0], rgb[1], rgb[2]) - expected) < 1e-6);
    }
  }
}

TEST_CASE("Octahedral maps that cannot be are refused", "[octahedral]") {
  const Cubemap chain = chain_of(Content::uniform, 8);
  for (const OctahedralOptions& options : {OctahedralOptions{.size = 0},
                                           {.size = 20000},
                                           {.size = 16, .levels = 0},
                                           {.size = 16, .levels = 5},
                                           {.size = 18, .levels = 3},
                                           {.size = 16, .levels = 2, .border = 3},
                                           {.size = 16, .levels = 1, .border = -1},
                                           {.size = 16, .levels = 1, .border = 8}}) {
    CAPTURE(options.size, options.levels, options.border);
    CHECK(thrown_by([&] { static_cast<void>(to_octahedral(chain, options)); }).code == ErrorCode::invalid_argument);
  }
  CHECK(thrown_by([&] { static_cast<void>(to_octahedral(Cubemap(), {})); }).code == ErrorCode::invalid_argument);
  CHECK(thrown_by([&] { static_cast<void>(to_octahedral(SphericalHarmonics(2), {.size = 16, .levels = 2})); }).code ==
        ErrorCode::invalid_argument);
}

}  // namespace welkin::test
