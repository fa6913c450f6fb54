// Files that are written: whole or not there, read back as what went in, saved sky tables as well.
#include <ImfInputFile.h>
#include <ImfStandardAttributes.h>

#include <clocale>
#include <locale>

#include "platform/thread.h"
#include "support/catch.h"
#include "support/damaged_files.h"
#include "support/exr_files.h"
#include "support/temporary_directory.h"
#include "support/test_environments.h"
#include "support/thrown_error.h"
#include "welkin/bake_file.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"
#include "welkin/sky.h"
#include "welkin/welkin.hpp"

namespace welkin::test {

// Promise: if writing a file fails, the new file does not exist and the previous one is unchanged.

namespace {

constexpr std::array kNames{"sky.exr", "sky.hdr", "sky.pfm", "sky.png"};

}  // namespace

TEST_CASE("A cancelled write leaves what was there", "[writers]") {
  const Cubemap map{32, some_pixels(32, 192)};
  for (const char* file : kNames) {
    for (const Layout layout : {Layout::automatic, Layout::six_files}) {
      const TemporaryDirectory directory;
      write_bytes(directory.file(file), {'o', 'l', 'd'});
      stop_source stop;
      const Control control{stop.get_token(), [&](double done) {
                              if (done > 0.6) stop.request_stop();
                            }};
      const auto call = [&] { write_environment(directory.file(file), map.view(), {layout}, control); };
      CHECK(thrown_by(call).code == ErrorCode::cancelled);
      CHECK(files_in(directory.path()).size() == 1);
      CHECK(read_bytes(directory.file(file)) == std::vector<char>{'o', 'l', 'd'});
    }
  }
}

TEST_CASE("A file that is there is replaced, and progress runs to one", "[writers]") {
  const Cubemap map{8, some_pixels(8, 48)};
  for (const char* file : kNames) {
    for (const Layout layout : {Layout::automatic, Layout::six_files}) {
      const TemporaryDirectory directory;
      write_bytes(directory.file(file), {'o', 'l', 'd'});
      double last = 0.0;
      const Control control{{}, [&](double done) {
                              CHECK(done >= last);
                              last = done;
                            }};
      const WriteReport report = write_environment(directory.file(file), map.view(), {layout}, control);
      CHECK(last == 1.0);
      CHECK(files_in(directory.path()).size() == (layout == Layout::six_files ? 7U : 1U));
      CHECK(std::filesystem::file_size(report.files.back()) > 3);
    }
  }
}

TEST_CASE("Refusals to write say what would do", "[writers]") {
  const TemporaryDirectory directory;
  const LatLongImage map{4, 2, some_pixels(4, 2)};
  const Cubemap cube{2, some_pixels(2, 12)};
  const auto refusal = [&](const std::string& file, const WriteOptions& options = {}) {
    return thrown_by([&] { write_environment(directory.file(file), map.view(), options); });
  };
  CHECK(refusal("sky.gif").code == ErrorCode::unsupported_file);
  CHECK(refusal("sky.gif").says("\".gif\" is not written; use .exr, .hdr, .pfm or .png"));
  CHECK(refusal("sky").says("no extension"));
  CHECK(refusal("none/sky.exr").code == ErrorCode::file_access);
  CHECK(refusal("none/sky.exr").says("its folder is not there"));
  CHECK(refusal("sky.exr", {Layout::automatic, SampleType::uint8}).says("half or float"));
  CHECK(refusal("sky.hdr", {Layout::automatic, SampleType::float32}).says("RGBE"));
  CHECK(refusal("sky.pfm", {Layout::automatic, SampleType::half}).says("floats alone"));
  CHECK(refusal("sky.png", {Layout::automatic, SampleType::half}).says("8 or 16 bits"));
  CHECK(refusal("sky.exr", {Layout::vertical_strip}).says("to_cubemap"));
  CHECK(refusal("sky.exr", {Layout::vertical_strip}).code == ErrorCode::invalid_argument);
  CHECK(thrown_by([&] {
          write_environment(directory.file("a.exr"), cube.view(), {Layout::lat_long});
        }).says("to_lat_long"));
  CHECK(thrown_by([&] { write_environment(directory.file("a.exr"), LatLongView{}); }).code ==
        ErrorCode::invalid_argument);
  std::filesystem::create_directory(directory.file("folder.exr"));
  CHECK(refusal("folder.exr").says("is a directory"));
  CHECK(files_in(directory.path()).size() == 1);
}

// Promise: every written format reads back as the input, within the precision of the format.

namespace {

LatLongImage some_lat_long(int width, int height) { return {width, height, some_pixels(width, height)}; }

double srgb_from_linear(double value) {
  return value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1.0 / 2.4) - 0.055;
}

}  // namespace

