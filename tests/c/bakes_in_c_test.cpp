// Reflections, bakes and tables through the C interface: the bits of the C++ calls.
#include "c/c_calls.h"
#include "c/c_worker.h"
#include "image/pixels.h"
#include "support/catch.h"
#include "support/test_environments.h"
#include "welkin/bake.h"
#include "welkin/projection.h"
#include "welkin/reflections.h"
#include "welkin/welkin.h"

namespace welkin::test {

// Reflections.

namespace {

const std::vector<double> kRoughness{0.0, 0.3, 1.0};
const std::vector<double> kLobes{0.0, 0.31, 0.9};
const std::vector<double> kWide{0.5, 0.8};
const std::vector<double> kSpectra{1.0, 0.5, 0.25, 2.0, 0.5, 0.0};

/// The defaults, and options that callers pass by pointer. (fields_in_c_test.cpp maps each option to C++.)
std::array<welkin_prefilter_options, 2> wanted_reflections(const welkin_pixel_policy* policy) {
  std::array<welkin_prefilter_options, 2> both;
  both.fill(c_struct<welkin_prefilter_options>());
  for (auto& wanted : both) wanted.size = 16;
  both[1].roughness = kRoughness.data();
  both[1].lobe_roughness = kLobes.data();
  both[1].roughness_count = 3;
  both[1].method = WELKIN_PREFILTER_REFERENCE;
  both[1].pixels = policy;
  return both;
}

welkin_pixel_policy clamping_policy() {
  auto policy = c_struct<welkin_pixel_policy>();
  policy.clamp_maximum = 50.0F;
  policy.clamp_preserve_colour = 1;
  policy.negative = WELKIN_NEGATIVE_REPLACE;
  return policy;
}

const char* name_of(welkin_prefilter_method method) {
  if (method == WELKIN_PREFILTER_COPY) return "copy";
  if (method == WELKIN_PREFILTER_NEAR_FAR) return "near_far";
  return name(static_cast<PrefilterMethod>(method));
}

void require_same(const welkin_chain* chain, const PrefilteredSpecular& expected) {
  require_same_chain(chain, expected.cubemap);
  auto info = c_struct<welkin_chain_info>();
  REQUIRE(welkin_chain_get_info(chain, &info) == WELKIN_OK);
  REQUIRE(info.prefiltered == 1);
  for (std::size_t level = 0; level < expected.mips.size(); ++level) {
    const MipRecord& record = expected.mips[level];
    auto mip = c_struct<welkin_mip>();
    REQUIRE(welkin_chain_get_mip(chain, static_cast<std::int32_t>(level), &mip) == WELKIN_OK);
    REQUIRE(mip.size == record.size);
    REQUIRE(same_bits(mip.roughness, record.roughness));
    REQUIRE(name_of(mip.method) == std::string_view(name(record.method)));
    REQUIRE(mip.bands == record.bands);
    REQUIRE(mip.bright_texels == record.bright_texels);
    REQUIRE(std::isnan(mip.error_estimate) == !record.error_estimate);
    if (record.error_estimate) REQUIRE(same_bits(mip.error_estimate, *record.error_estimate));
    REQUIRE(same_bits(mip.lobe_roughness, record.lobe_roughness));
    REQUIRE(std::isnan(mip.error_between) == !record.error_between);
    if (record.error_between) REQUIRE(same_bits(mip.error_between, *record.error_between));
    REQUIRE(same_triple(mip.mean, record.mean));
  }
}

}  // namespace

TEST_CASE("C: prefiltered chains have the C++ calls' bits", "[c_interface][slow]") {
  const CWorker worker(2);
  const auto cube = make_cubemap(Content::high_range, 8, 4, 1);
  const auto image = make_lat_long(Content::high_range, 16, 8, 2);
  const welkin_environment cube_view = c_view(cube.view());
  const welkin_environment lat_long_view = c_view(image.view());
  const auto policy = clamping_policy();
  bool posts = false;  // alternates between direct calls and jobs
  for (const welkin_prefilter_options& asked : wanted_reflections(&policy)) {
    const PrefilterOptions options = c_interface::prefilter_options(&asked, 256, true);
    const auto check = [&](const welkin_environment& view, const PrefilteredSpecular& expected) {
      welkin_chain* chain = nullptr;
      if (posts) {
        chain = posted_handle<welkin_chain>(
            [&](welkin_job** job) { return welkin_post_prefilter(worker.get(), &view, &asked, nullptr, job); },
            welkin_job_get_chain);
      } else {
        REQUIRE(welkin_prefilter(&view, &asked, nullptr, &chain) == WELKIN_OK);
      }
      require_same(chain, expected);
      welkin_chain_destroy(chain);
      posts = !posts;
    };
    check(cube_view, prefilter_specular(cube.view(), options));
    check(lat_long_view, prefilter_specular(image.view(), options));
    posts = !posts;
  }
}

TEST_CASE("C: lobes that are not known and spectra that no lobe reads are refused", "[c_interface]") {
  const auto cube = make_cubemap(Content::smooth, 4, 4, 1);
  const welkin_environment view = c_view(cube.view());
  const auto refused = [&](const auto& change) {
    auto options = c_struct<welkin_prefilter_options>();
    options.size = 4;
    change(options);
    welkin_chain* chain = nullptr;
    CHECK(welkin_prefilter(&view, &options, nullptr, &chain) == WELKIN_INVALID_ARGUMENT);
  };
  refused([](welkin_prefilter_options& options) { options.lobe = 6; });
  refused([](welkin_prefilter_options& options) { options.quality = 3; });
  refused([](welkin_prefilter_options& options) { options.schedule = 6; });
  refused([](welkin_prefilter_options& options) {
    options.roughness = kWide.data();
    options.roughness_count = 2;
    options.fitted = 1;
  });
  refused([](welkin_prefilter_options& options) { options.lobe_roughness = kLobes.data(); });
  refused([](welkin_prefilter_options& options) { options.spectrum_bands = 3; });
  refused([](welkin_prefilter_options& options) { options.lobe = WELKIN_LOBE_FAMILY_SPECTRA; });
  refused([](welkin_prefilter_options& options) {
    options.lobe = WELKIN_LOBE_FAMILY_SPECTRA;
    options.spectra = kSpectra.data();
  });
}

// Bakes.

namespace {

/// The structures that the C options point to.
struct BakeParts {
  welkin_prefilter_options specular = c_struct<welkin_prefilter_options>();
  welkin_brdf_options brdf = c_struct<welkin_brdf_options>();
  welkin_pixel_policy pixels = clamping_policy();
};

/// Everything at once, and irradiance alone.
std::array<welkin_bake_options, 2> wanted_bakes(BakeParts& parts) {
  parts.specular.size = 16;
  parts.brdf.width = 16;
  parts.brdf.height = 8;
  parts.brdf.multiple_scattering = 1;
  parts.brdf.without_sheen = 1;
  std::array<welkin_bake_options, 2> both;
  both.fill(c_struct<welkin_bake_options>());
  both[0].background_size = 8;
  both[0].background_without_mips = 1;
  both[0].background_box_filter = 1;
  both[0].specular = &parts.specular;
  both[0].octahedral_size = 24;
  both[0].octahedral_levels = 2;
  both[0].octahedral_border = 4;
  both[0].irradiance_size = 8;
  both[0].irradiance_method = WELKIN_IRRADIANCE_HARMONICS;
  both[0].bands = 5;
  both[0].brdf = &parts.brdf;
  both[0].pixels = &parts.pixels;
  both[1].leave_out = WELKIN_PART_BACKGROUND | WELKIN_PART_SPECULAR | WELKIN_PART_HARMONICS | WELKIN_PART_BRDF;
  both[1].irradiance_size = 4;
  both[1].irradiance_method = WELKIN_IRRADIANCE_DIRECT;
  return both;
}

void require_same_table(const welkin_bake_result* result, const BrdfTable& expected) {
  const auto width = static_cast<std::size_t>(expected.options.width);
  const auto height = static_cast<std::size_t>(expected.options.height);
  std::vector<float> texels(3 * width * height, -1.0F);
  auto target = c_struct<welkin_target>();
  target.faces[0] = texels.data();
  target.width = expected.options.width;
  target.height = expected.options.height;
  REQUIRE(welkin_bake_result_copy_brdf(result, &target, nullptr) == WELKIN_OK);
  const auto channels = static_cast<std::size_t>(expected.channels);
  for (std::size_t i = 0; i < width * height; ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      REQUIRE(texels[3 * i + c] == (c < channels ? expected.values[channels * i + c] : 0.0F));
    }
  }
}

void require_same_map(const welkin_bake_result* result, const OctahedralMap& expected) {
  for (int level = 0; level < static_cast<int>(expected.levels.size()); ++level) {
    const std::vector<float>& values = expected.levels[static_cast<std::size_t>(level)];
    std::vector<float> texels(values.size());
    auto target = c_struct<welkin_target>();
    target.faces[0] = texels.data();
    target.width = target.height = expected.level_size(level);
    REQUIRE(welkin_bake_result_copy_octahedral(result, level, &target, nullptr) == WELKIN_OK);
    REQUIRE(texels == values);
    target.width = 1;
    REQUIRE(welkin_bake_result_copy_octahedral(result, level, &target, nullptr) == WELKIN_INVALID_ARGUMENT);
    REQUIRE(welkin_bake_result_copy_octahedral(result, -1, &target, nullptr) == WELKIN_INVALID_ARGUMENT);
  }
}

void require_same(const welkin_bake_result* result, const BakeResult& expected) {
  auto info = c_struct<welkin_bake_info>();
  REQUIRE(welkin_bake_result_get_info(result, &info) == WELKIN_OK);
  REQUIRE(info.peak_bytes == expected.peak_bytes);
  const auto has = [&](welkin_parts part) { return (info.parts & part) != 0; };
  const auto chain = [&](welkin_parts part, bool wanted) {
    const welkin_chain* const made = welkin_bake_result_chain(result, part);
    REQUIRE(has(part) == wanted);
    REQUIRE((made != nullptr) == wanted);
    return made;
  };
  const auto* const background = chain(WELKIN_PART_BACKGROUND, expected.background.has_value());
  if (background != nullptr) require_same_chain(background, *expected.background);
  const auto* const specular = chain(WELKIN_PART_SPECULAR, expected.specular.has_value());
  if (specular != nullptr) require_same(specular, *expected.specular);
  const auto* const irradiance = chain(WELKIN_PART_IRRADIANCE, expected.irradiance.has_value());
  if (irradiance != nullptr) REQUIRE(same_texels(texels_of(irradiance, 0), expected.irradiance->pixels()));
  REQUIRE(has(WELKIN_PART_HARMONICS) == expected.radiance.has_value());
  auto light = c_struct<welkin_projection>();
  const welkin_status status = welkin_bake_result_get_projection(result, &light);
  REQUIRE(status == (expected.radiance ? WELKIN_OK : WELKIN_INVALID_ARGUMENT));
  if (expected.radiance) {
    REQUIRE(info.bands == expected.radiance->bands());
    require_same_projection(light, {*expected.radiance, expected.diagnostics});
  }
  REQUIRE(has(WELKIN_PART_BRDF) == (expected.brdf != nullptr));
  if (expected.brdf) require_same_table(result, *expected.brdf);
  REQUIRE(has(WELKIN_PART_OCTAHEDRAL) == expected.octahedral.has_value());
  if (expected.octahedral) {
    REQUIRE(info.octahedral_size == expected.octahedral->size);
    REQUIRE(info.octahedral_border == expected.octahedral->border);
    REQUIRE(info.octahedral_levels == static_cast<std::int32_t>(expected.octahedral->levels.size()));
    require_same_map(result, *expected.octahedral);
  }
}

}  // namespace

