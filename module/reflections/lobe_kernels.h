// The kernel of lights that are blurred by a GGX lobe.
#pragma once

#include "simd/dispatch.h"

namespace welkin::reflections {

/// A light of no extent; its colour holds all that one mip's lobe does not change from texel to texel.
struct LobeLight {
  float x, y, z;  ///< unit direction
  float red, green, blue;
  float half_width;  ///< of what it stands for, radians, above 0: the horizon cuts it little by little
  float half_slope;  ///< 1 / (4 half_width)
};

/// A row of a cubemap face, and the lobe. Texel i's centre is at base + u along, u = (2 i + 1) step - 1.
struct LobeRow {
  float base[3];
  float along[3];
  float step;  ///< 1 / texels along an edge
  int count;
  float alpha_squared;
  float half_slope;  ///< (1 - alpha^2) / 4
};

/// Adds to each texel, packed RGB, the sum over lights of colour max(0, c) / (alpha^2 + (1 - c) (1 - alpha^2) / 2)^2,
/// c = cosine between texel and light: relative error 2e-6 + 1e-7 / alpha for positive light.
using AddLobes = void (*)(const LobeRow& row, const LobeLight* lights, int count, float* rgb);

struct LobeKernels {
  AddLobes add_lobes;
};
WELKIN_KERNEL_TABLES(LobeKernels, lobe_kernels)

}  // namespace welkin::reflections
