// What happens where numbers are extreme: a named suite that measures every promise on its hardest cases. Errors are
// deterministic (the library gives the same bits everywhere), so a result can be compared with a recorded one.
#pragma once

#include "standard_headers.h"

namespace welkin::test::stability {

/// What a number of a result counts.
enum class StabilityUnit {
  relative,  ///< error over the truth, or over what the promise names
  ulps,      ///< error in units of the last place of the float nearest to the truth
  count,     ///< answers that are wrong: 0 or it does not hold
  ratio,     ///< how many times an error grew
};

enum class Effort { quick, full };  ///< full: not in quick runs

/// A number, and what it is called in names.
struct Named {
  std::string text;
  double value;
};

/// The bound that a case's error is held to, and when.
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
