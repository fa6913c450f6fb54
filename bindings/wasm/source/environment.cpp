// Files in memory: the whole of image-based lighting in one call.
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "interface.h"
#include "light.h"
#include "welkin/environment_file.h"
#include "welkin/projection.h"

namespace welkin::wasm {
namespace {

/// A width of 0: the bytes are a file's. Otherwise they are packed RGB floats that another module unpacked, of a
/// cubemap if the height is 0.
enum FileOption { kFileBytes, kFileLength, kFileName, kFileLayout, kFileWidth, kFileHeight, kFileSun, kFilePolicy };
constexpr int kFileLight = kFilePolicy + kPolicyOptions;

void give_sun(const std::optional<Sun>& sun) {
  std::vector<double> numbers;
  if (sun) {
    numbers = {sun->direction.x,  sun->direction.y,  sun->direction.z,           sun->irradiance.x,
               sun->irradiance.y, sun->irradiance.z, sun->angular_radius_degrees};
  }
  give(std::move(numbers));
}

/// Bakes a lat-long, whose pixels may be moved from. Returns the extracted sun.
template <class Done>
std::optional<Sun> bake_wide(LatLongView view, const Options& options, const Done& done) {
  LatLongImage image;
  std::optional<Sun> sun;
  if (options.flag(kFileSun)) {
    const auto* const values = static_cast<const float*>(view.pixels);
    const auto count = std::size_t{3} * static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height);
    image = {view.width, view.height, std::vector<float>(values, values + count)};
    done();
    sun = extract_sun(image);
    view = image.view();
  }
  bake_pixels(&view, nullptr, options, kFileLight, policy_of(options, kFilePolicy), 0.2);
  return sun;
}

void bake_cube(const CubemapView& view, const Options& options) {
  bake_pixels(nullptr, &view, options, kFileLight, policy_of(options, kFilePolicy), 0.2);
}

CubemapView unpacked_cube(const float* values, int size) {
  CubemapView view{{}, size, 0, PixelFormat::rgb32f};
  const std::ptrdiff_t face_values = std::ptrdiff_t{3} * size * size;
  for (std::size_t face = 0; face < 6; ++face)
    view.faces[face] = values + static_cast<std::ptrdiff_t>(face) * face_values;
  return view;
}

/// Results behind those of `bake_pixels`: the sun that was taken out (direction, irradiance, radius in degrees), or
/// nothing; the image's width and height.
void bake_bytes(const Options& options) {
  const int width = options.whole(kFileWidth);
  const int height = options.whole(kFileHeight);
  if (width > 0) {
    const auto* const values = options.pointer<float>(kFileBytes);
    std::optional<Sun> sun;
    if (height > 0) {
      sun = bake_wide({values, width, height, 0, PixelFormat::rgb32f}, options, [] {});
    } else {
      bake_cube(unpacked_cube(values, width), options);
    }
    give_sun(sun);
    give(std::vector<double>{static_cast<double>(width), static_cast<double>(height > 0 ? height : 6 * width)});
    return;
  }
  const std::span<const std::byte> bytes(options.pointer<std::byte>(kFileBytes),
                                         static_cast<std::size_t>(options.number(kFileLength)));
  ReadOptions read;
  read.layout = static_cast<Layout>(options.whole(kFileLayout));
  read.memory_limit_bytes = kMaxBytes;
  Environment image = read_environment({bytes, options.pointer<char>(kFileName)}, read, part(0.0, 0.2));
  std::optional<Sun> sun;
  if (image.face_size() == 0) {
    sun = bake_wide(image.lat_long(), options, [&] { image.pixels.reset(); });
  } else {
    bake_cube(image.cubemap(), options);
  }
  give_sun(sun);
  give(std::vector<double>{static_cast<double>(image.info.width), static_cast<double>(image.info.height)});
}

}  // namespace
}  // namespace welkin::wasm

WELKIN_ENTRY(welkin_bake) int welkin_bake(const double* options) {
  return welkin::wasm::guarded(welkin::wasm::bake_bytes, options);
}
