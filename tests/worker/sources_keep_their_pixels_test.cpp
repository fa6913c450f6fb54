// Promise: a source takes pixels over or shares them, never copies them; it knows their size and who they are.
#include <memory>
#include <utility>
#include <vector>

#include "support/catch.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/environment_writer.h"
#include "welkin/requests.h"

namespace welkin::test {
namespace {

CubemapImage some_cubemap(int size) { return {size, make_cubemap(Content::random, size, 3, 1).pixels}; }
LatLongImage some_lat_long(int height) {
  return {2 * height, height, make_lat_long(Content::random, 2 * height, height, 1).pixels};
}

}  // namespace

TEST_CASE("a source has the very pixels that it was given", "[worker]") {
  CubemapImage cubemap = some_cubemap(5);
  const float* pixels = cubemap.pixels.data();
  CubemapSource source(std::move(cubemap));
  CHECK(source.view().faces[0] == pixels);
  CHECK(source.view().faces[5] == pixels + std::ptrdiff_t{5} * 5 * 5 * 3);
  CHECK(source.view().size == 5);
  CHECK(source.mips().size() == 1);

  const CubemapSource copy = source;
  CHECK(copy.view().faces[0] == pixels);
  const ProjectCubemap request{std::move(source)};
  CHECK(request.source.view().faces[0] == pixels);

  LatLongImage lat_long = some_lat_long(5);
  pixels = lat_long.pixels.data();
  CHECK(LatLongSource(std::move(lat_long)).view().pixels == pixels);

  const auto shared_cubemap = std::make_shared<const CubemapImage>(some_cubemap(3));
  CHECK(CubemapSource(shared_cubemap).view() == shared_cubemap->view());
  const auto shared_lat_long = std::make_shared<const LatLongImage>(some_lat_long(3));
  CHECK(LatLongSource(shared_lat_long).view() == shared_lat_long->view());
}

TEST_CASE("an environment's pixels go over, of the right kind alone", "[worker]") {
  const TemporaryDirectory directory;
  const auto cube = directory.file("cube.exr");
  const auto sky = directory.file("sky.exr");
  write_environment(cube, some_cubemap(4).view());
  write_environment(sky, some_lat_long(4).view());

  Environment environment = read_environment(cube);
  const float* pixels = environment.pixels.get();
  CHECK(CubemapSource(std::move(environment)).view().faces[0] == pixels);
  environment = read_environment(sky);
  pixels = environment.pixels.get();
  CHECK(LatLongSource(std::move(environment)).view().pixels == pixels);

  CHECK(thrown_by([&] { CubemapSource{read_environment(sky)}; }).code == ErrorCode::invalid_argument);
  CHECK(thrown_by([&] { LatLongSource{read_environment(cube)}; }).code == ErrorCode::invalid_argument);
}

TEST_CASE("the last copy of a source frees its pixels", "[worker]") {
  auto image = std::make_shared<const CubemapImage>(some_cubemap(4));
  const std::weak_ptr<const CubemapImage> watched = image;
  {
    const CubemapSource first(std::move(image));
    {
      const CubemapSource second = first;  // NOLINT(performance-unnecessary-copy-initialization): the copy is the point
      CHECK(watched.use_count() == 2);
    }
    CHECK(watched.use_count() == 1);
  }
  CHECK(watched.expired());
}

TEST_CASE("a source counts the bytes of its pixels, padding included", "[worker]") {
  CHECK(CubemapSource(some_cubemap(7)).bytes() == 6 * 7 * 7 * 12);
  CHECK(LatLongSource(some_lat_long(7)).bytes() == 14 * 7 * 12);
  CHECK(ProjectCubemap{some_cubemap(7)}.bytes() == 6 * 7 * 7 * 12);
  CHECK(ProjectLatLong{some_lat_long(7)}.bytes() == 14 * 7 * 12);
  CHECK(CubemapToCubemap{some_cubemap(7), 3}.bytes() == 6 * 7 * 7 * 12);

  const TestCubemapHalf halves = make_cubemap_half(Content::random, 8, 4, 1);
  CubemapView view = halves.view();
  CHECK(CubemapSource(view, nullptr).bytes() == 6 * 8 * 8 * 8);
  view.size = 4;
  view.row_stride_bytes = 64;
  CHECK(CubemapSource(view, nullptr).bytes() == 6 * 4 * 64);
  const std::byte* last_row = static_cast<const std::byte*>(view.faces[0]) + std::ptrdiff_t{3} * 64;
  view.faces.fill(last_row);
  view.row_stride_bytes = -64;
  CHECK(CubemapSource(view, nullptr).bytes() == 6 * 4 * 64);

  const TestCubemap full = make_cubemap(Content::random, 4, 3, 1);
  const TestCubemap next = make_cubemap(Content::random, 2, 3, 1);
  CHECK(CubemapSource({full.view(), next.view()}, nullptr).bytes() == 6 * (16 + 4) * 12);

  const TestLatLongBytes bytes = make_lat_long_bytes(Content::random, 8, 4, 1, 4);
  CHECK(LatLongSource(bytes.view(), nullptr).bytes() == 8 * 4 * 4);
}

TEST_CASE("sources are equal if they are the same pixels in memory", "[worker]") {
  const auto image = std::make_shared<const CubemapImage>(some_cubemap(4));
  CHECK(CubemapSource(image) == CubemapSource(image));
  CHECK_FALSE(CubemapSource(image) == CubemapSource(CubemapImage(*image)));
  CubemapView smaller = image->view();
  smaller.size = 2;
  CHECK_FALSE(CubemapSource(smaller, image) == CubemapSource(image));

  const ProjectCubemap request{image};
  CHECK(request == ProjectCubemap{image});
  ProjectionOptions options;
  options.bands = 4;
  CHECK_FALSE(request == ProjectCubemap{image, options});
  CHECK(ProjectFile{"a.exr"} == ProjectFile{"a.exr"});
  CHECK_FALSE(ProjectFile{"a.exr"} == ProjectFile{"b.exr"});

  const auto sky = std::make_shared<const LatLongImage>(some_lat_long(4));
  CHECK(LatLongToCubemap{sky, 4} == LatLongToCubemap{sky, 4});
  CHECK_FALSE(LatLongToCubemap{sky, 4} == LatLongToCubemap{sky, 5});
}

}  // namespace welkin::test
