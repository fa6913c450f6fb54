// Promise: the library's predictions for shaders that interpolate between mips match what such a shader shows, and
// fitted lobes bring it nearer to the reference.
#include "reflections/lookups.h"

#include "image/geometry.h"
#include "perf/report/passes.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/images.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/environment_file.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"

namespace welkin::test {
namespace {

constexpr RoughnessSchedule kSchedules[] = {RoughnessSchedule::linear, RoughnessSchedule::filament,
                                            RoughnessSchedule::babylon, RoughnessSchedule::unity,
                                            RoughnessSchedule::unreal};

/// Size of a cubemap whose texels' centres share no lines with those of a chain.
constexpr int kPlaces = 13;

/// Returns the squared error of lookups between two mips, relative to the reference integral at kPlaces' texels.
double square_between(const LatLongView& source, const PrefilteredSpecular& chain, const reflections::LookupFormula& by,
                      int mip) {
  const auto k = static_cast<std::size_t>(mip);
  const reflections::MipPair pair{mip, {chain.mips[k].roughness, chain.mips[k + 1].roughness}, {}, {}};
  double sum = 0.0;
  constexpr int kLookups = 4;
  for (const reflections::Lookup& lookup : reflections::lookups_between(pair, by, kLookups)) {
    const PrefilterOptions exact{.size = kPlaces, .mips = 1, .roughness = {lookup.roughness}, .rms_error = 1e-4};
    const PrefilteredSpecular truth = prefilter_specular(source, exact);
    double error = 0.0;
    double whole = 0.0;
    for (int texel = 0; texel < 6 * kPlaces * kPlaces; ++texel) {
      const int face = texel / (kPlaces * kPlaces);
      const int row = texel / kPlaces % kPlaces;
      const int column = texel % kPlaces;
      const float* const rgb = truth.cubemap.face(0, face) + 3 * (row * kPlaces + column);
      const dvec3 right(rgb[0], rgb[1], rgb[2]);
      const dvec3 where = image::face_direction(kPlaces, face, column + 0.5, row + 0.5);
      const dvec3 off = report::lookup(chain.cubemap, mip + lookup.share, where) - right;
      error += glm::dot(off, off);
      whole += glm::dot(right, right);
    }
    sum += error / whole / kLookups;
  }
  return sum;
}

/// Returns the root mean square error over all roughnesses.
double error_of_lookups(const LatLongView& source, const PrefilterOptions& options, RoughnessSchedule schedule) {
  const PrefilteredSpecular chain = prefilter_specular(source, options);
  const auto mips = static_cast<int>(chain.mips.size());
  double sum = 0.0;
  for (int mip = 0; mip + 1 < mips; ++mip) {
    const auto k = static_cast<std::size_t>(mip);
    sum += (chain.mips[k + 1].roughness - chain.mips[k].roughness) *
           square_between(source, chain, {schedule, mips, options.size}, mip);
  }
  return std::sqrt(sum);
}

PrefilterOptions fitted(RoughnessSchedule schedule, int mips, int size) {
  return {.size = size,
          .roughness = mip_roughness(schedule, mips, size),
          .lobe_roughness = fitted_mip_roughness(schedule, mips, size)};
}

/// Returns the predicted error of lookups in a chain of a typical image, root mean square over all roughnesses.
double typical_error(RoughnessSchedule schedule, int size, const std::vector<double>& lobes) {
  std::vector<float> energies{9.0F};
  for (int l = 1; l < 512; ++l) energies.push_back(static_cast<float>((2.0 * l + 1.0) / std::pow(l, 2.5)));
  const auto mips = static_cast<int>(lobes.size());
  const std::vector<double> nominal = mip_roughness(schedule, mips, size);
  double sum = 0.0;
  for (int k = 0; k + 1 < mips; ++k) {
    const auto i = static_cast<std::size_t>(k);
    const reflections::MipPair pair{k,
                                    {nominal[i], nominal[i + 1]},
                                    {lobes[i], lobes[i + 1]},
                                    {std::max(1, size >> k), std::max(1, size >> (k + 1))}};
    const double one = reflections::error_between(pair, {schedule, mips, size}, energies);
    sum += (nominal[i + 1] - nominal[i]) * one * one;
  }
  return std::sqrt(sum);
}

void check_estimates(const LatLongView& source) {
  const PrefilteredSpecular chain = prefilter_specular(source, {.size = 64, .mips = 5});
  CHECK_FALSE(chain.mips.back().error_between);
  for (int mip = 0; mip < 4; ++mip) {
    const double found = std::sqrt(square_between(source, chain, {RoughnessSchedule::filament, 5, 64}, mip));
    const double said = chain.mips[static_cast<std::size_t>(mip)].error_between.value();
    INFO("mip " << mip << ": " << found << ", estimate " << said);
    CHECK(said > 0.55 * found);
    CHECK(said < 1.5 * found);
  }
}

}  // namespace

TEST_CASE("between mips: estimates are what direct integration finds", "[specular][lookups][slow]") {
  check_estimates(make_lat_long(Content::random, 128, 64, 3).view());
  check_estimates(make_lat_long(Content::sun_disc, 128, 64, 3).view());
  check_estimates(make_lat_long(Content::smooth, 128, 64, 3).view());
}

TEST_CASE("between mips: estimates hold on a photograph", "[specular][lookups][slow]") {
  if (!shared_images_are_here()) return;
  const Environment image = read_environment((kImages / "env" / "lebombo_1k.hdr").string());
  check_estimates(to_lat_long(image.lat_long(), 64, 32).view());
}

TEST_CASE("between mips: records have errors where they are known", "[specular][lookups][slow]") {
  const TestLatLong source = make_lat_long(Content::smooth, 128, 64, 3);
  const auto errors = [&](const PrefilterOptions& options) {
    std::vector<double> known;
    for (const MipRecord& mip : prefilter_specular(source.view(), options).mips)
      known.push_back(mip.error_between.value_or(-1.0));
    return known;
  };
  const std::vector<double> five = errors({.size = 64, .mips = 5});
  CHECK(five.back() == -1.0);
  CHECK(errors({.size = 64, .mips = 7})[1] < five[1]);
  CHECK(errors({.size = 8, .mips = 2, .method = PrefilterMethod::reference}) == std::vector{-1.0, -1.0});
  CHECK(errors({.size = 8, .mips = 2, .lobe = LobeFamily::charlie}) == std::vector{-1.0, -1.0});
}

TEST_CASE("fitted lobes: rising from a mirror, near those of the schedule", "[specular][lookups][roughness]") {
  for (const RoughnessSchedule schedule : kSchedules) {
    for (const int size : {1, 5, 32, 1024}) {
      for (const int mips : {1, 2, 5, 6, full_chain_levels(size)}) {
        if (mips > full_chain_levels(size)) continue;
        INFO(name(schedule) << ", " << mips << " mips of " << size);
        const std::vector<double> nominal = mip_roughness(schedule, mips, size);
        const std::vector<double> lobes = fitted_mip_roughness(schedule, mips, size);
        REQUIRE(lobes.size() == nominal.size());
        CHECK(lobes.front() == 0.0);
        CHECK(lobes.back() <= 1.0);
        CHECK(std::is_sorted(lobes.begin(), lobes.end()));
        // Texels that are wide for a lobe alias its remainder, so none may become narrow without limit.
        for (std::size_t mip = 1; mip < lobes.size(); ++mip) CHECK(lobes[mip] > 0.5 * nominal[mip]);
        CHECK(typical_error(schedule, size, lobes) <= 1.0001 * typical_error(schedule, size, nominal));
      }
    }
  }
  const std::vector<double> filament = fitted_mip_roughness(RoughnessSchedule::filament, 7, 256);
  CHECK(filament.back() == Approx(0.89).margin(0.005));
  CHECK(thrown_by([] { (void)fitted_mip_roughness(RoughnessSchedule::linear, 17, 4); }).says("mips"));
}

TEST_CASE("fitted lobes: no other lobes near by show a typical image better", "[specular][lookups]") {
  for (const RoughnessSchedule schedule : kSchedules) {
    const auto error = [&](const std::vector<double>& lobes) { return typical_error(schedule, 256, lobes); };
    const std::vector<double> nominal = mip_roughness(schedule, 7, 256);
    const std::vector<double> lobes = fitted_mip_roughness(schedule, 7, 256);
    INFO(name(schedule) << ": " << error(lobes) << ", not fitted " << error(nominal));
    CHECK(error(lobes) <= error(nominal));
    for (std::size_t mip = 1; mip < 7; ++mip) {
      for (const double times : {0.95, 1.05}) {
        std::vector<double> other = lobes;
        other[mip] = std::min(1.0, times * other[mip]);
        INFO("mip " << mip << " times " << times);
        CHECK(error(lobes) <= error(other));
      }
    }
  }
}

TEST_CASE("fitted lobes: what a shader shows is nearer to the truth", "[specular][lookups][slow]") {
  const TestLatLong source = make_lat_long(Content::smooth, 128, 64, 3);
  for (const auto schedule : {RoughnessSchedule::filament, RoughnessSchedule::babylon}) {
    const int mips = schedule == RoughnessSchedule::filament ? 5 : 7;
    const PrefilterOptions exact{.size = 64, .roughness = mip_roughness(schedule, mips, 64)};
    const double before = error_of_lookups(source.view(), exact, schedule);
    const double after = error_of_lookups(source.view(), fitted(schedule, mips, 64), schedule);
    INFO(name(schedule) << ": " << after << ", not fitted " << before);
    CHECK(after < before);
  }
}

TEST_CASE("Lobes of mips may be others than shaders look for", "[specular][lookups]") {
  const TestLatLong source = make_lat_long(Content::blocks, 32, 16, 3);
  const std::vector<double> lobes{0.0, 0.4, 0.9};
  const PrefilteredSpecular made =
      prefilter_specular(source.view(), {.size = 16, .roughness = {0.0, 0.5, 1.0}, .lobe_roughness = lobes});
  const PrefilteredSpecular same = prefilter_specular(source.view(), {.size = 16, .roughness = lobes});
  CHECK(all_values(made.cubemap, same.cubemap, [](float a, float b) { return a == b; }));
  CHECK(made.mips[1].roughness == 0.5);
  CHECK(made.mips[1].lobe_roughness == 0.4);
  CHECK(same.mips[1].lobe_roughness == 0.4);
  const auto refused = [&](const PrefilterOptions& options) {
    return thrown_by([&] { (void)prefilter_specular(source.view(), options); });
  };
  CHECK(refused({.size = 16, .mips = 3, .lobe_roughness = {0.0, 1.0}}).says("3 mips, but lobe_roughness names 2"));
  CHECK(refused({.size = 16, .mips = 1, .lobe_roughness = {2.0}}).says("lobe_roughness of mip 0 is 2"));
}

}  // namespace welkin::test
