// Lobes from a point to the whole hemisphere: roughness 0, 1e-6, 1e-3, about the change of methods, 1.
#include <array>
#include <cmath>

#include "report/stability/cases.h"
#include "report/stability/maps.h"
#include "report/stability/measures.h"
#include "welkin/roughness.h"
#include "welkin/specular.h"

namespace welkin::report::stability {
namespace {

PrefilteredSpecular prefiltered(const CubemapImage& source, int size, double roughness, PrefilterMethod method) {
  PrefilterOptions options{.size = size};
  options.roughness = {roughness};
  options.method = method;
  return prefilter_specular(source.view(), options);
}

double error_of(double roughness, int size, PrefilterMethod method) {
  const CubemapImage source = noise_cube(16, 12);
  return worst_relative_error(texels(prefiltered(source, size, roughness, method).cubemap, 0),
                              reference_specular(source.view(), roughness, texel_directions(size)));
}

/// Of lobes narrower than a texel, at the source's own size.
double narrow_error(double roughness) {
  const CubemapImage source = noise_cube(8, 12);
  return rms_error(texels(prefiltered(source, 8, roughness, PrefilterMethod::automatic).cubemap, 0),
                   reference_specular(source.view(), roughness, texel_directions(8)));
}

/// How far a texel leaves the range of the source's, 1 to 1000, over the end that it leaves.
double outside_of_range(double roughness, PrefilterMethod method) {
  const CubemapImage source = with_texel(uniform_cube(16, 1.0F), 300, 1000.0F);
  double worst = 0.0;
  for (const glm::dvec3& texel : texels(prefiltered(source, 16, roughness, method).cubemap, 0)) {
    worst = worse(worst, worse(1.0 - texel.x, texel.x / 1000.0 - 1.0));
  }
  return worst;
}

double copy_differs() {
  const CubemapImage source = noise_cube(32, 12);
  const PrefilteredSpecular found = prefiltered(source, 32, 0.0, PrefilterMethod::automatic);
  double wrong = 0.0;
  for (std::size_t k = 0; k < source.pixels.size(); ++k)
    wrong += wrong_if(found.cubemap.face(0, 0)[k] != source.pixels[k]);
  return wrong;
}

/// The truth of a lobe far narrower than a texel is the texel it points at.
double narrow_truth(double roughness) {
  const CubemapImage source = noise_cube(8, 12);
  const std::vector<glm::dvec3> truth = reference_specular(source.view(), roughness, texel_directions(8));
  std::vector<glm::dvec3> values;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    values.emplace_back(source.pixels[3 * k], source.pixels[3 * k + 1], source.pixels[3 * k + 2]);
  }
  return worst_relative_error(truth, values);
}

double schedules_unsound() {
  double wrong = 0.0;
  for (const RoughnessSchedule schedule :
       {RoughnessSchedule::linear, RoughnessSchedule::filament, RoughnessSchedule::babylon}) {
    for (const int mips : {1, 2, 16}) {
      for (const int size : {1, 2, 256, 8192}) {
        const std::vector<double> table = roughness_of_mips(schedule, mips, size);
        wrong += wrong_if(table.front() != 0.0 || table.size() != static_cast<std::size_t>(mips));
        for (std::size_t k = 0; k < table.size(); ++k) {
          wrong += wrong_if(!(table[k] >= 0.0 && table[k] <= 1.0) || (k > 0 && table[k] < table[k - 1]));
        }
      }
    }
  }
  return wrong;
}

struct Roughness {
  const char* text;
  double value;
};

}  // namespace

void add_roughness_cases(StabilityCases& cases) {
  cases.push_back({"roughness/0", "roughness 0 at the source's size is a copy", "the source, bit for bit",
                   StabilityUnit::count, 0.0, [](const Control&) { return copy_differs(); }});
  const std::string narrow =
      "Below roughness 0.055 no method but `reference` is held to the bounds (specular.h): the samples blur by about a "
      "texel of the source. Use roughness 0 for such a mip, or a chain whose first rough mip is above 0.055.";
  constexpr std::array<Roughness, 7> all{
      {{"1e-6", 1e-6}, {"1e-3", 1e-3}, {"0.05", 0.05}, {"0.06", 0.06}, {"0.1", 0.1}, {"0.999", 0.999}, {"1", 1.0}}};
  for (const Roughness& r : all) {
    const bool is_narrow = r.value < 0.055;
    cases.push_back({std::string("roughness/automatic-") + r.text,
                     is_narrow ? std::string("faces of 8 of noise at roughness ") + r.text + ", rms (rms_error)"
                               : std::string("every texel of 4 x 4 faces of noise of 16 at roughness ") + r.text +
                                     " (maximum_error)",
                     "reference_specular (double)", StabilityUnit::relative, is_narrow ? 1e-3 : 1e-2,
                     [r, is_narrow](const Control&) {
                       return is_narrow ? narrow_error(r.value) : error_of(r.value, 4, PrefilterMethod::automatic);
                     },
                     is_narrow ? narrow : ""});
    cases.push_back({std::string("roughness/range-") + r.text,
                     std::string("one texel of 1000 over 1 at roughness ") + r.text +
                         ": nothing below 1 or above 1000 by more than maximum_error of it",
                     "the source's range", StabilityUnit::relative, 1e-2,
                     [r](const Control&) { return outside_of_range(r.value, PrefilterMethod::automatic); }});
  }
  for (const Roughness& r : {Roughness{"1e-3", 1e-3}, {"0.1", 0.1}, {"1", 1.0}}) {
    cases.push_back({std::string("roughness/reference-") + r.text,
                     std::string("method `reference` at roughness ") + r.text + " is the truth, in float",
                     "reference_specular (double)", StabilityUnit::relative, 1e-7,
                     [r](const Control&) { return error_of(r.value, 4, PrefilterMethod::reference); }});
    cases.push_back(
        {std::string("roughness/sampled-range-") + r.text,
         std::string("one texel of 1000 over 1 by samples at roughness ") + r.text + ": nothing below 1 or above 1000",
         "the source's range", StabilityUnit::relative, 1e-6,
         [r](const Control&) { return outside_of_range(r.value, PrefilterMethod::sampled); }});
  }
  for (const Roughness& r : {Roughness{"1e-6", 1e-6}, {"1e-3", 1e-3}, {"0.01", 0.01}}) {
    cases.push_back({std::string("roughness/narrow-truth-") + r.text,
                     std::string("the truth itself at roughness ") + r.text + " is the texel it points at",
                     "the source's texels", StabilityUnit::relative, 1e-2,
                     [r](const Control&) { return narrow_truth(r.value); }});
  }
  cases.push_back({"roughness/schedules", "every schedule rises from 0 and stays in [0, 1], for 1 to 16 mips",
                   "its definition", StabilityUnit::count, 0.0, [](const Control&) { return schedules_unsound(); }});
}

}  // namespace welkin::report::stability
