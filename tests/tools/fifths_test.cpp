// `welkin bake --for playcanvas` and `--for qt`, texel by texel: each holds what the engine's shader reads there. The
// shaders' lookups are written down here again in double, from PlayCanvas 2.23 (envAtlas, reflectionEnv, ambient,
// spherical) and Qt Quick 3D 6.4 (sampleprobe.glsllib).
#include "files/env.h"
#include "tools/command.h"

using namespace welkin;
using namespace welkin::test;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kSourceHeight = 512;
constexpr int kSmallSourceHeight = 128;  ///< where no texel is compared within a step
constexpr int kBand = 8;
constexpr double kMeanLight = 6.0;

double legendre(int band, double c) {
  double before = 1.0;
  double value = c;
  for (int l = 1; l < band; ++l) {
    const double next = ((2.0 * l + 1.0) * c * value - l * before) / (l + 1.0);
    before = value;
    value = next;
  }
  return value;
}

/// How much of band l is left by the prefilter of a roughness: the split sum's lobe with N = V = R.
double left_by_ggx(int band, double roughness) {
  const double squared = roughness * roughness * roughness * roughness;
  constexpr int kSteps = 100000;
  double weighted = 0.0;
  double all = 0.0;
  for (int step = 0; step < kSteps; ++step) {
    const double angle = (step + 0.5) * kPi / 2.0 / kSteps;
    const double c = std::cos(angle);
    const double bracket = (1.0 + c) / 2.0 * (squared - 1.0) + 1.0;
    const double weight = c * std::sin(angle) / (bracket * bracket);
    weighted += weight * legendre(band, c);
    all += weight;
  }
  return weighted / all;
}

/// An environment in an engine's world: bands 0, 1 and 8. No turn or mirror leaves it as it is.
struct Light {
  double first = 1.0;   ///< what is left of band 1
  double eighth = 1.0;  ///< of band 8

  [[nodiscard]] static Light at_roughness(double roughness) {
    return roughness > 0.0 ? Light{left_by_ggx(1, roughness), left_by_ggx(kBand, roughness)} : Light{};
  }
  [[nodiscard]] dvec3 towards(const dvec3& d) const {
    const double ripple = 1.5 * eighth * legendre(kBand, (2.0 * d.x + 3.0 * d.y + 6.0 * d.z) / 7.0);
    return dvec3(kMeanLight + ripple) + 2.0 * first * d;
  }
};

/// Directions of a lat-long's points: u from left to right and v from top to bottom, in [0, 1] and beyond.
using Direction = std::function<dvec3(double u, double v)>;

/// PlayCanvas: x is negated, then u = atan(x, z) / 2 pi + 1 / 2 and v = 1 / 2 - asin(y) / pi.
dvec3 playcanvas_direction(double u, double v) {
  const double longitude = 2.0 * kPi * (u - 0.5);
  const double latitude = kPi * (0.5 - v);
  return {-std::sin(longitude) * std::cos(latitude), std::sin(latitude), std::cos(longitude) * std::cos(latitude)};
}

/// Qt: `balsam` has the centre of an image at +x, and +z on its right.
dvec3 qt_direction(double u, double v) {
  const double longitude = 2.0 * kPi * (u - 0.5);
  const double latitude = kPi * (0.5 - v);
  return {std::cos(longitude) * std::cos(latitude), std::sin(latitude), std::sin(longitude) * std::cos(latitude)};
}

void write_source(const std::filesystem::path& path, const Direction& direction, int height = kSourceHeight,
                  double scale = 1.0) {
  std::vector<float> rgb;
  for (int row = 0; row < height; ++row) {
    for (int column = 0; column < 2 * height; ++column) {
      const dvec3 light = scale * Light().towards(direction((column + 0.5) / 2.0 / height, (row + 0.5) / height));
      for (int channel = 0; channel < 3; ++channel) rgb.push_back(static_cast<float>(light[channel]));
    }
  }
  write_pfm(path, 2 * height, height, rgb);
}

struct Atlas {
  int size = 0;
  std::vector<std::uint8_t> rgba;

