// Before the projection: arguments, and what is done to pixels that are no light.
#include "reference/reference_projection.h"
#include "support/catch.h"
#include "support/coefficients.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/projection.h"

namespace welkin::test {
namespace {

void require_refused(const CubemapView& view, const ProjectionOptions& options, const std::string& words) {
  const ThrownError error = thrown_by([&] { static_cast<void>(project(view, options)); });
  CHECK(error.code == ErrorCode::invalid_argument);
  CAPTURE(error.message);
  CHECK(error.says(words));
}

}  // namespace

TEST_CASE("Views that cannot be read are refused", "[sh]") {
  const TestCubemap cubemap = make_cubemap(Content::uniform, 8, 3, 1);
  CubemapView view = cubemap.view();
  view.size = 0;
  require_refused(view, {}, "the cubemap's size is 0; it must be from 1 to 16384");
  view.size = 16385;
  require_refused(view, {}, "is 16385");
  view = cubemap.view();
  view.faces[3] = nullptr;
  require_refused(view, {}, "face 3 of the cubemap has no pixels");
  view = cubemap.view();
  view.faces[1] = reinterpret_cast<const std::byte*>(view.faces[1]) + 1;
  require_refused(view, {}, "face 1 of the cubemap is not aligned");
  view = cubemap.view();
  view.row_stride_bytes = 95;
  require_refused(view, {}, "row_stride_bytes is 95, less than a row of 96 bytes");
  view.row_stride_bytes = 98;
  require_refused(view, {}, "leaves rows unaligned");
  LatLongView lat_long{cubemap.pixels.data(), 8, 0, 0, PixelFormat::rgb32f};
  CHECK(thrown_by([&] { static_cast<void>(project(lat_long)); }).says("the lat-long's height is 0"));
  lat_long.height = 4;
  lat_long.pixels = nullptr;
  CHECK(thrown_by([&] { static_cast<void>(project(lat_long)); }).says("the lat-long has no pixels"));
}

TEST_CASE("Options out of range are refused", "[sh]") {
  const TestCubemap cubemap = make_cubemap(Content::uniform, 8, 3, 1);
  ProjectionOptions options{.bands = 0};
  require_refused(cubemap.view(), options, "bands is 0; it must be from 1 to 16");
  options.bands = 17;
  require_refused(cubemap.view(), options, "bands is 17");
  options = {};
  options.target_size = -1;
  require_refused(cubemap.view(), options, "target_size is -1");
  for (const float maximum :
       {0.0F, -1.0F, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    options = {};
    options.pixels.clamp = RadianceClamp{maximum, false};
    require_refused(cubemap.view(), options, "the clamp's maximum is");
  }
}

// Treatment and diagnostics of NaN, infinities, negatives, gamma and too bright texels.

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// Returns a channel of one of the cubemap's texels.
float& channel(TestCubemap& cubemap, int face, int row, int column, int c) {
  const int texel = (face * cubemap.size + row) * cubemap.size + column;
  return cubemap.pixels[static_cast<std::size_t>(texel * cubemap.channels + c)];
}

const int kSizes[] = {1, 7, 64, 200};

}  // namespace

TEST_CASE("Negatives are kept, replaced or rejected", "[sh][policy][truth]") {
  for (const int size : kSizes) {
    TestCubemap cubemap = make_cubemap(Content::random, size, 3, 1);
    TestCubemap lifted = cubemap;
    channel(cubemap, 1, 0, size - 1, 1) = -3.0F;
    channel(lifted, 1, 0, size - 1, 1) = 0.0F;
    ProjectionOptions options;
    const Projection kept = project(cubemap.view(), options);
    CHECK(kept.diagnostics.negatives_replaced == 0);
    CHECK(relative_error(kept.radiance, reference_projection(cubemap.view())) < 5e-7);
    options.pixels.negative = NegativePolicy::replace;
    const Projection replaced = project(cubemap.view(), options);
    CHECK(replaced.diagnostics.negatives_replaced == 1);
    CHECK(relative_error(replaced.radiance, project(lifted.view()).radiance) < 3e-7);
    options.pixels.negative = NegativePolicy::reject;
    const ThrownError error = thrown_by([&] { static_cast<void>(project(cubemap.view(), options)); });
    CHECK(error.code == ErrorCode::rejected_pixel);
    CHECK(error.says("face -X, row 0, column " + std::to_string(size - 1) + " is negative"));
  }
}

TEST_CASE("Of several rejected texels the first by face, row and column is named", "[sh][policy]") {
  TestCubemap cubemap = make_cubemap(Content::random, 200, 3, 1);
  channel(cubemap, 5, 0, 0, 0) = kNan;
  channel(cubemap, 3, 150, 20, 0) = kNan;
  channel(cubemap, 3, 149, 190, 2) = kNan;
  channel(cubemap, 3, 149, 191, 2) = kNan;
  const ProjectionOptions options{.pixels = {.nan = NonFinitePolicy::reject}};
  const ThrownError error = thrown_by([&] { static_cast<void>(project(cubemap.view(), options)); });
  CHECK(error.code == ErrorCode::rejected_pixel);
  CHECK(error.says("face +Y") == false);
  CHECK(error.says("face -Y, row 149, column 190 is NaN"));

  TestLatLong lat_long = make_lat_long(Content::random, 300, 150, 1);
  lat_long.pixels[(100 * 300 + 7) * 3] = kInfinity;
  lat_long.pixels[(99 * 300 + 250) * 3 + 2] = kInfinity;
  const ProjectionOptions strict{.pixels = {.infinity = NonFinitePolicy::reject}};
  const ThrownError infinite = thrown_by([&] { static_cast<void>(project(lat_long.view(), strict)); });
  CHECK(infinite.says("row 99, column 250 is infinite"));
}

TEST_CASE("A clamp reports what it takes away", "[sh][policy][truth]") {
  for (const bool preserve : {false, true}) {
    for (const int size : kSizes) {
      const TestCubemap cubemap = make_cubemap(Content::clamped, size, 3, 1);
      const ProjectionOptions options{.pixels = {.clamp = RadianceClamp{4096.0F, preserve}}};
      const Projection found = project(cubemap.view(), options);
      const Projection unclamped = project(cubemap.view());
      CHECK(found.diagnostics.texels_clamped > 0);
      for (int c = 0; c < 3; ++c) {
        CHECK(found.diagnostics.total_radiance[c] < found.diagnostics.total_radiance_before_clamp[c]);
        CHECK(found.diagnostics.total_radiance_before_clamp[c] ==
              Approx(unclamped.diagnostics.total_radiance[c]).epsilon(1e-6));
      }
      CHECK(relative_error(found.radiance, reference_projection(cubemap.view(), options)) < 5e-7);
    }
    const TestLatLong lat_long = make_lat_long(Content::clamped, 301, 150, 1);
    const ProjectionOptions options{.pixels = {.clamp = RadianceClamp{4096.0F, preserve}}};
    const Projection found = project(lat_long.view(), options);
    CHECK(found.diagnostics.total_radiance_before_clamp.x ==
          Approx(project(lat_long.view()).diagnostics.total_radiance.x).epsilon(1e-6));
    CHECK(relative_error(found.radiance, reference_projection(lat_long.view(), options)) < 5e-7);
  }
}

TEST_CASE("A clamp below 1 takes light from bytes too, one of 1 none", "[sh][policy][truth]") {
  for (const int size : {1, 7, 64, 257}) {
    for (const float maximum : {0.5F, 1.0F}) {
      const TestCubemapBytes cubemap = make_cubemap_bytes(Content::random, size, 3, 1);
      const TestLatLongBytes lat_long = make_lat_long_bytes(Content::random, 2 * size, size, 1, 3);
      const ProjectionOptions options{.pixels = {.clamp = RadianceClamp{maximum, false}}};
      const auto check = [&](const auto& view) {
        const Projection found = project(view, options);
        const bool clamps = maximum < 1.0F;
        CHECK((found.diagnostics.texels_clamped > 0) == clamps);
        const SphericalHarmonics wanted = clamps ? reference_projection(view, options) : project(view).radiance;
        CHECK(relative_error(found.radiance, wanted) < 5e-7);
      };
      check(cubemap.view());
      check(lat_long.view());
    }
  }
}

TEST_CASE("Gamma input is linearised texel by texel", "[sh][policy]") {
  for (const int size : kSizes) {
    const TestCubemap cubemap = make_cubemap(Content::gamma_encoded, size, 3, 1);
    const ProjectionOptions options{.pixels = {.gamma = true}};
    CHECK(relative_error(project(cubemap.view(), options).radiance, reference_projection(cubemap.view(), options)) <
          5e-7);
  }
}

// Promises: a colour-preserving clamp takes texels above its maximum down to it, with the ratios of their channels; it
// leaves all others alone, and says how much light it took from which channel.

TEST_CASE("A colour-preserving clamp scales texels and reports what it took", "[sh][policy]") {
  std::mt19937 generator(11);
  for (const int size : {1, 3, 7, 64}) {
    for (const float maximum : {0.3F, 10.0F, 4096.0F}) {
      TestCubemap cubemap{size, 3, std::vector<float>(static_cast<std::size_t>(18 * size * size))};
      TestCubemap scaled = cubemap;
      std::uint64_t above = 0;
      for (std::size_t i = 0; i < cubemap.pixels.size(); i += 3) {
        const float scale = static_cast<float>(generator() % 1000) * maximum / 300.0F;
        float brightest = 0.0F;
        for (std::size_t c = i; c < i + 3; ++c) {
          cubemap.pixels[c] = scale * (static_cast<float>(generator() % 1000) / 1000.0F - 0.05F);
          brightest = std::max(brightest, cubemap.pixels[c]);
        }
        above += brightest > maximum ? 1 : 0;
        const double factor = std::min(1.0, static_cast<double>(maximum) / std::max(1e-30F, brightest));
        for (std::size_t c = i; c < i + 3; ++c) {
          scaled.pixels[c] = static_cast<float>(factor * static_cast<double>(cubemap.pixels[c]));
        }
      }
      const ProjectionOptions options{.pixels = {.clamp = RadianceClamp{maximum, true}}};
      const Projection found = project(cubemap.view(), options);
      const Projection expected = project(scaled.view());
      const Projection whole = project(cubemap.view());
      CAPTURE(size, maximum);
      CHECK(found.diagnostics.texels_clamped == above);
      CHECK(relative_error(found.radiance, expected.radiance) < 1e-6);
      for (int c = 0; c < 3; ++c) {
        CHECK(found.diagnostics.total_radiance[c] == Approx(expected.diagnostics.total_radiance[c]).epsilon(1e-6));
        CHECK(found.diagnostics.total_radiance_before_clamp[c] ==
              Approx(whole.diagnostics.total_radiance[c]).epsilon(1e-6));
      }
    }
  }
}

}  // namespace welkin::test
