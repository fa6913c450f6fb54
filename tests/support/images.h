// Images that tests make, and the shared real ones where they are present.
#pragma once

#include "image/geometry.h"
#include "places.h"
#include "support/catch.h"
#include "support/chains.h"
#include "support/temporary_directory.h"
#include "welkin/environment_file.h"
#include "welkin/image.h"
#include "welkin/resampling.h"

namespace welkin::test {

inline const std::filesystem::path kImages = std::filesystem::path(WELKIN_SHARED) / "hdr";
inline const std::filesystem::path kVariants = kImages / "variants";

/// Prints a note if the shared images are absent.
inline bool shared_images_are_here() {
  if (std::filesystem::exists(kVariants / "truth_256x128.npy")) return true;
  WARN("left out: the shared images are not at " << kImages);
  return false;
}

/// Returns the shared lat-longs of up to 1024 columns, sorted by name; of one file type if `extension` is given.
inline std::vector<std::filesystem::path> shared_lat_longs(const std::string& extension = "") {
  std::vector<std::filesystem::path> files;
  if (!shared_images_are_here()) return files;
  for (const auto& entry : std::filesystem::directory_iterator(kImages / "env")) {
    if (!extension.empty() && entry.path().extension() != extension) continue;
    const EnvironmentInfo info = inspect_environment(entry.path());
    if (info.layout == Layout::lat_long && info.width <= 1024) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// Returns the records of a kind from the shared images' REFERENCE_SH.csv, by file name: names and values, in its
/// order. Its lines are file,kind,name,r,g,b,note; a kind with commas is quoted.
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

/// Returns the data behind the header of a version 1 .npy file, which must name this type and shape, such as '<f4' and
/// (128, 256, 3).
template <class Value>
std::vector<Value> npy_values(const std::filesystem::path& path, const std::string& type, const std::string& shape) {
  const std::string bytes = read_text(path);
  REQUIRE(bytes.size() > 10);
  CHECK(bytes.substr(0, 8) == std::string("\x93NUMPY\x01\x00", 8));
  const std::size_t header = number_at<std::uint16_t>(bytes, 8);
  CHECK((10 + header) % 64 == 0);
  CHECK(bytes.substr(10, header).find("'descr': " + type + ", 'fortran_order': False, 'shape': " + shape) !=
        std::string::npos);
  std::vector<Value> values((bytes.size() - 10 - header) / sizeof(Value));
  std::memcpy(values.data(), bytes.data() + 10 + header, values.size() * sizeof(Value));
  return values;
}

/// Returns the mean, over all pixels, of the gradient of log2 luminance, in stops per pixel. Blur lowers it.
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

/// Returns a lat-long whose texels hold the function at their centres.
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

/// Returns unit directions of the centres of a cubemap's texels, in the order of its pixels.
inline std::vector<glm::dvec3> texel_centres(int size) {
  std::vector<glm::dvec3> centres;
  for (int row = 0; row < 6 * size; ++row) {
    for (int column = 0; column < size; ++column)
      centres.push_back(image::face_direction(size, row / size, column + 0.5, row % size + 0.5));
  }
  return centres;
}

/// Returns a cubemap of one mip whose texels hold the function at their centres.
inline Cubemap cubemap_of(int size, const std::function<glm::dvec3(const glm::dvec3&)>& radiance) {
  std::vector<float> pixels;
  for (const glm::dvec3& centre : texel_centres(size)) {
    const glm::dvec3 value = radiance(centre);
    for (int c = 0; c < 3; ++c) pixels.push_back(static_cast<float>(value[c]));
  }
  return {size, pixels};
}

/// Returns noise of 0.5 to 1, and a coloured disc three texels wide that reaches 50 000.
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
