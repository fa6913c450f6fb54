#include "tools/json_text.h"

namespace welkin::tool {
namespace {

std::string one_line(const Json& value) { return value.dump(-1, ' ', false, Json::error_handler_t::replace); }

std::string member_text(const Json& value) {
  if (!value.is_array() || value.empty() || value.front().is_number()) return one_line(value);
  std::string text;
  for (const Json& element : value) {
    text += text.empty() ? "[\n    " : ",\n    ";
    text += one_line(element);
  }
  return text + ']';
}

}  // namespace

Json json_triple(const glm::dvec3& rgb) { return Json::array({rgb.x, rgb.y, rgb.z}); }

std::string json_text(const Json& object) {
  std::string text;
  for (const auto& [key, value] : object.items()) {
    text += text.empty() ? "{\n  " : ",\n  ";
    text += one_line(key) + ": " + member_text(value);
  }
  return text + "\n}\n";
}

}  // namespace welkin::tool
