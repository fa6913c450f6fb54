// How honest estimates are over many trials: the share that is at least the true error, and how careful they are.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

namespace welkin::test {

class Honesty {
 public:
  explicit Honesty(std::string what) : what_(std::move(what)) {}

  Honesty(const Honesty&) = delete;
  Honesty& operator=(const Honesty&) = delete;

  /// With WELKIN_RANDOM_TRIALS set, says what was measured: docs/maths/reflections.md has such figures.
  ~Honesty() {
    if (std::getenv("WELKIN_RANDOM_TRIALS") == nullptr) return;
    std::printf("%-44s %5zu estimates, honest %7.3f %%, median estimate/true %6.2f, worst true/estimate %6.3f (%s)\n",
                what_.c_str(), count_, 100.0 * share(), median(), worst_, worst_case_.c_str());
  }

  /// `floor`: true errors below it say nothing of how careful the estimate is (they are rounding).
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
  /// Of estimate over true error.
  [[nodiscard]] double median() const {
    if (ratios_.empty()) return 0.0;
    std::vector<double> sorted = ratios_;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
  }
  /// Of true error over estimate.
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

}  // namespace welkin::test
