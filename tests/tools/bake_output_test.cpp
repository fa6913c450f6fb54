
#include "support/images.h"
#include "tools/command.h"
#include "welkin/bake_file.h"
#include "welkin/core.h"
#include "welkin/environment_file.h"

using namespace welkin;
using namespace welkin::test;

// Promises: previews are there, of the size that the manifest says, and show the surroundings the right way round.

namespace {

/// A PNG, read as linear light.
class Preview {
 public:
  explicit Preview(const std::filesystem::path& path) : image_(read_environment(path, {.layout = Layout::lat_long})) {}

  [[nodiscard]] int width() const { return image_.info.width; }
  [[nodiscard]] int height() const { return image_.info.height; }

  /// Returns the light at a position in units of `unit` pixels from the upper left.
  [[nodiscard]] std::array<float, 3> at(double x, double y, int unit = 1) const {
    const auto column = static_cast<std::size_t>(x * unit);
    const auto row = static_cast<std::size_t>(y * unit);
    const float* const rgb = image_.pixels.get() + (row * static_cast<std::size_t>(width()) + column) * 3;
    return {rgb[0], rgb[1], rgb[2]};
  }

 private:
  Environment image_;
};

/// Red grows along x, green along y, blue along z.
std::filesystem::path write_directions(const std::filesystem::path& folder) {
  const LatLongImage image = lat_long_of(128, 64, [](const dvec3& direction) { return 1.0 + direction; });
  const auto path = folder / "directions.pfm";
  write_pfm(path, image.width, image.height, image.pixels);
  return path;
}

constexpr int kHeight = 512;  // of the panorama
constexpr int kSphere = 256;  // of a sphere, followed by the pitch of its cells:
constexpr int kPitch = 288;
constexpr int kRow = 320;

/// Returns the light at (u, v) on the sphere in that column and row of a preview. The sphere's centre is (0, 0) and
/// its radius 1.
std::array<float, 3> on_sphere(const Preview& spheres, int column, int row, double u, double v) {
  return spheres.at(32.0 + (column + 0.5) * kPitch + 0.5 * kSphere * u, row * kRow + 0.5 * kPitch - 0.5 * kSphere * v);
}

}  // namespace

TEST_CASE(
    "bake: the panorama shows what one sees who faces +z, and spheres mirror what is behind and are lit from above",
    "[tools][bake]") {
  const TemporaryDirectory scratch;
  const auto in = write_directions(scratch.path());
  bake_into(scratch.path() / "out", quoted(in) + " --size 64");
  const Preview image(scratch.path() / "out" / "preview_environment.png");
  REQUIRE(image.width() == 2 * kHeight);
  REQUIRE(image.height() == kHeight);
  const auto at = [&](double x, double y) { return image.at(x, y, kHeight); };
  CHECK(at(0.5, 0.5)[0] > 1.5F * at(1.5, 0.5)[0]);   // +x to the left, -x to the right
  CHECK(at(1.0, 0.05)[1] > 1.5F * at(1.0, 0.9)[1]);  // +y above, -y below
  CHECK(at(1.0, 0.5)[2] > 1.5F * at(0.02, 0.5)[2]);  // +z in front, -z behind
  // There is no seam: directions change slowly, so that neighbours are alike, also across the cube's edges.
  for (double x = 0.1; x < 1.9; x += 0.01) {
    for (std::size_t channel = 0; channel < 3; ++channel) {
      CHECK(std::abs(at(x, 0.3)[channel] - at(x + 0.004, 0.3)[channel]) < 0.02F);
    }
  }

  const Preview spheres(scratch.path() / "out" / "preview_spheres.png");
  REQUIRE(spheres.height() == 2 * kRow);
  REQUIRE(spheres.width() == 6 * kPitch + 64);
  for (int row = 0; row < 2; ++row) {
    for (int sphere = 0; sphere < 6; ++sphere) {
      INFO("row " << row << ", sphere " << sphere);
      const auto on = [&](double u, double v) { return on_sphere(spheres, sphere, row, u, v); };
      CHECK(on(0.55, 0.0)[0] > 1.05F * on(-0.55, 0.0)[0]);  // +x is to the right
      CHECK(on(0.0, 0.55)[1] > 1.05F * on(0.0, -0.55)[1]);  // +y is up
      CHECK(on(0.0, 0.0)[2] > 1.05F * on(0.9, 0.0)[2]);     // +z is behind the viewer
    }
  }
}

