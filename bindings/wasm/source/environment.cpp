// Files in memory and computed skies: the whole of image-based lighting in one call.
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "chains.h"
#include "env_file.h"
#include "interface.h"
#include "platform/text.h"
#include "welkin/bake.h"
#include "welkin/bake_file.h"
#include "welkin/engines.h"
#include "welkin/environment_file.h"
#include "welkin/resampling.h"
#include "welkin/sky.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::wasm {
namespace {

/// A module has at most 4 GiB. Results are copied out of it one after the other.
constexpr std::uint64_t kMostBytes = std::uint64_t{3} << 30U;

/// What a bake hands out, asked for from `first` on, behind a chain's options.
enum LightOption { kLightBands = kChainOptions, kLightEnv, kLightKtx2, kLightTexels, kLightBackground, kLightOptions };

std::vector<double> polynomial_numbers(const BabylonPolynomial& p) {
  std::vector<double> numbers;
  for (const dvec3& term : {p.x, p.y, p.z, p.xx, p.yy, p.zz, p.yz, p.zx, p.xy}) {
    numbers.insert(numbers.end(), {term.x, term.y, term.z});
  }
  return numbers;
}

/// Results: radiance; the polynomial in Babylon.js's axes; then, each empty where it was not asked for, the chain's
/// numbers, its texels, an .env file, a KTX2 file, the background's texels.
void give_light(const BakeResult& light, const Options& options, int first, std::span<const std::byte> env) {
  give(*light.radiance);
  const dmat3& into_babylon = convention(Engine::babylon).from_welkin;
  give(polynomial_numbers(light.stored_polynomial ? *light.stored_polynomial
                                                  : babylon_polynomial(turned(*light.radiance, into_babylon))));
  const bool floats = options.flag(first + kChainFloats);
  if (light.specular && options.flag(first + kLightTexels)) {
    give_chain(*light.specular, floats);
  } else {
    results().resize(results().size() + 2);
  }
  give(std::vector<std::byte>(env.begin(), env.end()));
  std::vector<std::byte> ktx2;
  if (light.specular && options.flag(first + kLightKtx2)) {
    TextureOptions texture{.format = floats ? TexelFormat::rgba32f : TexelFormat::rgba16f};
    std::string roughness;
    for (const MipRecord& mip : light.specular->mips) {
      if (!roughness.empty()) roughness += ' ';
      roughness += platform::number_text(mip.roughness);
    }
    texture.metadata["welkin.roughness"] = roughness;
    write_texture({ktx2, "environment.ktx2"}, light.specular->cubemap.views(), texture);
  }
  give(std::move(ktx2));
  if (light.background) {
    give_texels(*light.background, floats);
  } else {
    results().resize(results().size() + 1);
  }
}

BakeOptions bake_options(const Options& options, int first, const PixelPolicy& pixels) {
  BakeOptions wanted;
  wanted.background.reset();
  wanted.irradiance.reset();
  wanted.brdf.reset();
  wanted.bands = options.whole(first + kLightBands);
  wanted.pixels = pixels;
  wanted.memory_limit_bytes = kMostBytes;
  if (options.flag(first + kLightTexels) || options.flag(first + kLightKtx2)) {
    wanted.specular = prefilter_options(options, first);
  } else {
    wanted.specular.reset();
  }
  if (options.whole(first + kLightBackground) > 0) {
    require_edge("background.size", options.whole(first + kLightBackground));
    wanted.background = BackgroundOptions{.size = options.whole(first + kLightBackground), .mips = false};
  }
  return wanted;
}

/// The share of a call's progress between two others.
Control part(double from, double to) {
  Control whole = reporting();
  Control part;
  part.progress = [report = whole.progress, from, to](double share) { report(from + (to - from) * share); };
  return part;
}

void bake_pixels(const LatLongView* wide, const CubemapView* cube, const Options& options, int first,
                 const PixelPolicy& pixels, double from) {
  const bool env = options.flag(first + kLightEnv);
  const BakeOptions wanted = bake_options(options, first, pixels);
  const double middle = env ? from + 0.5 * (1.0 - from) : 1.0;
  const BakeResult light =
      wide != nullptr ? bake(*wide, wanted, part(from, middle)) : bake(*cube, wanted, part(from, middle));
  std::vector<std::byte> file;
  if (env) file = env_file({wide, cube}, options, first, pixels, *light.radiance, part(middle, 1.0));
  give_light(light, options, first, file);
}

enum FileOption { kFileBytes, kFileLength, kFileName, kFileLayout, kFileSun, kFilePolicy };
constexpr int kFileLight = kFilePolicy + kPolicyOptions;

/// Results behind those of `give_light`: the sun that was taken out (direction, irradiance, radius in degrees), or
/// nothing; the picture's width and height.
void bake_bytes(const Options& options) {
  const std::span<const std::byte> bytes(options.pointer<std::byte>(kFileBytes),
                                         static_cast<std::size_t>(options.number(kFileLength)));
  const FileInput input(bytes, options.pointer<char>(kFileName));
  ReadOptions read;
  read.layout = static_cast<Layout>(options.whole(kFileLayout));
  read.memory_limit_bytes = kMostBytes;
  Environment picture = read_environment(input, read, part(0.0, 0.2));
  const PixelPolicy pixels = policy_of(options, kFilePolicy);
  std::optional<Sun> sun;
  const double width = picture.info.width;
  const double height = picture.info.height;
  if (picture.face_size() == 0) {
    LatLongView view = picture.lat_long();
    LatLongImage image;
    if (options.flag(kFileSun)) {
      const auto values = std::size_t{3} * static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
      image = {view.width, view.height, std::vector<float>(picture.pixels.get(), picture.pixels.get() + values)};
      picture.pixels.reset();
      sun = take_out_sun(image);
      view = image.view();
    }
    bake_pixels(&view, nullptr, options, kFileLight, pixels, 0.2);
  } else {
    const CubemapView view = picture.cubemap();
    bake_pixels(nullptr, &view, options, kFileLight, pixels, 0.2);
  }
  std::vector<double> numbers;
  if (sun) {
    numbers = {sun->direction.x,  sun->direction.y,  sun->direction.z,           sun->irradiance.x,
               sun->irradiance.y, sun->irradiance.z, sun->angular_radius_degrees};
  }
  give(std::move(numbers));
  give(std::vector<double>{width, height});
}

enum SkyOption { kSkyElevation, kSkyAzimuth, kSkyAltitude, kSkyAerosol, kSkyTables, kSkySize, kSkyDisc, kSkyLight };

/// The tables of one sky at a time: a turned sun needs no new ones.
std::shared_ptr<const SkyTables> sky_tables(int aerosol, bool full, const Control& control) {
  static auto& kept = *new std::shared_ptr<const SkyTables>;
  static int kept_aerosol = -1;
  static bool kept_full = false;
  if (kept && kept_aerosol == aerosol && kept_full == full) return kept;
  SkyTableOptions tables;
  if (!full) {
    tables.heights = 8;
    tables.view_zeniths = 64;
    tables.sun_zeniths = 32;
    tables.sun_angles = 4;
    tables.orders = 2;
  }
  Atmosphere air = earth({680.0, 550.0, 440.0}, static_cast<AerosolKind>(aerosol));
  kept = std::make_shared<const SkyTables>(precompute_sky(air, tables, control));
  kept_aerosol = aerosol;
  kept_full = full;
  return kept;
}

/// Results: those of `give_light` of the sky without its disc; the sun (direction, irradiance, radius in degrees).
void compute_sky(const Options& options) {
  const auto tables = sky_tables(options.whole(kSkyAerosol), options.whole(kSkyTables) != 0, part(0.0, 0.7));
  const SkyView view(tables, options.number(kSkyAltitude));
  const dvec3 direction = sun_direction(options.number(kSkyElevation), options.number(kSkyAzimuth));
  require_edge("size", options.whole(kSkySize));
  const Cubemap faces = sky_cubemap(view, direction, options.whole(kSkySize), {.sun_disc = options.flag(kSkyDisc)});
  const CubemapView cube = faces.view();
  bake_pixels(nullptr, &cube, options, kSkyLight, {}, 0.7);
  const Sun sun = view.sun(direction);
  give(std::vector<double>{sun.direction.x, sun.direction.y, sun.direction.z, sun.irradiance.x, sun.irradiance.y,
                           sun.irradiance.z, sun.angular_radius_degrees});
}

}  // namespace
}  // namespace welkin::wasm

WELKIN_ENTRY(welkin_bake) int welkin_bake(const double* options) {
  return welkin::wasm::guarded(welkin::wasm::bake_bytes, options);
}

WELKIN_ENTRY(welkin_sky) int welkin_sky(const double* options) {
  return welkin::wasm::guarded(welkin::wasm::compute_sky, options);
}
