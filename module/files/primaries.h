// Colours in primaries other than Rec. 709, and their conversion to Rec. 709.
#pragma once

#include <cstddef>
#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <optional>
#include <string>

#include "welkin/environment_file.h"

namespace welkin::files {

/// The CIE 1931 xy of a set of primaries and of the white that equal parts of them make.
struct Chromaticities {
  glm::dvec2 red, green, blue, white;
};

/// ITU-R BT.709-6, section 1; sRGB's as well.
inline constexpr Chromaticities kRec709{{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}, {0.3127, 0.3290}};

/// The primaries for which R, G and B are the CIE's X, Y and Z.
inline constexpr Chromaticities kCieXyz{{1.0, 0.0}, {0.0, 1.0}, {0.0, 0.0}, {1.0 / 3.0, 1.0 / 3.0}};

/// Returns whether no coordinate differs by more than 0.001: writers round to three or four digits.
[[nodiscard]] bool nearly_same(const Chromaticities& a, const Chromaticities& b) noexcept;

/// Returns the matrix from R, G, B to X, Y, Z; (1, 1, 1) becomes the white at Y = 1. Empty if the primaries span no
/// triangle or a coordinate is not finite.
[[nodiscard]] std::optional<glm::dmat3> rgb_to_xyz(const Chromaticities& primaries) noexcept;

/// Returns the matrix to linear Rec. 709. The colour `neutral` (by default the primaries' white) becomes D65 by the
/// Bradford transform, so that grey stays grey. X, Y, Z are colours themselves, and their white (1/3, 1/3) is only a
/// scale: they are not adapted unless a neutral is given. Empty as for `rgb_to_xyz`, and if no adaptation leads from
/// the neutral to D65.
[[nodiscard]] std::optional<glm::dmat3> to_rec709(const Chromaticities& primaries,
                                                  std::optional<glm::dvec2> neutral = std::nullopt) noexcept;

/// Multiplies `texels` RGB texels in place; each sum in double, rounded once. An infinity or NaN in one channel spreads
/// to the others.
void apply(const glm::dmat3& matrix, float* rgb, std::size_t texels) noexcept;

/// Returns a text: "CIE XYZ", "Rec. 2020" and the like, else "red (0.64 0.33) green (..) blue (..) white (..)".
[[nodiscard]] std::string describe(const Chromaticities& primaries);

// The primaries that Radiance, PNG and JPEG files state, as a matrix to Rec. 709.

/// Returns nothing if they are those of Rec. 709, if colours are requested as stored, or if they are not valid
/// primaries; `info.notes` states what was done, and `where` names their origin.
[[nodiscard]] std::optional<glm::dmat3> rec709_from_stated(const Chromaticities& stated, const char* where,
                                                           Primaries wanted, EnvironmentInfo& info);

}  // namespace welkin::files