TEST_CASE("OpenEXR's own library reads what is written: float bit for bit, half to the nearest", "[writers]") {
  for (const auto& [width, height] : {std::pair{1, 1}, {2, 1}, {3, 2}, {64, 33}, {257, 17}}) {
    const LatLongImage map = some_lat_long(width, height);
    const TemporaryFile path("sky.exr");
    REQUIRE(write_environment(path, map.view(), {Layout::automatic, SampleType::float32}).values_clamped == 0);
    CHECK(read_exr_with_library(path) == map.pixels);

    write_environment(path, map.view());
    std::vector<float> rounded = map.pixels;
    for (float& value : rounded) value = as_half(value);
    CHECK(read_exr_with_library(path) == rounded);
    const Imf::InputFile file(path.string().c_str());
    CHECK(Imf::envmap(file.header()) == Imf::ENVMAP_LATLONG);
    CHECK(file.header().compression() == Imf::ZIP_COMPRESSION);
  }
}

TEST_CASE("Halves clamp what is finite, and keep NaN and infinities", "[writers]") {
  const TemporaryFile path("sky.exr");
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const LatLongImage map{2, 1, {65505.0F, -1e9F, kInfinity, -kInfinity, NAN, 65504.0F}};
  CHECK(write_environment(path, map.view()).values_clamped == 2);
  const std::vector<float> read = read_exr_with_library(path);
  CHECK(std::vector<float>(read.begin(), read.begin() + 4) ==
        std::vector<float>{65504.0F, -65504.0F, kInfinity, -kInfinity});
  CHECK(std::isnan(read[4]));
  CHECK(read[5] == 65504.0F);
}

TEST_CASE("Radiance images hold values to half a step of the largest component", "[writers]") {
  const TemporaryFile path("sky.hdr");
  for (const auto& [width, height] : {std::pair{1, 2}, {7, 3}, {8, 4}, {257, 5}, {32767, 1}, {32768, 1}}) {
    LatLongImage map = some_lat_long(width, height);
    // Runs of every length among noise, and dark texels.
    for (std::size_t i = 0; i < map.pixels.size(); ++i) {
      if (i / 3 % 300 < 150) map.pixels[i] = 0.25F * static_cast<float>(i % 3);
      if (i / 3 % 31 == 0) map.pixels[i] *= 1e-30F;
    }
    map.pixels[0] = 255.9F;  // rounds up to the next exponent
    CAPTURE(width, height);
    CHECK(write_environment(path, map.view()).values_clamped == 0);
    const Environment read = read_environment(path, {Layout::lat_long});
    REQUIRE(read.info.width == width);
    REQUIRE(read.info.height == height);
    int wrong = 0;
    for (std::size_t texel = 0; texel < map.pixels.size() / 3; ++texel) {
      const float* in = map.pixels.data() + 3 * texel;
      const float* out = read.pixels.get() + 3 * texel;
      const float step = 2.0F * std::max({in[0], in[1], in[2]}) / 256.0F;
      for (int c = 0; c < 3; ++c) {
        if (std::abs(in[c] - out[c]) > 0.5F * step + 1e-38F) ++wrong;
      }
    }
    CHECK(wrong == 0);
  }
  std::vector<char> bytes = read_bytes(path);
  CHECK(std::string(bytes.data(), 10) == "#?RADIANCE");
}

