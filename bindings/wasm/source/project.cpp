// Projections: pixels to spherical harmonics, and what Babylon.js calls a polynomial.
#include <vector>

#include "interface.h"
#include "welkin/engines.h"

namespace welkin::wasm {
namespace {

/// After the source and the policy.
enum ProjectOption { kBands = kSourceOptions + kPolicyOptions, kMidpoint, kTargetSize };

/// Results: radiance, the polynomial (x y z xx yy zz yz zx xy, three numbers each), diagnostics.
void give_projection(const Projection& light) {
  give(light.radiance);
  const BabylonPolynomial p = babylon_polynomial(light.radiance);
  std::vector<double> polynomial;
  for (const dvec3& term : {p.x, p.y, p.z, p.xx, p.yy, p.zz, p.yz, p.zx, p.xy}) {
    polynomial.insert(polynomial.end(), {term.x, term.y, term.z});
  }
  give(std::move(polynomial));
  const ProjectionDiagnostics& d = light.diagnostics;
  give(std::vector<double>{static_cast<double>(d.texels), static_cast<double>(d.nans_replaced),
                           static_cast<double>(d.infinities_replaced), static_cast<double>(d.negatives_replaced),
                           static_cast<double>(d.texels_clamped), d.error_estimate, d.total_radiance.x,
                           d.total_radiance.y, d.total_radiance.z});
}

void project_pixels(const Options& options) {
  ProjectionOptions wanted;
  wanted.bands = options.whole(kBands);
  wanted.quadrature = options.flag(kMidpoint) ? Quadrature::midpoint : Quadrature::exact;
  if (options.whole(kTargetSize) > 0) wanted.target_size = options.whole(kTargetSize);
  wanted.pixels = policy_of(options, kSourceOptions);
  give_projection(is_lat_long(options) ? project(lat_long_of(options), wanted, reporting())
                                       : project(cubemap_of(options), wanted, reporting()));
}

}  // namespace
}  // namespace welkin::wasm

WELKIN_ENTRY(welkin_project) int welkin_project(const double* options) {
  return welkin::wasm::guarded(welkin::wasm::project_pixels, options);
}
