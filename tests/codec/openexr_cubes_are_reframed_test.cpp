// Promises: cubes with OpenEXR's envmap attribute come out in Welkin's frames, other strips as they are.
#include <ImfEnvmap.h>

#include <algorithm>
#include <cmath>

#include "support/catch.h"
#include "support/coefficients.h"
#include "support/exr_files.h"
#include "support/temporary_directory.h"
#include "welkin/environment_file.h"

namespace welkin {
namespace {

// Each texel's colour is the direction that OpenEXR itself gives for its centre: it counts places in a face by its own
// axes, and says where in the picture they lie. (Its face runs from the centre of its first texel to that of its last
// one, ours over their areas: the place is stretched.)
std::vector<float> directions_by_openexr(int size) {
  const Imath::Box2i window({0, 0}, {size - 1, 6 * size - 1});
  const float scale = static_cast<float>(size - 1) / static_cast<float>(size);
  std::vector<float> rgb(std::size_t{18} * static_cast<std::size_t>(size * size));
  for (int face = 0; face < 6; ++face) {
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const auto id = static_cast<Imf::CubeMapFace>(face);
        const Imath::V2f place(static_cast<float>(x), static_cast<float>(y));
        const Imath::V3f direction =
            Imf::CubeMap::direction(id, window, (place + Imath::V2f(0.5F)) * scale).normalized();
        const Imath::V2f pixel = Imf::CubeMap::pixelPosition(id, window, place);
        const auto texel = static_cast<std::size_t>(pixel.y * static_cast<float>(size) + pixel.x);
        std::copy_n(&direction.x, 3, rgb.begin() + static_cast<std::ptrdiff_t>(3 * texel));
      }
    }
  }
  return rgb;
}

glm::dvec3 direction_of_view(int size, std::size_t face, int column, int row) {
  const glm::dvec3 normals[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  const glm::dvec3 us[] = {{0, 0, -1}, {0, 0, 1}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}, {-1, 0, 0}};
  const glm::dvec3 vs[] = {{0, -1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}, {0, -1, 0}, {0, -1, 0}};
  const double u = (2.0 * column + 1.0) / size - 1.0;
  const double v = (2.0 * row + 1.0) / size - 1.0;
  const glm::dvec3 point = normals[face] + u * us[face] + v * vs[face];
  return point / std::sqrt(1.0 + u * u + v * v);
}

}  // namespace

TEST_CASE("a strip with the envmap attribute of a cube is turned to Welkin's frames", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("cube.exr");
  for (const int size : {4, 7, 40}) {
    for (const auto& tiles : {std::optional<Imf::TileDescription>{}, std::optional{Imf::TileDescription(16, 16)}}) {
      const std::vector<float> stored = directions_by_openexr(size);
      test::ExrRecipe recipe{size,  6 * size,         0, 0, Imf::ZIP_COMPRESSION, Imf::INCREASING_Y,
                             tiles, Imf::ENVMAP_CUBE, {}};
      recipe.channels = test::rgb_channels(Imf::FLOAT);
      test::write_exr(path, recipe, stored);
      const Environment cube = read_environment(path);
      const CubemapView view = cube.cubemap();
      for (std::size_t face = 0; face < 6; ++face) {
        const auto* texel = static_cast<const float*>(view.faces[face]);
        for (int row = 0; row < size; ++row) {
          for (int column = 0; column < size; ++column, texel += 3) {
            const glm::dvec3 wanted = direction_of_view(size, face, column, row);
            for (int axis = 0; axis < 3; ++axis) {
              REQUIRE(std::abs(texel[axis] - wanted[axis]) < 1e-6);
            }
          }
        }
      }
    }
  }
}

TEST_CASE("a cube of OpenEXR's has the same light and statistics as its faces in a plain strip", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("cube.exr");
  const int size = 120;
  test::ExrRecipe recipe{size,         6 * size,         0, 0, Imf::PIZ_COMPRESSION, Imf::INCREASING_Y,
                         std::nullopt, Imf::ENVMAP_CUBE, {}};
  recipe.channels = test::rgb_channels(Imf::FLOAT);
  test::write_exr(path, recipe, test::some_pixels(size, 6 * size));
  const Environment cube = read_environment(path);
  const std::filesystem::path plain = directory.file("plain.exr");
  const auto count = static_cast<std::ptrdiff_t>(18 * size * size);
  recipe.envmap = std::nullopt;
  test::write_exr(plain, recipe, std::vector<float>(cube.pixels.get(), cube.pixels.get() + count));

  CHECK(test::same_bits(project_file(path).radiance, project_file(plain).radiance));
  const EnvironmentStatistics found = measure_environment(path);
  const EnvironmentStatistics wanted = measure_environment(plain);
  CHECK(found.brightest == wanted.brightest);
  CHECK(found.brightest_direction == wanted.brightest_direction);
  CHECK(found.mean.g == Approx(wanted.mean.g).epsilon(1e-13));
  for (const int threads : {1, 2, 5}) {
    run_with_threads(threads, [&] {
      const Environment again = read_environment(path);
      CHECK(std::equal(again.pixels.get(), again.pixels.get() + count, cube.pixels.get()));
    });
  }
}

TEST_CASE("another layout that is asked for is taken as it is, whatever the attribute says", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("cube.exr");
  const std::vector<float> pixels = test::some_pixels(5, 30);
  test::ExrRecipe recipe{5, 30, 0, 0, Imf::ZIP_COMPRESSION, Imf::INCREASING_Y, std::nullopt, Imf::ENVMAP_CUBE, {}};
  recipe.channels = test::rgb_channels(Imf::FLOAT);
  test::write_exr(path, recipe, pixels);
  ReadOptions options;
  options.layout = Layout::lat_long;
  const Environment picture = read_environment(path, options);
  CHECK(std::equal(pixels.begin(), pixels.end(), picture.pixels.get()));
}

TEST_CASE("a strip without the attribute is taken as it is", "[codec]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("strip.exr");
  const std::vector<float> pixels = test::some_pixels(5, 30);
  test::ExrRecipe recipe{5, 30, 0, 0, Imf::ZIP_COMPRESSION, Imf::INCREASING_Y, std::nullopt, std::nullopt, {}};
  recipe.channels = test::rgb_channels(Imf::FLOAT);
  test::write_exr(path, recipe, pixels);
  const Environment strip = read_environment(path);
  CHECK(std::equal(pixels.begin(), pixels.end(), strip.pixels.get()));
}

}  // namespace welkin
