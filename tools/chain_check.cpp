#include "tools/chain_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "image/geometry.h"
#include "image/pixels.h"
#include "tools/terminal.h"
#include "tools/text.h"
#include "welkin/core.h"
#include "welkin/image.h"
#include "welkin/reflections.h"
#include "welkin/resampling.h"

namespace welkin::tool {
namespace {

constexpr double kTruthError = 1e-4;
constexpr double kFitError = 1e-3;
/// Mips that are nearer to the reference of their stated roughness are not fitted.
constexpr double kExact = 1e-3;
/// Smaller relative differences of means are not reported.
constexpr double kScaleTold = 0.02;

/// Makes references of one mip: GGX or Lambert lobes, by Welkin's own prefilter.
class Truths {
 public:
  Truths(const EnvironmentView& source, const PixelPolicy& pixels, const Control& control)
      : source_(source), pixels_(pixels), control_{control.stop, {}} {}

  [[nodiscard]] Cubemap at(int size, double roughness, double rms_error, LobeFamily lobe = LobeFamily::ggx,
                           double unit = 1.0) const {
    PrefilterOptions options{.size = size, .mips = 1, .roughness = {roughness}, .lobe = lobe, .rms_error = rms_error};
    options.pixels = pixels_;
    Cubemap truth = within(options);
    if (unit != 1.0) {
      for (float& value : truth.pixels()) value *= static_cast<float>(unit);
    }
    return truth;
  }

 private:
  /// Loosens bounds that are too tight for narrow lobes of a few lamps.
  [[nodiscard]] Cubemap within(PrefilterOptions options) const {
    constexpr double kLoosest = 1e-2;
    for (;; options.rms_error *= 10.0) {
      try {
        return prefilter_specular(source_, options, control_).cubemap;
      } catch (const Error& error) {
        if (error.code() != ErrorCode::limit_exceeded || options.rms_error > 0.5 * kLoosest) throw;
      }
    }
  }

  const EnvironmentView& source_;
  const PixelPolicy& pixels_;
  Control control_;
};

/// Sums over a mip and its reference in the mip's placement, weighted by solid angle.
struct Sums {
  glm::dvec3 image{};
  glm::dvec3 truth{};
  double squared_difference = 0.0;
  double squared_truth = 0.0;

