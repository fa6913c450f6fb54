// An image's pixels as the prefilter reads them: RGB floats, every one finite.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <vector>

#include "platform/memory.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/projection.h"

namespace welkin::projection {

class Sanitizer;

/// The caller's own pixels where they are RGB floats that need no change, else a sanitized copy. Rows are counted face
/// after face. The view's pixels must outlive this object.
class SanitizedSource {
 public:
  /// Reads every pixel once. Throws `Error`: rejected_pixel, cancelled.
  SanitizedSource(const EnvironmentView& view, const PixelPolicy& policy, const Control& control);

  [[nodiscard]] bool cubemap() const noexcept { return cubemap_; }
  [[nodiscard]] int columns() const noexcept { return columns_; }
  [[nodiscard]] int rows() const noexcept { return static_cast<int>(first_texels_.size()); }
  [[nodiscard]] const float* row(int row) const noexcept { return first_texels_[static_cast<std::size_t>(row)]; }

  /// The sanitized pixels: of the one kind that this is.
  [[nodiscard]] const LatLongView& lat_long() const noexcept { return lat_long_; }
  [[nodiscard]] const CubemapView& cube() const noexcept { return cube_; }
  [[nodiscard]] EnvironmentView view() const noexcept {
    return cubemap_ ? EnvironmentView(cube_) : EnvironmentView(lat_long_);
  }

  /// Largest and least channel of a row, and the mean of all its channels.
  struct RowRange {
    float least;
    float largest;
    double mean;
  };
  [[nodiscard]] const RowRange& range(int row) const noexcept { return ranges_[static_cast<std::size_t>(row)]; }
  [[nodiscard]] bool has_negatives() const noexcept { return has_negatives_; }

  /// Returns counts of texels read and replaced; total radiances stay zero, except for what a clamp removed: see
  /// `clamped_radiance`.
  [[nodiscard]] const ProjectionDiagnostics& diagnostics() const noexcept { return diagnostics_; }
  /// Integral over the sphere of what the clamp took away.
  [[nodiscard]] const glm::dvec3& clamped_radiance() const noexcept { return clamped_radiance_; }

  [[nodiscard]] std::size_t bytes() const noexcept { return copy_.bytes(); }

 private:
  /// Notes a row's range. Returns whether all its values are finite and within the sanitizer's bounds.
  bool measure(std::size_t row, const Sanitizer& sanitizer);
  /// Whether no row needs a change; notes their ranges.
  bool measure(const PixelPolicy& policy, const Control& control);
  void copy(PixelFormat format, const std::vector<const void*>& rows, const PixelPolicy& policy,
            const Control& control);
  void read(PixelFormat format, const std::vector<const void*>& rows, const PixelPolicy& policy,
            const Control& control);
  /// The rows of the copy that are marked.
  void sanitize(const std::vector<char>& suspects, const Sanitizer& sanitizer, const Control& control);

  bool cubemap_;
  int columns_ = 0;
  LatLongView lat_long_{};
  CubemapView cube_{};
  std::vector<const float*> first_texels_;
  std::vector<RowRange> ranges_;
  bool has_negatives_ = false;
  platform::AlignedBuffer<float> copy_;
  ProjectionDiagnostics diagnostics_;
  glm::dvec3 clamped_radiance_{};
};

}  // namespace welkin::projection