// Promise: the exposure shows the lit part of any image, or is the value of --exposure.

namespace {

/// Surroundings of 64 x 32 texels: `share` of the rows from above have the light `lit`, the rest `dark`; one texel is a
/// sun.
std::vector<float> half_lit(double share, float lit, float dark, float sun) {
  std::vector<float> pixels;
  for (int row = 0; row < 32; ++row) {
    for (int value = 0; value < 64 * 3; ++value) pixels.push_back(row < share * 32 ? lit : dark);
  }
  for (std::size_t channel = 0; channel < 3; ++channel) pixels[(4 * 64 + 20) * 3 + channel] = sun;
  return pixels;
}

}  // namespace

TEST_CASE("bake: neither black surroundings nor a sun pull the exposure", "[tools][bake][slow]") {
  const TemporaryDirectory scratch;
  const auto in = scratch.path() / "in.pfm";
  const auto exposure_of = [&](const std::vector<float>& pixels, const std::string& options = "") {
    write_pfm(in, 64, 32, pixels);
    return bake_into(scratch.path() / "out",
                     quoted(in) + " --size 32 --irradiance 0 --no-brdf --preview-size 16" + options)
        .at("previews")
        .at("exposure")
        .get<double>();
  };
  const double even = exposure_of(grey_image(64, 32, 0.5F));
  CHECK(even == Approx(0.72).epsilon(1e-6));                                           // 0.36 / 0.5
  CHECK(exposure_of(half_lit(0.3, 0.5F, 1e-5F, 0.5F)) == Approx(even).epsilon(1e-3));  // a studio
  CHECK(exposure_of(half_lit(0.3, 0.5F, 0.0F, 0.5F)) == Approx(even).epsilon(1e-3));
  CHECK(exposure_of(half_lit(1.0, 0.5F, 0.5F, 1e6F)) == Approx(even).epsilon(0.1));  // a sun
  CHECK(exposure_of(half_lit(0.0, 0.0F, 0.0F, 5.0F)) < 10.0);                        // nothing but a lamp
  // --exposure is in a camera's stops: the factor is 2^EV for any image.
  CHECK(exposure_of(grey_image(64, 32, 0.5F), " --exposure -1.5") == Approx(std::exp2(-1.5)));
  CHECK(exposure_of(grey_image(64, 32, 500.0F), " --exposure 0") == 1.0);
  CHECK(run_welkin("bake " + quoted(in) + " --exposure bright -o " + quoted(scratch.path() / "no")).exit_code == 2);
}

// Promise: the same input gives the same files, bit for bit, on any number of threads and every instruction set; only
// the times in the manifest differ.

namespace {

void check_same(const std::filesystem::path& folder, const std::filesystem::path& expected) {
  check_same_files(folder, expected);
  nlohmann::json ours = manifest_of(folder);
  nlohmann::json theirs = manifest_of(expected);
  for (nlohmann::json* manifest : {&ours, &theirs}) {
    for (auto& pass : manifest->at("times")) pass.erase("ms");
  }
  CHECK(ours == theirs);
}

const std::string kOptions = "--sky --size 64 --irradiance 16 --brdf 16 --formats ktx2,dds,exr,env ";

}  // namespace