  [[nodiscard]] double rms() const {
    return squared_truth > 0.0 ? std::sqrt(squared_difference / squared_truth) : squared_difference > 0.0 ? 1.0 : 0.0;
  }
  [[nodiscard]] glm::dvec3 scale() const {
    glm::dvec3 scale(1.0);
    for (int channel = 0; channel < 3; ++channel) {
      if (truth[channel] > 0.0 && image[channel] > 0.0) scale[channel] = image[channel] / truth[channel];
    }
    return scale;
  }
};

glm::dvec3 rgb_at(const Cubemap& image, int face, int column, int row) {
  const float* rgb = image.face(face) + 3 * (static_cast<std::ptrdiff_t>(row) * image.size() + column);
  return {rgb[0], rgb[1], rgb[2]};
}

/// Calls `use(image, truth, weight, texel)` for each texel of a mip, with the reference's value there.
template <class Use>
void for_each_texel(const Cubemap& image, const Cubemap& truth, const ChainPlacement& placement, const Use& use) {
  const int size = image.size();
  const std::shared_ptr<const image::FaceSolidAngles> angles = image::FaceSolidAngles::get(size);
  for (int face = 0; face < 6; ++face) {
    for (int row = 0; row < size; ++row) {
      for (int column = 0; column < size; ++column) {
        const CubeTexel shown = shown_by(placement.faces[static_cast<std::size_t>(face)], size, column, row);
        const glm::dvec3 from = rgb_at(truth, shown.face, shown.column, shown.row);
        const std::array<int, 3>& order = placement.channels;
        use(rgb_at(image, face, column, row), glm::dvec3(from[order[0]], from[order[1]], from[order[2]]),
            angles->at(row, column), CubeTexel{face, column, row});
      }
    }
  }
}

/// Compares the image with the scaled reference.
Sums sums_of(const Cubemap& image, const Cubemap& truth, const ChainPlacement& placement,
             const glm::dvec3& scale = glm::dvec3(1.0)) {
  Sums sums;
  for_each_texel(image, truth, placement,
                 [&](const glm::dvec3& value, const glm::dvec3& expected, double weight, const CubeTexel& /*texel*/) {
                   const glm::dvec3 scaled = scale * expected;
                   const glm::dvec3 difference = value - scaled;
                   sums.image += weight * value;
                   sums.truth += weight * expected;
                   sums.squared_difference += weight * glm::dot(difference, difference);
                   sums.squared_truth += weight * glm::dot(scaled, scaled);
                 });
  return sums;
}

MipErrors errors_of(const Cubemap& image, const Cubemap& truth, const ChainPlacement& placement) {
  const Sums sums = sums_of(image, truth, placement);
  const auto sum = [](const glm::dvec3& rgb) { return rgb.x + rgb.y + rgb.z; };
  MipErrors errors{.rms = sums.rms(), .bias = sum(sums.truth) > 0.0 ? sum(sums.image) / sum(sums.truth) - 1.0 : 0.0};
  const double floor =
      std::max(0.01 * std::sqrt(sums.squared_truth / (12.0 * std::numbers::pi)), std::numeric_limits<double>::min());
  for_each_texel(image, truth, placement,
                 [&](const glm::dvec3& value, const glm::dvec3& expected, double /*weight*/, const CubeTexel& texel) {
                   for (int channel = 0; channel < 3; ++channel) {
                     const double error =
                         std::abs(value[channel] - expected[channel]) / std::max(expected[channel], floor);
                     if (error <= errors.largest) continue;
                     errors.largest = error;
                     errors.place = texel;
                   }
                 });
  return errors;
}

/// The roughness whose reference is nearest to a mip at any scale, that scale, and their difference.
struct Fit {
  double roughness = 0.0;
  glm::dvec3 scale{1.0};
  double squares = std::numeric_limits<double>::max();
  double rest = 0.0;
};

class RoughnessFit {
 public:
  RoughnessFit(const Cubemap& image, const ChainPlacement& placement, const Truths& truths)
      : image_(image), placement_(placement), truths_(truths) {}

  /// Tries several roughnesses from `minimum` up, then searches around the best by golden sections.
  Fit search(double minimum) {
    fit_ = {};
    std::vector<double> tried = {minimum};
    for (const double step : {0.0, 0.04, 0.08, 0.12, 0.17, 0.23, 0.3, 0.4, 0.5, 0.6, 0.7, 0.85, 1.0}) {
      if (step > minimum) tried.push_back(step);
    }
    std::size_t best = 0;
    for (std::size_t i = 0; i < tried.size(); ++i) {
      if (consider(tried[i])) best = i;
    }
    double low = best > 0 ? tried[best - 1] : tried[best];
    double high = best + 1 < tried.size() ? tried[best + 1] : tried[best];
    constexpr double kGolden = 0.381966011250105;
    while (high - low > 0.004) {
      const bool is_right_longer = high - fit_.roughness > fit_.roughness - low;
      const double longer = is_right_longer ? high - fit_.roughness : low - fit_.roughness;
      const double centre = fit_.roughness;
      const double next = centre + kGolden * longer;
      if (consider(next)) {
        (is_right_longer ? low : high) = centre;
      } else {
        (is_right_longer ? high : low) = next;
      }
    }
    return fit_;
  }

  /// Returns whether that roughness is better than all before.
  bool consider(double roughness, LobeFamily lobe = LobeFamily::ggx) {
    const Cubemap truth = truths_.at(image_.size(), roughness, kFitError, lobe);
    const glm::dvec3 scale = sums_of(image_, truth, placement_).scale();
    const Sums sums = sums_of(image_, truth, placement_, scale);
    worst_ = std::max(worst_, sums.rms());
    if (sums.squared_difference >= fit_.squares) return false;
    fit_ = {roughness, scale, sums.squared_difference, sums.rms()};
    return true;
  }

  [[nodiscard]] const Fit& best() const noexcept { return fit_; }
  /// Returns whether roughness made a difference: in uniform light it makes none.
  [[nodiscard]] bool is_telling() const noexcept { return worst_ > kExact && worst_ > 1.5 * fit_.rest; }