TEST_CASE("C: bakes have the C++ calls' bits, part by part", "[c_interface][slow]") {
  const CWorker worker(2);
  const auto cube = make_cubemap(Content::high_range, 16, 3, 1);
  const auto image = make_lat_long(Content::high_range, 64, 32, 2);
  const welkin_environment cube_view = c_view(cube.view());
  const welkin_environment lat_long_view = c_view(image.view());
  BakeParts parts;
  bool posts = false;  // alternates between direct calls and jobs
  for (const welkin_bake_options& asked : wanted_bakes(parts)) {
    const BakeOptions options = c_interface::bake_options(&asked);
    const auto check = [&](const welkin_environment& view, const BakeResult& expected) {
      welkin_bake_result* result = nullptr;
      if (posts) {
        result = posted_handle<welkin_bake_result>(
            [&](welkin_job** job) { return welkin_post_bake(worker.get(), &view, &asked, nullptr, nullptr, job); },
            welkin_job_get_bake);
      } else {
        REQUIRE(welkin_bake(&view, &asked, nullptr, &result) == WELKIN_OK);
      }
      require_same(result, expected);
      welkin_bake_result_destroy(result);
      posts = !posts;
    };
    check(cube_view, bake(cube.view(), options));
    check(lat_long_view, bake(image.view(), options));
    posts = !posts;
  }
}