  explicit Atlas(const std::filesystem::path& folder) {
    size = file_of(manifest_of(folder), "env_atlas.png").at("size").get<int>();
    const std::string png = file_text(folder / "env_atlas.png");
    rgba.resize(4 * static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
    files::decode_rgba({{png.begin(), png.end()}, size, "env_atlas.png", "the atlas"}, rgba.data());
  }
  [[nodiscard]] const std::uint8_t* texel(int column, int row) const {
    return rgba.data() + 4 * (static_cast<std::ptrdiff_t>(row) * size + column);
  }
};

/// A rectangle of the atlas as the shader has it, in units of the atlas' edge.
struct AtlasRectangle {
  double left;
  double top;
  double width;
  double height;
};

constexpr double kSeam = 1.0 / 512.0;  // `seamSize`, whatever the size of the atlas

/// Where mapUv is inverted: the direction that the shader reads at a point of the atlas.
dvec3 read_at(const AtlasRectangle& rectangle, double x, double y) {
  return playcanvas_direction((x - rectangle.left - kSeam) / (rectangle.width - 2.0 * kSeam),
                              (y - rectangle.top - kSeam) / (rectangle.height - 2.0 * kSeam));
}

/// Largest distance of the root of radiance, in steps of the texel's RGBP, over the rectangle: at a texel's centre, or
/// over its area for levels that are to be looked at through a reflection's footprint.
double farthest(const Atlas& atlas, const AtlasRectangle& rectangle, const Light& light, int samples) {
  const int edge = atlas.size;
  const int stride = std::max(1, static_cast<int>(rectangle.width * edge) / 96);
  double most = 0.0;
  for (int row = 0; row < static_cast<int>(rectangle.height * edge); row += stride) {
    for (int column = 0; column < static_cast<int>(rectangle.width * edge); column += stride) {
      dvec3 sum(0.0);
      double weight = 0.0;
      for (int sample = 0; sample < samples * samples; ++sample) {
        const double x = rectangle.left + (column + (sample % samples + 0.5) / samples) / edge;
        const double y = rectangle.top + (row + (sample / samples + 0.5) / samples) / edge;
        const dvec3 d = read_at(rectangle, x, y);
        const double area = std::hypot(d.x, d.z);
        sum += area * light.towards(d);
        weight += area;
      }
      const std::uint8_t* const texel = atlas.texel(static_cast<int>(std::lround(rectangle.left * edge)) + column,
                                                    static_cast<int>(std::lround(rectangle.top * edge)) + row);
      const double step = (8.0 - 7.0 * texel[3] / 255.0) / 255.0;
      for (int channel = 0; channel < 3; ++channel)
        most = std::max(most, std::abs(texel[channel] - std::sqrt(sum[channel] / weight) / step));
    }
  }
  return most;
}

AtlasRectangle shiny(int level) {
  const double t = std::exp2(-level);
  return {1.0 - t, 1.0 - t, t, t / 2.0};
}

AtlasRectangle rough(int level) {
  const double t = std::exp2(-level);
  return {0.0, 1.0 - t, t, t / 2.0};
}

constexpr AtlasRectangle kAmbient{128.0 / 512.0, 384.0 / 512.0, 64.0 / 512.0, 32.0 / 512.0};

/// A KTX 1 file of halves with six faces, read by its specification alone.
struct Ktx {
  std::string bytes;
  std::array<std::uint32_t, 13> header{};
  std::map<std::string, std::string> keys;
  std::vector<std::size_t> mips;  ///< where each begins

