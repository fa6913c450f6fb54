// Resampling between cubemaps and lat-longs, by filter and by area; and rotations of either.
#include "welkin/resampling.h"

#include "image/area_weights.h"
#include "image/cube_symmetry.h"
#include "image/geometry.h"
#include "image/pixels.h"
#include "support/catch.h"
#include "support/coefficients.h"
#include "support/exr_files.h"
#include "support/images.h"
#include "support/same_bits.h"
#include "support/sun_maps.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/core.h"
#include "welkin/projection.h"

namespace welkin::test {

// Promise: resampling keeps light where it is, has no seams, and is bit-identical on any number of threads.

namespace {

// A smooth environment: a polynomial of degree 3 in the direction.
glm::dvec3 radiance(const glm::dvec3& d) {
  return {1.0 + 0.5 * d.x + 0.3 * d.y * d.z, 2.0 + d.z - d.x * d.y * d.z,
          1.5 - 0.7 * d.y + 0.4 * (d.x * d.x - d.z * d.z)};
}

Cubemap smooth_cubemap(int size, const glm::dmat3& rotation = glm::dmat3(1.0)) {
  return cubemap_of(size, [&](const glm::dvec3& d) { return radiance(glm::transpose(rotation) * d); });
}

LatLongImage smooth_lat_long(int width, int height, const glm::dmat3& rotation = glm::dmat3(1.0)) {
  return lat_long_of(width, height, [&](const glm::dvec3& d) { return radiance(glm::transpose(rotation) * d); });
}

double worst_difference(std::span<const float> a, std::span<const float> b) {
  REQUIRE(a.size() == b.size());
  double worst = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(static_cast<double>(a[i]) - b[i]));
  return worst;
}

// Without the rows next to the poles: the mean of such a texel by solid angle lies two thirds down it, not half-way.
double worst_difference_off_poles(const LatLongImage& a, const LatLongImage& b) {
  const auto inner = [](const LatLongImage& map) {
    return std::vector<float>(map.pixels.begin() + 12 * map.width, map.pixels.end() - 12 * map.width);
  };
  return worst_difference(inner(a), inner(b));
}

const glm::dmat3 kAskew = rotation_about_y(37.0) * glm::dmat3(0.6, 0.8, 0, -0.8, 0.6, 0, 0, 0, 1);

}  // namespace

TEST_CASE("A smooth environment is resampled to itself in every shape, askew too", "[resampling]") {
  const Cubemap cube = smooth_cubemap(64);
  const LatLongImage lat_long = smooth_lat_long(256, 128);
  for (const glm::dmat3& rotation : {glm::dmat3(1.0), kAskew, kAskew * glm::dmat3(-1, 0, 0, 0, 1, 0, 0, 0, 1)}) {
    CHECK(worst_difference(to_cubemap(cube.view(), 48, rotation).pixels(), smooth_cubemap(48, rotation).pixels()) <
          2e-3);
    CHECK(worst_difference(to_cubemap(lat_long.view(), 48, rotation).pixels(), smooth_cubemap(48, rotation).pixels()) <
          2e-3);
    CHECK(worst_difference_off_poles(to_lat_long(cube.view(), 160, 80, rotation), smooth_lat_long(160, 80, rotation)) <
          2e-3);
    CHECK(worst_difference_off_poles(to_lat_long(lat_long.view(), 160, 80, rotation),
                                     smooth_lat_long(160, 80, rotation)) < 2e-3);
  }
}

TEST_CASE("Resampling keeps a smooth environment's harmonics", "[resampling]") {
  const Cubemap cube = smooth_cubemap(128);
  const SphericalHarmonics wanted = project(cube.view()).radiance;
  CHECK(relative_error(project(to_cubemap(cube.view(), 64).view()).radiance, wanted) < 2e-4);
  CHECK(relative_error(project(to_lat_long(cube.view(), 512, 256).view()).radiance, wanted) < 2e-4);
  CHECK(relative_error(project(to_lat_long(cube.view(), 64, 32).view()).radiance, wanted) < 2e-3);
}

TEST_CASE("A lat-long goes on over its poles, in odd widths too", "[resampling]") {
  for (const int width : {64, 63}) {
    const LatLongImage coarse = smooth_lat_long(width, 32);
    const Cubemap wanted = smooth_cubemap(64);
    const glm::dmat3 upright(1.0);
    CHECK(worst_difference(to_cubemap(coarse.view(), 64, upright, ResampleFilter::bilinear).pixels(), wanted.pixels()) <
          0.01);
    CHECK(worst_difference(to_cubemap(coarse.view(), 64, kAskew).pixels(), smooth_cubemap(64, kAskew).pixels()) < 0.01);
    // By area a texel next to the pole extends to the pole unchanged.
    CHECK(worst_difference(to_cubemap(coarse.view(), 64).pixels(), wanted.pixels()) < 0.02);
  }
}