TEST_CASE("C: a part that is kept outlives its bake, and a bake beyond its memory is a limit exceeded",
          "[c_interface]") {
  const auto cube = make_cubemap(Content::smooth, 8, 3, 1);
  const welkin_environment view = c_view(cube.view());
  auto options = c_struct<welkin_bake_options>();
  options.leave_out = WELKIN_PART_SPECULAR;
  welkin_bake_result* result = nullptr;
  REQUIRE(welkin_bake(&view, &options, nullptr, &result) == WELKIN_OK);
  welkin_chain* kept = nullptr;
  const welkin_chain* const chain = welkin_bake_result_chain(result, WELKIN_PART_BACKGROUND);
  REQUIRE(welkin_chain_share(chain, &kept) == WELKIN_OK);
  auto first = c_struct<welkin_environment>();
  auto second = c_struct<welkin_environment>();
  REQUIRE(welkin_chain_get_level(chain, 1, &first) == WELKIN_OK);
  REQUIRE(welkin_chain_get_level(kept, 1, &second) == WELKIN_OK);
  REQUIRE(first.faces[5] == second.faces[5]);  // shared, not copied
  const auto before = texels_of(kept, 0);
  welkin_bake_result_destroy(result);
  REQUIRE(same_texels(texels_of(kept, 0), before));
  welkin_chain_destroy(kept);

  options.memory_limit_bytes = 100;
  result = reinterpret_cast<welkin_bake_result*>(&options);
  REQUIRE(welkin_bake(&view, &options, nullptr, &result) == WELKIN_LIMIT_EXCEEDED);
  REQUIRE(result == nullptr);
}