  explicit Ktx(std::string all) : bytes(std::move(all)) {
    REQUIRE(bytes.substr(0, 12) == std::string("\xABKTX 11\xBB\r\n\x1A\n", 12));
    for (std::size_t k = 0; k < header.size(); ++k) header[k] = number_at(bytes, 12 + 4 * k);
    std::size_t at = 64;
    while (at < 64 + header[12]) {
      const std::size_t length = number_at(bytes, at);
      const std::string pair = bytes.substr(at + 4, length);
      const std::size_t end = pair.find('\0');
      REQUIRE(end != std::string::npos);
      keys[pair.substr(0, end)] = pair.substr(end + 1);
      at += 4 + (length + 3) / 4 * 4;
    }
    REQUIRE(at == 64 + header[12]);
    for (std::uint32_t mip = 0; mip < header[11]; ++mip) {
      const std::size_t edge = std::max<std::size_t>(1, header[6] >> mip);
      REQUIRE(number_at(bytes, at) == 8 * edge * edge);
      mips.push_back(at + 4);
      at += 4 + 6 * 8 * edge * edge;
    }
    REQUIRE(at == bytes.size());
  }
  [[nodiscard]] double half(std::size_t at) const {
    const std::uint32_t bits = number_at<std::uint16_t>(bytes, at);
    REQUIRE(bits >> 10U > 0);  // no sign and no denormal: light of 2.5 to 9.5
    REQUIRE(bits >> 10U < 31);
    return std::ldexp(1024.0 + (bits & 1023U), static_cast<int>(bits >> 10U) - 25);
  }
};

/// Returns the direction of a texel by OpenGL's table of faces.
dvec3 face_direction(int face, double s, double t) {
  switch (face) {
    case 0: return {1.0, -t, -s};
    case 1: return {-1.0, -t, s};
    case 2: return {s, 1.0, t};
    case 3: return {s, -1.0, -t};
    case 4: return {s, -t, 1.0};
    default: return {-s, -t, -1.0};
  }
}

/// Largest relative distance of a mip's texels from the light in their directions.
double farthest(const Ktx& file, int mip, const Light& light) {
  const int edge = static_cast<int>(file.header[6]) >> mip;
  double most = 0.0;
  for (int texel = 0; texel < 6 * edge * edge; ++texel) {
    const double s = (2.0 * (texel % edge) + 1.0) / edge - 1.0;
    const double t = (2.0 * (texel / edge % edge) + 1.0) / edge - 1.0;
    const dvec3 wanted = light.towards(glm::normalize(face_direction(texel / edge / edge, s, t)));
    const std::size_t at = file.mips[static_cast<std::size_t>(mip)] + 8 * static_cast<std::size_t>(texel);
    for (std::size_t channel = 0; channel < 3; ++channel) {
      const double there = wanted[static_cast<int>(channel)];
      most = std::max(most, std::abs(file.half(at + 2 * channel) / there - 1.0));
    }
    CHECK(file.half(at + 6) == 1.0);
  }
  return most;
}

}  // namespace

TEST_CASE("bake --for playcanvas: each rectangle of the atlas holds what the shader reads there, at every size",
          "[tools][bake][playcanvas][slow]") {
  const TemporaryDirectory scratch;
  const auto source = scratch.path() / "source.pfm";
  write_source(source, playcanvas_direction);
  for (const auto& [size, atlas_size] : std::map<int, int>{{64, 512}, {256, 512}, {512, 1024}, {800, 1536}}) {
    INFO("--size " << size);
    const auto folder = scratch.path() / std::to_string(size);
    bake_into(folder, quoted(source) + " --for playcanvas --no-previews --size " + std::to_string(size));
    const Atlas atlas(folder);
    REQUIRE(atlas.size == atlas_size);
    for (int level = 0; level < 6; ++level) {
      INFO("shiny level " << level);
      CHECK(farthest(atlas, shiny(level), Light(), 6) < (size < 256 ? 3.0 : 1.0));  // 64 texels hold less than it has
    }
    for (int level = 1; level < 6; ++level) {
      INFO("rough level " << level);
      // Interpolated between the mip's texels, so that its curvature is left out; roughness 1 comes from the diffuse
      // map.
      const double edge = level == 5 ? 32.0 : size >> level;
      CHECK(farthest(atlas, rough(level), Light::at_roughness(level / 5.0), 1) < 1.0 + 120.0 / (edge * edge));
    }
    CHECK(farthest(atlas, kAmbient, Light::at_roughness(1.0), 1) < 1.0);
  }
}