TEST_CASE("Resampling refuses what it cannot do", "[resampling]") {
  const Cubemap map = smooth_cubemap(4);
  const ThrownError skewed = thrown_by([&] { return to_cubemap(map.view(), 4, glm::dmat3(1.1)); });
  CHECK(skewed.code == ErrorCode::invalid_argument);
  CHECK(skewed.says("orthogonal"));
  CHECK(thrown_by([&] { return to_cubemap(map.view(), 4, glm::dmat3(NAN)); }).says("orthogonal"));
  CHECK(thrown_by([&] { return to_cubemap(map.view(), 0); }).says("from 1 to 16384"));
  CHECK(thrown_by([&] { return to_lat_long(map.view(), 70000, 4); }).says("from 1 to 65536"));
  CHECK(thrown_by([&] { return to_lat_long(CubemapView{}, 4, 2); }).code == ErrorCode::invalid_argument);
  CHECK(thrown_by([] { return rotation_about_y(std::numeric_limits<double>::infinity()); }).code ==
        ErrorCode::invalid_argument);
}

// Promise: from a lat-long to a cubemap by area no light is lost, gained or moved, wherever a texel lies.

namespace {

/// The relative error of a lone texel's total radiance.
double lone_texel_error(int width, int height, int column, int row, int size) {
  LatLongImage map = grey_lat_long(width, height, 0.0F);
  map.pixels[static_cast<std::size_t>(3 * (row * width + column) + 1)] = 1e6F;
  const Cubemap cube = to_cubemap(map.view(), size);
  CHECK(std::ranges::all_of(cube.pixels(), [](float value) { return value >= 0.0F; }));
  const double wanted = 1e6 * image::lat_long_texel_solid_angle(width, height, row);
  return std::abs(total_radiance_of(cube).y / wanted - 1.0);
}

}  // namespace

TEST_CASE("A lone bright texel keeps its total radiance at random places, sizes and at all seams", "[area][slow]") {
  std::mt19937 generator(11);
  const auto upto = [&](int count) { return static_cast<int>(generator() % static_cast<unsigned>(count)); };
  for (int k = 0; k < 60; ++k) {
    const int width = 1 + upto(400);
    const int height = 1 + upto(200);
    const int size = 1 + upto(130);  // odd ones too: the texel around a pole, and those next to it, are wide
    const int row = k % 3 == 0 ? (upto(2) == 0 ? 0 : height - 1) : upto(height);
    const int column = k % 5 == 0 ? (upto(2) == 0 ? 0 : width - 1) : upto(width);
    CAPTURE(width, height, size, row, column);
    CHECK(lone_texel_error(width, height, column, row, size) < 1e-6);
  }
  // Where three faces meet: latitude 35.26 degrees, longitude 45; and where two do.
  for (const int row : {63, 76, 77, 78, 179}) {
    for (const int column : {63, 64, 191, 192, 255, 256}) {
      CHECK(lone_texel_error(512, 256, column, row, 100) < 1e-6);
    }
  }
}

TEST_CASE("A lat-long's lone texel nearly keeps its total radiance, turned by any rotation", "[resampling]") {
  constexpr int kHeight = 128;
  LatLongImage map = grey_lat_long(2 * kHeight, kHeight, 0.0F);
  for (const glm::dmat3& rotation : {kAskew, glm::transpose(kAskew), kAskew * rotation_about_y(45.0) * kAskew}) {
    for (const int row : {0, 1, 2, 3, 5, 9, 16, 32, 64}) {
      float& texel = map.pixels[static_cast<std::size_t>(3 * (row * map.width + 9))];
      texel = 1e6F;
      const double wanted = 1e6 * image::lat_long_texel_solid_angle(map.width, kHeight, row);
      for (const int rows : {kHeight, kHeight / 2}) {
        const LatLongImage turned = to_lat_long(map.view(), 2 * rows, rows, rotation);
        double sum = 0.0;
        for (int at = 0; at < 2 * rows * rows; ++at) {
          sum += static_cast<double>(turned.pixels[static_cast<std::size_t>(3 * at)]) *
                 image::lat_long_texel_solid_angle(2 * rows, rows, at / (2 * rows));
        }
        CAPTURE(row, rows, sum / wanted);
        CHECK(std::abs(sum / wanted - 1.0) < (row < 16 ? 0.6 : 0.15));
      }
      for (const int size : {32, 16}) {
        const double share = total_radiance_of(to_cubemap(map.view(), size, rotation)).x / wanted;
        CAPTURE(row, size, share);
        CHECK(std::abs(share - 1.0) < (row < 16 ? 0.6 : 0.15));
      }
      texel = 0.0F;
    }
  }
}

