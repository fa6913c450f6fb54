// Carries a pixel policy out: NaN, infinities, negatives, gamma and too bright texels.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <optional>

#include "welkin/projection.h"

namespace welkin::projection {

/// The first texel that a policy rejects, in the order of faces, rows, columns.
struct RejectedTexel {
  int face;  ///< 0 for a lat-long
  int row;
  int column;
  enum class Kind { nan, infinity, negative } kind;

  [[nodiscard]] bool before(const RejectedTexel& other) const noexcept;
};

/// A record of what was done to the texels of a tile.
struct SanitizeRecord {
  std::uint64_t nans = 0;
  std::uint64_t infinities = 0;
  std::uint64_t negatives = 0;
  std::uint64_t clamped = 0;
  glm::dvec3 radiance_removed{};  ///< by the clamp, in units of the weights that were passed along
  std::optional<RejectedTexel> rejected;

  void add(const SanitizeRecord& other) noexcept;
};

/// A run of decoded texels and where it came from.
struct TexelRun {
  float* rgb;  ///< packed, changed in place
  int count;
  int face = 0;
  int row;
  int first_column = 0;
  const float* weights = nullptr;  ///< of each texel in the total radiance; null: what a clamp removes is not recorded
  int weight_step = 1;             ///< -1 where the run is mirrored against its weights, 0 where all have the same
  double weight_scale = 1.0;       ///< factor to all weights
};

/// A `PixelPolicy` made ready for runs of texels.
class Sanitizer {
 public:
  explicit Sanitizer(const PixelPolicy& policy);

  /// False if finite pixels pass unchanged, so that only a sum that is not finite calls for a look at them.
  [[nodiscard]] bool needs_every_texel() const noexcept { return looks_at_every_texel_; }

  /// Bounds between which a channel passes unchanged; NaN never does. Meaningless with gamma.
  [[nodiscard]] float low() const noexcept { return low_; }
  [[nodiscard]] float high() const noexcept { return high_; }

  /// False if every channel of texels that were decoded from `format` passes unchanged. Cost: a comparison a channel,
  /// nothing for eight bits, which lie between 0 and 1, unless the clamp is below 1.
  [[nodiscard]] bool may_change(PixelFormat format, const float* rgb, int count) const noexcept;

  /// Applies the policies in Babylon.js's order: NaN and infinities, gamma, clamp. Records what it did.
  void sanitize(const TexelRun& run, SanitizeRecord& record) const noexcept;

 private:
  void sanitize_channel(float& value, int texel, const TexelRun& run, SanitizeRecord& record) const noexcept;
  [[nodiscard]] bool clamp(float* rgb) const noexcept;

  PixelPolicy policy_;
  float infinity_replacement_;
  float low_;
  float high_;
  bool looks_at_every_texel_;
};

/// Throws `Error` (rejected_pixel) if the record has a rejected texel. `cubemap`: whether to name a face.
void throw_if_rejected(const SanitizeRecord& record, bool cubemap);

// Refuses what no call can work on, before any work.

/// Throws `Error` (invalid_argument) with a message that says what was found and what is allowed.
void check_options(const ProjectionOptions& options);
/// Checks a policy alone; throws the same errors.
void check_policy(const PixelPolicy& policy);

}  // namespace welkin::projection