TEST_CASE("C: jobs hand out what they make, and nothing else", "[c_interface]") {
  const CWorker worker(1);
  const auto cube = make_cubemap(Content::smooth, 8, 3, 1);
  const welkin_environment view = c_view(cube.view());
  auto options = c_struct<welkin_prefilter_options>();
  options.size = 8;
  welkin_job* job = nullptr;
  REQUIRE(welkin_post_prefilter(worker.get(), &view, &options, nullptr, &job) == WELKIN_OK);
  REQUIRE(welkin_job_wait(job, WELKIN_NO_LIMIT) == WELKIN_OK);
  auto light = c_struct<welkin_projection>();
  welkin_bake_result* result = nullptr;
  welkin_sky_tables* tables = nullptr;
  welkin_sky_curve* curve = nullptr;
  REQUIRE(welkin_job_projection(job, &light) == WELKIN_INVALID_ARGUMENT);
  REQUIRE(welkin_job_get_bake(job, &result) == WELKIN_INVALID_ARGUMENT);
  REQUIRE(welkin_job_get_sky_tables(job, &tables) == WELKIN_INVALID_ARGUMENT);
  REQUIRE(welkin_job_get_sky_curve(job, &curve) == WELKIN_INVALID_ARGUMENT);
  REQUIRE(std::string(welkin_last_error()).find("curve") != std::string::npos);
  welkin_chain* first = nullptr;
  welkin_chain* second = nullptr;
  REQUIRE(welkin_job_get_chain(job, &first) == WELKIN_OK);
  REQUIRE(welkin_job_get_chain(job, &second) == WELKIN_OK);
  REQUIRE(first != second);
  require_same(first, prefilter_specular(cube.view(), {.size = 8}));
  require_same(second, prefilter_specular(cube.view(), {.size = 8}));
  welkin_chain_destroy(first);
  welkin_chain_destroy(second);
  welkin_job_release(job);
}