TEST_CASE("A uniform lat-long is a uniform cubemap, to the last bit", "[area][slow]") {
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {3, 2}, {7, 3}, {128, 64}, {257, 128}, {130, 65}}) {
    const LatLongImage map = grey_lat_long(width, height, 0.1F);
    for (const int size : {1, 2, 3, 7, 64, 257}) {
      const Cubemap cube = to_cubemap(map.view(), size);
      CHECK(std::ranges::all_of(cube.pixels(), [](float value) { return value == 0.1F; }));
    }
  }
}

TEST_CASE("Quarter turns and mirrors of a lat-long permute the cubemap's texels", "[area]") {
  const int width = 64;
  const int height = 32;
  const TestLatLong noise = make_lat_long(Content::random, width, height, 5);
  LatLongImage map{width, height, noise.pixels};
  for (const int size : {2, 7, 16}) {
    for (const glm::dmat3& rotation :
         {rotation_about_y(90.0), rotation_about_y(180.0), glm::dmat3(1, 0, 0, 0, -1, 0, 0, 0, 1),
          glm::dmat3(-1, 0, 0, 0, 1, 0, 0, 0, 1)}) {
      const LatLongImage rotated = to_lat_long(map.view(), width, height, rotation);
      const Cubemap before = to_cubemap(to_cubemap(map.view(), size).view(), size, rotation);
      const Cubemap after = to_cubemap(rotated.view(), size);
      for (std::size_t i = 0; i < after.pixels().size(); ++i) {
        REQUIRE(after.pixels()[i] == Approx(before.pixels()[i]).epsilon(3e-6));
      }
    }
  }
}

TEST_CASE("Resampling by area and bilinearly agree on a smooth environment", "[area][slow]") {
  for (const int width : {256, 255}) {
    const auto radiance = [](const glm::dvec3& d) {
      return glm::dvec3(1.0 + 0.5 * d.x + 0.3 * d.y * d.z, 2.0 + d.z - d.x * d.y * d.z, 1.5 - 0.7 * d.y);
    };
    const LatLongImage map = lat_long_of(width, 128, radiance);
    for (const int size : {3, 48, 64, 150, 600}) {
      const Cubemap wanted = cubemap_of(size, radiance);
      const Cubemap by_area = to_cubemap(map.view(), size, glm::dmat3(1.0), ResampleFilter::area);
      const Cubemap bilinear = to_cubemap(map.view(), size, glm::dmat3(1.0), ResampleFilter::bilinear);
      const std::vector<glm::dvec3> centres = texel_centres(size);
      double worst_off_poles = 0.0;
      for (std::size_t i = 0; i < wanted.pixels().size(); ++i) {
        if (std::abs(centres[i / 3].y) >= 0.998) continue;
        worst_off_poles =
            std::max(worst_off_poles, std::abs(static_cast<double>(by_area.pixels()[i]) - wanted.pixels()[i]));
      }
      CAPTURE(width, size);
      // A texel's mean is not its centre's value: size 3. Next to a pole the first row extends unchanged: size 600.
      CHECK(worst_difference(by_area.pixels(), wanted.pixels()) < (size == 3 ? 0.18 : 7e-3));
      CHECK(worst_off_poles < (size == 3 ? 0.18 : 2.5e-3));
      CHECK(worst_difference(bilinear.pixels(), wanted.pixels()) < 1e-3);
    }
  }
}

