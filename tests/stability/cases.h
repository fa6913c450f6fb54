// A named suite that measures every promise on its hardest cases, where numbers are extreme. Errors are deterministic
// (the library gives the same bits everywhere), so a result can be compared with a recorded one.
#pragma once

#include "standard_headers.h"

namespace welkin::test::stability {

/// Unit of a measured error.
enum class StabilityUnit {
  relative,  ///< relative to the reference, or to what the promise names
  ulps,      ///< in units in the last place of the float nearest to the reference
  count,     ///< number of wrong answers: must be 0
  ratio,     ///< factor by which an error grew
};

enum class Effort { quick, full };  ///< full: not in quick runs

/// A number, and its form in names.
struct Named {
  std::string text;
  double value;
};

/// The bound of a case's error, and when it is checked.
struct Terms {
  double bound;
  StabilityUnit unit = StabilityUnit::relative;
  std::string advice{};
  Effort effort = Effort::quick;
};

/// A case to be measured.
struct StabilityCase {
  std::string name;
  std::string promise;
  std::string truth;
  Terms terms;
  std::function<double()> measure;  ///< NaN counts as infinity
};

/// A subject's cases in their order.
class StabilityCases {
 public:
  explicit StabilityCases(std::string subject) : subject_(std::move(subject)) {}

  void add(const std::string& name, const std::string& promise, const std::string& truth, const Terms& terms,
           std::function<double()> measure) {
    cases_.push_back({subject_ + "/" + name, promise, truth, terms, std::move(measure)});
  }

  /// Adds a case that counts wrong answers: there must be none.
  void add_count(const std::string& name, const std::string& promise, const std::string& truth,
                 std::function<double()> measure) {
    add(name, promise, truth, {0.0, StabilityUnit::count}, std::move(measure));
  }

  [[nodiscard]] const std::vector<StabilityCase>& all() const { return cases_; }

 private:
  std::string subject_;
  std::vector<StabilityCase> cases_;
};

// Each appends its cases.
void add_range_cases(StabilityCases& cases);
void add_image_range_cases(StabilityCases& cases);
void add_cancellation_cases(StabilityCases& cases);
void add_accumulation_cases(StabilityCases& cases);
void add_policy_cases(StabilityCases& cases);
void add_size_cases(StabilityCases& cases);
void add_roughness_cases(StabilityCases& cases);
void add_grazing_cases(StabilityCases& cases);
void add_brdf_cases(StabilityCases& cases);
void add_window_cases(StabilityCases& cases);
void add_rotation_cases(StabilityCases& cases);
void add_sky_ray_cases(StabilityCases& cases);
void add_sky_sun_cases(StabilityCases& cases);
void add_sky_air_cases(StabilityCases& cases);
void add_sky_planet_cases(StabilityCases& cases);

}  // namespace welkin::test::stability