TEST_CASE("C: BRDF tables and irradiance cubemaps have the C++ calls' bits", "[c_interface]") {
  for (const bool sheen : {true, false}) {
    const auto table = brdf_table({16, 8, BrdfModel::split_sum, sheen});
    auto options = c_struct<welkin_brdf_options>();
    options.width = 16;
    options.height = 8;
    options.without_sheen = sheen ? 0 : 1;
    std::vector<std::uint16_t> halves(2 * 16 * 8);
    auto target = c_struct<welkin_target>();
    target.format = WELKIN_FORMAT_RG_F16;
    target.faces[0] = halves.data();
    target.width = 16;
    target.height = 8;
    REQUIRE(welkin_brdf_table(&options, nullptr, &target, nullptr) == WELKIN_OK);
    const auto channels = static_cast<std::size_t>(table->channels);
    for (std::size_t i = 0; i < 16 * 8; ++i) {
      REQUIRE(halves[2 * i] == image::half_from_float(table->values[channels * i]));
      REQUIRE(halves[2 * i + 1] == image::half_from_float(table->values[channels * i + 1]));
    }
    target.width = 8;
    REQUIRE(welkin_brdf_table(&options, nullptr, &target, nullptr) == WELKIN_INVALID_ARGUMENT);
  }

  const auto image = make_lat_long(Content::smooth, 32, 16, 1);
  const auto irradiance = irradiance_from_radiance(project(image.view(), {.bands = 4}).radiance);
  const Cubemap expected = irradiance_cubemap(irradiance, 12);
  std::vector<float> texels(expected.pixels().size());
  const welkin_target target = c_target(texels, 12);
  REQUIRE(welkin_irradiance_cubemap(4, plain(irradiance).data(), nullptr, &target, nullptr) == WELKIN_OK);
  REQUIRE(same_texels(texels, expected.pixels()));
}

TEST_CASE("C: many probes are baked as by the C++ call", "[c_interface][many]") {
  const auto halves = make_cubemap_half(Content::special_values, 16, 4, 1);
  const auto floats = make_cubemap(Content::random, 9, 3, 2);
  const std::vector<CubemapView> views{halves.view(), floats.view()};
  const std::vector<welkin_environment> probes{c_view(views[0]), c_view(views[1])};
  const PrefilterOptions options{.size = 4, .mips = 2, .roughness = {0.5, 1.0}};
  const double roughness[2] = {0.5, 1.0};
  auto c_options = c_struct<welkin_prefilter_options>();
  c_options.size = 4;
  c_options.roughness = roughness;
  c_options.roughness_count = 2;

  const UploadLayout layout{.format = TexelFormat::rgba32f, .size = 4, .levels = 2};
  const std::size_t bytes = upload_bytes(layout);
  std::vector<std::byte> wanted(2 * bytes);
  std::vector<std::byte> found(2 * bytes);
  std::vector<CubemapTarget> targets;
  std::vector<welkin_target> c_targets;
  for (std::size_t k = 0; k < 2; ++k) {
    for (const CubemapTarget& target : upload_targets(layout, std::span(wanted).subspan(k * bytes, bytes)))
      targets.push_back(target);
    for (const CubemapTarget& target : upload_targets(layout, std::span(found).subspan(k * bytes, bytes)))
      c_targets.push_back(c_target(target, WELKIN_FORMAT_RGBA_F32));
  }
  std::vector<dvec3> light(8);
  const BakeResult baked = bake_many(views, targets, light, options, 2);
  std::vector<double> coefficients(24);
  auto totals = c_struct<welkin_projection>();
  std::uint64_t clamped = 77;
  REQUIRE(welkin_bake_many(probes.data(), 2, &c_options, nullptr, c_targets.data(), 4, 2, coefficients.data(), &totals,
                           &clamped) == WELKIN_OK);
  CHECK(std::memcmp(light.data(), coefficients.data(), 24 * sizeof(double)) == 0);
  CHECK(wanted == found);
  CHECK(totals.texels == baked.diagnostics.texels);
  CHECK(clamped == baked.values_clamped);
  const auto refused = [&](std::int64_t count, std::int32_t bands, double* coefficients_out) {
    return welkin_bake_many(probes.data(), 2, &c_options, nullptr, c_targets.data(), count, bands, coefficients_out,
                            nullptr, nullptr) == WELKIN_INVALID_ARGUMENT;
  };
  CHECK(refused(3, 2, coefficients.data()));
  CHECK(refused(-1, 2, coefficients.data()));
  CHECK(refused(4, 17, coefficients.data()));
  CHECK(refused(4, 2, nullptr));
  c_targets[3].format = WELKIN_FORMAT_RGB_F16;
  CHECK(refused(4, 2, coefficients.data()));
  CHECK(std::string(welkin_last_error()).starts_with("targets[3].format"));
}

}  // namespace welkin::test
