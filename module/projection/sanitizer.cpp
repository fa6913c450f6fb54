#include "projection/sanitizer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>

#include "image/pixels.h"
#include "platform/text.h"
#include "projection/projection_kernels.h"
#include "welkin/core.h"

namespace welkin::projection {
namespace {

constexpr float kLargestHalf = 65504.0F;
constexpr float kLargestFloat = std::numeric_limits<float>::max();

void keep_first(std::optional<RejectedTexel>& first, const RejectedTexel& candidate) noexcept {
  if (!first || candidate.before(*first)) first = candidate;
}

}  // namespace

bool RejectedTexel::before(const RejectedTexel& other) const noexcept {
  return std::tie(face, row, column) < std::tie(other.face, other.row, other.column);
}

void SanitizeRecord::add(const SanitizeRecord& other) noexcept {
  nans += other.nans;
  infinities += other.infinities;
  negatives += other.negatives;
  clamped += other.clamped;
  radiance_removed += other.radiance_removed;
  if (other.rejected) keep_first(rejected, *other.rejected);
}

Sanitizer::Sanitizer(const PixelPolicy& policy)
    : policy_(policy),
      infinity_replacement_(policy.clamp ? policy.clamp->maximum : kLargestHalf),
      low_(-kLargestFloat),
      high_(policy.clamp ? policy.clamp->maximum : kLargestFloat) {
  const bool clamp_lifts_negatives = policy.clamp && !policy.clamp->preserve_colour;
  if (policy.negative != NegativePolicy::keep || clamp_lifts_negatives) low_ = 0.0F;
  looks_at_every_texel_ = policy.gamma || policy.clamp.has_value() || policy.negative != NegativePolicy::keep;
}

bool Sanitizer::may_change(PixelFormat format, const float* rgb, int count) const noexcept {
  if (policy_.gamma) return true;
  if (image::is_eight_bit(format) && low_ <= 0.0F && high_ >= 1.0F) return false;
  return projection_kernels().any_outside(rgb, 3 * count, low_, high_);
}

void Sanitizer::sanitize_channel(float& value, int texel, const TexelRun& run, SanitizeRecord& record) const noexcept {
  const auto reject = [&](RejectedTexel::Kind kind) {
    keep_first(record.rejected, {run.face, run.row, run.first_column + texel, kind});
  };
  if (std::isnan(value)) {
    if (policy_.nan == NonFinitePolicy::reject) reject(RejectedTexel::Kind::nan);
    ++record.nans;
    value = 0.0F;
  } else if (std::isinf(value)) {
    if (policy_.infinity == NonFinitePolicy::reject) reject(RejectedTexel::Kind::infinity);
    ++record.infinities;
    value = value > 0.0F ? infinity_replacement_ : 0.0F;
  } else if (value < 0.0F && policy_.negative != NegativePolicy::keep) {
    if (policy_.negative == NegativePolicy::reject) reject(RejectedTexel::Kind::negative);
    ++record.negatives;
    value = 0.0F;
  }
  if (policy_.gamma) value = static_cast<float>(image::power_2_2(std::clamp(static_cast<double>(value), 0.0, 1.0)));
}

bool Sanitizer::clamp(float* rgb) const noexcept {
  if (!policy_.clamp) return false;
  const float maximum = policy_.clamp->maximum;
  if (policy_.clamp->preserve_colour) {
    const float brightest = std::max({rgb[0], rgb[1], rgb[2]});
    if (!(brightest > maximum)) return false;
    const double factor = static_cast<double>(maximum) / static_cast<double>(brightest);
    for (int c = 0; c < 3; ++c) rgb[c] = static_cast<float>(rgb[c] * factor);
    return true;
  }
  bool changed = false;
  for (int c = 0; c < 3; ++c) {
    const float bounded = std::clamp(rgb[c], 0.0F, maximum);
    changed |= bounded != rgb[c];
    rgb[c] = bounded;
  }
  return changed;
}

void Sanitizer::sanitize(const TexelRun& run, SanitizeRecord& record) const noexcept {
  for (int i = 0; i < run.count; ++i) {
    float* const rgb = run.rgb + static_cast<std::ptrdiff_t>(3) * i;
    for (int c = 0; c < 3; ++c) sanitize_channel(rgb[c], i, run, record);
    const glm::dvec3 before(rgb[0], rgb[1], rgb[2]);
    if (!clamp(rgb)) continue;
    ++record.clamped;
    if (run.weights == nullptr) continue;
    const double weight = static_cast<double>(run.weights[i * run.weight_step]) * run.weight_scale;
    record.radiance_removed += weight * (before - glm::dvec3(rgb[0], rgb[1], rgb[2]));
  }
}

void throw_if_rejected(const SanitizeRecord& record, bool cubemap) {
  if (!record.rejected) return;
  static constexpr std::array<const char*, 6> faces{"+X", "-X", "+Y", "-Y", "+Z", "-Z"};
  static constexpr std::array<const char*, 3> kinds{"is NaN", "is infinite", "is negative"};
  static constexpr std::array<const char*, 3> options{"nan", "infinity", "negative"};
  const RejectedTexel& texel = *record.rejected;
  const auto kind = static_cast<std::size_t>(texel.kind);
  const std::string face =
      cubemap ? "face " + std::string(faces[static_cast<std::size_t>(texel.face)]) + ", " : std::string();
  throw Error(ErrorCode::rejected_pixel, "a channel of the texel at " + face + "row " + std::to_string(texel.row) +
                                             ", column " + std::to_string(texel.column) + " " + kinds[kind] +
                                             "; set the policy '" + options[kind] +
                                             "' to replace such values instead of rejecting them");
}

namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::invalid_argument, message); }

}  // namespace

void check_options(const ProjectionOptions& options) {
  image::require_range("bands", options.bands, 1, kMaximumBands);
  if (options.target_size) image::require_range("target_size", *options.target_size, 1, image::kLargestFace);
  check_policy(options.pixels);
}

void check_policy(const PixelPolicy& policy) {
  if (!policy.clamp) return;
  const float maximum = policy.clamp->maximum;
  if (!(maximum > 0.0F) || std::isinf(maximum)) {
    refuse("the clamp's maximum is " + platform::number_text(maximum) +
           "; it must be above 0 and finite (no clamp is off)");
  }
}

}  // namespace welkin::projection
