// A target size per call: from the mip chain, or by averaging while reading.
#include <algorithm>
#include <vector>

#include "support/catch.h"
#include "support/coefficients.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/projection.h"

namespace welkin::test {
namespace {

ProjectionOptions with_target(int target, Quadrature quadrature = Quadrature::exact) {
  ProjectionOptions options;
  options.target_size = target;
  options.quadrature = quadrature;
  return options;
}

/// A chain whose levels are different noise, so that it shows which one was read.
struct Chain {
  explicit Chain(int size) {
    for (;; size = size / 2) {
      levels.push_back(make_cubemap(Content::random, size, 3, static_cast<std::uint32_t>(size)));
      if (size == 1) break;
    }
    for (const TestCubemap& level : levels) views.push_back(level.view());
  }
  std::vector<TestCubemap> levels;
  std::vector<CubemapView> views;
};

}  // namespace

TEST_CASE("Averaging by solid angle matches the readable twin at any ratio", "[sh][target]") {
  const int shapes[][2] = {{64, 8}, {64, 48}, {64, 63},  {64, 1},   {7, 3},
                           {7, 2},  {3, 1},   {100, 64}, {101, 16}, {130, 32}};
  for (const auto& [size, target] : shapes) {
    for (const Content content : {Content::random, Content::one_texel_sun}) {
      const TestCubemap cubemap = make_cubemap(content, size, 3, 1);
      const double error = relative_error(project(cubemap.view(), with_target(target)).radiance,
                                          reference_projection(cubemap.view(), with_target(target)));
      CAPTURE(size, target, error);
      CHECK(error < 1e-6);
    }
  }
}

TEST_CASE("A lat-long is averaged to four by two targets", "[sh][target]") {
  const int shapes[][3] = {{64, 32, 8},   {64, 32, 5},  {65, 33, 8},  {65, 33, 1},
                           {100, 30, 12}, {64, 32, 16}, {256, 128, 8}};
  for (const auto& [width, height, target] : shapes) {
    for (const Quadrature quadrature : {Quadrature::exact, Quadrature::midpoint}) {
      const TestLatLong lat_long = make_lat_long(Content::random, width, height, 1);
      const double error = relative_error(project(lat_long.view(), with_target(target, quadrature)).radiance,
                                          reference_projection(lat_long.view(), with_target(target, quadrature)));
      CAPTURE(width, height, target, error);
      CHECK(error < 1e-6);
    }
  }
}

TEST_CASE("Averaging keeps the flux", "[sh][target]") {
  const TestCubemap cubemap = make_cubemap(Content::one_texel_sun, 150, 3, 1);
  const ProjectionDiagnostics whole = project(cubemap.view()).diagnostics;
  for (const int target : {1, 7, 64, 149}) {
    const ProjectionDiagnostics reduced = project(cubemap.view(), with_target(target)).diagnostics;
    CHECK(reduced.flux.x == Approx(whole.flux.x).epsilon(1e-6));
    CHECK(reduced.error_estimate > whole.error_estimate);
  }
}

TEST_CASE("A target that is no smaller than the source changes nothing", "[sh][target]") {
  const TestCubemap cubemap = make_cubemap(Content::random, 40, 3, 1);
  for (const int target : {40, 41, 1000}) {
    CHECK(same_bits(project(cubemap.view(), with_target(target)).radiance, project(cubemap.view()).radiance));
  }
}

TEST_CASE("Clamp and gamma act before an exact average, so brightness does not depend on the target", "[sh][target]") {
  const TestCubemap cubemap = make_cubemap(Content::clamped, 128, 3, 1);
  ProjectionOptions options = with_target(0);
  options.clamp = RadianceClamp{};
  const glm::dvec3 whole = average_radiance(project(cubemap.view(), options).radiance);
  for (const int target : {8, 33}) {
    options.target_size = target;
    CHECK(average_radiance(project(cubemap.view(), options).radiance).x == Approx(whole.x).epsilon(1e-6));
  }
}

TEST_CASE("The mip level nearest to the target is read", "[sh][target]") {
  const Chain chain(96);  // 96 48 24 12 6 3 1
  const int expected[][2] = {{200, 0}, {96, 0}, {70, 0}, {67, 1}, {48, 1}, {30, 2}, {24, 2}, {5, 4}, {2, 5}, {1, 6}};
  for (const auto& [target, level] : expected) {
    CAPTURE(target, level);
    const Projection found = project(chain.views, with_target(target));
    CHECK(same_bits(found.radiance, project(chain.views[static_cast<std::size_t>(level)]).radiance));
  }
  CHECK(same_bits(project(chain.views, with_target(0)).radiance, project(chain.views[0]).radiance));
}

TEST_CASE("Passes say where the smaller size came from", "[sh][target]") {
  const Chain chain(64);
  const Projection from_chain = project(chain.views, with_target(16));
  REQUIRE(from_chain.diagnostics.passes.size() == 2);
  CHECK(from_chain.diagnostics.passes[0].name == "reduce");
  CHECK(from_chain.diagnostics.passes[0].action == "reuse");
  CHECK(project(chain.views[0], with_target(16)).diagnostics.passes[0].action == "skip");
  CHECK(project(chain.views[0], with_target(16, Quadrature::midpoint)).diagnostics.passes[0].action == "run");
  CHECK(project(chain.views[0]).diagnostics.passes.size() == 1);
}

TEST_CASE("A box reduction rejects texels by their own place", "[sh][target][policy]") {
  TestCubemap cubemap = make_cubemap(Content::random, 128, 3, 1);
  cubemap.pixels[static_cast<std::size_t>((3 * 128 + 70) * 128 + 90) * 3 + 1] = -1.0F;
  ProjectionOptions options = with_target(16, Quadrature::midpoint);
  CHECK(project(cubemap.view(), options).diagnostics.texels == 6 * 128 * 128);
  options.negative = NegativePolicy::reject;
  const ThrownError error = thrown_by([&] { static_cast<void>(project(cubemap.view(), options)); });
  CHECK(error.says("face -Y, row 70, column 90 is negative"));
}

TEST_CASE("Progress over several passes rises once", "[sh][target]") {
  const TestCubemap cubemap = make_cubemap(Content::random, 256, 3, 1);
  std::vector<double> seen;
  Control control;
  control.progress = [&](double share) { seen.push_back(share); };
  static_cast<void>(project(cubemap.view(), with_target(128, Quadrature::midpoint), control));
  CHECK(std::is_sorted(seen.begin(), seen.end()));
  CHECK(seen.back() == 1.0);
}

TEST_CASE("An uneven chain is refused", "[sh][target]") {
  const Chain chain(16);
  std::vector<CubemapView> views = chain.views;
  views.erase(views.begin() + 1);
  const ThrownError error = thrown_by([&] { static_cast<void>(project(views, with_target(4))); });
  CHECK(error.code == ErrorCode::invalid_argument);
  CHECK(error.says("mip level 1 has size 4"));
  CHECK(thrown_by([] { static_cast<void>(project(std::vector<CubemapView>{})); }).code == ErrorCode::invalid_argument);
}

}  // namespace welkin::test
