// Writes a page that shows spheres and a knot, which the viewer rotates, in the baked light.
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "embedded_texts.h"
#include "image/pixels.h"
#include "jobs/control.h"
#include "tools/bake_manifest.h"
#include "tools/json.h"
#include "tools/text.h"
#include "welkin/image.h"

namespace welkin::tool {
namespace {

constexpr int kLargestMip = 128, kLargestEnvironment = 256;

std::string base64(std::span<const std::byte> bytes) {
  constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8U | (k < count ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kLetters[group >> (18 - 6 * k) & 63U] : '=';
  }
  return text;
}

/// Packs nine bits per channel and one exponent for all, as WebGL's RGB9_E5. (OpenGL ES 3.0, 3.8.3.2.) NaN becomes 0.
std::uint32_t shared_exponent(const float* rgb) {
  const auto held = [](float value) { return value > 0.0F ? std::min(value, image::kLargestSharedFloat) : 0.0F; };
  return image::pack_e5b9g9r9({held(rgb[0]), held(rgb[1]), held(rgb[2])});
}

/// Returns levels of a cubemap in packed floats, starting with one of at most `largest` texels.
Json levels_json(std::vector<CubemapView> levels, int largest, std::size_t& first, const Control& control) {
  for (first = 0; first + 1 < levels.size() && levels[first].size > largest;) ++first;
  levels.erase(levels.begin(), levels.begin() + static_cast<std::ptrdiff_t>(first));
  std::vector<std::uint32_t> words;
  for (const CubemapView& level : levels) {
    jobs::throw_if_cancelled(control);
    for (const auto& face : level.faces) {
      const auto* texel = static_cast<const float*>(face);
      for (int i = 0; i < level.size * level.size; ++i, texel += 3) words.push_back(shared_exponent(texel));
    }
  }
  return {{"size", levels[0].size}, {"levels", levels.size()}, {"texels", base64(std::as_bytes(std::span(words)))}};
}

Json table_json(const BrdfTable& table) {
  std::vector<float> values;  // scale and bias, without sheen
  for (std::size_t i = 0; i < table.values.size(); i += static_cast<std::size_t>(table.channels)) {
    values.insert(values.end(), {table.values[i], table.values[i + 1]});
  }
  return {{"width", table.options.width},
          {"height", table.options.height},
          {"values", base64(std::as_bytes(std::span(values)))}};
}

}  // namespace

void write_preview_page(const BakeResult& light, const ToneMap& tone_map, const std::filesystem::path& file,
                        const Control& control) {
  std::size_t first = 0;
  Json data = {{"exposureStops", tone_map.stops()}};
  data["chain"] = levels_json(light.specular->cubemap.views(), kLargestMip, first, control);
  std::vector<double> roughness;
  for (std::size_t mip = first; mip < light.specular->mips.size(); ++mip)
    roughness.push_back(light.specular->mips[mip].roughness);
  data["roughness"] = roughness;
  std::size_t unused = 0;
  if (light.background)
    data["environment"] = levels_json(light.background->views(), kLargestEnvironment, unused, control);
  if (light.irradiance) data["irradiance"] = levels_json({light.irradiance->view()}, kLargestMip, unused, control);
  if (light.brdf) data["brdf"] = table_json(*light.brdf);
  std::string page = embedded_text("preview.html");
  constexpr std::string_view kMarker = ">DATA<";
  page.replace(page.find(kMarker) + 1, kMarker.size() - 2, data.one_line());
  write_text_file(file, page);
}

}  // namespace welkin::tool