 private:
  const Cubemap& image_;
  const ChainPlacement& placement_;
  const Truths& truths_;
  Fit fit_;
  double worst_ = 0.0;
};

/// Counts NaN and infinities, and replaces them with 0.
std::uint64_t replace_odd_values(Cubemap& image) {
  std::uint64_t odd = 0;
  for (float& value : image.pixels()) {
    if (std::isfinite(value)) continue;
    value = 0.0F;
    ++odd;
  }
  return odd;
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

/// Returns pairs of faces at whose edge the relative rest is three times that of texels a few rows inside, and 1 %.
std::vector<std::string> seams_of(const Cubemap& image, const Cubemap& truth, const ChainPlacement& placement,
                                  const glm::dvec3& scale) {
  const int size = image.size();
  if (size < 8) return {};
  struct Edge {
    std::vector<double> outermost;  ///< relative squares by texel
    std::vector<double> inside;
  };
  std::array<std::array<Edge, 6>, 6> edges;  // by the texels' face and the one beyond
  const Sums sums = sums_of(image, truth, placement);
  const double floor = 1e-4 * sums.squared_truth / (4.0 * std::numbers::pi) + std::numeric_limits<double>::min();
  const int ring = size < 16 ? 2 : 3;
  for_each_texel(image, truth, placement,
                 [&](const glm::dvec3& value, const glm::dvec3& expected, double /*weight*/, const CubeTexel& texel) {
                   const glm::dvec3 difference = value / scale - expected;
                   const double rest = glm::dot(difference, difference) / (glm::dot(expected, expected) + floor);
                   const auto add = [&](int distance, int column, int row) {
                     if (distance != 0 && distance != ring) return;
                     const CubeTexel beyond = image::across_edge(size, {texel.face, column, row});
                     Edge& edge = edges[static_cast<std::size_t>(texel.face)][static_cast<std::size_t>(beyond.face)];
                     (distance == 0 ? edge.outermost : edge.inside).push_back(rest);
                   };
                   add(texel.column, -1, texel.row);
                   add(size - 1 - texel.column, size, texel.row);
                   add(texel.row, texel.column, -1);
                   add(size - 1 - texel.row, texel.column, size);
                 });
  const auto is_seam = [&](int face, int beyond) {
    const Edge& edge = edges[static_cast<std::size_t>(face)][static_cast<std::size_t>(beyond)];
    if (edge.outermost.empty()) return false;  // opposite faces
    // The median keeps a lamp from looking like a seam or hiding one.
    const double rest = median(edge.outermost);
    return rest > 9.0 * median(edge.inside) && rest > 1e-4;
  };
  std::vector<std::string> seams;
  for (int face = 0; face < 6; ++face) {
    for (int other = face + 1; other < 6; ++other) {
      if (is_seam(face, other) || is_seam(other, face)) {
        seams.push_back(std::string(face_name(face)) + '/' + face_name(other));
      }
    }
  }
  return seams;
}

/// Returns the root mean square distance between a table and the fitted roughness of the mips, without mirrors; the
/// largest number if no mip was fitted.
double distance_to(std::span<const double> table, const std::vector<MipCheck>& mips) {
  double squares = 0.0;
  int fitted = 0;
  for (std::size_t mip = 0; mip < mips.size(); ++mip) {
    if (!mips[mip].fitted || mips[mip].size < 4 || table[mip] == 0.0) continue;  // a few texels say little
    const double distance = *mips[mip].fitted - table[mip];
    squares += distance * distance;
    ++fitted;
  }
  return fitted > 0 ? std::sqrt(squares / fitted) : std::numeric_limits<double>::max();
}

/// Finds the schedule that is nearest to the fitted roughness of the mips, or the stated schedule if its lobes for
/// lookups between mips are much nearer. Such lobes are fitted to a whole chain, of which the mips may be a part: bakes
/// and checks can leave mips out.
void find_schedule(ChainCheck& check, const std::vector<double>& stated) {
  constexpr double kNear = 0.05;
  const auto mips = check.mips.size();
  const int size = check.mips.front().size;
  double minimum = kNear;
  const auto is_nearer = [&](RoughnessSchedule schedule, std::span<const double> table) {
    const double distance = distance_to(table, check.mips);
    if (distance >= minimum) return false;
    check.schedule = schedule;
    check.schedule_distance = minimum = distance;
    return true;
  };
  for (const RoughnessSchedule schedule : kRoughnessSchedules) {
    if (mips >= 3 && mips <= 16) is_nearer(schedule, mip_roughness(schedule, static_cast<int>(mips), size));
  }
  if (mips < 2 || stated.empty()) return;
  minimum = std::min(kNear, 0.5 * distance_to(stated, check.mips));
  const auto is_same = [](double a, double b) { return std::abs(a - b) < 1e-3; };
  for (const RoughnessSchedule schedule : kRoughnessSchedules) {
    int whole = size;
    for (std::size_t first = 0; whole <= image::kLargestFace; ++first, whole *= 2) {
      for (int count = static_cast<int>(first + mips); count <= full_chain_levels(whole); ++count) {
        const std::vector<double> table = mip_roughness(schedule, count, whole);
        if (!std::ranges::equal(stated, std::span(table).subspan(first, mips), is_same)) continue;
        const std::vector<double> fitted = fitted_mip_roughness(schedule, count, whole);
        const std::span<const double> lobes = std::span(fitted).subspan(first, mips);
        if (!is_nearer(schedule, lobes)) continue;
        check.fits_lookups = true;
        for (std::size_t mip = 0; mip < mips; ++mip) check.mips[mip].lobe_roughness = lobes[mip];
      }
    }
  }
}

std::string mips_words(const std::vector<std::size_t>& mips) {
  return (mips.size() == 1 ? "mip " : "mips ") + listed(mips, [](std::size_t mip) { return std::to_string(mip); });
}

void add_scale_findings(ChainCheck& check) {
  const glm::dvec3& scale = check.scale;
  const double mean = (scale.x + scale.y + scale.z) / 3.0;
  const bool is_grey =
      std::max({scale.x, scale.y, scale.z}) < (1.0 + kScaleTold) * std::min({scale.x, scale.y, scale.z});
  if (!is_grey) {
    check.findings.push_back("channels are scaled by " + significant(scale, 3));
  } else if (std::abs(mean - 1.0) > kScaleTold) {
    const std::string words = scale_words(mean);
    check.findings.push_back("scaled by " + significant(mean, 4) + (words.empty() ? "" : ": " + words + " the source"));
  }
  std::vector<std::size_t> others;
  for (std::size_t mip = 0; mip < check.mips.size(); ++mip) {
    const glm::dvec3& rgb = check.mips[mip].scale;
    if (check.mips[mip].size >= 4 && std::abs((rgb.x + rgb.y + rgb.z) / (scale.x + scale.y + scale.z) - 1.0) > 0.05) {
      others.push_back(mip);
    }
  }
  if (!others.empty()) {
    check.findings.push_back("energy: the means of " + mips_words(others) +
                             " differ from the other mips' by more than 5 %");
  }
}

void add_roughness_findings(ChainCheck& check, bool is_stated) {
  std::size_t blurred = 0;
  std::size_t plain = 0;
  for (std::size_t mip = 1; mip < check.mips.size(); ++mip) {
    if (!check.mips[mip].fitted || check.mips[mip].size < 4) continue;
    ++blurred;
    if (*check.mips[mip].fitted < 0.08) ++plain;
  }
  if (blurred > 1 && plain == blurred) {
    check.findings.emplace_back("levels are plain mips, not reflections");
    return;
  }
  if (!is_stated) return;
  for (std::size_t mip = 0; mip < check.mips.size(); ++mip) {
    const MipCheck& each = check.mips[mip];
    if (!each.fitted || std::abs(*each.fitted - each.lobe_roughness) < 0.01) continue;
    if (each.errors.rms < std::max(0.01, 2.0 * each.rest)) continue;
    check.findings.push_back("roughness of mip " + std::to_string(mip) + " is " + significant(*each.fitted, 2) +
                             ", not " + significant(each.lobe_roughness, 2));
  }
}

void add_seam_findings(ChainCheck& check) {
  for (std::size_t mip = 0; mip < check.mips.size(); ++mip) {
    const std::vector<std::string>& seams = check.mips[mip].seams;
    if (seams.empty()) continue;
    check.findings.push_back("seams of mip " + std::to_string(mip) +
                             (seams.size() == 12 ? " at all edges" : " at " + joined(seams)));
  }
}

void add_clipped_findings(ChainCheck& check) {
  for (std::size_t mip = 0; mip < check.mips.size(); ++mip) {
    if (const std::optional<double>& limit = check.mips[mip].clipped_at) {
      check.findings.push_back("values of mip " + std::to_string(mip) + " are clipped at " + significant(*limit, 4));
    }
  }
}

void add_findings(ChainCheck& check, bool is_stated) {
  std::uint64_t odd = 0;
  for (const MipCheck& mip : check.mips) odd += mip.odd_values;
  if (odd > 0) check.findings.push_back(counted(odd, "value") + (odd == 1 ? " is" : " are") + " NaN or infinite");
  if (!check.placement.is_identity()) check.findings.push_back(words_of(check.placement));
  add_clipped_findings(check);
  add_scale_findings(check);
  add_roughness_findings(check, is_stated);
  add_seam_findings(check);
}

/// Returns the largest value of a mip if clipping the reference there halves the rest at its scale or at 1 (clipped
/// values lower the means too); nothing otherwise.
std::optional<double> clipped_at(const Cubemap& image, const Cubemap& truth, const ChainPlacement& placement,
                                 const glm::dvec3& mip_scale) {
  constexpr double kTold = 0.01;
  if (image.size() < 4) return std::nullopt;
  const std::span<const float> values = image.pixels();
  const double largest = *std::max_element(values.begin(), values.end());
  for (const glm::dvec3& scale : {mip_scale, glm::dvec3(1.0)}) {
    Cubemap cut = truth;
    for (std::size_t i = 0; i < cut.pixels().size(); ++i) {
      const auto limit = static_cast<float>(largest / scale[static_cast<int>(i % 3)]);
      cut.pixels()[i] = std::min(cut.pixels()[i], limit);
    }
    const double rest = sums_of(image, truth, placement, scale).rms();
    if (rest > kTold && sums_of(image, cut, placement, scale).rms() < 0.5 * rest) return largest;
  }
  return std::nullopt;
}

/// Fits a mip without regard to the schedule.
void fit_mip(MipCheck& mip, const Cubemap& image, ChainCheck& check, const Truths& truths, double minimum,
             bool is_only_one) {
  // Many references of a large mip would take minutes.
  constexpr int kLargestFitted = 256;
  const Cubemap fitted = image.size() > kLargestFitted ? to_cubemap(image.view(), kLargestFitted) : image;
  RoughnessFit fit(fitted, check.placement, truths);
  // A mip that matches its stated roughness needs no search.
  if (mip.roughness >= 0.0 && fit.consider(mip.roughness) && fit.best().rest < kExact) {
    mip.fitted = mip.roughness;
  } else {
    fit.search(minimum);
    if (fit.is_telling()) mip.fitted = fit.best().roughness;
    if (is_only_one && fit.consider(1.0, LobeFamily::lambert)) {
      check.lobe = LobeFamily::lambert;
      mip.fitted.reset();
      const glm::dvec3& scale = fit.best().scale;
      if (scale.x + scale.y + scale.z > 3.0 * std::sqrt(std::numbers::pi)) check.unit = std::numbers::pi;
    }
  }
  mip.scale = fit.best().scale / check.unit;
  mip.rest = fit.best().rest;
}

/// Returns the placement by the reference most similar to the first mip, which may be a mirror, rough, or irradiance.
ChainPlacement find_placement(const Cubemap& image, const Truths& truths) {
  const int size = std::min(image.size(), 32);
  const Cubemap small = to_cubemap(image.view(), size);
  PlacementFit best = placement_of(small, truths.at(size, 0.0, kFitError));
  for (const double roughness : {0.3, 1.0}) {
    const PlacementFit fit = placement_of(small, truths.at(size, roughness, kFitError));
    if (fit.difference < 0.5 * best.difference) best = fit;
  }
  return best.placement;
}

}  // namespace

double ChainCheck::rms() const {
  double largest = 0.0;
  for (const MipCheck& mip : mips) largest = std::max(largest, mip.errors.rms);
  return largest;
}

std::string scale_words(double scale) {
  constexpr double kNear = 0.01;
  const auto is_near = [&](double factor) { return std::abs(scale / factor - 1.0) < kNear; };
  if (is_near(std::numbers::pi)) return "pi times";
  if (is_near(1.0 / std::numbers::pi)) return "1/pi of";
  for (int power = 1; power <= 16; ++power) {
    const double factor = std::exp2(power);
    const std::string number = std::to_string(1 << power);
    if (is_near(factor)) return number + " times";
    if (is_near(1.0 / factor)) return "1/" + number + " of";
    if (is_near(factor * std::numbers::pi)) return number + " pi times";
  }
  return "";
}

Cubemap truth_of(const ChainCheck& check, const MipCheck& mip, const EnvironmentView& source, const PixelPolicy& pixels,
                 const Control& control) {
  const Cubemap truth =
      Truths(source, pixels, control).at(mip.size, mip.lobe_roughness, kTruthError, check.lobe, check.unit);
  Cubemap placed(mip.size);
  for_each_texel(
      truth, truth, check.placement,
      [&](const glm::dvec3& /*value*/, const glm::dvec3& expected, double /*weight*/, const CubeTexel& texel) {
        float* rgb = placed.face(texel.face) + 3 * (static_cast<std::ptrdiff_t>(texel.row) * mip.size + texel.column);
        for (int channel = 0; channel < 3; ++channel) rgb[channel] = static_cast<float>(expected[channel]);
      });
  return placed;
}

ChainCheck check_chain(const ChainMips& chain, const EnvironmentView& source, const std::vector<double>& stated,
                       const PixelPolicy& pixels, const Control& control) {
  if (chain.empty()) throw Error(ErrorCode::invalid_argument, "check: there are no mips");
  if (!stated.empty() && stated.size() != chain.size()) {
    throw Error(ErrorCode::invalid_argument, "check: " + std::to_string(stated.size()) + " roughnesses for " +
                                                 std::to_string(chain.size()) + " mips");
  }
  const auto report = [&](std::size_t mip, double part) {
    if (control.stop.stop_requested()) throw Error(ErrorCode::cancelled, "check: cancelled");
    if (control.progress) control.progress((static_cast<double>(mip) + part) / static_cast<double>(chain.size()));
  };
  const Truths truths(source, pixels, control);
  ChainMips images = chain;
  ChainCheck check;
  check.mips.resize(images.size());
  for (std::size_t mip = 0; mip < images.size(); ++mip) {
    check.mips[mip].size = images[mip].size();
    check.mips[mip].odd_values = replace_odd_values(images[mip]);
    check.mips[mip].roughness = stated.empty() ? -1.0 : stated[mip];
  }
  check.placement = find_placement(images.front(), truths);

  double minimum = 0.0;  // roughness grows from mip to mip
  for (std::size_t mip = 0; mip < images.size(); ++mip) {
    report(mip, 0.0);
    fit_mip(check.mips[mip], images[mip], check, truths, minimum, images.size() == 1);
    minimum = std::max(0.0, check.mips[mip].fitted.value_or(0.0) - 0.05);
  }
  find_schedule(check, stated);
  const std::vector<double> table =
      check.schedule ? mip_roughness(*check.schedule, static_cast<int>(images.size()), images.front().size())
                     : std::vector<double>();
  for (std::size_t mip = 0; mip < images.size(); ++mip) {
    MipCheck& each = check.mips[mip];
    if (stated.empty()) each.roughness = !table.empty() ? table[mip] : each.fitted.value_or(1.0);
    if (!check.fits_lookups) each.lobe_roughness = each.roughness;
    const Cubemap truth = truths.at(each.size, each.lobe_roughness, kTruthError, check.lobe, check.unit);
    each.errors = errors_of(images[mip], truth, check.placement);
    each.rest = std::min(each.rest, each.errors.rms);  // its reference is more exact than those of the search
    const Cubemap nearest = each.fitted ? truths.at(each.size, *each.fitted, kFitError) : Cubemap();
    const Cubemap& compared = each.fitted ? nearest : truth;
    each.clipped_at = clipped_at(images[mip], truth, check.placement, each.scale);
    if (!each.clipped_at) each.seams = seams_of(images[mip], compared, check.placement, each.scale);
  }
  for (int channel = 0; channel < 3; ++channel) {
    std::vector<double> scales;
    for (const MipCheck& mip : check.mips) scales.push_back(mip.scale[channel]);
    check.scale[channel] = median(scales);
  }
  add_findings(check, !stated.empty());
  report(images.size() - 1, 1.0);
  return check;
}

}  // namespace welkin::tool
