#include <cstddef>
#include <limits>
#include <stop_token>
#include <string>
#include <vector>

#include "support/catch.h"
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
  LatLongView lat_long{cubemap.pixels.data(), 8, 0, 0, PixelFormat::rgb_f32};
  CHECK(thrown_by([&] { static_cast<void>(project(lat_long)); }).says("the lat-long's height is 0"));
  lat_long.height = 4;
  lat_long.pixels = nullptr;
  CHECK(thrown_by([&] { static_cast<void>(project(lat_long)); }).says("the lat-long has no pixels"));
}

TEST_CASE("Options out of range are refused", "[sh]") {
  const TestCubemap cubemap = make_cubemap(Content::uniform, 8, 3, 1);
  ProjectionOptions options;
  options.bands = 0;
  require_refused(cubemap.view(), options, "bands is 0; it must be from 1 to 16");
  options.bands = 17;
  require_refused(cubemap.view(), options, "bands is 17");
  options = {};
  options.target_size = -1;
  require_refused(cubemap.view(), options, "target_size is -1");
  for (const float maximum :
       {0.0F, -1.0F, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    options = {};
    options.clamp = RadianceClamp{maximum, false};
    require_refused(cubemap.view(), options, "the clamp's maximum is");
  }
}

TEST_CASE("A stop request cancels a projection, and the next one works", "[sh]") {
  const TestCubemap cubemap = make_cubemap(Content::random, 300, 3, 1);
  std::stop_source source;
  source.request_stop();
  Control control;
  control.stop = source.get_token();
  CHECK(thrown_by([&] { static_cast<void>(project(cubemap.view(), {}, control)); }).code == ErrorCode::cancelled);
  CHECK(project(cubemap.view()).diagnostics.texels == 6 * 300 * 300);
}

}  // namespace welkin::test
