// Kernels with names, those of the caller's, and chains by them.
#include <algorithm>
#include <cmath>
#include <string>

#include "image/pixels.h"
#include "math/elementary.h"
#include "math/table_cache.h"
#include "platform/float_environment.h"
#include "platform/text.h"
#include "projection/sanitized_pixels.h"
#include "reflections/direct.h"
#include "reflections/lobe.h"
#include "reflections/prefilter.h"
#include "transform/spectrum.h"
#include "welkin/reflections.h"

namespace welkin {
namespace {

/// x^power for x in [0, 1].
double power_of(double x, double power) noexcept {
  if (x >= 1.0) return 1.0;
  return x > 1e-300 ? math::exponential(power * math::logarithm(x)) : (power > 0.0 ? 0.0 : 1.0);
}

void require_number(const char* what, double value, double minimum, double maximum) {
  if (value >= minimum && value <= maximum) return;
  throw Error(ErrorCode::invalid_argument, std::string(what) + " is " + platform::number_text(value) +
                                               "; it must be from " + platform::number_text(minimum) + " to " +
                                               platform::number_text(maximum));
}

std::shared_ptr<const reflections::Lobe> lobe_of(const std::function<double(double)>& value,
                                                 const std::vector<double>& breaks) {
  std::vector<double> positions;
  positions.reserve(breaks.size());
  for (const double cosine : breaks) {
    if (!(cosine > -1.0 && cosine < 1.0)) {
      throw Error(ErrorCode::invalid_argument, "a kernel's break is at the cosine " + platform::number_text(cosine) +
                                                   "; it must lie between -1 and 1");
    }
    positions.push_back(std::sqrt(0.5 * (1.0 - cosine)));
  }
  return std::make_shared<const reflections::Lobe>(value, std::move(positions));
}

/// Which function a kernel with a name is.
struct Key {
  LobeFamily family;
  double number;
  bool operator==(const Key&) const = default;
};

/// Returns the lobe of a function of cosines above 0. The latest ones are kept: their spectra and tables take longer
/// than the blur of a small mip.
template <class Value>
std::shared_ptr<const reflections::Lobe> above_horizon(const Key& key, const Value& value) {
  static auto& lobes =
      *new math::TableCache<Key, reflections::Lobe>(16 * reflections::Lobe::bytes());  // never destroyed
  return lobes.get(key, [&] { return lobe_of([&](double c) { return c > 0.0 ? value(c) : 0.0; }, {0.0}); });
}

}  // namespace

ZonalLobe ZonalLobe::charlie(double roughness) {
  const platform::FloatingPointScope floating_point;
  require_number("roughness of Charlie sheen", roughness, 0.01, 1.0);
  // With N = V the half vector is half of the angle from the axis: sin^2 h = (1 - c) / 2, and sin(h)^(1 / alpha) of
  // Estevez and Kulla's distribution is (1 - c)^(1 / (2 alpha)) but for a factor. c weighs the light.
  const double power = 0.5 / (roughness * roughness);
  return {above_horizon({LobeFamily::charlie, power},
                        [power](double cosine) { return cosine * power_of(1.0 - cosine, power); }),
          roughness};
}

ZonalLobe ZonalLobe::lambert() {
  const platform::FloatingPointScope floating_point;
  return {above_horizon({LobeFamily::lambert, 0.0}, [](double cosine) { return cosine; }), 0.0};
}

ZonalLobe ZonalLobe::phong(double power) {
  const platform::FloatingPointScope floating_point;
  require_number("the power of Phong's lobe", power, 0.5, 1e6);
  return {above_horizon({LobeFamily::phong, power}, [power](double cosine) { return power_of(cosine, power); }), 0.0};
}

ZonalLobe ZonalLobe::blinn(double power) {
  const platform::FloatingPointScope floating_point;
  require_number("the power of Blinn's lobe", power, 0.0, 1e6);
  return {above_horizon(
              {LobeFamily::blinn, power},
              [power](double cosine) { return cosine * power_of(std::min(1.0, 0.5 * (1.0 + cosine)), 0.5 * power); }),
          0.0};
}

ZonalLobe ZonalLobe::from_function(const std::function<double(double)>& value, const std::vector<double>& breaks) {
  const platform::FloatingPointScope floating_point;
  if (!value) throw Error(ErrorCode::invalid_argument, "a kernel has no function; pass one of the cosine");
  return {lobe_of(value, breaks), 0.0};
}

ZonalLobe ZonalLobe::from_spectrum(const std::vector<double>& factors) {
  const platform::FloatingPointScope floating_point;
  image::require_range("the number of a kernel's factors",
                       static_cast<int>(std::min<std::size_t>(factors.size(), 99999)), 1,
                       transforms::kMaximumSpectrumBands);
  for (std::size_t l = 0; l < factors.size(); ++l) {
    if (std::isfinite(factors[l]) && (l > 0 || factors[l] > 0.0)) continue;
    throw Error(ErrorCode::invalid_argument, "a kernel's factor of degree " + std::to_string(l) + " is " +
                                                 platform::number_text(factors[l]) + "; " +
                                                 (l > 0 ? "it must be finite" : "the first one must be above 0"));
  }
  std::vector<double> ratios;
  ratios.reserve(factors.size());
  for (const double factor : factors) ratios.push_back(factor / factors.front());
  return {std::make_shared<const reflections::Lobe>(std::move(ratios)), 0.0};
}

double ZonalLobe::value(double cosine) const {
  const platform::FloatingPointScope floating_point;
  return lobe_->value(cosine);
}

std::vector<double> ZonalLobe::spectrum(int bands) const {
  const platform::FloatingPointScope floating_point;
  image::require_range("bands", bands, 1, transforms::kMaximumSpectrumBands);
  return lobe_->spectrum(bands);
}

PrefilteredSpecular prefilter_by_lobes(const EnvironmentView& source, const LobeChainOptions& options,
                                       const Control& control) {
  const platform::FloatingPointScope floating_point;
  image::check_view(source);
  return reflections::prefilter(source, reflections::plan_prefilter(options), options.pixels, {}, control);
}

std::vector<dvec3> reference_by_lobe(const EnvironmentView& source, const ZonalLobe& kernel,
                                     const std::vector<dvec3>& directions, const Control& control) {
  const platform::FloatingPointScope floating_point;
  image::check_view(source);
  const projection::SanitizedSource texels(source, {}, {control.stop, {}});
  return reflections::integrate_lobe(texels, *kernel.lobe(), reflections::unit_directions(directions), control);
}

}  // namespace welkin
