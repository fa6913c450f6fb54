// Sums of faces that are kept give the bits of a whole projection, and a changed face is all that is read.
#include <array>
#include <limits>

#include "support/catch.h"
#include "support/same_bits.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/face_harmonics.h"

namespace {

using namespace welkin;
using test::Content;

std::vector<ProjectionOptions> some_options() {
  ProjectionOptions clamped;
  clamped.clamp = RadianceClamp{50.0F, true};
  ProjectionOptions midpoint{.bands = 5, .quadrature = Quadrature::midpoint};
  midpoint.negative = NegativePolicy::replace;
  return {{}, {.bands = 1}, {.bands = 9, .target_size = 16}, clamped, midpoint, {.gamma = true}};
}

TEST_CASE("faces: their total is the whole projection, bit for bit") {
  for (const ProjectionOptions& options : some_options()) {
    for (const int size : {1, 2, 33, 100, 200}) {
      for (const Content content : {Content::high_range, Content::special_values}) {
        const test::TestCubemap cubemap = test::make_cubemap(content, size, 3, 11);
        INFO(size << " bands " << options.bands);
        CHECK(test::same_bits(total(project_faces(cubemap.view(), options)), project(cubemap.view(), options)));
      }
    }
  }
}

TEST_CASE("faces: of a changed cubemap only the changed faces are read") {
  for (const ProjectionOptions& options : some_options()) {
    test::TestCubemap cubemap = test::make_cubemap(Content::high_range, 80, 3, 5);
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
    CHECK_FALSE(test::same_bits(total(kept), whole));
    update_faces(kept, only, std::array{3}, {});
    CHECK(test::same_bits(total(kept), whole));
  }
}

TEST_CASE("faces: the same pixels have the same sums on any face") {
  const test::TestCubemap cubemap = test::make_cubemap(Content::random, 40, 4, 2);
  CubemapView swapped = cubemap.view();
  std::swap(swapped.faces[0], swapped.faces[3]);
  const FaceHarmonics kept = project_faces(cubemap.view());
  FaceHarmonics moved = kept;
  moved.set_face(0, kept.face(3));
  moved.set_face(3, kept.face(0));
  CHECK(test::same_bits(total(moved), project(swapped)));
}

TEST_CASE("faces: what cannot be is refused, and leaves the sums as they were") {
  const test::TestCubemap cubemap = test::make_cubemap(Content::smooth, 8, 3, 2);
  const auto code_of = [](const auto& call) { return test::thrown_by(call).code; };
  FaceHarmonics kept = project_faces(cubemap.view());
  const Projection before = total(kept);
  CHECK(code_of([&] { update_faces(kept, cubemap.view(), std::array{6}); }) == ErrorCode::invalid_argument);
  for (const ProjectionOptions& options : {ProjectionOptions{.bands = 0}, ProjectionOptions{.bands = 17},
                                           ProjectionOptions{.quadrature = Quadrature::midpoint, .target_size = 2}}) {
    FaceHarmonics own(cubemap.size, options);  // whose options nobody has looked at
    CHECK(code_of([&] { update_faces(own, cubemap.view(), std::array{2}); }) == ErrorCode::invalid_argument);
  }
  CHECK(code_of([&] { update_faces(kept, cubemap.view(), std::array{2, 2}); }) == ErrorCode::invalid_argument);
  const test::TestCubemap other = test::make_cubemap(Content::smooth, 9, 3, 2);
  CHECK(code_of([&] { update_faces(kept, other.view(), std::array{2}); }) == ErrorCode::invalid_argument);
  CHECK(code_of([&] { static_cast<void>(total(FaceHarmonics{})); }) == ErrorCode::invalid_argument);
  CHECK(code_of([&] {
          static_cast<void>(project_faces(cubemap.view(), {.quadrature = Quadrature::midpoint, .target_size = 4}));
        }) == ErrorCode::invalid_argument);
  test::TestCubemap broken = cubemap;
  broken.pixels.back() = std::numeric_limits<float>::quiet_NaN();
  FaceHarmonics strict = project_faces(cubemap.view(), {.nan = NonFinitePolicy::reject});
  CHECK(code_of([&] { update_faces(strict, broken.view(), std::array{1, 5}); }) == ErrorCode::rejected_pixel);
  CHECK(test::same_bits(total(strict), project(cubemap.view(), {.nan = NonFinitePolicy::reject})));
  FaceHarmonics mixed = kept;
  mixed.set_face(1, project_faces(cubemap.view(), {.bands = 4}).face(1));
  CHECK(code_of([&] { static_cast<void>(total(mixed)); }) == ErrorCode::invalid_argument);
  CHECK(test::same_bits(total(kept), before));
}

}  // namespace