TEST_CASE("Radiance images and PNGs count what they cannot hold", "[writers]") {
  const TemporaryDirectory directory;
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const LatLongImage map{2, 1, {-1.0F, NAN, 0.5F, kInfinity, 3e38F, 0.25F}};
  CHECK(write_environment(directory.file("a.hdr"), map.view()).values_clamped == 4);
  const Environment hdr = read_environment(directory.file("a.hdr"));
  CHECK(std::vector<float>(hdr.pixels.get(), hdr.pixels.get() + 6) ==
        std::vector<float>{0.0F, 0.0F, 0.5F, 0xFFp119F, 0xFFp119F, 0.0F});
  CHECK(write_environment(directory.file("a.png"), map.view()).values_clamped == 4);
  const Environment png = read_environment(directory.file("a.png"));
  CHECK(png.pixels[0] == 0.0F);
  CHECK(png.pixels[1] == 0.0F);
  CHECK(png.pixels[2] == Approx(0.5).margin(0.003));
  CHECK(png.pixels[3] == 1.0F);
  CHECK(png.pixels[4] == 1.0F);
}

TEST_CASE("PNGs hold the nearest code of the sRGB curve, in 8 and 16 bits", "[writers]") {
  const TemporaryFile path("ramp.png");
  const int width = 3000;
  LatLongImage ramp{width, 2, std::vector<float>(std::size_t{6} * width)};
  for (std::size_t i = 0; i < ramp.pixels.size(); ++i) {
    ramp.pixels[i] = static_cast<float>(std::pow(static_cast<double>(i) / (6.0 * width - 1.0), 3.0));
  }
  for (const auto& [type, largest] : {std::pair{SampleType::uint8, 255.0}, {SampleType::uint16, 65535.0}}) {
    CHECK(write_environment(path, ramp.view(), {Layout::automatic, type}).values_clamped == 0);
    const Environment read = read_environment(path, {Layout::lat_long});
    CHECK(read.info.channels.front().type == (largest > 255.0 ? ChannelType::uint16 : ChannelType::uint8));
    double worst = 0.0;
    for (std::size_t i = 0; i < ramp.pixels.size(); ++i) {
      const double code = srgb_from_linear(read.pixels[i]) * largest;  // whole, but for rounding
      worst = std::max(worst, std::abs(code - srgb_from_linear(ramp.pixels[i]) * largest));
    }
    CHECK(worst < 0.51);
  }
}

// Promise: saved sky tables are read back bit for bit; a file with any damage is refused.

namespace {

SkyTableOptions tiny_options(ScatteringLayout layout) {
  return {.layout = layout,
          .heights = 2,
          .view_zeniths = 4,
          .sun_zeniths = 4,
          .sun_angles = 2,
          .transmittance_heights = 2,
          .transmittance_zeniths = 3,
          .irradiance_heights = 2,
          .irradiance_sun_zeniths = 2,
          .orders = 2};
}

}  // namespace

TEST_CASE("Saved sky tables come back with all their parameters and bits", "[sky][codec]") {
  const TemporaryDirectory directory;
  for (const ScatteringLayout layout : {ScatteringLayout::full, ScatteringLayout::compact}) {
    for (const Atmosphere& air : {earth(), mars(), earth_hillaire()}) {
      const SkyTables tables = precompute_sky(air, tiny_options(layout));
      save_sky_tables(tables, directory.file("sky.tables"));
      const SkyTables back = load_sky_tables(directory.file("sky.tables"));
      CHECK(back.atmosphere == tables.atmosphere);
      CHECK(back.options == tables.options);
      CHECK(back.transmittance == tables.transmittance);
      CHECK(back.scattering == tables.scattering);
      CHECK(back.single_mie == tables.single_mie);
      CHECK(back.irradiance == tables.irradiance);
      CHECK(back.orders == tables.orders);
      CHECK(back.last_change == tables.last_change);
    }
  }
  CHECK(std::distance(std::filesystem::directory_iterator(directory.file("")), {}) == 1);
}

TEST_CASE("Sky tables cut off anywhere or changed in any byte are refused", "[sky][codec][slow]") {
  const TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.tables");
  save_sky_tables(precompute_sky(earth(), tiny_options(ScatteringLayout::compact)), path);
  SoundFile sound{"sky.tables", read_bytes(path)};
  sound.header_bytes = sound.bytes.size();
  const auto check_refused = [&](const std::vector<char>& bytes) {
    write_bytes(path, bytes);
    const ThrownError error = thrown_by([&] { static_cast<void>(load_sky_tables(path, std::uint64_t{1} << 20U)); });
    if (!error.says("sky.tables")) FAIL(error.message);
  };
  for_each_truncation(sound, check_refused);
  for_each_changed_byte(sound, check_refused);
  sound.bytes.push_back('\0');
  check_refused(sound.bytes);
}

