// The suite: all cases in order, each measured or caught.
#include "stability/cases.h"
#include "stability/stability.h"
#include "standard_headers.h"
#include "welkin/core.h"

namespace welkin::test {
namespace {

struct Subject {
  StabilitySubject words;
  void (*add)(stability::StabilityCases&);
};

constexpr std::array<Subject, 15> kSubjects{
    {{{"range", "Projection to spherical harmonics of maps with extreme values."}, stability::add_range_cases},
     {{"image-range",
       "Mips, resampled and prefiltered maps with extreme values. \"Each texel\" is the largest error over "
       "the truth at that texel; rms is the error of a mip as a whole."},
      stability::add_image_range_cases},
     {{"cancellation", "Sums whose terms are large and whose result is small."}, stability::add_cancellation_cases},
     {{"accumulation", "Sums over 256 to 400 million texels: errors must not grow with their number."},
      stability::add_accumulation_cases},
     {{"policies", "NaN, infinities and negatives: each policy does what it says, in every pass that reads pixels."},
      stability::add_policy_cases},
     {{"sizes", "Maps, tables and chains of 1 and 2 texels."}, stability::add_size_cases},
     {{"roughness", "Lobes from a point to the whole hemisphere."}, stability::add_roughness_cases},
     {{"grazing", "Cosine and GGX kernels over a sphere that is lit above the horizon only."},
      stability::add_grazing_cases},
     {{"brdf", "The split sum's table at grazing views (DFG)."}, stability::add_brdf_cases},
     {{"windows", "Least windows that are hard to find, by light that is hardly or nearly all negative."},
      stability::add_window_cases},
     {{"rotation", "Turns of coefficients."}, stability::add_rotation_cases},
     {{"sky-rays", "Rays that graze a planet; the horizon from both sides."}, stability::add_sky_ray_cases},
     {{"sky-sun", "Suns from the zenith to the nadir. Tables of single scattering with 8 heights, unless stated."},
      stability::add_sky_sun_cases},
     {{"sky-air", "Air of any density and height, lobes of any sharpness, many orders."}, stability::add_sky_air_cases},
     {{"sky-planet", "Planets of any size, seen from the ground to far away."}, stability::add_sky_planet_cases}}};

StabilityResult measured(const std::string& subject, const stability::StabilityCase& one) {
  StabilityResult result{one.name,       subject,         one.promise, one.truth,        0.0,
                         one.terms.unit, one.terms.bound, false,       one.terms.advice, {}};
  try {
    result.measured = one.measure();
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

std::vector<StabilitySubject> stability_subjects() {
  std::vector<StabilitySubject> subjects;
  for (const Subject& subject : kSubjects) subjects.push_back(subject.words);
  return subjects;
}

std::vector<StabilityResult> run_stability(const std::string& subject, bool quick) {
  stability::StabilityCases cases(subject);
  for (const Subject& known : kSubjects) {
    if (subject == known.words.name) known.add(cases);
  }
  std::vector<StabilityResult> results;
  for (const stability::StabilityCase& one : cases.all()) {
    if (!quick || one.terms.effort != stability::Effort::full) results.push_back(measured(subject, one));
  }
  return results;
}

}  // namespace welkin::test