TEST_CASE("bake: the same files on any number of threads", "[tools][bake][slow]") {
  const TemporaryDirectory scratch;
  const auto expected = scratch.path() / "one";
  bake_into(expected, kOptions + "--threads 1");
  for (const char* threads : {"--threads 2", "--threads 5", ""}) {
    INFO(threads);
    bake_into(scratch.path() / "many", kOptions + threads);
    check_same(scratch.path() / "many", expected);
  }
}

namespace {

/// A word of shared exponents: nine bits each of red, green and blue, then the exponent. (OpenGL ES 3.0, 3.8.3.2.)
std::array<double, 3> light_of(const std::vector<std::uint8_t>& bytes, std::size_t texel) {
  std::uint32_t word = 0;
  for (std::size_t k = 4; k-- > 0;) word = word << 8U | bytes[4 * texel + k];
  const double unit = std::ldexp(1.0, static_cast<int>(word >> 27U) - 15 - 9);
  return {(word & 511U) * unit, (word >> 9U & 511U) * unit, (word >> 18U & 511U) * unit};
}

std::vector<std::uint8_t> bytes_of_base64(const std::string& text) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  std::uint32_t group = 0;
  int bits = 0;
  for (const char letter : text) {
    if (letter == '=') break;
    group = group << 6U | static_cast<std::uint32_t>(letters.find(letter));
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes.push_back(static_cast<std::uint8_t>(group >> static_cast<unsigned>(bits)));
  }
  return bytes;
}

}  // namespace

TEST_CASE("bake: the page of a preview holds the chain, and asks no network", "[tools][bake]") {
  const TemporaryDirectory scratch;
  const auto folder = scratch.path() / "out";
  const nlohmann::json manifest = bake_into(folder, quoted(write_directions(scratch.path())) + " --size 256 --brdf 8 " +
                                                        "--irradiance 8 --ktx2-format rgba32f --preview html");
  CHECK(file_of(manifest, "preview.html").at("format") == "HTML");
  const std::string page = file_text(folder / "preview.html");
  for (const char* word : {"http:", "https:", "src=", "href=", ">DATA<"}) CHECK_FALSE(contains(page, word));
  const std::string opening = R"(<script id="data" type="application/json">)";
  const std::size_t begin = page.find(opening) + opening.size();
  const nlohmann::json data = json_of(page.substr(begin, page.find("</script>", begin) - begin));
  CHECK(data.at("environment").at("size") == 256);
  CHECK(data.at("irradiance").at("size") == 8);
  CHECK(data.at("brdf").at("width") == 8);

  // Mips from 128 texels down, each face by face.
  const Cubemap chain = read_texture(folder / "specular.ktx2").cubemap;
  const std::vector<std::uint8_t> bytes = bytes_of_base64(data.at("chain").at("texels"));
  REQUIRE(data.at("chain").at("levels") == chain.levels() - 1);
  REQUIRE(data.at("roughness").size() == static_cast<std::size_t>(chain.levels()) - 1);
  std::size_t texel = 0;
  double worst = 0.0;
  for (int level = 1; level < chain.levels(); ++level) {
    for (int face = 0; face < 6; ++face) {
      const float* const rgb = chain.face(level, face);
      const auto edge = static_cast<std::size_t>(chain.level_size(level));
      for (std::size_t i = 0; i < 3 * edge * edge; i += 3) {
        const std::array<double, 3> stored = light_of(bytes, texel++);
        const double brightest = std::max({rgb[i], rgb[i + 1], rgb[i + 2]});
        for (std::size_t k = 0; k < 3; ++k) worst = std::max(worst, std::abs(stored[k] - rgb[i + k]) / brightest);
      }
    }
  }
  CHECK(texel * 4 == bytes.size());
  CHECK(worst < 1.0 / 510);
  bake_into(folder, quoted(scratch.path() / "directions.pfm") + " --size 32");  // which owns the page, and removes it
  CHECK_FALSE(std::filesystem::exists(folder / "preview.html"));
}
