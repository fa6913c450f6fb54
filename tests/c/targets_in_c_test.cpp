// Results that the C interface writes to the caller's memory (formats, row pitch, direction, what is refused) and to
// files: the bits and bytes of the C++ calls.
#include <Imath/half.h>

#include "c/c_calls.h"
#include "c/c_worker.h"
#include "image/pixels.h"
#include "support/catch.h"
#include "support/pfm_files.h"
#include "support/small_skies.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "welkin/bake.h"
#include "welkin/bake_file.h"
#include "welkin/reflections.h"
#include "welkin/welkin.h"

namespace welkin::test {

namespace {

struct TargetFormat {
  welkin_format format;
  std::size_t channels;
  bool halves;
};

constexpr std::array kTargetFormats{
    TargetFormat{WELKIN_FORMAT_RGB_F32, 3, false}, TargetFormat{WELKIN_FORMAT_RGBA_F32, 4, false},
    TargetFormat{WELKIN_FORMAT_RGB_F16, 3, true},  TargetFormat{WELKIN_FORMAT_RGBA_F16, 4, true},
    TargetFormat{WELKIN_FORMAT_RG_F32, 2, false},  TargetFormat{WELKIN_FORMAT_RG_F16, 2, true}};

std::uint16_t half_of(float value) { return Imath::half(std::min(std::max(value, -65504.0F), 65504.0F)).bits(); }

/// Returns the expected bytes of a texel of three floats.
std::vector<std::uint8_t> texel_bytes(const float* rgb, const TargetFormat& format) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t c = 0; c < format.channels; ++c) {
    const float value = c < 3 ? rgb[c] : 1.0F;
    std::array<std::uint8_t, 4> channel{};
    const std::uint16_t half = half_of(value);
    std::memcpy(channel.data(), format.halves ? static_cast<const void*>(&half) : &value, format.halves ? 2 : 4);
    bytes.insert(bytes.end(), channel.begin(), channel.begin() + (format.halves ? 2 : 4));
  }
  return bytes;
}

/// Bakes only the background of a cubemap with texels beyond the range of halves.
welkin_bake_result* bright_bake(const welkin_environment& view) {
  auto options = c_struct<welkin_bake_options>();
  options.leave_out = WELKIN_PART_SPECULAR | WELKIN_PART_IRRADIANCE | WELKIN_PART_HARMONICS | WELKIN_PART_BRDF;
  welkin_bake_result* result = nullptr;
  REQUIRE(welkin_bake(&view, &options, nullptr, &result) == WELKIN_OK);
  return result;
}

constexpr std::uint8_t kUntouched = 0x5a;

/// Checks six faces in one block with `padding` bytes behind each row, and rows upwards if `upwards`.
void check_target(const welkin_chain* chain, int level, const TargetFormat& format, std::size_t padding, bool upwards) {
  const auto texels = texels_of(chain, level);
  auto info = c_struct<welkin_environment>();
  REQUIRE(welkin_chain_get_level(chain, level, &info) == WELKIN_OK);
  const auto size = static_cast<std::size_t>(info.size);
  const std::size_t texel = format.channels * (format.halves ? 2 : 4);
  const std::size_t row = size * texel + padding;
  std::vector<std::uint8_t> block(6 * size * row, kUntouched);
  auto target = c_struct<welkin_target>();
  target.format = format.format;
  target.size = info.size;
  target.row_stride_bytes = padding == 0 && !upwards ? 0 : static_cast<std::int64_t>(row) * (upwards ? -1 : 1);
  const auto row_of = [&](std::size_t face, std::size_t y) {
    return block.data() + (face * size + (upwards ? size - 1 - y : y)) * row;
  };
  for (std::size_t face = 0; face < 6; ++face) target.faces[face] = row_of(face, 0);
  std::uint64_t clamped = 99;
  REQUIRE(welkin_chain_copy(chain, level, &target, &clamped) == WELKIN_OK);
  std::uint64_t expected_clamped = 0;
  bool same = true;
  for (std::size_t face = 0; face < 6; ++face) {
    for (std::size_t y = 0; y < size; ++y) {
      const std::uint8_t* at = row_of(face, y);
      for (std::size_t x = 0; x < size; ++x, at += texel) {
        const float* rgb = texels.data() + 3 * ((face * size + y) * size + x);
        for (std::size_t c = 0; c < std::min<std::size_t>(format.channels, 3); ++c) {
          if (format.halves && !(std::abs(rgb[c]) <= 65504.0F)) ++expected_clamped;
        }
        same = same && std::memcmp(at, texel_bytes(rgb, format).data(), texel) == 0;
      }
      for (std::size_t i = 0; i < padding; ++i) same = same && at[i] == kUntouched;
    }
  }
  REQUIRE(same);
  REQUIRE(clamped == expected_clamped);
}

}  // namespace

