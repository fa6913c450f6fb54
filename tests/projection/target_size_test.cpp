// Projecting at a smaller size: solid angles of texels, the choice of a level, real environments.
#include "projection/lat_long_projection.h"
#include "projection/texel_weights.h"
#include "reference/reference_projection.h"
#include "support/catch.h"
#include "support/coefficients.h"
#include "support/images.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "support/trials.h"
#include "welkin/environment_file.h"
#include "welkin/projection.h"

namespace welkin::test {

// Solid angles: the sum over the sphere, and each texel by itself (totals hide wrong parts).

namespace {

/// A(x, y) = atan2(xy, sqrt(x^2 + y^2 + 1)): solid angle of the rectangle from the face's centre to (x, y).
long double corner_area(long double x, long double y) { return std::atan2(x * y, std::sqrt(x * x + y * y + 1.0L)); }

long double solid_angle(int size, int column, int row) {
  const auto edge = [size](int index) { return 2.0L * index / size - 1.0L; };
  return corner_area(edge(column + 1), edge(row + 1)) - corner_area(edge(column), edge(row + 1)) -
         corner_area(edge(column + 1), edge(row)) + corner_area(edge(column), edge(row));
}

/// Calls `use(column, row, solid angle)` for all texels of the quadrant.
template <class Use>
void for_each_weight(const projection::TexelWeights& weights, const Use& use) {
  platform::AlignedBuffer<float> scratch(weights.scratch_size());
  constexpr double y00 = 0.28209479177387814;
  for (int index = 0; index < weights.chunk_count(); ++index) {
    const projection::QuadrantChunk chunk = weights.chunk(index);
    const float* const values = weights.chunk_weights(index, scratch.data());
    for (int row = 0; row < chunk.row_count; ++row) {
      for (int column = 0; column < chunk.column_count; ++column) {
        const int position = row * chunk.groups_per_row * simd::kLanes + column;
        use(chunk.first_column + column, chunk.first_row + row, static_cast<double>(values[position]) / y00);
      }
    }
  }
}

}  // namespace

TEST_CASE("Every texel has its own solid angle", "[tables]") {
  for (const int bands : {1, 3, 4}) {
    for (const int size : {1, 2, 3, 7, 31, 64, 100, 128, 129, 257, 512, 1024}) {
      if (bands == 4 && size > 300) continue;
      const projection::TexelWeights weights({size, bands, false, size});
      int texels = 0;
      double worst = 0.0;
      for_each_weight(weights, [&](int column, int row, double found) {
        ++texels;
        const auto expected = static_cast<double>(solid_angle(size, column, row));
        worst = std::max(worst, std::abs(found / expected - 1.0));
      });
      CAPTURE(size, bands);
      CHECK(texels == ((size + 1) / 2) * ((size + 1) / 2));
      CHECK(worst < 4e-7);
    }
  }
}

// A target size per call: from the mip chain, or by averaging while reading.

namespace {

ProjectionOptions with_target(std::optional<int> target, Quadrature quadrature = Quadrature::exact) {
  ProjectionOptions options{.quadrature = quadrature, .target_size = target};
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

TEST_CASE("Averaging by solid angle matches the readable twin at any ratio", "[sh][target][truth]") {
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

TEST_CASE("Averaging keeps the total radiance", "[sh][target]") {
  const TestCubemap cubemap = make_cubemap(Content::one_texel_sun, 150, 3, 1);
  const ProjectionDiagnostics whole = project(cubemap.view()).diagnostics;
  for (const int target : {1, 7, 64, 149}) {
    const ProjectionDiagnostics reduced = project(cubemap.view(), with_target(target)).diagnostics;
    CHECK(reduced.total_radiance.x == Approx(whole.total_radiance.x).epsilon(1e-6));
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
  ProjectionOptions options = with_target(std::nullopt);
  options.pixels.clamp = RadianceClamp{};
  const glm::dvec3 whole = mean_radiance(project(cubemap.view(), options).radiance);
  for (const int target : {8, 33}) {
    options.target_size = target;
    CHECK(mean_radiance(project(cubemap.view(), options).radiance).x == Approx(whole.x).epsilon(1e-6));
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
  CHECK(same_bits(project(chain.views, with_target(std::nullopt)).radiance, project(chain.views[0]).radiance));
}

TEST_CASE("Passes say where the smaller size came from", "[sh][target]") {
  const Chain chain(64);
  const Projection from_chain = project(chain.views, with_target(16));
  REQUIRE(from_chain.diagnostics.passes.size() == 2);
  CHECK(from_chain.diagnostics.passes[0].name == "reduce");
  CHECK(from_chain.diagnostics.passes[0].action == PassAction::reuse);
  CHECK(project(chain.views[0], with_target(16)).diagnostics.passes[0].action == PassAction::skip);
  CHECK(project(chain.views[0], with_target(16, Quadrature::midpoint)).diagnostics.passes[0].action == PassAction::run);
  CHECK(project(chain.views[0]).diagnostics.passes.size() == 1);
}

TEST_CASE("A box reduction rejects texels by their own place", "[sh][target][policy]") {
  TestCubemap cubemap = make_cubemap(Content::random, 128, 3, 1);
  cubemap.pixels[static_cast<std::size_t>((3 * 128 + 70) * 128 + 90) * 3 + 1] = -1.0F;
  ProjectionOptions options = with_target(16, Quadrature::midpoint);
  CHECK(project(cubemap.view(), options).diagnostics.texels == 6 * 128 * 128);
  options.pixels.negative = NegativePolicy::reject;
  const ThrownError error = thrown_by([&] { static_cast<void>(project(cubemap.view(), options)); });
  CHECK(error.says("face -Y, row 70, column 90 is negative"));
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

// The environments of ../shared, where they are: the direct lat-long path against a dense double-precision integral,
// and against the values that an independent program (numpy, float64) recorded.

TEST_CASE("Real lat-longs agree with a dense double-precision integral", "[sh][shared][truth]") {
  const std::vector<std::filesystem::path> paths = shared_lat_longs();
  for (std::size_t k = 0; k < paths.size(); k += static_cast<std::size_t>(stride(3))) {
    const std::filesystem::path& path = paths[k];
    const Environment environment = read_environment(path);
    const SphericalHarmonics found = project_file(path).radiance;
    const double error = relative_error(found, reference_projection(environment.lat_long()));
    CAPTURE(path.filename().string(), error);
    CHECK(error < 1e-6);
  }
}

TEST_CASE("Real lat-longs agree with what an independent program recorded", "[sh][shared]") {
  const auto recorded = recorded_harmonics("radiance SH");  // in the order of l (l + 1) + m
  int compared = 0;
  for (const std::filesystem::path& path : shared_lat_longs()) {
    const auto at = recorded.find(path.filename().string());
    if (at == recorded.end()) continue;
    ++compared;
    REQUIRE(at->second.size() == 9);
    const SphericalHarmonics found = project_file(path).radiance;
    // Recorded with +x a quarter in from the right, where Welkin and OpenEXR have it a quarter in from the
    // left: what is odd in x changes its sign. Theirs is the midpoint rule, whose error is about 7 / width^2.
    constexpr double odd_in_x[9] = {1, 1, 1, -1, -1, 1, 1, -1, 1};
    SphericalHarmonics truth(3);
    for (std::size_t k = 0; k < 9; ++k) truth.coefficients()[k] = odd_in_x[k] * at->second[k].second;
    CAPTURE(path.filename().string(), relative_error(found, truth));
    const double width = inspect_environment(path).width;
    CHECK(relative_error(found, truth) < 10.0 / (width * width));
  }
  if (shared_images_are_here()) CHECK(compared > 0);
}

}  // namespace welkin::test
