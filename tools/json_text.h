// JSON as the command prints it.
#pragma once

#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>
#include <string>

namespace welkin::tool {

/// Keeps its members in the order in which they were added.
using Json = nlohmann::ordered_json;

/// [r, g, b]
[[nodiscard]] Json json_triple(const glm::dvec3& rgb);

/// One line per member of the object and per element of a member that is an array, so that a person and a
/// diff find their way. Numbers have as many digits as their exact value needs; text that is no UTF-8
/// (file names may be anything) is made valid.
[[nodiscard]] std::string json_text(const Json& object);

}  // namespace welkin::tool
