// The cases, by subject.
#pragma once

#include "stability/stability.h"
#include "standard_headers.h"

namespace welkin::test::stability {

enum class Effort { quick, full };  ///< full: not in quick runs

/// A case to be measured. Its subject is what its name has before the slash.
struct StabilityCase {
  std::string name;
  std::string promise;
  std::string truth;
  StabilityUnit unit;
  double bound;
  std::function<double(const Control&)> measure;  ///< NaN counts as infinity
  std::string advice{};
  Effort effort = Effort::quick;
};

using StabilityCases = std::vector<StabilityCase>;

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
