// A direction as a person finds it in the sky.
#pragma once

#include <glm/vec3.hpp>
#include <string>

namespace welkin::tool {

/// "(0.287, 0.643, 0.710): 40.0 degrees up, 22.0 degrees from +z towards +x" where y is up; where z is (Unreal,
/// Blender) the azimuth is counted from +x towards +y.
[[nodiscard]] std::string direction_text(const glm::dvec3& unit, bool z_is_up = false);

/// "+X", "-X", ... for 0 to 5.
[[nodiscard]] const char* face_name(int face) noexcept;

}  // namespace welkin::tool
