// The light that a report is measured on, and the same pixels in every format that Welkin reads.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "welkin/image.h"

namespace welkin::report {

struct ReportEnvironment {
  std::string name;
  LatLongImage image;  ///< twice as wide as high
};

/// A made-up place with what is hard in real ones: a sun 1.2 degrees across that is 40 000 times the mean of the sky
/// and most of the light, two bright windows with sharp edges, a smooth sky, a dark ground with grain. Nearly the same
/// light at any width: from 512 on within a tenth, which is what the sun's few texels make.
[[nodiscard]] ReportEnvironment built_in_environment(int width);

/// A file's lat-long, resampled to `width` x width / 2 by area; a cubemap is turned to one. Throws what
/// `read_environment` throws.
[[nodiscard]] ReportEnvironment environment_from(const std::filesystem::path& path, int width);

/// "rgb32f", "rgba32f", "rgba16f", "rgb16f", "rgb8", "rgb8srgb", ...
[[nodiscard]] std::string name(PixelFormat format);

/// A cubemap's pixels in another format: halves by GLM, at most 65504; bytes rounded to nearest from values clamped to
/// 0 to 1; alpha is 1.
class FormattedCubemap {
 public:
  FormattedCubemap(const Cubemap& image, PixelFormat format);
  [[nodiscard]] CubemapView view() const noexcept;

 private:
  int size_;
  PixelFormat format_;
  std::vector<std::byte> bytes_;
};

}  // namespace welkin::report