TEST_CASE("A cube's lone bright texel keeps its total radiance in a lat-long, by area", "[area][slow]") {
  for (const int size : {1, 2, 3, 8, 15, 24}) {
    for (const auto& [width, height] : {std::pair{4 * size, 2 * size}, {7, 3}, {33, 50}, {64, 32}}) {
      double worst = 0.0;
      const int step = std::max(1, 6 * size * size / 150);
      for (int texel = 0; texel < 6 * size * size; texel += step) {
        Cubemap cube = grey_cubemap(size, 0.0F);
        cube.pixels()[static_cast<std::size_t>(3 * texel + 1)] = 1e6F;
        const LatLongImage map = to_lat_long(cube.view(), width, height, glm::dmat3(1.0), ResampleFilter::area);
        CHECK(std::ranges::all_of(map.pixels, [](float value) { return value >= 0.0F; }));
        double sum = 0.0;
        glm::dvec3 centroid(0.0);
        for (int at = 0; at < width * height; ++at) {
          const double value = map.pixels[static_cast<std::size_t>(3 * at + 1)];
          const double total_there = value * image::lat_long_texel_solid_angle(width, height, at / width);
          sum += total_there;
          centroid += total_there * image::lat_long_direction(width, height, at % width + 0.5, at / width + 0.5);
        }
        std::vector<double> angles(static_cast<std::size_t>(size));
        image::cubemap_row_solid_angles(texel / size % size, angles);
        worst = std::max(worst, std::abs(sum / (1e6 * angles[static_cast<std::size_t>(texel % size)]) - 1.0));
        if (width < 4 * size || height < 2 * size || size < 8) continue;
        const glm::dvec3 to =
            image::face_direction(size, texel / (size * size), texel % size + 0.5, texel / size % size + 0.5);
        CHECK(glm::length(glm::normalize(centroid) - to) < 0.42 / size);  // a fifth of a texel
      }
      CAPTURE(size, width, height);
      CHECK(worst < 1e-6);
    }
  }
}

TEST_CASE("A uniform cube is a uniform lat-long by area", "[area]") {
  for (const int size : {1, 2, 3, 7, 64}) {
    const Cubemap cube = grey_cubemap(size, 0.1F);
    for (const glm::dmat3& rotation : {glm::dmat3(1.0), rotation_about_y(90.0)}) {
      const LatLongImage map = to_lat_long(cube.view(), 4 * size + 1, 2 * size, rotation, ResampleFilter::area);
      CHECK(std::ranges::all_of(map.pixels, [](float value) {
        return std::abs(static_cast<double>(value) / static_cast<double>(0.1F) - 1.0) <= 3e-7;
      }));
    }
  }
}

// All weights are kept and give the same bits again, and sources are read where they lie.

namespace {

std::vector<float> cube_by_area(const LatLongView& source, int size) {
  Cubemap cube(size);
  image::fill_cubemap(source, cube, 0, ResampleFilter::area, {});
  return std::move(cube).pixels();
}

}  // namespace

TEST_CASE("All weights of tiles are kept, and give the bits that they gave at first", "[resampling][area]") {
  // Widths that all images share, that pairs share and that none share; rows coarser and finer than texels.
  for (const auto& [width, height] :
       {std::pair{4, 2}, {16, 9}, {61, 30}, {64, 32}, {130, 64}, {257, 128}, {512, 256}}) {
    const LatLongImage source{width, height, some_pixels(width, height)};
    for (const int size : {1, 2, 3, 7, 33, 64, 128, 257}) {
      CAPTURE(width, height, size);
      const std::vector<float> first = cube_by_area(source.view(), size);
      const auto table = image::TileWeightTable::find({width, height, size});
      REQUIRE(table != nullptr);
      CHECK(table->complete());
      REQUIRE(cube_by_area(source.view(), size) == first);
    }
  }
}

TEST_CASE("Rows that are apart, upside down or of another format give the same cube", "[resampling][area]") {
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {7, 3}, {16, 8}, {61, 30}, {130, 64}}) {
    const LatLongImage packed{width, height, some_pixels(width, height)};
    // The rows from the bottom up, with floats after each of them that belong to no texel.
    const std::ptrdiff_t row = std::ptrdiff_t{3} * width;
    const std::ptrdiff_t stride = row + 5;
    std::vector<float> apart(static_cast<std::size_t>(stride * height), std::numeric_limits<float>::quiet_NaN());
    std::vector<float> with_alpha;
    for (std::ptrdiff_t y = 0; y < height; ++y) {
      std::copy_n(packed.pixels.begin() + y * row, row, apart.begin() + (height - 1 - y) * stride);
    }
    for (std::size_t k = 0; k < packed.pixels.size(); ++k) {
      with_alpha.push_back(packed.pixels[k]);
      if (k % 3 == 2) with_alpha.push_back(std::numeric_limits<float>::quiet_NaN());
    }
    LatLongView upside_down = packed.view();
    upside_down.pixels = apart.data() + (height - 1) * stride;
    upside_down.row_stride_bytes = -stride * static_cast<std::ptrdiff_t>(sizeof(float));
    LatLongView rgba = packed.view();
    rgba.pixels = with_alpha.data();
    rgba.format = PixelFormat::rgba32f;
    for (const int size : {1, 2, 3, 7, 64}) {
      CAPTURE(width, height, size);
      const std::vector<float> expected = cube_by_area(packed.view(), size);
      CHECK(cube_by_area(upside_down, size) == expected);
      CHECK(cube_by_area(rgba, size) == expected);
    }
  }
}