TEST_CASE("bake --for playcanvas: an atlas that is turned, mirrored or of PlayCanvas' own roughness is told from ours",
          "[tools][bake][playcanvas][slow]") {
  const TemporaryDirectory scratch;
  const auto source = scratch.path() / "source.pfm";
  const auto atlas_of = [&](const std::string& options) {
    bake_into(scratch.path() / "out", quoted(source) + " --for playcanvas --no-previews " + options);
    return Atlas(scratch.path() / "out");
  };
  write_source(source, playcanvas_direction, kSmallSourceHeight);
  for (const std::string wrong : {"--mirror", "--yaw 90", "--rotation 0,0,1,0"}) {
    INFO(wrong);
    const Atlas atlas = atlas_of("--size 64 " + wrong);
    CHECK(farthest(atlas, shiny(1), Light(), 1) > 20.0);
    CHECK(farthest(atlas, rough(5), Light::at_roughness(1.0), 1) > 20.0);
    CHECK(farthest(atlas, kAmbient, Light::at_roughness(1.0), 1) > 20.0);
  }
  write_source(source, playcanvas_direction);
  const Atlas atlas = atlas_of("--size 256 --roughness 0,0.18,0.36,0.55,0.73,0.91");
  for (int level = 1; level < 5; ++level)
    CHECK(farthest(atlas, rough(level), Light::at_roughness(level / 5.0), 1) > 1.5);
}

TEST_CASE("bake --for playcanvas: light above 64 is clamped and counted, and the asset says how the image is loaded",
          "[tools][bake][playcanvas]") {
  const TemporaryDirectory scratch;
  const auto source = scratch.path() / "source.pfm";
  write_source(source, playcanvas_direction, kSmallSourceHeight, 10.0);  // 25 to 95
  const nlohmann::json manifest =
      bake_into(scratch.path() / "out", quoted(source) + " --for playcanvas --no-previews --size 32 --irradiance 8");
  CHECK(file_of(manifest, "env_atlas.png").at("values_clamped").get<std::uint64_t>() > 0);
  const Atlas atlas(scratch.path() / "out");
  double brightest = 0.0;
  for (std::size_t texel = 0; texel < atlas.rgba.size(); texel += 4) {
    for (std::size_t channel = 0; channel < 3; ++channel)
      brightest =
          std::max(brightest, atlas.rgba[texel + channel] / 255.0 * (8.0 - 7.0 * atlas.rgba[texel + 3] / 255.0));
  }
  CHECK(brightest == 8.0);
  const nlohmann::json asset = json_of(file_text(scratch.path() / "out" / "env_atlas.json"));
  CHECK(asset.at("type") == "texture");
  CHECK(asset.at("file").at("url") == "env_atlas.png");
  CHECK(asset.at("data").at("type") == "rgbp");
  CHECK(asset.at("data").at("mipmaps") == false);
  for (const char* axis : {"addressu", "addressv"}) CHECK(asset.at("data").at(axis) == "clamp");
}

TEST_CASE("bake --for qt: the light probe's mips, key and faces are those that Qt's shader looks up",
          "[tools][bake][qt][slow]") {
  const TemporaryDirectory scratch;
  const auto source = scratch.path() / "source.pfm";
  write_source(source, qt_direction);
  for (const int size : {32, 64, 256}) {
    INFO("--size " << size);
    const std::string name = std::to_string(size);
    const auto folder = scratch.path() / name;
    bake_into(folder, quoted(source) + " --for qt --no-previews --size " + name);
    const Ktx file(file_text(folder / "environment.ktx"));
    CHECK(file.keys.contains("QT_IBL_BAKER_VERSION"));
    // byte order, GL_HALF_FLOAT of 2 bytes, GL_RGBA, GL_RGBA16F, GL_RGBA, no depth, no array, a cubemap
    const std::array<std::uint32_t, 11> wanted{0x04030201,     0x140B,         2, 0x1908, 0x881A, 0x1908,
                                               file.header[6], file.header[6], 0, 0,      6};
    CHECK(std::equal(wanted.begin(), wanted.end(), file.header.begin()));
    CHECK(file.header[6] == static_cast<std::uint32_t>(size));
    const int mips = static_cast<int>(file.mips.size());
    CHECK(mips == (size == 32 ? 6 : 7));
    // The last mip is diffuse light, and reflections of roughness 1 end at the one before.
    for (int mip = 0; mip < mips; ++mip) {
      INFO("mip " << mip);
      CHECK(farthest(file, mip, Light::at_roughness(std::min(1.0, mip / 5.0))) < (mip == 0 ? 0.01 : 0.002));
    }
  }
  bake_into(scratch.path() / "wrong", quoted(source) + " --for qt --no-previews --size 64 --mirror");
  CHECK(farthest(Ktx(file_text(scratch.path() / "wrong" / "environment.ktx")), 6, Light::at_roughness(1.0)) > 0.2);
}
