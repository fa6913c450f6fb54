// Promise: beside lamps of 1e4 to 1e8, however large their texels are beside the narrowest lobe of a chain and wherever
// they are, every mip is within the bounds at every texel.
#include "image/geometry.h"
#include "reflections/direct.h"
#include "reflections/lobe.h"
#include "reflections/prefilter_support.h"
#include "support/catch.h"
#include "support/test_environments.h"
#include "welkin/reflections.h"

namespace welkin::test {
namespace {

struct Lamp {
  std::int64_t texel;
  float light;
};

/// A picture of 1 with lamps, and what its mips are in truth: 1 and the lamps' own lobes, integrated in double.
class LampRoom {
 public:
  /// `height` 0: a cubemap.
  LampRoom(int width, int height, std::vector<Lamp> lamps)
      : width_(width),
        height_(height),
        grid_(height > 0 ? image::TexelGrid::lat_long(width, height) : image::TexelGrid::cubemap(width)),
        texels_(height > 0 ? projection::texels_of_lat_long(width, height) : projection::texels_of_cubemap(width)),
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

  /// Checks `count` texels of each mip, evenly spread, and as many that see a lamp at their horizon or in their lobe.
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

/// Corners of faces and their edges, poles and the seam, and places inside.
std::vector<std::int64_t> lamp_places(int width, int height) {
  const std::int64_t w = width;
  if (height == 0) return {0, 2 * w * w + w / 2 * w + w / 2, (5 * w - 1) * w + w / 2, 5 * w * w + w / 3 * w + w / 5};
  return {w / 3, height / 2 * w, height * w - 1, height / 3 * w + w / 2};
}

struct Shape {
  int width;
  int height;
};

/// Each lamp at another place of each source.
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

TEST_CASE("A lamp in a small picture leaves rough mips as bright as the darkest of it", "[specular][bright][lamps]") {
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

TEST_CASE("Lamps over a picture of many values leave all mips within their bounds",
          "[specular][bright][lamps][truth]") {
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
  for (const int width : {4, 16}) {  // a cubemap, a lat-long
    CAPTURE(width);
    const bool cubemap = width == 4;
    std::vector<float> pixels(std::size_t{3} * (cubemap ? 96 : 128), 1.0F);
    std::fill_n(pixels.begin() + 3 * 37, 3, 1e6F);
    const Cubemap cube = cubemap ? Cubemap(4, pixels) : Cubemap();
    const LatLongImage lat_long{16, 8, cubemap ? std::vector<float>() : pixels};
    const LobeChainOptions options{.size = 8, .lobes = {ZonalLobe::charlie(0.35), ZonalLobe::lambert()}};
    const PrefilteredSpecular result =
        cubemap ? prefilter_by_lobes(cube.view(), options) : prefilter_by_lobes(lat_long.view(), options);
    for (std::size_t level = 0; level < 2; ++level) {
      constexpr std::size_t step = 23;
      const std::vector<glm::dvec3> some = every(step, texel_centres(8 >> level));
      const auto truth = cubemap ? reference_by_lobe(cube.view(), options.lobes[level], some)
                                 : reference_by_lobe(lat_long.view(), options.lobes[level], some);
      const LevelError error = level_error(result.cubemap, static_cast<int>(level), truth, step);
      CAPTURE(level, error.rms, error.maximum);
      CHECK(error.rms < 1e-3);
      CHECK(error.maximum < 1e-2);
      CHECK(result.mips[level].bright_texels >= 1);
    }
  }
}

}  // namespace welkin::test
