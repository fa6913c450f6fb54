// Files through the C interface: bakes have the C++ calls' bits, and what is written the same bytes.
#include "c/c_calls.h"
#include "c/c_worker.h"
#include "support/catch.h"
#include "support/pfm_files.h"
#include "support/small_skies.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "welkin/bake_file.h"
#include "welkin/reflections.h"
#include "welkin/welkin.h"

namespace welkin::test {
namespace {

/// A chain of 16 texels with Babylon.js's roughness, in both languages.
struct Reflections {
  Reflections() {
    const auto cube = make_cubemap(Content::high_range, 16, 3, 1);
    const welkin_environment view = c_view(cube.view());
    expected =
        prefilter_specular(cube.view(), {.size = 16, .roughness = mip_roughness(RoughnessSchedule::babylon, 5, 16)});
    auto options = c_struct<welkin_prefilter_options>();
    options.size = 16;
    options.schedule = WELKIN_ROUGHNESS_BABYLON;
    REQUIRE(welkin_prefilter(&view, &options, nullptr, &chain) == WELKIN_OK);
    radiance = project(cube.view()).radiance;
  }
  ~Reflections() { welkin_chain_destroy(chain); }
  Reflections(const Reflections&) = delete;
  Reflections& operator=(const Reflections&) = delete;