TEST_CASE("C: levels are written to the caller's memory in every format, row pitch and direction", "[c_interface]") {
  const auto cube = make_cubemap(Content::one_texel_sun, 8, 3, 1);
  const welkin_environment view = c_view(cube.view());
  welkin_bake_result* result = bright_bake(view);
  const auto* const chain = welkin_bake_result_chain(result, WELKIN_PART_BACKGROUND);
  for (const TargetFormat& format : kTargetFormats) {
    for (const int level : {0, 1, 3}) {
      check_target(chain, level, format, 0, false);
      check_target(chain, level, format, 20, false);
      check_target(chain, level, format, 4, true);
    }
  }
  welkin_bake_result_destroy(result);
}

TEST_CASE("C: targets that nothing can be written to are refused before anything is written", "[c_interface]") {
  const auto cube = make_cubemap(Content::smooth, 8, 3, 1);
  const welkin_environment view = c_view(cube.view());
  welkin_bake_result* result = bright_bake(view);
  const auto* const chain = welkin_bake_result_chain(result, WELKIN_PART_BACKGROUND);
  std::vector<float> block(6 * 8 * 8 * 4, 7.0F);
  const welkin_target sound = c_target(block, 8, WELKIN_FORMAT_RGBA_F32);
  using Target = welkin_target;
  const std::pair<const char*, std::function<void(Target&)>> refused[] = {
      {"texels", [](Target& target) { target.size = 4; }},
      {"size", [](Target& target) { target.size = 0; }},
      {"size", [](Target& target) { target.size = 1 << 20; }},
      {"format", [](Target& target) { target.format = WELKIN_FORMAT_RGBA_U8; }},
      {"format", [](Target& target) { target.format = 10; }},
      {"format", [](Target& target) { target.format = -1; }},
      {"row_stride_bytes", [](Target& target) { target.row_stride_bytes = 8 * 16 - 4; }},
      {"row_stride_bytes", [](Target& target) { target.row_stride_bytes = -(8 * 16 - 4); }},
      {"row_stride_bytes", [](Target& target) { target.row_stride_bytes = 8 * 16 + 2; }},
      {"row_stride_bytes", [](Target& target) { target.row_stride_bytes = std::numeric_limits<std::int64_t>::min(); }},
      {"null", [](Target& target) { target.faces[3] = nullptr; }},
      {"width", [](Target& target) { target.width = 8; }},
      {"flat",
       [](Target& target) {
         target.size = 0;
         target.width = target.height = 8;
       }},
      {"aligned", [&](Target& target) { target.faces[3] = reinterpret_cast<std::byte*>(block.data()) + 2; }},
      {"size", [](Target& target) { target.struct_size = 8; }},  // it ends before the faces
      {"struct_size", [](Target& target) { target.struct_size = 12; }}};
  for (const auto& [word, spoil] : refused) {
    INFO(word);
    Target target = sound;
    spoil(target);
    std::uint64_t clamped = 99;
    REQUIRE(welkin_chain_copy(chain, 0, &target, &clamped) == WELKIN_INVALID_ARGUMENT);
    REQUIRE(std::string(welkin_last_error()).find(word) != std::string::npos);
    REQUIRE(clamped == 99);
  }
  for (const float value : block) REQUIRE(value == 7.0F);
  REQUIRE(welkin_chain_copy(chain, 0, &sound, nullptr) == WELKIN_OK);
  REQUIRE(block.back() == 1.0F);
  welkin_bake_result_destroy(result);
}

