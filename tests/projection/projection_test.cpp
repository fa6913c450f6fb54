// Projections: their symmetries and accuracy, faces one by one, and the same bits everywhere.
#include "welkin/projection.h"

#include <tbb/global_control.h>

#include <glm/gtc/quaternion.hpp>

#include "reference/reference_projection.h"
#include "support/catch.h"
#include "support/coefficients.h"
#include "support/images.h"
#include "support/same_bits.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "support/trials.h"
#include "transform/frame_transform.h"
#include "welkin/core.h"

namespace welkin::test {

// Exact quadrature against the readable double-precision twin: 5e-7 of the coefficient vector.

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

TEST_CASE("Cubemaps of any size and content project to double precision's result", "[sh][projection][truth]") {
  for (const Content content :
       {Content::random, Content::smooth, Content::blocks, Content::high_range, Content::one_texel_sun}) {
    for (const int size : some_of(2, {1, 200, 2, 128, 3, 100, 4, 5, 7, 16, 31, 64, 32, 129, 33})) {
      CAPTURE(name(content));
      require_exact(make_cubemap(content, size, 3, 7).view(), {});
    }
  }
}

TEST_CASE("Large cubemaps project to double precision's result", "[sh][projection][truth]") {
  for (const int size : some_of(2, {257, 512}))
    require_exact(make_cubemap(Content::one_texel_sun, size, 3, 11).view(), {});
  require_exact(make_cubemap(Content::random, 257, 4, 11).view(), {});
  require_exact(make_cubemap(Content::blocks, 512, 3, 11).view(), {});
  // By strips, the twin of which takes long.
  for (const auto& [size, bands] : {std::pair{256, 4}, {320, 6}}) {
    const ProjectionOptions options{.bands = bands};
    require_exact(make_cubemap(Content::random, size, 4, 11).view(), options);
  }
}

TEST_CASE("Every number of bands is as exact as three", "[sh][projection][truth]") {
  for (int bands = 1; bands <= kMaximumBands; ++bands) {
    const ProjectionOptions options{.bands = bands};
    for (const int size : {1, 2, 7, 33}) require_exact(make_cubemap(Content::random, size, 3, 5).view(), options);
    require_exact(make_lat_long(Content::random, 32, 16, 5).view(), options);
  }
  const ProjectionOptions ten{.bands = 10};
  require_exact(make_cubemap(Content::one_texel_sun, 150, 3, 5).view(), ten);
}

TEST_CASE("The midpoint rule is its textbook loop", "[sh][projection][truth]") {
  for (const int bands : {1, 3, 6}) {
    ProjectionOptions options{.bands = bands, .quadrature = Quadrature::midpoint};
    for (const int size : {1, 2, 3, 7, 64, 129, 257}) {
      require_exact(make_cubemap(Content::random, size, 3, 3).view(), options);
    }
    require_exact(make_lat_long(Content::random, 65, 31, 3).view(), options);
    require_exact(make_lat_long(Content::random, 64, 32, 3).view(), options);
  }
}

TEST_CASE("Lat-longs of any shape project to double precision's result", "[sh][projection][truth]") {
  const int shapes[][2] = {{1, 1},   {2, 1},   {1, 2},    {3, 2},     {7, 5},     {16, 8},
                           {31, 17}, {64, 32}, {257, 64}, {520, 260}, {1024, 512}};
  for (const auto& shape : shapes) {
    for (const Content content : {Content::random, Content::one_texel_sun}) {
      require_exact(make_lat_long(content, shape[0], shape[1], 9).view(), {});
    }
    if (shape[0] < 4) require_exact(make_lat_long(Content::random, shape[0], shape[1], 9).view(), {.bands = 16});
  }
}

TEST_CASE("Every pixel format gives what its values give", "[sh][projection][slow]") {
  for (const int channels : {3, 4}) {
    for (const int size : {1, 7, 64, 65}) {
      require_exact(make_cubemap(Content::random, size, channels, 1).view(), {});
      const TestCubemapHalf half = make_cubemap_half(Content::random, size, channels, 1);
      require_exact(half.view(), {});
      TestCubemapBytes bytes = make_cubemap_bytes(Content::random, size, channels, 1);
      CubemapView view = bytes.view();
      require_exact(view, {});
      view.format = channels == 3 ? PixelFormat::srgb8 : PixelFormat::srgba8;
      require_exact(view, {});
    }
    require_exact(make_lat_long(Content::random, 66, 33, 1, channels).view(), {});
    require_exact(make_lat_long_half(Content::random, 66, 33, 1, channels).view(), {});
    require_exact(make_lat_long_bytes(Content::random, 66, 33, 1, channels).view(), {});
  }
}

TEST_CASE("A texel that goes round the whole sphere has nothing above band 0, for the twin too", "[sh][projection]") {
  const ProjectionOptions options{.bands = kMaximumBands};
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

// Properties of any projection: linearity, rotations, mirror images, energy.

namespace {

double smooth_function(const glm::dvec3& d) { return 1.0 + 0.5 * d.x + 0.25 * d.y * d.z + std::exp(4.0 * (d.z - 1.0)); }

}  // namespace

TEST_CASE("Turning by any angle turns the coefficients within the texels' error", "[sh][property]") {
  const glm::dquat rotation = glm::angleAxis(0.7, glm::normalize(glm::dvec3(1.0, 2.0, -0.5)));
  double error_before = 1.0;
  for (const int size : {16, 32, 64, 128}) {
    const SphericalHarmonics before =
        project(cubemap_of(size, [](const glm::dvec3& d) { return glm::dvec3(smooth_function(d)); }).view()).radiance;
    const SphericalHarmonics after =
        project(cubemap_of(size,
                           [&](const glm::dvec3& d) { return glm::dvec3(smooth_function(glm::inverse(rotation) * d)); })
                    .view())
            .radiance;
    double worst = 0.0;
    for (int k = 0; k < 50; ++k) {
      const glm::dvec3 d = glm::normalize(glm::dvec3(std::sin(k * 1.3), std::cos(k * 2.1), std::sin(k * 0.7 + 1.0)));
      worst = std::max(worst, std::abs(evaluate(after, rotation * d).x - evaluate(before, d).x));
    }
    CAPTURE(size, worst);
    CHECK(worst < 4.0 / (size * size));
    CHECK(worst < 0.5 * error_before);
    error_before = worst;
  }
}

TEST_CASE("The total radiance is the sum of radiance times solid angle", "[sh][property]") {
  const TestCubemap uniform = make_cubemap(Content::uniform, 50, 3, 0);
  const ProjectionDiagnostics diagnostics = project(uniform.view()).diagnostics;
  CHECK(diagnostics.total_radiance.x == Approx(0.5 * 4.0 * std::numbers::pi).epsilon(1e-7));
  CHECK(diagnostics.total_radiance.z == Approx(2.0 * 4.0 * std::numbers::pi).epsilon(1e-7));
  CHECK(diagnostics.total_radiance_before_clamp == diagnostics.total_radiance);
}

TEST_CASE("A cubemap and the lat-long of the same scene agree", "[sh][property]") {
  const auto radiance = [](const glm::dvec3& d) { return glm::dvec3(smooth_function(d), 1.0 + d.x * d.z, 2.0 - d.y); };
  CHECK(relative_error(project(lat_long_of(1024, 512, radiance).view()).radiance,
                       project(cubemap_of(256, radiance).view()).radiance) < 3e-5);
}

// Sums of faces that are kept give the bits of a whole projection, and a changed face is all that is read.

namespace {

std::vector<ProjectionOptions> some_options() {
  const ProjectionOptions clamped{.pixels = {.clamp = RadianceClamp{50.0F, true}}};
  ProjectionOptions midpoint{.bands = 5, .quadrature = Quadrature::midpoint};
  midpoint.pixels.negative = NegativePolicy::replace;
  return {{}, {.bands = 1}, {.bands = 9, .target_size = 16}, clamped, midpoint, {.pixels = {.gamma = true}}};
}

TEST_CASE("faces: their total is the whole projection, bit for bit", "[slow]") {
  for (const ProjectionOptions& options : some_options()) {
    for (const int size : {1, 2, 33, 100, 200}) {
      for (const Content content : {Content::high_range, Content::special_values}) {
        const TestCubemap cubemap = make_cubemap(content, size, 3, 11);
        INFO(size << " bands " << options.bands);
        CHECK(same_bits(combine(project_faces(cubemap.view(), options)), project(cubemap.view(), options)));
      }
    }
  }
}

TEST_CASE("faces: of a changed cubemap only the changed faces are read") {
  for (const ProjectionOptions& options : some_options()) {
    TestCubemap cubemap = make_cubemap(Content::high_range, 80, 3, 5);
    FaceHarmonics kept = project_faces(cubemap.view(), options);
    const std::size_t face_values = cubemap.pixels.size() / 6;
    for (const int face : {0, 3, 5}) {
      for (std::size_t k = 0; k < face_values; ++k) {
        cubemap.pixels[static_cast<std::size_t>(face) * face_values + k] *= 0.5F + static_cast<float>(k % 3);
      }
    }
    const Projection whole = project(cubemap.view(), options);
    CubemapView only = cubemap.view();
    const std::vector<float> poison(face_values, std::numeric_limits<float>::quiet_NaN());
    for (const std::size_t face : {1U, 2U, 4U}) only.faces[face] = poison.data();
    update_faces(kept, only, std::array{5, 0}, {});
    CHECK_FALSE(same_bits(combine(kept), whole));
    update_faces(kept, only, std::array{3}, {});
    CHECK(same_bits(combine(kept), whole));
  }
}

TEST_CASE("faces: after any sequence of updates their total is the whole projection") {
  for (const int size : {1, 2, 3, 7, 64, 257}) {
    INFO(size);
    TestCubemap cubemap = make_cubemap(Content::high_range, size, 3, 7);
    FaceHarmonics kept = project_faces(cubemap.view());
    const std::size_t face_values = cubemap.pixels.size() / 6;
    for (int step = 0; step < 9; ++step) {
      const std::array faces{5 * step % 6, (5 * step + 1 + step % 5) % 6};  // every face, and some twice in a row
      for (const int face : faces) {
        float* const first = cubemap.pixels.data() + static_cast<std::size_t>(face) * face_values;
        for (std::size_t k = 0; k < face_values; ++k)
          first[k] *= 0.5F + static_cast<float>((k + static_cast<std::size_t>(step)) % 3);
      }
      const FaceHarmonics older = kept;
      update_faces(kept, cubemap.view(), faces);
      CHECK(same_bits(combine(kept), project(cubemap.view())));
      CHECK_FALSE(same_bits(combine(older), combine(kept)));
    }
  }
}

TEST_CASE("faces: the same pixels have the same sums on any face") {
  const TestCubemap cubemap = make_cubemap(Content::random, 40, 4, 2);
  CubemapView swapped = cubemap.view();
  std::swap(swapped.faces[0], swapped.faces[3]);
  const FaceHarmonics kept = project_faces(cubemap.view());
  FaceHarmonics moved = kept;
  moved.set_face(0, kept.face(3));
  moved.set_face(3, kept.face(0));
  CHECK(same_bits(combine(moved), project(swapped)));
}

TEST_CASE("faces: what cannot be is refused, and leaves the sums as they were") {
  const TestCubemap cubemap = make_cubemap(Content::smooth, 8, 3, 2);
  const auto code_of = [](const auto& call) { return thrown_by(call).code; };
  FaceHarmonics kept = project_faces(cubemap.view());
  const Projection before = combine(kept);
  CHECK(code_of([&] { update_faces(kept, cubemap.view(), std::array{6}); }) == ErrorCode::invalid_argument);
  for (const ProjectionOptions& options : {ProjectionOptions{.bands = 0}, ProjectionOptions{.bands = 17},
                                           ProjectionOptions{.quadrature = Quadrature::midpoint, .target_size = 2}}) {
    FaceHarmonics unchecked(cubemap.size, options);  // its options have not been checked
    CHECK(code_of([&] { update_faces(unchecked, cubemap.view(), std::array{2}); }) == ErrorCode::invalid_argument);
  }
  CHECK(code_of([&] { update_faces(kept, cubemap.view(), std::array{2, 2}); }) == ErrorCode::invalid_argument);
  const TestCubemap other = make_cubemap(Content::smooth, 9, 3, 2);
  CHECK(code_of([&] { update_faces(kept, other.view(), std::array{2}); }) == ErrorCode::invalid_argument);
  CHECK(code_of([&] { static_cast<void>(combine(FaceHarmonics{})); }) == ErrorCode::invalid_argument);
  CHECK(code_of([&] {
          static_cast<void>(project_faces(cubemap.view(), {.quadrature = Quadrature::midpoint, .target_size = 4}));
        }) == ErrorCode::invalid_argument);
  TestCubemap broken = cubemap;
  broken.pixels.back() = std::numeric_limits<float>::quiet_NaN();
  FaceHarmonics strict = project_faces(cubemap.view(), {.pixels = {.nan = NonFinitePolicy::reject}});
  CHECK(code_of([&] { update_faces(strict, broken.view(), std::array{1, 5}); }) == ErrorCode::rejected_pixel);
  CHECK(same_bits(combine(strict), project(cubemap.view(), {.pixels = {.nan = NonFinitePolicy::reject}})));
  FaceHarmonics mixed = kept;
  mixed.set_face(1, project_faces(cubemap.view(), {.bands = 4}).face(1));
  CHECK(code_of([&] { static_cast<void>(combine(mixed)); }) == ErrorCode::invalid_argument);
  CHECK(same_bits(combine(kept), before));
}

}  // namespace

}  // namespace welkin::test
