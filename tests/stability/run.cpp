// The suite: all cases in order, each measured or caught.
#include "stability/cases.h"
#include "stability/stability.h"
#include "standard_headers.h"
#include "welkin/core.h"

namespace welkin::test {
namespace {

using stability::Effort;
using stability::StabilityCase;
using stability::StabilityCases;

struct Subject {
  const char* name;
  void (*add)(StabilityCases&);
};

constexpr std::array<Subject, 15> kSubjects{{{"range", stability::add_range_cases},
                                             {"image-range", stability::add_image_range_cases},
                                             {"cancellation", stability::add_cancellation_cases},
                                             {"accumulation", stability::add_accumulation_cases},
                                             {"policies", stability::add_policy_cases},
                                             {"sizes", stability::add_size_cases},
                                             {"roughness", stability::add_roughness_cases},
                                             {"grazing", stability::add_grazing_cases},
                                             {"brdf", stability::add_brdf_cases},
                                             {"windows", stability::add_window_cases},
                                             {"rotation", stability::add_rotation_cases},
                                             {"sky-rays", stability::add_sky_ray_cases},
                                             {"sky-sun", stability::add_sky_sun_cases},
                                             {"sky-air", stability::add_sky_air_cases},
                                             {"sky-planet", stability::add_sky_planet_cases}}};

std::string subject_of(const std::string& name) { return name.substr(0, name.find('/')); }

StabilityResult measured(const StabilityCase& one) {
  StabilityResult result{one.name, subject_of(one.name), one.promise, one.truth, 0.0, one.unit, one.bound,
                         false,    one.advice,           {}};
  try {
    result.measured = one.measure({});
  } catch (const std::exception& error) {
    result.failure = error.what();
  }
  if (std::isnan(result.measured) || !result.failure.empty()) {
    result.measured = std::numeric_limits<double>::infinity();
  }
  result.holds = result.measured <= result.bound;
  return result;
}

}  // namespace

const char* name(StabilityUnit unit) noexcept {
  switch (unit) {
    case StabilityUnit::relative: return "relative";
    case StabilityUnit::ulps: return "ulps";
    case StabilityUnit::count: return "wrong";
    case StabilityUnit::ratio: return "times";
  }
  return "";
}

std::vector<std::string> stability_subjects() {
  std::vector<std::string> names;
  names.reserve(std::size(kSubjects));
  for (const Subject& subject : kSubjects) names.emplace_back(subject.name);
  return names;
}

std::vector<StabilityResult> run_stability(const std::string& subject, bool quick) {
  StabilityCases cases;
  for (const Subject& known : kSubjects) {
    if (subject == known.name) known.add(cases);
  }
  std::vector<StabilityResult> results;
  for (const StabilityCase& one : cases) {
    if (!quick || one.effort != Effort::full) results.push_back(measured(one));
  }
  return results;
}

}  // namespace welkin::test
