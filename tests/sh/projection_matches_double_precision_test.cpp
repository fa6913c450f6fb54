// Exact quadrature against the readable double-precision twin: 5e-7 of the coefficient vector.
#include <string>

#include "support/catch.h"
#include "support/coefficients.h"
#include "support/test_environments.h"
#include "welkin/projection.h"

namespace welkin::test {
namespace {

constexpr double kBound = 5e-7;

void require_exact(const CubemapView& view, const ProjectionOptions& options) {
  const double error = relative_error(project(view, options).radiance, reference_projection(view, options));
  CAPTURE(view.size, options.bands, error);
  CHECK(error <= kBound);
}

void require_exact(const LatLongView& view, const ProjectionOptions& options) {
  const double error = relative_error(project(view, options).radiance, reference_projection(view, options));
  CAPTURE(view.width, view.height, options.bands, error);
  CHECK(error <= kBound);
}

}  // namespace

TEST_CASE("Cubemaps of any size and content project to double precision's result", "[sh][projection]") {
  for (const Content content :
       {Content::random, Content::smooth, Content::blocks, Content::high_range, Content::one_texel_sun}) {
    for (const int size : {1, 2, 3, 4, 5, 7, 16, 31, 32, 33, 64, 100, 128, 129, 200}) {
      CAPTURE(name(content));
      require_exact(make_cubemap(content, size, 3, 7).view(), {});
    }
  }
}

TEST_CASE("Large cubemaps project to double precision's result", "[sh][projection]") {
  for (const int size : {257, 512}) {
    require_exact(make_cubemap(Content::one_texel_sun, size, 3, 11).view(), {});
  }
  require_exact(make_cubemap(Content::random, 257, 4, 11).view(), {});
  require_exact(make_cubemap(Content::blocks, 512, 3, 11).view(), {});
}

TEST_CASE("Every number of bands is as exact as three", "[sh][projection]") {
  for (int bands = 1; bands <= kMaximumBands; ++bands) {
    ProjectionOptions options;
    options.bands = bands;
    for (const int size : {1, 2, 7, 33}) require_exact(make_cubemap(Content::random, size, 3, 5).view(), options);
    require_exact(make_lat_long(Content::random, 32, 16, 5).view(), options);
  }
  ProjectionOptions ten;
  ten.bands = 10;
  require_exact(make_cubemap(Content::one_texel_sun, 150, 3, 5).view(), ten);
}

TEST_CASE("The midpoint rule is its textbook loop", "[sh][projection]") {
  for (const int bands : {1, 3, 6}) {
    ProjectionOptions options;
    options.bands = bands;
    options.quadrature = Quadrature::midpoint;
    for (const int size : {1, 2, 3, 7, 64, 129, 257}) {
      require_exact(make_cubemap(Content::random, size, 3, 3).view(), options);
    }
    require_exact(make_lat_long(Content::random, 65, 31, 3).view(), options);
    require_exact(make_lat_long(Content::random, 64, 32, 3).view(), options);
  }
}

TEST_CASE("Lat-longs of any shape project to double precision's result", "[sh][projection]") {
  const int shapes[][2] = {{1, 1},   {2, 1},   {1, 2},    {3, 2},     {7, 5},     {16, 8},
                           {31, 17}, {64, 32}, {257, 64}, {520, 260}, {1024, 512}};
  for (const auto& shape : shapes) {
    for (const Content content : {Content::random, Content::one_texel_sun}) {
      require_exact(make_lat_long(content, shape[0], shape[1], 9).view(), {});
    }
  }
}

TEST_CASE("Every pixel format gives what its values give", "[sh][projection]") {
  for (const int channels : {3, 4}) {
    for (const int size : {1, 7, 64, 65}) {
      require_exact(make_cubemap(Content::random, size, channels, 1).view(), {});
      const TestCubemapHalf half = make_cubemap_half(Content::random, size, channels, 1);
      require_exact(half.view(), {});
      TestCubemapBytes bytes = make_cubemap_bytes(Content::random, size, channels, 1);
      CubemapView view = bytes.view();
      require_exact(view, {});
      view.format = channels == 3 ? PixelFormat::rgb_srgb8 : PixelFormat::rgba_srgb8;
      require_exact(view, {});
    }
    require_exact(make_lat_long(Content::random, 66, 33, 1, channels).view(), {});
    require_exact(make_lat_long_half(Content::random, 66, 33, 1, channels).view(), {});
    require_exact(make_lat_long_bytes(Content::random, 66, 33, 1, channels).view(), {});
  }
}

TEST_CASE("Rows may be padded or stored bottom-up", "[sh][projection]") {
  const int size = 37;
  const TestCubemap packed = make_cubemap(Content::random, size, 3, 2);
  const SphericalHarmonics expected = project(packed.view()).radiance;

  constexpr int padding = 5;  // floats
  const std::size_t row_floats = static_cast<std::size_t>(3 * size);
  std::vector<float> padded(6 * static_cast<std::size_t>(size) * (row_floats + padding), -1e30F);
  std::vector<float> flipped(packed.pixels.size());
  for (std::size_t row = 0; row < static_cast<std::size_t>(6 * size); ++row) {
    const std::size_t face = row / static_cast<std::size_t>(size);
    const std::size_t mirrored = face * static_cast<std::size_t>(size) + static_cast<std::size_t>(size) - 1 -
                                 row % static_cast<std::size_t>(size);
    for (std::size_t k = 0; k < row_floats; ++k) {
      padded[row * (row_floats + padding) + k] = packed.pixels[row * row_floats + k];
      flipped[mirrored * row_floats + k] = packed.pixels[row * row_floats + k];
    }
  }
  CubemapView padded_view = packed.view();
  CubemapView flipped_view = packed.view();
  padded_view.row_stride_bytes = static_cast<std::ptrdiff_t>((row_floats + padding) * sizeof(float));
  flipped_view.row_stride_bytes = -static_cast<std::ptrdiff_t>(row_floats * sizeof(float));
  for (std::size_t face = 0; face < 6; ++face) {
    padded_view.faces[face] = padded.data() + face * static_cast<std::size_t>(size) * (row_floats + padding);
    flipped_view.faces[face] = flipped.data() + ((face + 1) * static_cast<std::size_t>(size) - 1) * row_floats;
  }
  CHECK(same_bits(project(padded_view).radiance, expected));
  CHECK(same_bits(project(flipped_view).radiance, expected));
}

TEST_CASE("A uniform environment has nothing above band 0", "[sh][projection]") {
  for (const int bands : {3, 10}) {
    ProjectionOptions options;
    options.bands = bands;
    for (const int size : {1, 2, 3, 7, 64, 129, 257, 512}) {
      const SphericalHarmonics c = project(make_cubemap(Content::uniform, size, 3, 0).view(), options).radiance;
      for (std::size_t k = 1; k < c.coefficients().size(); ++k) {
        for (int channel = 0; channel < 3; ++channel) {
          CAPTURE(size, k, channel);
          CHECK(std::abs(c.coefficients()[k][channel]) <= 1e-7 * c.coefficients()[0][channel]);
        }
      }
    }
  }
}

TEST_CASE("A texel that goes round the whole sphere has nothing above band 0, for the twin too", "[sh][projection]") {
  ProjectionOptions options;
  options.bands = kMaximumBands;
  for (const int height : {1, 2, 7}) {
    const TestLatLong image = make_lat_long(Content::uniform, 1, height, 0);
    for (const SphericalHarmonics& c :
         {project(image.view(), options).radiance, reference_projection(image.view(), options)}) {
      for (std::size_t k = 1; k < c.coefficients().size(); ++k) {
        CAPTURE(height, k);
        CHECK(std::abs(c.coefficients()[k].x) <= 1e-9 * c.coefficients()[0].x);
      }
    }
  }
}

}  // namespace welkin::test
