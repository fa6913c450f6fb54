// The error of a shader that reads mips bilinearly and interpolates linearly between two, and the lobes that make it
// least.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "reflections/bright_lights.h"
#include "reflections/bright_texels.h"
#include "welkin/core.h"
#include "welkin/reflections.h"

namespace welkin::reflections {

/// Where a shader looks a roughness up.
struct LookupFormula {
  std::optional<RoughnessSchedule> schedule;  ///< none: linear in roughness between two mips
  int mips = 1;                               ///< of the chain
  int size = 1;                               ///< texels along an edge of its mip 0

  bool operator==(const LookupFormula&) const = default;
};

/// Returns the mip, fractions too, at which a shader looks `roughness` up in a chain of `mips` from `size` texels.
[[nodiscard]] double mip_by_formula(RoughnessSchedule schedule, double roughness, int mips, int size);

/// Returns the formula of a chain of `size` with these roughnesses: that of the schedule that gives them, if one does.
[[nodiscard]] LookupFormula formula_of(const std::vector<double>& roughness, int size);

/// Two mips that a shader interpolates between.
struct MipPair {
  int first = 0;                         ///< number of the sharper one
  std::array<double, 2> roughness = {};  ///< where the shader finds each alone
  std::array<double, 2> lobes = {};      ///< roughness of each mip's lobe
  std::array<int, 2> sizes = {1, 1};     ///< texels along an edge

  bool operator==(const MipPair&) const = default;
};

/// A roughness between two mips.
struct Lookup {
  double roughness = 0.0;
  double share = 0.0;  ///< of the second mip
};

/// Returns where the shader looks for `count` roughnesses between two mips, evenly spread; none if both have the same.
[[nodiscard]] std::vector<Lookup> lookups_between(const MipPair& mips, const LookupFormula& formula, int count);

/// Returns k_l of the GGX lobe of a roughness for l < degrees, to 1e-4.
[[nodiscard]] std::vector<double> spectrum_of(double roughness, int degrees);

/// Says what bilinear interpolation between the texels of a face shows of each degree, on average over all places.
/// Texels of mips of roughness 0 are means over their areas.
struct TexelFilter {
  TexelFilter(int size, double roughness, int degrees);

  std::vector<double> gain;   ///< what the degree is multiplied by
  std::vector<double> noise;  ///< mean square of what it adds in other degrees, over that of the degree
};

/// Returns the root mean square error over all roughnesses between two mips, relative to the root mean square of the
/// reference, of an image with these energies per degree.
[[nodiscard]] double error_between(const MipPair& mips, const LookupFormula& formula, std::span<const float> energies);

/// Returns the energies per degree of an image, over their sum, from those of what is left without its bright texels.
/// Degrees beyond those that are known follow a power law through the last ones.
[[nodiscard]] std::vector<float> whole_energies(std::span<const double> rest, const std::vector<BrightTexel>& lights,
                                                const ImageShape& shape, const Control& control);

}  // namespace welkin::reflections
