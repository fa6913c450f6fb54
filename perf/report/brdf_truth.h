// Directional albedo over the light's hemisphere, in double: the truth that BRDF tables are measured against.
#pragma once

namespace welkin::report {

struct BrdfTruth {
  double scale;
  double bias;
};

/// Int D V (n.l) {1 - F, F} dl, F = (1 - v.h)^5: GGX with height-correlated Smith visibility. To 1e-8.
BrdfTruth ggx_truth(double normal_view, double alpha);

/// Int D V (n.l) dl of Charlie sheen with Neubelt's visibility. To 1e-8 of what is above 1.
double sheen_truth(double normal_view, double alpha);

}  // namespace welkin::report
