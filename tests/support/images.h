// Images that tests make, and the real ones where they are at hand.
#pragma once

#include "image/geometry.h"
#include "places.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/temporary_directory.h"
#include "welkin/image.h"
#include "welkin/resampling.h"

namespace welkin::test {

inline const std::filesystem::path kImages = std::filesystem::path(WELKIN_SHARED) / "hdr";
inline const std::filesystem::path kVariants = kImages / "variants";

/// Says so if they are not.
inline bool shared_images_are_here() {
  if (std::filesystem::exists(kVariants / "truth_256x128.npy")) return true;
  WARN("left out: the shared images are not at " << kImages);
  return false;
}

/// What REFERENCE_SH.csv of the shared images has of a kind, by file name: names and values, in its order. Its lines
/// are file,kind,name,r,g,b,note; a kind with commas stands in quotes.
inline std::map<std::string, std::vector<std::pair<std::string, glm::dvec3>>> recorded_harmonics(
    const std::string& kind) {
  std::map<std::string, std::vector<std::pair<std::string, glm::dvec3>>> found;
  std::ifstream lines(kImages / "REFERENCE_SH.csv");
  for (std::string line; std::getline(lines, line);) {
    if (line.find(kind) == std::string::npos) continue;
    const std::filesystem::path file = line.substr(0, line.find(','));
    const std::size_t quoted = line.find("\",");
    std::istringstream fields(
        line.substr(quoted != std::string::npos ? quoted + 2 : line.find(',', line.find(',') + 1) + 1));
    std::string name;
    glm::dvec3 value{};
    char comma = 0;
    std::getline(fields, name, ',');
    fields >> value.x >> comma >> value.y >> comma >> value.z;
    found[file.filename().string()].emplace_back(name, value);
  }
  return found;
}

/// The values of a version 1 .npy file of little-endian floats in C order; its shape is the caller's to know.
inline std::vector<float> read_npy(const std::filesystem::path& path) {
  const std::vector<char> bytes = read_bytes(path);
  constexpr std::size_t kPrefix = 10;  // magic, version, header length
  if (bytes.size() < kPrefix || std::string(bytes.data() + 1, 5) != "NUMPY" || bytes[6] != 1) {
    throw std::runtime_error("not a version 1 .npy file");
  }
  const std::size_t header = static_cast<unsigned char>(bytes[8]) + 256U * static_cast<unsigned char>(bytes[9]);
  const std::string description(bytes.data() + kPrefix, header);
  if (description.find("'<f4'") == std::string::npos || description.find("False") == std::string::npos) {
    throw std::runtime_error("not little-endian floats in C order: " + description);
  }
  std::vector<float> values((bytes.size() - kPrefix - header) / sizeof(float));
  std::memcpy(values.data(), bytes.data() + kPrefix + header, values.size() * sizeof(float));
  return values;
}

/// The mean, over all pixels, of the gradient of log2 luminance: stops a pixel. Blur lowers it.
inline double sharpness(const LatLongView& image) {
  const auto* const pixels = static_cast<const float*>(image.pixels);
  const auto stops = [&](int column, int row) {
    const float* const rgb = pixels + (static_cast<std::ptrdiff_t>(row) * image.width + column % image.width) * 3;
    const double luminance = 0.2126 * static_cast<double>(rgb[0]) + 0.7152 * static_cast<double>(rgb[1]) +
                             0.0722 * static_cast<double>(rgb[2]);
    return std::log2(std::max(luminance, 1e-6));
  };
  double sum = 0.0;
  for (int row = 0; row + 1 < image.height; ++row) {
    for (int column = 0; column < image.width; ++column) {
      const double here = stops(column, row);
      sum += std::hypot(stops(column + 1, row) - here, stops(column, row + 1) - here);
    }
  }
  return sum / (static_cast<double>(image.height - 1) * image.width);
}

/// A lat-long whose texels hold the function at their centres.
inline LatLongImage lat_long_of(int width, int height, const std::function<glm::dvec3(const glm::dvec3&)>& radiance) {
  LatLongImage image{width, height, {}};
  for (int row = 0; row < height; ++row) {
    const double latitude = std::numbers::pi * (0.5 - (row + 0.5) / height);
    for (int column = 0; column < width; ++column) {
      const double longitude = std::numbers::pi * (1.0 - 2.0 * (column + 0.5) / width);
      const glm::dvec3 value = radiance(
          {std::sin(longitude) * std::cos(latitude), std::sin(latitude), std::cos(longitude) * std::cos(latitude)});
      for (int c = 0; c < 3; ++c) image.pixels.push_back(static_cast<float>(value[c]));
    }
  }
  return image;
}

/// Unit directions of the centres of a cubemap's texels, in the order of its pixels.
inline std::vector<glm::dvec3> texel_centres(int size) {
  std::vector<glm::dvec3> centres;
  for (int row = 0; row < 6 * size; ++row) {
    for (int column = 0; column < size; ++column)
      centres.push_back(image::face_direction(size, row / size, column + 0.5, row % size + 0.5));
  }
  return centres;
}

/// A cubemap of one level, the same.
inline Cubemap cubemap_of(int size, const std::function<glm::dvec3(const glm::dvec3&)>& radiance) {
  std::vector<float> pixels;
  for (const glm::dvec3& centre : texel_centres(size)) {
    const glm::dvec3 value = radiance(centre);
    for (int c = 0; c < 3; ++c) pixels.push_back(static_cast<float>(value[c]));
  }
  return {size, pixels};
}

/// Noise of 0.5 to 1, and a coloured disc three texels wide that reaches 50 000.
inline Cubemap sun_chain(int size) {
  Cubemap sky(size, 1);
  std::uint32_t state = 7;
  for (int k = 0; k < 18 * size * size; ++k) {
    state = 1664525U * state + 1013904223U;
    sky.face(0, 0)[k] = 0.5F + 0.5F * static_cast<float>(state >> 8U) / 16777216.0F;
  }
  for (int row = 0; row < size; ++row) {
    for (int column = 0; column < size; ++column) {
      const float x = static_cast<float>(column - size / 2) - 0.3F;
      const float y = static_cast<float>(row - size / 2) + 0.6F;
      float* const rgb = sky.face(0, 2) + std::ptrdiff_t{3} * (row * size + column);
      const float light = 50000.0F / (1.0F + (x * x + y * y) * (x * x + y * y));
      rgb[0] += light;
      rgb[1] += light * (0.55F + 0.07F * x);
      rgb[2] += light * (0.21F - 0.03F * y);
    }
  }
  return build_mips(sky.view(0));
}

}  // namespace welkin::test