  PrefilteredSpecular expected;
  SphericalHarmonics radiance;
  welkin_chain* chain = nullptr;
};

}  // namespace

TEST_CASE("C: bakes of files have the C++ call's bits, at once and as jobs", "[c_interface]") {
  const CWorker worker(2);
  const TemporaryDirectory directory;
  const auto picture = make_lat_long(Content::high_range, 64, 32, 4);
  write_bytes(directory.file("sky.pfm"), pfm_bytes(64, 32, false, "-1.0", picture.pixels));
  const std::string path = directory.file("sky.pfm").string();
  const BakeResult expected =
      bake_file(path, {}, {.specular = PrefilterOptions{.size = 16}, .irradiance = IrradianceOptions{.size = 8}});
  auto specular = c_struct<welkin_prefilter_options>();
  specular.size = 16;
  auto options = c_struct<welkin_bake_options>();
  options.specular = &specular;
  options.irradiance_size = 8;
  auto reading = c_struct<welkin_read_options>();
  reading.layout = WELKIN_LAYOUT_LAT_LONG;
  welkin_bake_result* at_once = nullptr;
  REQUIRE(welkin_bake_file(path.c_str(), &reading, &options, nullptr, &at_once) == WELKIN_OK);
  welkin_bake_result* const posted = posted_handle<welkin_bake_result>(
      [&](welkin_job** job) {
        return welkin_post_bake_file(worker.get(), path.c_str(), &reading, &options, nullptr, job);
      },
      welkin_job_get_bake);
  for (welkin_bake_result* const result : {at_once, posted}) {
    require_same_chain(welkin_bake_result_chain(result, WELKIN_PART_BACKGROUND), *expected.background);
    require_same_chain(welkin_bake_result_chain(result, WELKIN_PART_SPECULAR), expected.specular->cubemap);
    REQUIRE(same_texels(texels_of(welkin_bake_result_chain(result, WELKIN_PART_IRRADIANCE), 0),
                        expected.irradiance->pixels()));
    auto light = c_struct<welkin_projection>();
    REQUIRE(welkin_bake_result_get_projection(result, &light) == WELKIN_OK);
    require_same_projection(light, {*expected.radiance, expected.diagnostics});
    welkin_bake_result_destroy(result);
  }
  REQUIRE(welkin_bake_file(directory.file("none.exr").string().c_str(), nullptr, nullptr, nullptr, &at_once) ==
          WELKIN_FILE_ACCESS);
  REQUIRE(at_once == nullptr);
}

TEST_CASE("C: textures are the bytes that the C++ calls write", "[c_interface]") {
  const TemporaryDirectory directory;
  const Reflections reflections;
  const auto place = [&](const char* name) { return directory.file(name).string(); };
  auto options = c_struct<welkin_texture_options>();
  options.format = WELKIN_TEXEL_E5B9G9R9;
  options.supercompression = WELKIN_SUPERCOMPRESSION_ZSTD;
  TextureOptions expected{.format = TexelFormat::e5b9g9r9, .supercompression = Supercompression::zstd};

  std::vector<welkin_environment> mips(5, c_struct<welkin_environment>());
  for (std::size_t level = 0; level < mips.size(); ++level) {
    REQUIRE(welkin_chain_get_level(reflections.chain, static_cast<std::int32_t>(level), &mips[level]) == WELKIN_OK);
  }
  const auto report = write_texture(place("cpp.ktx2"), reflections.expected.cubemap.views(), expected);
  std::uint64_t clamped = 99;
  REQUIRE(welkin_write_texture(place("c.ktx2").c_str(), mips.data(), 5, &options, nullptr, &clamped) == WELKIN_OK);
  REQUIRE(clamped == report.values_clamped);
  REQUIRE(read_text(place("c.ktx2")) == read_text(place("cpp.ktx2")));

  // The chain brings its roughness, which a later bake finds.
  REQUIRE(welkin_write_chain(place("chain.ktx2").c_str(), reflections.chain, nullptr, nullptr, nullptr) == WELKIN_OK);
  const StoredEnvironment stored = inspect_stored_environment(place("chain.ktx2"));
  REQUIRE(stored.content == LevelContent::reflections);
  REQUIRE(stored.roughness == mip_roughness(RoughnessSchedule::babylon, 5, 16));

  const std::vector<float> rgb{0.5F, 1.0F, 2.0F, 3.0F, 4.0F, 5.0F};
  write_texture_2d(place("cpp.dds"), 2, 1, rgb.data());
  const welkin_environment flat = c_view(LatLongView{rgb.data(), 2, 1});
  REQUIRE(welkin_write_texture(place("c.dds").c_str(), &flat, 1, nullptr, nullptr, nullptr) == WELKIN_OK);
  REQUIRE(read_text(place("c.dds")) == read_text(place("cpp.dds")));

  REQUIRE(welkin_write_texture(place("c.gif").c_str(), mips.data(), 5, nullptr, nullptr, nullptr) ==
          WELKIN_UNSUPPORTED_FILE);
  REQUIRE(welkin_write_texture(place("c.ktx2").c_str(), mips.data(), 0, nullptr, nullptr, nullptr) ==
          WELKIN_INVALID_ARGUMENT);
  REQUIRE(welkin_write_texture(directory.file("no/folder.ktx2").string().c_str(), mips.data(), 5, nullptr, nullptr,
                               nullptr) == WELKIN_FILE_ACCESS);
}

TEST_CASE("C: textures in blocks are the bytes that the C++ calls write", "[c_interface][slow]") {
  const TemporaryDirectory directory;
  const Reflections reflections;
  const std::string in_c = directory.file("c.ktx2").string();
  const auto in_cpp = directory.file("cpp.ktx2");
  const auto same = [&](const welkin_texture_options& options, const TextureOptions& expected) {
    if (welkin_write_chain(in_c.c_str(), reflections.chain, &options, nullptr, nullptr) != WELKIN_OK) return false;
    TextureOptions with_roughness = expected;
    with_roughness.metadata = read_texture(directory.file("c.ktx2")).metadata;
    std::erase_if(with_roughness.metadata, [](const auto& entry) { return entry.first.starts_with("KTX"); });
    write_texture(in_cpp, reflections.expected.cubemap.views(), with_roughness);
    return read_text(in_c) == read_text(in_cpp.string());
  };
  auto options = c_struct<welkin_texture_options>();
  options.effort = WELKIN_EFFORT_FAST;  // (fields_in_c_test.cpp has the others)
  options.format = WELKIN_TEXEL_BC6H_SFLOAT;
  CHECK(same(options, {.format = TexelFormat::bc6h_sfloat, .bc6h_effort = Bc6hEffort::fast}));
  // A program that was built before there were efforts.
  options.struct_size = offsetof(welkin_texture_options, effort);
  CHECK(same(options, {.format = TexelFormat::bc6h_sfloat}));

  options = c_struct<welkin_texture_options>();
  options.format = WELKIN_TEXEL_ASTC_6X6_HDR;
  if (welkin_write_chain(in_c.c_str(), reflections.chain, &options, nullptr, nullptr) == WELKIN_UNSUPPORTED_FILE)
    return;
  options.effort = WELKIN_EFFORT_FASTEST;
  CHECK(same(options, {.format = TexelFormat::astc_6x6_hdr, .astc_effort = AstcEffort::fastest}));
}

TEST_CASE("C: Babylon.js's environments are the bytes that the C++ call writes", "[c_interface]") {
  const TemporaryDirectory directory;
  const Reflections reflections;
  const auto report = write_babylon_environment(directory.file("cpp.env"),
                                                to_babylon(reflections.expected.cubemap, reflections.radiance));
  const auto radiance = plain(reflections.radiance);
  const std::string path = directory.file("c.env").string();
  std::uint64_t clamped = 99;
  REQUIRE(welkin_write_babylon_environment(path.c_str(), reflections.chain, 3, radiance.data(), nullptr, &clamped) ==
          WELKIN_OK);
  REQUIRE(clamped == report.values_clamped);
  REQUIRE(read_text(path) == read_text(directory.file("cpp.env").string()));
}

TEST_CASE("C: a sky's tables are saved and loaded as the same bits", "[c_interface]") {
  const TemporaryDirectory directory;
  const std::string path = directory.file("sky.tables").string();
  const SkyTables expected = precompute_sky(earth(), tiny_tables());
  const welkin_sky_tables tables{std::make_shared<const SkyTables>(expected)};
  REQUIRE(welkin_sky_tables_save(&tables, path.c_str()) == WELKIN_OK);
  save_sky_tables(expected, directory.file("cpp.tables"));
  REQUIRE(read_text(path) == read_text(directory.file("cpp.tables").string()));
  welkin_sky_tables* loaded = nullptr;
  REQUIRE(welkin_sky_tables_load(path.c_str(), 0, &loaded) == WELKIN_OK);
  REQUIRE(same_texels(loaded->tables->scattering, expected.scattering));
  REQUIRE(same_texels(loaded->tables->irradiance, expected.irradiance));
  welkin_sky_tables_destroy(loaded);
  REQUIRE(welkin_sky_tables_load(path.c_str(), 1000, &loaded) == WELKIN_LIMIT_EXCEEDED);
  REQUIRE(loaded == nullptr);
  REQUIRE(welkin_sky_tables_load(directory.file("none").string().c_str(), 0, &loaded) == WELKIN_FILE_ACCESS);
}

}  // namespace welkin::test