TEST_CASE("an environment view is the view that it was made of, and refuses to be of the other kind", "[image]") {
  const auto cube = make_cubemap(Content::smooth, 4, 3, 1);
  const auto wide = make_lat_long(Content::smooth, 8, 4, 1);
  const EnvironmentView faces = cube.view();
  const EnvironmentView sphere = wide.view();
  CHECK(faces.kind() == EnvironmentKind::cubemap);
  CHECK(faces.cubemap() == cube.view());
  CHECK(sphere.kind() == EnvironmentKind::lat_long);
  CHECK(sphere.lat_long() == wide.view());
  CHECK(faces == EnvironmentView(cube.view()));
  CHECK_FALSE(faces == sphere);
  CHECK(thrown_by([&] { return faces.lat_long(); }).says("to_lat_long"));
  CHECK(thrown_by([&] { return sphere.cubemap(); }).says("to_cubemap"));
}

// A cube's symmetries take texels to texels, each its own way and back.

TEST_CASE("A cube's sixteen images are all different, and lead back", "[symmetry]") {
  constexpr int size = 5;
  const image::CubeTexel texel{2, 0, 3};
  const glm::ivec3 point = image::point_of(size, texel);
  std::set<std::tuple<int, int, int>> texels;
  for (int k = 0; k < 16; ++k) {
    const image::CubeImage there = image::cube_image_of(k);
    CHECK(image::index_of(there) == k);
    const glm::ivec3 reached = moved(there, point);
    CHECK(moved_back(there, reached) == point);
    const image::CubeTexel found = image::texel_at(size, reached);
    CHECK(found.face == (there.below ? 3 : 2));
    texels.emplace(found.face, found.column, found.row);
  }
  CHECK(texels.size() == 16);
}

TEST_CASE("A turn is a cube's symmetry if it is within 1e-9 of one", "[symmetry]") {
  glm::dmat3 rotation(0.0);
  rotation[0][1] = 1.0;
  rotation[1][0] = -1.0;
  rotation[2][2] = 1.0 - 0.9e-9;
  REQUIRE(image::cube_symmetry_of(rotation));
  CHECK((*image::cube_symmetry_of(rotation))[1][0] == -1);
  rotation[2][2] = 1.0 - 1.1e-9;
  CHECK_FALSE(image::cube_symmetry_of(rotation));
}

// A lat-long rotated about y by a fraction of a texel stays sharp and within its range, and keeps every row's sum.

namespace {

/// Octaves of noise as photographs have them, and a sun of one texel that is 1e6 times as bright.
LatLongImage photograph_like(int width, int height) {
  std::mt19937 random(7);
  LatLongImage image{width, height, std::vector<float>(std::size_t{3} * static_cast<std::size_t>(width * height))};
  std::vector<double> stops(static_cast<std::size_t>(width * height));
  for (int block = 1; block <= 32; block *= 2) {
    std::vector<double> coarse(stops.size());
    for (double& value : coarse) value = static_cast<double>(random()) / 4294967296.0 - 0.5;
    for (int row = 0; row < height; ++row) {
      for (int column = 0; column < width; ++column) {
        const auto at = static_cast<std::size_t>(row / block * width + column / block);
        stops[static_cast<std::size_t>(row * width + column)] += 0.5 * block * coarse[at] / 4.0;
      }
    }
  }
  for (std::size_t texel = 0; texel < stops.size(); ++texel) {
    for (std::size_t c = 0; c < 3; ++c)
      image.pixels[3 * texel + c] = static_cast<float>(std::exp2(stops[texel]) * (1.0 + 0.1 * static_cast<double>(c)));
  }
  for (std::size_t c = 0; c < 3; ++c)
    image.pixels[3 * static_cast<std::size_t>(height / 3 * width + width / 2) + c] = 1e6F;
  return image;
}

double row_sum(const LatLongImage& image, int row, int channel) {
  double sum = 0.0;
  for (int column = 0; column < image.width; ++column)
    sum += static_cast<double>(
        image.pixels[3 * static_cast<std::size_t>(row * image.width + column) + static_cast<std::size_t>(channel)]);
  return sum;
}

}  // namespace

