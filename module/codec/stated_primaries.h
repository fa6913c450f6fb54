// What Radiance and PNG files say about their primaries, as a matrix to Rec. 709.
#pragma once

#include <array>
#include <glm/mat3x3.hpp>
#include <optional>

#include "welkin/environment_file.h"

namespace welkin::codec {

/// `numbers`: x and y of red, green, blue and white. Nothing if they are those of Rec. 709, if colours are
/// wanted as stored, or if no three primaries are these; `info.notes` says what was done, and `where` who said it.
[[nodiscard]] std::optional<glm::dmat3> rec709_from_stated(const std::array<double, 8>& numbers, const char* where,
                                                           Primaries wanted, EnvironmentInfo& info);

/// From CIE XYZ; nothing if the numbers are wanted as stored.
[[nodiscard]] std::optional<glm::dmat3> rec709_from_stored_xyz(Primaries wanted, EnvironmentInfo& info);

}  // namespace welkin::codec