TEST_CASE("Refused sky tables say why", "[sky][codec]") {
  const TemporaryDirectory directory;
  const std::filesystem::path path = directory.file("sky.tables");
  save_sky_tables(precompute_sky(earth(), tiny_options(ScatteringLayout::full)), path);
  const auto load = [&](std::uint64_t limit = 1U << 30U) {
    return thrown_by([&] { static_cast<void>(load_sky_tables(path, limit)); });
  };
  CHECK(load(100).code == ErrorCode::limit_exceeded);
  std::vector<char> bytes = read_bytes(path);
  const char original = bytes[8];
  for (const int version : {7, 107}) {  // of other minor versions of the library
    bytes[8] = static_cast<char>(version);
    write_bytes(path, bytes);
    CHECK(load().code == ErrorCode::unsupported_file);
    CHECK(load().says("version " + std::to_string(version)));
    CHECK(load().says("; compute it again"));
  }
  bytes[8] = original;
  bytes.back() = static_cast<char>(bytes.back() ^ 1);
  write_bytes(path, bytes);
  CHECK(load().code == ErrorCode::corrupt_file);
  CHECK(load().says("checksum"));
  write_bytes(path, std::vector<char>(100, 'x'));
  CHECK(load().code == ErrorCode::unsupported_file);
  std::filesystem::remove(path);
  CHECK(load().code == ErrorCode::file_access);
  CHECK(thrown_by([&] {
          save_sky_tables(precompute_sky(earth(), tiny_options(ScatteringLayout::compact)),
                          directory.file("missing/sky.tables"));
        }).code == ErrorCode::file_access);
  SkyTables odd = precompute_sky(earth(), tiny_options(ScatteringLayout::compact));
  odd.scattering.pop_back();
  CHECK(thrown_by([&] { save_sky_tables(odd, path); }).code == ErrorCode::invalid_argument);
  odd = precompute_sky(earth(), tiny_options(ScatteringLayout::compact));
  odd.atmosphere.name.assign(5000, 'n');
  CHECK(thrown_by([&] { save_sky_tables(odd, path); }).code == ErrorCode::invalid_argument);
  CHECK(!std::filesystem::exists(path));
}

// Files' texts are read and written the same whatever the host's C++ locale is: one with a decimal comma and points
// between thousands, as in Germany, would read "0.25" as 0.

