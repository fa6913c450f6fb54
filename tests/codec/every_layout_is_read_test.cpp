// Promises: a cubemap comes out of a picture of any layout texel for texel, whatever its size, and what lies between
// the faces of a cross is never seen: not in pixels, not in statistics, not in a projection.
#include <algorithm>
#include <cmath>
#include <limits>

#include "codec/row_source.h"
#include "support/catch.h"
#include "support/coefficients.h"
#include "support/cube_pictures.h"
#include "support/exr_files.h"
#include "support/pfm_files.h"
#include "support/temporary_directory.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"

namespace welkin {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

void write_pfm(const std::filesystem::path& path, const test::CubePicture& picture) {
  test::write_bytes(path, test::pfm_bytes(picture.width, picture.height, false, "-1", picture.pixels));
}

void write_float_exr(const std::filesystem::path& path, const test::CubePicture& picture,
                     const std::optional<Imf::TileDescription>& tiles) {
  test::ExrRecipe recipe{picture.width, picture.height, 0, 0, Imf::ZIP_COMPRESSION, Imf::INCREASING_Y,
                         tiles,         std::nullopt,   {}};
  recipe.channels = test::rgb_channels(Imf::FLOAT);
  test::write_exr(path, recipe, picture.pixels);
}

bool holds(const Environment& environment, const std::vector<float>& faces) {
  return std::equal(faces.begin(), faces.end(), environment.pixels.get());
}

}  // namespace

TEST_CASE("every texel of every layout comes to its place", "[codec][layout]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("cube.pfm");
  for (const Layout layout : test::one_file_cube_layouts()) {
    for (const int size : {1, 2, 3, 7, 64, 130}) {
      CAPTURE(name(layout), size);
      const std::vector<float> faces = test::unlike_texels(size);
      write_pfm(path, test::cube_picture(layout, size, faces, kNaN));
      const Environment cube = read_environment(path);
      CHECK(cube.info.layout == layout);
      CHECK(cube.face_size() == size);
      CHECK(holds(cube, faces));
      const CubemapView view = cube.cubemap();
      CHECK(view.size == size);
      for (std::size_t face = 0; face < 6; ++face) {
        const auto edge = static_cast<std::size_t>(size);
        CHECK(*static_cast<const float*>(view.faces[face]) == faces[face * edge * edge * 3]);
      }
    }
  }
}

TEST_CASE("layouts are read alike from blocks and tiles, on any number of threads", "[codec][layout]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("cube.exr");
  const int size = 133;
  const std::vector<float> faces = test::unlike_texels(size);
  for (const Layout layout : test::one_file_cube_layouts()) {
    CAPTURE(name(layout));
    const test::CubePicture picture = test::cube_picture(layout, size, faces, kNaN);
    for (const auto& tiles : {std::optional<Imf::TileDescription>{}, std::optional{Imf::TileDescription(60, 50)}}) {
      write_float_exr(path, picture, tiles);
      for (const int threads : {1, 2, 5}) {
        run_with_threads(threads, [&] { CHECK(holds(read_environment(path), faces)); });
      }
    }
  }
}

TEST_CASE("what lies between the faces of a cross counts for nothing", "[codec][layout]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("cube.pfm");
  const int size = 24;
  const std::vector<float> faces = test::some_pixels(size, 6 * size);
  write_pfm(path, test::cube_picture(Layout::vertical_strip, size, faces, 0.0F));
  const EnvironmentStatistics wanted = measure_environment(path);
  const Projection wanted_light = project_file(path);
  for (const Layout layout : test::one_file_cube_layouts()) {
    for (const float blank : {0.0F, 1e30F, -1.0F, kNaN}) {
      CAPTURE(name(layout), blank);
      write_pfm(path, test::cube_picture(layout, size, faces, blank));
      const EnvironmentStatistics found = measure_environment(path);
      CHECK(found.texels == std::uint64_t{6} * size * size);
      CHECK(found.nans == 0);
      CHECK(found.negatives == wanted.negatives);
      CHECK(found.minimum == wanted.minimum);
      CHECK(found.maximum == wanted.maximum);
      for (int channel = 0; channel < 3; ++channel) {
        CHECK(found.mean[channel] == Approx(wanted.mean[channel]).epsilon(1e-13));
        CHECK(found.flux[channel] == Approx(wanted.flux[channel]).epsilon(1e-13));
      }
      CHECK(found.brightest == wanted.brightest);
      CHECK(found.brightest_direction == wanted.brightest_direction);
      CHECK(test::same_bits(project_file(path).radiance, wanted_light.radiance));
    }
  }
}

TEST_CASE("the brightest texel is told by its place in the picture and its direction", "[codec][layout]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("cube.pfm");
  const int size = 8;
  const std::vector<float> dark(std::size_t{18} * size * size, 0.25F);
  for (std::size_t face = 0; face < 6; ++face) {
    std::vector<float> faces = dark;
    std::fill_n(faces.begin() + static_cast<std::ptrdiff_t>(3 * ((face * size + 2) * size + 5)), 3, 9.0F);
    write_pfm(path, test::cube_picture(Layout::vertical_strip, size, faces, 0.0F));
    const glm::dvec3 wanted = measure_environment(path).brightest_direction;
    for (const Layout layout : test::one_file_cube_layouts()) {
      CAPTURE(name(layout), face);
      const test::CubePicture picture = test::cube_picture(layout, size, faces, 0.5F);
      write_pfm(path, picture);
      const EnvironmentStatistics found = measure_environment(path);
      CHECK(found.brightest_direction == wanted);
      CHECK(picture
                .pixels[static_cast<std::size_t>(3 * (found.brightest_row * picture.width + found.brightest_column))] ==
            9.0F);
    }
  }
}

TEST_CASE("a cross is held as its faces alone and refused by what they take", "[codec][layout]") {
  const test::TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("cross.pfm");
  const int size = 64;
  write_pfm(path, test::cube_picture(Layout::horizontal_cross, size, test::unlike_texels(size), kNaN));
  ReadOptions options;
  options.memory_limit_bytes = 6 * size * size * 12 - 1;
  const test::ThrownError error = test::thrown_by([&] { (void)read_environment(path, options); });
  CHECK(error.code == ErrorCode::limit_exceeded);
  CHECK(error.message == path.string() +
                             ": 256 x 192 texels take 294912 bytes as RGB floats, above the limit of 294911; raise "
                             "the limit or reduce the picture");
  options.memory_limit_bytes += std::uint64_t{1} << 19U;  // room for decoding
  CHECK(read_environment(path, options).face_size() == size);
}

}  // namespace welkin
