// Bakes looked at and compared.
#pragma once

#include "support/catch.h"
#include "support/chains.h"
#include "support/same_bits.h"
#include "welkin/bake.h"

namespace welkin::test {

/// Everything but times and memory; the reasons of passes too, but for whether a table was made before.
inline bool same_bits(const BakeResult& a, const BakeResult& b) {
  const auto same_radiance = [&] {
    if (a.radiance.has_value() != b.radiance.has_value()) return false;
    return !a.radiance || same_bytes(a.radiance->coefficients(), b.radiance->coefficients());
  };
  const auto same_specular = [&] {
    if (a.specular.has_value() != b.specular.has_value()) return false;
    return !a.specular || same_bits(a.specular->cubemap, b.specular->cubemap);
  };
  const auto same_table = [&] {
    if ((a.brdf == nullptr) != (b.brdf == nullptr)) return false;
    return !a.brdf || same_bytes<float>(a.brdf->values, b.brdf->values);
  };
  const auto same_polynomial = [&] {
    if (a.stored_polynomial.has_value() != b.stored_polynomial.has_value()) return false;
    return !a.stored_polynomial ||
           std::memcmp(&*a.stored_polynomial, &*b.stored_polynomial, sizeof *a.stored_polynomial) == 0;
  };
  const ProjectionDiagnostics& x = a.diagnostics;
  const ProjectionDiagnostics& y = b.diagnostics;
  const bool same_diagnostics =
      x.texels == y.texels && x.nans_replaced == y.nans_replaced && x.infinities_replaced == y.infinities_replaced &&
      x.negatives_replaced == y.negatives_replaced && x.texels_clamped == y.texels_clamped &&
      same_bits(x.total_radiance, y.total_radiance) &&
      same_bits(x.total_radiance_before_clamp, y.total_radiance_before_clamp) &&
      std::equal(x.passes.begin(), x.passes.end(), y.passes.begin(), y.passes.end(),
                 [](const PassRecord& p, const PassRecord& q) {
                   return p.name == q.name && (p.name == "brdf" || (p.action == q.action && p.reason == q.reason));
                 });
  const auto same = [](const auto& x_or_none, const auto& y_or_none) {
    if (x_or_none.has_value() != y_or_none.has_value()) return false;
    return !x_or_none || same_bits(*x_or_none, *y_or_none);
  };
  const auto same_map = [&] {
    if (a.octahedral.has_value() != b.octahedral.has_value()) return false;
    return !a.octahedral || (a.octahedral->size == b.octahedral->size && a.octahedral->border == b.octahedral->border &&
                             a.octahedral->levels == b.octahedral->levels);
  };
  return same(a.background, b.background) && same_specular() && same_map() && same(a.irradiance, b.irradiance) &&
         same_radiance() && same_table() && same_diagnostics && same_polynomial();
}

inline const PassRecord& pass_named(const BakeResult& result, const std::string& name) {
  const auto& passes = result.diagnostics.passes;
  const auto found = std::find_if(passes.begin(), passes.end(), [&](const PassRecord& p) { return p.name == name; });
  if (found == passes.end()) throw std::runtime_error("no pass is called " + name);
  return *found;
}

/// Small and quick, with every pass.
inline BakeOptions small_bake(int size = 16) {
  BakeOptions options{.specular = PrefilterOptions{.size = size}};
  options.irradiance->size = 5;
  options.brdf = BrdfTableOptions{.width = 9, .height = 7};
  return options;
}

}  // namespace welkin::test
