// Promises: with a target size, the level of a file's mip chain that is nearest to it in log2 is chosen, by the rule
// that holds for chains in memory; a level that has lost its layout's shape is not among them.
#include <cmath>

#include "codec/project_file.h"
#include "support/catch.h"
#include "support/test_environments.h"

namespace welkin {
namespace {

EnvironmentInfo chain(Layout layout, int width, int height, int count) {
  EnvironmentInfo info;
  info.layout = layout;
  info.width = width;
  info.height = height;
  for (int level = 0; level < count; ++level) {
    info.levels.push_back({std::max(1, width >> level), std::max(1, height >> level)});
  }
  return info;
}

ProjectionOptions target(int size, Quadrature quadrature = Quadrature::exact) {
  ProjectionOptions options;
  options.target_size = size;
  options.quadrature = quadrature;
  return options;
}

}  // namespace

TEST_CASE("the level nearest to the target is chosen for cubes", "[codec][levels]") {
  const EnvironmentInfo strip = chain(Layout::vertical_strip, 256, 6 * 256, 9);
  CHECK(codec::level_for_target(strip, target(64)) == 2);
  CHECK(codec::level_for_target(strip, target(1)) == 8);
  CHECK(codec::level_for_target(strip, target(90)) == 2);  // 64 sqrt 2 = 90.5
  CHECK(codec::level_for_target(strip, target(91)) == 1);
  CHECK(codec::level_for_target(strip, target(255)) == 0);
  CHECK(codec::level_for_target(strip, target(91, Quadrature::midpoint)) == 2);  // rounded down to a power of two
  CHECK(!codec::level_for_target(strip, target(0)));
  CHECK(!codec::level_for_target(strip, target(256)));
  CHECK(!codec::level_for_target(strip, target(1000)));
  CHECK(!codec::level_for_target(chain(Layout::vertical_strip, 256, 6 * 256, 1), target(64)));
  CHECK(!codec::level_for_target(chain(Layout::vertical_strip, 256, 6 * 256, 0), target(64)));
  const EnvironmentInfo cross = chain(Layout::horizontal_cross, 256, 192, 7);
  CHECK(codec::level_for_target(cross, target(16)) == 2);
}

TEST_CASE("the level nearest to four times the target is chosen for lat-longs", "[codec][levels]") {
  const EnvironmentInfo sky = chain(Layout::lat_long, 1024, 512, 11);
  CHECK(codec::level_for_target(sky, target(64)) == 2);
  CHECK(codec::level_for_target(sky, target(91)) == 1);
  CHECK(codec::level_for_target(sky, target(91, Quadrature::midpoint)) == 1);
  CHECK(codec::level_for_target(sky, target(1)) == 8);
  CHECK(codec::level_for_target(sky, target(255)) == 0);
  CHECK(!codec::level_for_target(sky, target(256)));
  CHECK(!codec::level_for_target(sky, target(0)));
}

TEST_CASE("levels that are no longer six squares are not chosen", "[codec][levels]") {
  const EnvironmentInfo odd = chain(Layout::vertical_strip, 12, 72, 7);  // 12 x 72, 6 x 36, 3 x 18, 1 x 9
  CHECK(codec::level_for_target(odd, target(3)) == 2);
  CHECK(codec::level_for_target(odd, target(1)) == 2);
  CHECK(!codec::level_for_target(chain(Layout::vertical_strip, 3, 18, 5), target(1)));
}

TEST_CASE("files choose as chains in memory do", "[codec][levels]") {
  std::vector<test::TestCubemap> levels;
  std::vector<CubemapView> views;
  EnvironmentInfo info;
  info.layout = Layout::vertical_strip;
  for (int size = 32; size >= 1; size /= 2) {
    levels.push_back(test::make_cubemap(test::Content::random, size, 3, static_cast<std::uint32_t>(size)));
    info.levels.push_back({size, 6 * size});
  }
  for (const test::TestCubemap& level : levels) views.push_back(level.view());
  for (const Quadrature quadrature : {Quadrature::exact, Quadrature::midpoint}) {
    for (int size = 1; size < 32; ++size) {
      const Projection projection = project(views, target(size, quadrature));
      const std::optional<int> level = codec::level_for_target(info, target(size, quadrature));
      REQUIRE(level);
      const int chosen = info.levels[static_cast<std::size_t>(*level)].width;
      CHECK(projection.diagnostics.texels == std::uint64_t{6} * static_cast<std::uint64_t>(chosen * chosen));
    }
  }
}

}  // namespace welkin