namespace {

/// A chain in memory, with targets for either interface.
struct BothTargets {
  BothTargets(int size, int levels) : layout{.size = size, .levels = levels, .row_alignment_bytes = 256} {
    for (const CubemapTarget& target : cpp) c.push_back(c_target(target, WELKIN_FORMAT_RGBA_F16));
  }

  UploadLayout layout;
  std::vector<std::byte> memory = std::vector<std::byte>(upload_bytes(layout), std::byte{kUntouched});
  std::vector<CubemapTarget> cpp = upload_targets(layout, memory);
  std::vector<welkin_target> c{};
};

/// Memory for all cubemaps of a bake of 4 texels.
struct BakeBuffers {
  BakeBuffers() : c(c_struct<welkin_bake_targets>()) {
    c.background = background.c.data();
    c.background_count = 3;
    c.specular = specular.c.data();
    c.specular_count = 1;
    c.irradiance = irradiance.c.data();
  }
  friend bool operator==(const BakeBuffers& a, const BakeBuffers& b) {
    return a.background.memory == b.background.memory && a.specular.memory == b.specular.memory &&
           a.irradiance.memory == b.irradiance.memory;
  }

  BothTargets background{4, 3};
  BothTargets specular{4, 1};
  BothTargets irradiance{2, 1};
  welkin_bake_targets c;
};

}  // namespace

TEST_CASE("C: a posted bake writes halves to the caller's memory with the bits of bake_to", "[c_interface]") {
  const auto cube = make_cubemap_half(Content::random, 8, 4, 1);
  const auto wide = make_lat_long(Content::one_texel_sun, 16, 8, 1);
  const welkin_environment cube_view = c_view(cube.view());
  const welkin_environment wide_view = c_view(wide.view());
  const double roughness = 0.5;
  auto specular = c_struct<welkin_prefilter_options>();
  specular.size = 4;
  specular.roughness = &roughness;
  specular.roughness_count = 1;
  auto asked = c_struct<welkin_bake_options>();
  asked.specular = &specular;
  asked.irradiance_size = 2;
  asked.leave_out = WELKIN_PART_BRDF;
  const BakeOptions options = c_interface::bake_options(&asked);

  const CWorker worker(2);
  const auto check = [&](const auto& view, const auto& post) {
    const BakeBuffers expected;
    const BakeBuffers found;
    const BakeResult baked =
        bake_to({expected.background.cpp, expected.specular.cpp, expected.irradiance.cpp.front()}, view, options);
    int released = 0;
    auto posting = c_struct<welkin_post_options>();
    posting.release = [](void* count) { ++*static_cast<int*>(count); };
    posting.release_user = &released;
    auto* const result = posted_handle<welkin_bake_result>(
        [&](welkin_job** job) { return post(&found.c, &posting, job); }, welkin_job_get_bake);
    CHECK(found == expected);
    auto info = c_struct<welkin_bake_info>();
    REQUIRE(welkin_bake_result_get_info(result, &info) == WELKIN_OK);
    CHECK(info.parts == WELKIN_PART_HARMONICS);  // the cubemaps went to the targets
    CHECK(info.values_clamped == baked.values_clamped);
    welkin_bake_result_destroy(result);
    REQUIRE(welkin_worker_wait_until_idle(worker.get()) == WELKIN_OK);
    CHECK(released == 1);
    return baked.values_clamped;
  };
  check(cube.view(), [&](const auto* targets, const auto* posting, welkin_job** job) {
    return welkin_post_bake(worker.get(), &cube_view, &asked, targets, posting, job);
  });
  CHECK(check(wide.view(), [&](const auto* targets, const auto* posting, welkin_job** job) {
          return welkin_post_bake(worker.get(), &wide_view, &asked, targets, posting, job);
        }) > 0);

  BakeBuffers buffers;
  const auto refused = [&](std::string_view what) {
    welkin_job* job = nullptr;
    CHECK(welkin_post_bake(worker.get(), &cube_view, &asked, &buffers.c, nullptr, &job) == WELKIN_INVALID_ARGUMENT);
    CHECK(std::string(welkin_last_error()).find(what) != std::string::npos);
  };
  buffers.irradiance.c[0].format = WELKIN_FORMAT_RGB_F16;
  refused("targets.irradiance[0].format");
  buffers.c.specular_count = -1;
  refused("targets.specular is -1");
}

