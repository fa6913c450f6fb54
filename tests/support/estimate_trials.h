// How often estimates are at least the true error over many trials, and how conservative they are.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "welkin/image.h"

namespace welkin::test {

class Honesty {
 public:
  explicit Honesty(std::string what) : what_(std::move(what)) {}

  Honesty(const Honesty&) = delete;
  Honesty& operator=(const Honesty&) = delete;

  /// With WELKIN_RANDOM_TRIALS set, prints the measurements: docs/maths/reflections.md has such figures.
  ~Honesty() {
    if (std::getenv("WELKIN_RANDOM_TRIALS") == nullptr) return;
    std::printf("%-44s %5zu estimates, honest %7.3f %%, median estimate/true %6.2f, worst true/estimate %6.3f (%s)\n",
                what_.c_str(), count_, 100.0 * share(), median(), worst_, worst_case_.c_str());
  }

  /// `floor`: true errors below it are rounding and do not show how conservative the estimate is.
  void add(double truth, double estimate, const std::string& where = "", double floor = 0.0) {
    ++count_;
    if (truth <= estimate) ++honest_;
    const double ratio = truth == 0.0 ? 0.0 : truth / estimate;
    if (!(ratio <= worst_)) {
      worst_ = ratio;
      worst_case_ = where;
    }
    if (truth > floor) ratios_.push_back(estimate / truth);
  }

  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] double share() const {
    return count_ == 0 ? 0.0 : static_cast<double>(honest_) / static_cast<double>(count_);
  }
  /// Returns the median of estimate over true error.
  [[nodiscard]] double median() const {
    if (ratios_.empty()) return 0.0;
    std::vector<double> sorted = ratios_;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
  }
  /// Returns the largest true error over estimate.
  [[nodiscard]] double worst() const { return worst_; }
  [[nodiscard]] const std::string& worst_case() const { return worst_case_; }

 private:
  std::string what_;
  std::size_t count_ = 0;
  std::size_t honest_ = 0;
  double worst_ = 0.0;
  std::string worst_case_;
  std::vector<double> ratios_;
};

/// Trials by the kind of result, sorted by name.
using EstimateTrials = std::map<std::string, std::unique_ptr<Honesty>>;

struct RoughnessSpan {
  double least;
  double most;
  double rms_error = 1e-3;  ///< the requested bound
};

/// Makes `count` environments of the seeds from `seed` on (suns, noise, patterns, gradients, horizons; dark ones;
/// cubemaps of 4 to 20 texels and lat-longs of 6 to 32 rows; occasionally one of `images`, converted to such a size),
/// projects each, prefilters each to a mip of a roughness within `roughness`, and adds estimated and true errors.
/// Errors of projections are relative to the norm of the coefficients. Errors of mips, if their record has an estimate,
/// are relative to their root mean square over the sphere, at up to 192 of its texels.
void add_estimate_trials(std::uint32_t seed, int count, const RoughnessSpan& roughness,
                         const std::vector<Cubemap>& images, EstimateTrials& trials);

/// Does so with environments of each `Family` in turn, by up to nine bands. Their sources have 4 to 16 rows, with
/// `large` up to 24 and occasionally 67, 72 or 88. Where `roughness` begins below 0.1, two fifths are below that.
/// Occasionally a mip of a chain of 16 or 64 is judged, too.
void add_family_trials(std::uint32_t seed, int count, const RoughnessSpan& roughness, bool large,
                       EstimateTrials& trials);

/// Makes `count` environments of the seeds from `seed` on, of all kinds and families and of `images`, blurs each with a
/// lobe other than GGX (Charlie of 0.05 to 1, Phong and Blinn of 1 to 2000, Lambert, given spectra) to a mip of 4 to 32
/// texels, occasionally 64, within 1e-3 or 1e-4, and adds estimated and true errors. Returns how many were refused.
int add_lobe_trials(std::uint32_t seed, int count, const std::vector<Cubemap>& images, EstimateTrials& trials);

}  // namespace welkin::test