namespace {

class DecimalComma : public std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

/// For as long as it lives; of C's locale too, where the system has such a one.
class GermanHost {
 public:
  GermanHost() : before_(std::locale::global(std::locale(std::locale::classic(), new DecimalComma))) {
    for (const char* const name : {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8"}) {
      if (std::setlocale(LC_ALL, name) != nullptr) return;
    }
  }
  ~GermanHost() {
    std::locale::global(before_);
    std::setlocale(LC_ALL, "C");
  }
  GermanHost(const GermanHost&) = delete;
  GermanHost& operator=(const GermanHost&) = delete;

 private:
  std::locale before_;
};

/// Returns the text of a bake's plan with its reasons, and the messages for invalid arguments.
std::string all_explanations() {
  const TestLatLong image = make_lat_long(Content::smooth, 16, 8, 3);
  SceneNeeds needs;
  needs.glossy = RoughnessRange{0.25, 0.75};
  BakeOptions options{.specular = PrefilterOptions{}};
  options.specular->size = 16;
  std::string all = plan_text(plan(image.view(), needs, options));
  const auto add_message = [&all](const auto& call) {
    try {
      call();
    } catch (const Error& error) {
      all += error.what();
    }
  };
  Atmosphere air = earth();
  air.aerosol_asymmetry = -0.9;
  add_message([&] { (void)precompute_sky(air); });
  add_message([] { (void)rotation_about_y(2.5e6); });
  PrefilterOptions rough{.mips = 2, .roughness = {0.0, 1.5}};
  add_message([&] { (void)prefilter_specular(make_lat_long(Content::smooth, 16, 8, 3).view(), rough); });
  return all;
}

/// Returns, as text, the results of all parsers and writers of text for a few files.
std::string all_texts(const TemporaryDirectory& folder) {
  std::string all;
  const auto add = [&all](double value) { all += std::to_string(static_cast<long long>(value * 1e9)) + ' '; };

  TextureOptions options{.metadata = {{"welkin.roughness", "0 0.25 0.5 1"}}};
  const std::filesystem::path ktx2 = folder.file("specular.ktx2");
  write_texture(ktx2, Cubemap(8, 4).views(), options);
  const StoredEnvironment stored = inspect_stored_environment(ktx2);
  for (const double roughness : stored.roughness) add(roughness);
  for (const std::string& note : stored.info.notes) all += note;

  std::string pixels(std::size_t{8} * 4 * 12, '\0');
  pixels[2] = '\x80';
  pixels[3] = '\x3f';
  const std::filesystem::path pfm = folder.file("a.pfm");
  write_text(pfm, "PF\n8 4\n-1.5\n" + pixels);
  add(project_file(pfm).radiance.at(0, 0).x);

  const std::filesystem::path hdr = folder.file("a.hdr");
  const TestLatLong image = make_lat_long(Content::smooth, 16, 8, 3);
  write_environment(hdr, image.view());
  std::string text = read_text(hdr);
  const std::size_t line = text.find("FORMAT=");
  write_text(hdr, text.substr(0, line) + "EXPOSURE=1.25\nPRIMARIES=0.64 0.33 0.3 0.6 0.15 0.06 0.3127 0.329\n" +
                      text.substr(line));
  add(project_file(hdr).radiance.at(0, 0).x);

  const std::filesystem::path env = folder.file("a.env");
  write_babylon_environment(env, to_babylon(Cubemap(8, 4), project_file(hdr).radiance));
  all += read_text(env).substr(0, 700);
  add(project_file(env).radiance.at(0, 0).x);

  std::filesystem::create_directories(folder.file("root/proc/self"));
  std::filesystem::create_directories(folder.file("root/cg/a"));
  write_text(folder.file("root/proc/self/cgroup"), "0::/a\n");
  write_text(folder.file("root/proc/self/mountinfo"), "35 24 0:30 / /cg rw - cgroup2 cgroup2 rw\n");
  write_text(folder.file("root/cg/a/cpu.max"), "250000 100000\n");
  add(detail::quota_processors(folder.file("root")));
  return all;
}

}  // namespace

TEST_CASE("texts of files, plans and errors are the same to a host with a decimal comma", "[codec][locale]") {
  const TemporaryDirectory folder;
  const std::string here = all_texts(folder);
  CHECK(here.starts_with("0 250000000 500000000 1000000000 "));
  const std::string explained = all_explanations();
  CHECK(explained.find("-0.9") != std::string::npos);
  CHECK(explained.find("2500000") != std::string::npos);
  const GermanHost host;
  CHECK(all_texts(folder) == here);
  CHECK(all_explanations() == explained);
}

TEST_CASE("stored roughness that is not used is noted", "[codec][locale]") {
  const TemporaryFile path("specular.ktx2");
  const auto stored_as = [&](const std::string& text, LevelContent content = LevelContent::automatic) {
    TextureOptions options{.metadata = {{"welkin.roughness", text}}};
    write_texture(path, Cubemap(8, 4).views(), options);
    return inspect_stored_environment(path, {}, content);
  };
  const auto notes = [](const StoredEnvironment& stored) {
    int count = 0;
    for (const std::string& note : stored.info.notes) count += note.find("roughness") != std::string::npos ? 1 : 0;
    return count;
  };
  CHECK(notes(stored_as("0 0.25 0.5 1")) == 0);
  for (const char* const text : {"0 0,25 0,5 1", "0 0.25 0.5", "0 0.5 0.25 1", "0 0.25 0.5 1.5", "0 0.25 0.5 1 x", "",
                                 "nan nan nan nan", "-1 0 0.5 1", "0 0.25 0.5 1e"}) {
    const StoredEnvironment stored = stored_as(text);
    INFO(text);
    CHECK(notes(stored) == 1);
    CHECK(stored.roughness == mip_roughness(RoughnessSchedule::linear, 4, 8));
  }
  CHECK(notes(stored_as("0 0.25 0.5 1", LevelContent::radiance)) == 1);
}

}  // namespace welkin::test