// Files.

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
  const auto image = make_lat_long(Content::high_range, 64, 32, 4);
  write_bytes(directory.file("sky.pfm"), pfm_bytes(64, 32, false, "-1.0", image.pixels));
  const std::string path = directory.file("sky.pfm").string();
  auto specular = c_struct<welkin_prefilter_options>();
  specular.size = 16;
  auto options = c_struct<welkin_bake_options>();
  options.specular = &specular;
  options.irradiance_size = 8;
  const BakeResult expected = bake_file(path, {}, c_interface::bake_options(&options));
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
  const auto path = [&](const char* name) { return directory.file(name).string(); };
  auto options = c_struct<welkin_texture_options>();
  options.format = WELKIN_TEXEL_E5B9G9R9;
  options.supercompression = WELKIN_SUPERCOMPRESSION_ZSTD;
  TextureOptions expected{.format = TexelFormat::e5b9g9r9, .supercompression = Supercompression::zstd};

  std::vector<welkin_environment> mips(5, c_struct<welkin_environment>());
  for (std::size_t level = 0; level < mips.size(); ++level) {
    REQUIRE(welkin_chain_get_level(reflections.chain, static_cast<std::int32_t>(level), &mips[level]) == WELKIN_OK);
  }
  const auto report = write_texture(path("cpp.ktx2"), reflections.expected.cubemap.views(), expected);
  std::uint64_t clamped = 99;
  REQUIRE(welkin_write_texture(path("c.ktx2").c_str(), mips.data(), 5, &options, nullptr, &clamped) == WELKIN_OK);
  REQUIRE(clamped == report.values_clamped);
  REQUIRE(read_text(path("c.ktx2")) == read_text(path("cpp.ktx2")));

  // The chain brings its roughness, which a later bake finds.
  REQUIRE(welkin_write_chain(path("chain.ktx2").c_str(), reflections.chain, &options, nullptr, nullptr) == WELKIN_OK);
  REQUIRE(same_bits(read_texture(path("chain.ktx2")).cubemap, read_texture(path("c.ktx2")).cubemap));
  const StoredEnvironment stored = inspect_stored_environment(path("chain.ktx2"));
  REQUIRE(stored.content == LevelContent::reflections);
  REQUIRE(stored.roughness == mip_roughness(RoughnessSchedule::babylon, 5, 16));

  const std::vector<float> rgb{0.5F, 1.0F, 2.0F, 3.0F, 4.0F, 5.0F};
  write_texture_2d(path("cpp.dds"), 2, 1, rgb.data());
  const welkin_environment flat = c_view(LatLongView{rgb.data(), 2, 1});
  REQUIRE(welkin_write_texture(path("c.dds").c_str(), &flat, 1, nullptr, nullptr, nullptr) == WELKIN_OK);
  REQUIRE(read_text(path("c.dds")) == read_text(path("cpp.dds")));

  REQUIRE(welkin_write_texture(path("c.gif").c_str(), mips.data(), 5, nullptr, nullptr, nullptr) ==
          WELKIN_UNSUPPORTED_FILE);
  REQUIRE(welkin_write_texture(path("c.ktx2").c_str(), mips.data(), 0, nullptr, nullptr, nullptr) ==
          WELKIN_INVALID_ARGUMENT);
  REQUIRE(welkin_write_texture(directory.file("no/folder.ktx2").string().c_str(), mips.data(), 5, nullptr, nullptr,
                               nullptr) == WELKIN_FILE_ACCESS);
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
