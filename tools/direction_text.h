// A direction as a person finds it in the sky.
#pragma once

#include <glm/vec3.hpp>
#include <string>

namespace welkin::tool {

/// "(0.287, 0.643, 0.710): 40.0 degrees up, 22.0 degrees from +z towards +x". y is up; degrees.
[[nodiscard]] std::string direction_text(const glm::dvec3& unit);

/// "+X", "-X", ... for 0 to 5.
[[nodiscard]] const char* face_name(int face) noexcept;

}  // namespace welkin::tool
