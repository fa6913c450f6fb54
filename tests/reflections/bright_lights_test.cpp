// Promise: all bright texels are found, and the lights that represent them, merged or cut by the horizon, contribute
// what their areas do.
#include "reflections/bright_lights.h"

#include "image/geometry.h"
#include "reflections/cube_rings.h"
#include "reflections/direct.h"
#include "reflections/lobe.h"
#include "reflections/prefilter_support.h"
#include "support/catch.h"
#include "support/sun_maps.h"
#include "support/test_environments.h"
#include "support/trials.h"
#include "welkin/reflections.h"

namespace welkin::test {
namespace {

constexpr double kReach = 9.25;

/// Returns the texels of a disc on a lat-long of 1024 x 512 or the fifth face of a cubemap of 256, with different
/// colours on its two sides and one texel near the edge a thousand times as bright.
std::vector<reflections::BrightTexel> disc(const reflections::ImageShape& shape, int radius) {
  std::vector<reflections::BrightTexel> texels;
  std::vector<double> angles(static_cast<std::size_t>(shape.columns));
  for (int row = 100 - radius; row <= 100 + radius; ++row) {
    for (int column = 130 - radius; column <= 130 + radius; ++column) {
      if (std::hypot(row - 100, column - 130) > radius) continue;
      reflections::BrightTexel texel;
      texel.row = shape.cubemap ? 4 * shape.columns + row : row;
      texel.column = column;
      texel.excess = {1.0F, column < 130 ? 1.0F : 0.25F, 1.0F + 0.01F * static_cast<float>(row % 7)};
      if (row == 94 && column == 136) texel.excess = {1000.0F, 1000.0F, 1000.0F};
      if (shape.cubemap) image::cubemap_row_solid_angles(row, angles);
      texel.steradians = shape.cubemap ? angles[static_cast<std::size_t>(column)]
                                       : image::lat_long_texel_solid_angle(shape.columns, shape.rows, row);
      texels.push_back(texel);
    }
  }
  return texels;
}

/// Returns a lobe's integral over the texels, each cut in `cuts` x `cuts`, in double. `lobe` is a function of a cosine.
glm::dvec3 truth_of(const std::vector<reflections::BrightTexel>& texels, const reflections::ImageShape& shape,
                    const auto& lobe, const glm::dvec3& direction, int cuts) {
  glm::dvec3 sum(0.0);
  for (const reflections::BrightTexel& texel : texels) {
    double light = 0.0;
    double whole = 0.0;
    for (int k = 0; k < cuts * cuts; ++k) {
      const double column = texel.column + (k % cuts + 0.5) / cuts;
      const double row = (shape.cubemap ? texel.row % shape.columns : texel.row) + (k / cuts + 0.5) / cuts;
      const glm::dvec3 position = shape.cubemap
                                      ? image::face_direction(shape.columns, texel.row / shape.columns, column, row)
                                      : image::lat_long_direction(shape.columns, shape.rows, column, row);
      const double u = 2.0 * column / shape.columns - 1.0;
      const double v = 2.0 * row / shape.columns - 1.0;
      const double density =
          shape.cubemap ? std::pow(1.0 + u * u + v * v, -1.5) : std::sqrt(1.0 - position.y * position.y);
      light += density * lobe(glm::dot(position, direction));
      whole += density;
    }
    for (int c = 0; c < 3; ++c)
      sum[c] += light / whole * texel.steradians * static_cast<double>(texel.excess[static_cast<std::size_t>(c)]);
  }
  return sum;
}

/// Errors of the lights against the reference at every `step`th texel of a cubemap of `size`.
struct Off {
  double rms = 0.0;       ///< relative to that of the reference
  double whole = 0.0;     ///< root mean square of the reference
  double relative = 0.0;  ///< largest, over texels that are not below `dark` of the brightest
};

Off off_of(const std::vector<reflections::BrightTexel>& texels, const reflections::ImageShape& shape,
           const reflections::BrightLights& lights, const reflections::LightsLobe& blurred, const auto& lobe, int size,
           std::size_t step, double dark, int cuts = 8) {
  const auto face_floats = std::size_t{3} * static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
  std::vector<float> pixels(6 * face_floats, 0.0F);
  std::array<float*, 6> faces{};
  for (std::size_t face = 0; face < 6; ++face) faces[face] = pixels.data() + face * face_floats;
  lights.add(blurred, size, faces, {});
  const std::vector<glm::dvec3> all = texel_centres(size);
  const auto largest = static_cast<double>(*std::ranges::max_element(pixels));
  Off off;
  double squares = 0.0;
  std::size_t count = 0;
  for (std::size_t k = 0; k < all.size(); k += step, ++count) {
    const glm::dvec3 truth = truth_of(texels, shape, lobe, all[k], cuts);
    for (int c = 0; c < 3; ++c) {
      const double error = std::abs(static_cast<double>(pixels[3 * k + static_cast<std::size_t>(c)]) - truth[c]);
      squares += error * error;
      off.whole += truth[c] * truth[c];
      // Where the horizon leaves a sliver of the disc, the reference's sample points are coarse.
      if (truth[c] > dark * largest) off.relative = std::max(off.relative, error / truth[c]);
    }
  }
  off.rms = std::sqrt(squares / off.whole);
  off.whole = std::sqrt(off.whole / static_cast<double>(count));
  return off;
}

}  // namespace

TEST_CASE("Lights that are merged give what their texels give", "[specular][bright][truth]") {
  for (const reflections::ImageShape& shape :
       {reflections::ImageShape{false, 1024, 512}, reflections::ImageShape{true, 256, 256}}) {
    const std::vector<reflections::BrightTexel> texels = disc(shape, 9);
    const reflections::BrightLights lights(texels, shape, {reflections::LightsOf::ggx, 0.012}, kReach);
    for (const double alpha : some_of(2, {0.012, 0.05, 0.4, 1.0})) {
      const reflections::Lobe ggx(alpha);
      const auto lobe = [alpha](double cosine) {
        return reflections::lobe(cosine, alpha) / reflections::lobe_integral(alpha);
      };
      for (const int size : {16, 64, 201}) {
        const Off off = off_of(texels, shape, lights, {ggx}, lobe, size, size < 64 ? 7 : (size < 200 ? 61 : 809),
                               size < 200 ? 1e-3 : 1e-2);
        CAPTURE(shape.cubemap, alpha, size);
        CHECK(off.rms < (size == 201 ? 7e-4 : 5e-4));
        CHECK(off.rms < 4.0 * lights.error(ggx, size, off.whole) / off.whole);
        CHECK(off.relative < 1e-2);
      }
    }
  }
}

TEST_CASE("Lights are merged and interpolated sooner at looser bounds, and their estimate says so",
          "[specular][bright][truth]") {
  const reflections::ImageShape shape{false, 1024, 512};
  for (const int radius : {6, 0}) {
    const std::vector<reflections::BrightTexel> texels = disc(shape, radius);
    const auto lights_within = [&](double bound) {
      return reflections::BrightLights(texels, shape, {reflections::LightsOf::ggx, 0.012},
                                       reflections::reach_for(bound, 10.0 * bound));
    };
    const reflections::BrightLights strict = lights_within(1e-3);
    for (const double bound : {1e-2, 0.1}) {
      const reflections::BrightLights loose = lights_within(bound);
      for (const double alpha : {0.05, 0.4}) {
        const reflections::Lobe ggx(alpha);
        const auto lobe = [alpha](double cosine) {
          return reflections::lobe(cosine, alpha) / reflections::lobe_integral(alpha);
        };
        const int size = radius > 0 ? 64 : 100;
        const Off off = off_of(texels, shape, loose, {ggx}, lobe, size, radius > 0 ? 47 : 19, 1e-3);
        CAPTURE(bound, alpha);
        CHECK(off.rms < 5e-3);
        CHECK(off.rms < 4.0 * loose.error(ggx, size, off.whole) / off.whole);
        CHECK(off.relative < 0.05);
        if (alpha == 0.05) CHECK(loose.error(ggx, size, off.whole) > 3.0 * strict.error(ggx, size, off.whole));
      }
    }
  }
}

TEST_CASE("Lights may be left out of texels where they are dim, and of no others", "[specular][bright]") {
  constexpr int size = 64;
  constexpr std::size_t values = std::size_t{18} * size * size;
  const reflections::ImageShape shape{true, 256, 256};
  const reflections::BrightLights lights(disc(shape, 9), shape, {reflections::LightsOf::ggx, 0.012}, kReach);
  const auto lit = [&](double alpha, double least, double& left_out) {
    const reflections::Lobe ggx(alpha);
    std::vector<float> pixels(values, 0.0F);
    std::array<float*, 6> faces{};
    for (std::size_t face = 0; face < 6; ++face) faces[face] = pixels.data() + face * values / 6;
    left_out = lights.add({ggx, 0.0, least}, size, faces, {});
    return pixels;
  };
  for (const double alpha : {0.012, 0.3}) {
    double left_out = 0.0;
    const std::vector<float> whole = lit(alpha, 0.0, left_out);
    CHECK(left_out == 0.0);
    const double largest = *std::ranges::max_element(whole);
    for (const double least : {1e-4 * largest, 1e-2 * largest}) {
      const std::vector<float> rest = lit(alpha, least, left_out);
      CAPTURE(alpha, least);
      CHECK(left_out == Approx(rest == whole ? left_out : least));
      int fewer = 0;
      double most = 0.0;
      for (std::size_t k = 0; k < values; ++k) {
        most = std::max(most, std::abs(static_cast<double>(whole[k]) - static_cast<double>(rest[k])));
        if (rest[k] == 0.0F && whole[k] > 0.0F) ++fewer;
      }
      CHECK(most <= 1.001 * least);
      if (alpha < 0.1) CHECK(fewer > 30'000);
    }
  }
}

TEST_CASE("Lights through a kernel give what their texels give", "[kernels][bright][truth]") {
  const reflections::ImageShape shape{false, 1024, 512};
  const std::vector<reflections::BrightTexel> texels = disc(shape, 9);
  for (const ZonalLobe& kernel : some_of(2, {ZonalLobe::lambert(), ZonalLobe::charlie(0.3), ZonalLobe::phong(0.5)})) {
    const double scale = kernel.lobe()->scale();
    reflections::LightLobes lobes{reflections::LightsOf::any};
    lobes.take_in(*kernel.lobe());
    const reflections::BrightLights lights(texels, shape, lobes, kReach);
    const auto lobe = [&kernel](double cosine) { return kernel.value(cosine); };
    for (const int size : {16, 64}) {
      const Off off = off_of(texels, shape, lights, {*kernel.lobe()}, lobe, size, size < 64 ? 3 : 29, 1e-2);
      CAPTURE(scale, size);
      CHECK(off.rms < 5e-4);
      CHECK(off.relative < 1e-2);
    }
  }
}

TEST_CASE("Lights that are wider than an annular kernel is steep give what their texels give",
          "[kernels][bright][slow]") {
  const reflections::ImageShape shape{false, 1024, 512};
  const std::vector<reflections::BrightTexel> texels = disc(shape, 7);
  const ZonalLobe kernel = ZonalLobe::charlie(0.06);
  reflections::LightLobes lobes{reflections::LightsOf::any};
  lobes.take_in(*kernel.lobe());
  REQUIRE(kernel.lobe()->annular());
  REQUIRE_FALSE(ZonalLobe::phong(20.0).lobe()->annular());
  const reflections::BrightLights lights(texels, shape, lobes, kReach);
  const auto lobe = [&kernel](double cosine) { return kernel.value(cosine); };
  const Off off = off_of(texels, shape, lights, {*kernel.lobe()}, lobe, 16, 17, 5e-2, 24);
  CAPTURE(off.rms, off.relative);
  CHECK(off.rms < 7e-5);
  CHECK(off.relative < 5e-4);
}

TEST_CASE("A cut light gives the mean of what is above", "[specular][bright]") {
  const double half = 0.01;
  for (const double turn : {0.0, 0.3, 0.785}) {
    for (const double height : {-0.013, -0.008, -0.002, 0.0, 0.003, 0.009, 0.02}) {
      const glm::dvec3 middle = glm::normalize(glm::dvec3(height, 0.0, 1.0));
      const glm::dvec3 along(half * std::cos(turn), half * std::sin(turn), 0.0);
      const glm::dvec3 down(-half * std::sin(turn), half * std::cos(turn), 0.0);
      reflections::CutLight light{};
      light.light = {static_cast<float>(middle.x), static_cast<float>(middle.y), static_cast<float>(middle.z), 1, 1, 1};
      for (int axis = 0; axis < 3; ++axis) {
        light.along[axis] = static_cast<float>(along[axis]);
        light.down[axis] = static_cast<float>(down[axis]);
      }
      light.least = 2e-4F;
      // A texel along +x, alpha 1: the lobe is the cosine.
      const std::array<float, reflections::kLobeTexels> zeros{};
      const reflections::LobeBlock block{
          {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, zeros.data(), zeros.data(), reflections::kLobeTexels, 1.0F, 0.0F, 0.0F};
      std::array<float, 3 * reflections::kLobeTexels> sums{};
      const reflections::LobeRun run{0, 1};
      reflections::lobe_kernels().sum_cut_lobes(block, &light, &run, 1, sums.data());
      double truth = 0.0;
      constexpr int parts = 400;
      for (int k = 0; k < parts * parts; ++k) {
        const double s = 2.0 * (k % parts + 0.5) / parts - 1.0;
        const double t = 2.0 * (k / parts + 0.5) / parts - 1.0;
        truth += std::max(0.0, middle.x + s * along.x + t * down.x) / (parts * parts);
      }
      CAPTURE(turn, height);
      CHECK(std::abs(static_cast<double>(sums[0]) - truth) < 2e-6);
    }
  }
}

TEST_CASE("A disc is taken out with its edge, whatever the number of its texels", "[specular][bright]") {
  TestLatLong image = make_lat_long(Content::uniform, 512, 256, 0);
  for (float& channel : image.pixels) channel = 0.1F;
  std::size_t count = 0;
  for (int row = 50; row < 90; ++row) {
    for (int column = 0; column < 512; ++column) {
      if (std::hypot(row - 70, (column + 200) % 512 - 210) > 15.5) continue;
      std::fill_n(image.pixels.begin() + 3 * (row * 512 + column), 3, 1e5F);
      ++count;
    }
  }
  const projection::SanitizedSource source(image.view(), {}, {});
  const auto found = reflections::find_bright_texels(source, 0.03, reflections::kMaxBright, {});
  CHECK(count > 700);
  CHECK(found.size() == count);
  for (const float* const row : reflections::rows_without(found, source).rows)
    CHECK(*std::max_element(row, row + std::ptrdiff_t{3} * 512) <= 0.11F);
}

// Promise: near lamps of 1e4 to 1e8, however large their texels are against the narrowest lobe of a chain and wherever
// they are, every mip is within the bounds at every texel.

namespace {

struct Lamp {
  std::int64_t texel;
  float light;
};

/// An image of 1 with lamps, and the exact values of its mips: 1 and the lamps' lobes, integrated in double.
class LampRoom {
 public:
  /// A `height` of 0 makes a cubemap.
  LampRoom(int width, int height, std::vector<Lamp> lamps)
      : width_(width),
        height_(height),
        grid_(height > 0 ? image::TexelGrid::lat_long(width, height) : image::TexelGrid::cubemap(width)),
        texels_(projection::texel_integrals_of(grid_)),
        lamps_(std::move(lamps)),
        pixels_(static_cast<std::size_t>(3 * grid_.texels()), 1.0F) {
    for (const Lamp& lamp : lamps_) std::fill_n(pixels_.begin() + 3 * lamp.texel, 3, lamp.light);
  }

  [[nodiscard]] PrefilteredSpecular prefilter(const PrefilterOptions& options) const {
    return height_ > 0 ? prefilter_specular(LatLongImage{width_, height_, pixels_}.view(), options)
                       : prefilter_specular(Cubemap{width_, pixels_}.view(), options);
  }

  [[nodiscard]] double truth(const glm::dvec3& normal, double alpha) const {
    double sum = 1.0;
    for (const Lamp& lamp : lamps_) {
      const double share = texels_->integral(
          {static_cast<int>(lamp.texel / grid_.columns()), static_cast<int>(lamp.texel % grid_.columns())}, normal,
          reflections::GgxFunction(alpha));
      sum += (static_cast<double>(lamp.light) - 1.0) * share / reflections::lobe_integral(alpha);
    }
    return sum;
  }

  /// Checks `count` evenly spread texels of each mip, and as many that see a lamp at their horizon or in their lobe.
  void check(const PrefilterOptions& options, std::size_t count) const {
    const PrefilteredSpecular result = prefilter(options);
    for (std::size_t level = 0; level < result.mips.size(); ++level) {
      const MipRecord& mip = result.mips[level];
      if (mip.method == MipMethod::copy) continue;
      CAPTURE(width_, height_, options.size, lamps_.front().texel, lamps_.front().light, mip.roughness);
      if (lamps_.front().light > 1e5F) CHECK(mip.bright_texels >= 1);
      const std::vector<glm::dvec3> all = texel_centres(mip.size);
      double worst = 0.0;
      double squares = 0.0;
      double whole = 0.0;
      for (const std::size_t k : chosen(all, count)) {
        const double truth = this->truth(all[k], mip.roughness * mip.roughness);
        const double off =
            std::abs(static_cast<double>(result.cubemap.face(static_cast<int>(level), 0)[3 * k]) - truth);
        worst = std::max(worst, off / truth);
        squares += off * off;
        whole += truth * truth;
      }
      CHECK(worst < options.maximum_error.value_or(10.0 * options.rms_error));
      CHECK(std::sqrt(squares / whole) < options.rms_error);
    }
  }

 private:
  [[nodiscard]] std::vector<std::size_t> chosen(const std::vector<glm::dvec3>& all, std::size_t count) const {
    std::vector<std::size_t> indices;
    const std::size_t step = std::max<std::size_t>(1, all.size() / count) | 1U;
    for (std::size_t k = step / 2; k < all.size(); k += step) indices.push_back(k);
    const glm::dvec3 lamp = grid_.direction(lamps_.front().texel);
    const std::size_t even = indices.size();
    for (const double height : {0.0, 1.0}) {
      std::vector<std::pair<double, std::size_t>> near;
      for (std::size_t k = 0; k < all.size(); k += std::max<std::size_t>(1, step / 4))
        near.emplace_back(std::abs(glm::dot(all[k], lamp) - height), k);
      std::sort(near.begin(), near.end());
      for (std::size_t k = 0; k < std::min(near.size(), even / 2); ++k) indices.push_back(near[k].second);
    }
    return indices;
  }

  int width_;
  int height_;
  image::TexelGrid grid_;
  std::unique_ptr<projection::TexelIntegrals> texels_;
  std::vector<Lamp> lamps_;
  std::vector<float> pixels_;
};

/// Returns texels at corners of faces, their edges, poles, the seam, and inside.
std::vector<std::int64_t> lamp_places(int width, int height) {
  const std::int64_t w = width;
  if (height == 0) return {0, 2 * w * w + w / 2 * w + w / 2, (5 * w - 1) * w + w / 2, 5 * w * w + w / 3 * w + w / 5};
  return {w / 3, height / 2 * w, height * w - 1, height / 3 * w + w / 2};
}

struct Shape {
  int width;
  int height;
};

/// Puts each lamp at a different texel of each source.
void check_lamps(const std::vector<Shape>& sources, const std::vector<int>& chains, const std::vector<float>& lights,
                 std::size_t count) {
  std::size_t number = 0;
  for (const Shape& source : sources) {
    const std::vector<std::int64_t> indices = lamp_places(source.width, source.height);
    for (const int chain : chains) {
      for (const float light : lights) {
        const Lamp lamp{indices[number++ % indices.size()], light};
        LampRoom(source.width, source.height, {lamp}).check({.size = chain}, count);
      }
    }
  }
}

const std::vector<float> kLights{1e4F, 1e6F, 1e8F};

}  // namespace

TEST_CASE("A lamp in a small image leaves rough mips as bright as the darkest of it", "[specular][bright][lamps]") {
  const PrefilteredSpecular result = LampRoom(128, 64, {{2500, 1e6F}}).prefilter({.size = 256});
  for (int level = 1; level < static_cast<int>(result.mips.size()); ++level) {
    const std::span<const float> values = level_values(result.cubemap, level);
    CAPTURE(level);
    CHECK(*std::min_element(values.begin(), values.end()) > 0.99F);
    CHECK(result.mips[static_cast<std::size_t>(level)].bright_texels == 1);
  }
}

TEST_CASE("Lamps on cubemaps of any size leave small chains within their bounds", "[specular][bright][lamps][slow]") {
  check_lamps({{1, 0}, {2, 0}, {3, 0}, {7, 0}, {8, 0}, {32, 0}, {64, 0}}, {8, 16}, kLights, 60);
}

TEST_CASE("Lamps on lat-longs of any size leave small chains within their bounds", "[specular][bright][lamps][truth]") {
  check_lamps({{4, 2}, {3, 5}, {32, 16}, {64, 32}, {128, 64}, {256, 128}}, {8, 16}, kLights, 60);
}

TEST_CASE("Lamps leave large chains within their bounds", "[specular][bright][lamps][truth]") {
  check_lamps({{8, 0}, {32, 0}, {64, 0}, {32, 16}, {64, 32}, {128, 64}, {256, 128}}, {64}, kLights, 100);
  check_lamps({{32, 0}, {64, 32}, {128, 64}, {256, 128}}, {256}, {1e8F}, 100);
}

TEST_CASE("Several lamps, some a thousand times as bright as others, leave all mips within their bounds",
          "[specular][bright][lamps]") {
  for (const float light : kLights) {
    LampRoom(64, 32, {{700, light}, {701, 0.5F * light}, {1500, 1e4F}, {20, 3e4F}}).check({.size = 64}, 100);
    LampRoom(32, 0, {{700, light}, {701, 0.5F * light}, {3500, 1e4F}, {20, 3e4F}}).check({.size = 64}, 100);
    LampRoom(4, 0, {{17, light}, {18, 0.5F * light}, {80, 1e4F}}).check({.size = 16}, 60);
  }
}

TEST_CASE("Lamps over an image of many values leave all mips within their bounds", "[specular][bright][lamps][truth]") {
  for (const float light : kLights) {
    TestLatLong source = make_lat_long(Content::random, 32, 16, 3);
    for (const std::size_t texel : {33U, 300U, 301U, 511U}) std::fill_n(source.pixels.begin() + 3 * texel, 3, light);
    const PrefilteredSpecular result = prefilter_specular(source.view(), {.size = 32});
    for (std::size_t level = 1; level < result.mips.size(); ++level) {
      const LevelError error = error_of_mip(source.view(), result, level, step_for(result.mips[level].size, 50) | 1U);
      CAPTURE(light, level, error.rms, error.maximum);
      CHECK(error.rms < 1e-3);
      CHECK(error.maximum < 1e-2);
    }
  }
}

TEST_CASE("Sheen and diffuse light of lamps with large texels are within the bounds",
          "[specular][bright][lamps][zonal]") {
  Cubemap cube = grey_cubemap(4, 1.0F);
  LatLongImage lat_long = grey_lat_long(16, 8, 1.0F);
  std::fill_n(cube.pixels().begin() + 3 * 37, 3, 1e6F);
  std::fill_n(lat_long.pixels.begin() + 3 * 37, 3, 1e6F);
  const LobeChainOptions options{.size = 8, .lobes = {ZonalLobe::charlie(0.35), ZonalLobe::lambert()}};
  for (const EnvironmentView& view : {EnvironmentView(cube.view()), EnvironmentView(lat_long.view())}) {
    CAPTURE(static_cast<int>(view.kind()));
    const PrefilteredSpecular result = prefilter_by_lobes(view, options);
    for (std::size_t level = 0; level < 2; ++level) {
      constexpr std::size_t step = 23;
      const auto truth = reference_by_lobe(view, options.lobes[level], every(step, texel_centres(8 >> level)));
      const LevelError error = level_error(result.cubemap, static_cast<int>(level), truth, step);
      CAPTURE(level, error.rms, error.maximum);
      CHECK(error.rms < 1e-3);
      CHECK(error.maximum < 1e-2);
      CHECK(result.mips[level].bright_texels >= 1);
    }
  }
}

}  // namespace welkin::test
