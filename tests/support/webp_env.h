// An .env with WebP images, made from one with PNG images.
#pragma once

#include <webp/encode.h>

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "files/env.h"

namespace welkin::test {

/// Returns the file with each image encoded again, without loss. `png_env`: as `write_babylon_environment` writes it.
inline std::vector<char> with_webp_images(const std::vector<char>& png_env) {
  const auto end = std::find(png_env.begin() + 8, png_env.end(), '\0');
  nlohmann::ordered_json manifest = nlohmann::ordered_json::parse(png_env.begin() + 8, end);
  const auto payload = end + 1;
  std::vector<char> coded;
  const auto code_again = [&](nlohmann::ordered_json& entry, int size) {
    const auto from = payload + entry["position"].get<std::ptrdiff_t>();
    const std::vector<std::uint8_t> png(from, from + entry["length"].get<std::ptrdiff_t>());
    std::vector<std::uint8_t> rgba(std::size_t{4} * static_cast<std::size_t>(size * size));
    files::decode_rgba({png, size, "sound.env", "an image"}, rgba.data());
    std::uint8_t* webp = nullptr;
    const std::size_t bytes = WebPEncodeLosslessRGBA(rgba.data(), size, size, 4 * size, &webp);
    entry["position"] = coded.size();
    entry["length"] = bytes;
    coded.insert(coded.end(), webp, webp + bytes);
    WebPFree(webp);
  };
  manifest["imageType"] = "image/webp";
  const int width = manifest["width"];
  int index = 0;
  for (auto& entry : manifest["specular"]["mipmaps"]) code_again(entry, std::max(1, width >> (index++ / 6)));
  if (manifest["irradiance"].is_object() && manifest["irradiance"].contains("irradianceTexture")) {
    auto& texture = manifest["irradiance"]["irradianceTexture"];
    for (auto& entry : texture["faces"]) code_again(entry, texture["size"]);
  }
  std::string env(png_env.data(), 8);
  env += manifest.dump();
  env += '\0';
  env.append(coded.begin(), coded.end());
  return {env.begin(), env.end()};
}

}  // namespace welkin::test