TEST_CASE("A lat-long that is turned by a share of a texel stays sharp and keeps each row's light",
          "[image][resampling]") {
  constexpr int kWidth = 256;
  const LatLongImage image = photograph_like(kWidth, 128);
  const double before = sharpness(image.view());
  const float smallest = *std::ranges::min_element(image.pixels);
  const float largest = *std::ranges::max_element(image.pixels);
  const glm::dmat3 mirror(-1, 0, 0, 0, 1, 0, 0, 0, 1);
  for (const double texels : {0.1, 0.25, 0.5, 0.75, 33.4}) {
    for (const bool mirrored : {false, true}) {
      const glm::dmat3 rotation = rotation_about_y(360.0 * texels / kWidth) * (mirrored ? mirror : glm::dmat3(1.0));
      const LatLongImage rotated = to_lat_long(image.view(), kWidth, image.height, rotation);
      INFO(texels << (mirrored ? " mirrored" : "") << ": " << sharpness(rotated.view()) / before);
      CHECK(sharpness(rotated.view()) >= 0.9 * before);
      CHECK(sharpness(rotated.view()) <= before);
      for (int row = 0; row < image.height; ++row) {
        for (int c = 0; c < 3; ++c) CHECK(row_sum(rotated, row, c) == Approx(row_sum(image, row, c)).epsilon(1e-6));
      }
      CHECK(std::ranges::all_of(rotated.pixels, [&](float value) { return value >= smallest && value <= largest; }));
    }
  }
}

TEST_CASE("A smooth lat-long that is turned by a share of a texel is closer than linear interpolation",
          "[image][resampling]") {
  // cos(3 longitude): exact but for what cubic convolution loses of a wave of 40 texels.
  constexpr int kWidth = 120;
  const auto wave = [&](double shift) {
    LatLongImage image{kWidth, 4, {}};
    for (int texel = 0; texel < 4 * kWidth; ++texel) {
      const double longitude = std::acos(-1.0) * (1.0 - 2.0 * (texel % kWidth + 0.5 + shift) / kWidth);
      for (int c = 0; c < 3; ++c) image.pixels.push_back(static_cast<float>(2.0 + std::cos(3.0 * longitude)));
    }
    return image;
  };
  const LatLongImage rotated = to_lat_long(wave(0.0).view(), kWidth, 4, rotation_about_y(360.0 * 0.3 / kWidth));
  const LatLongImage wanted = wave(0.3);
  for (std::size_t i = 0; i < wanted.pixels.size(); ++i)
    REQUIRE(std::abs(rotated.pixels[i] - wanted.pixels[i]) < 2.7e-3F);  // as linear: crests are not exceeded
  double square = 0.0;
  for (std::size_t i = 0; i < wanted.pixels.size(); ++i)
    square += std::pow(static_cast<double>(rotated.pixels[i] - wanted.pixels[i]), 2.0);
  CHECK(std::sqrt(square / static_cast<double>(wanted.pixels.size())) < 8e-4);  // linear: 1.8e-3
}

TEST_CASE("Narrow rows, uniform ones, NaN and infinity are turned by a share of a texel", "[image][resampling]") {
  for (const int width : {1, 2, 3, 5}) {
    const LatLongImage grey{width, 2, std::vector<float>(std::size_t{6} * static_cast<std::size_t>(width), 0.1F)};
    const LatLongImage rotated = to_lat_long(grey.view(), width, 2, rotation_about_y(360.0 * 0.37 / width));
    for (const float value : rotated.pixels) CHECK(value == 0.1F);
  }
  LatLongImage image{16, 2, std::vector<float>(96, 0.5F)};
  image.pixels[3 * 4] = std::numeric_limits<float>::quiet_NaN();
  image.pixels[3 * 4 + 1] = std::numeric_limits<float>::infinity();
  const LatLongImage rotated = to_lat_long(image.view(), 16, 2, rotation_about_y(360.0 * 0.25 / 16));
  for (std::size_t column = 0; column < 16; ++column) {
    const bool touched = column == 3 || column == 4;
    INFO(column);
    CHECK(std::isnan(rotated.pixels[3 * column]) == touched);
    CHECK(std::isinf(rotated.pixels[3 * column + 1]) == touched);
    CHECK(rotated.pixels[3 * column + 2] == 0.5F);
  }
}

}  // namespace welkin::test
