#include "codec/stated_primaries.h"

#include <string>

#include "codec/primaries.h"

namespace welkin::codec {

std::optional<glm::dmat3> rec709_from_stated(const std::array<double, 8>& numbers, const char* where, Primaries wanted,
                                             EnvironmentInfo& info) {
  const Chromaticities stated{
      {numbers[0], numbers[1]}, {numbers[2], numbers[3]}, {numbers[4], numbers[5]}, {numbers[6], numbers[7]}};
  if (nearly_same(stated, kRec709)) {
    return std::nullopt;
  }
  const std::string said = describe(stated) + " (" + where + ")";
  if (wanted == Primaries::as_stored) {
    info.notes.push_back("primaries are left as stored: " + said);
    return std::nullopt;
  }
  const std::optional<glm::dmat3> matrix = to_rec709(stated);
  info.notes.push_back(matrix ? "primaries were converted to Rec. 709 from " + said
                              : "primaries that span no colours are ignored: " + said);
  return matrix;
}

std::optional<glm::dmat3> rec709_from_stored_xyz(Primaries wanted, EnvironmentInfo& info) {
  if (wanted == Primaries::as_stored) {
    info.notes.emplace_back("primaries are left as stored: CIE XYZ");
    return std::nullopt;
  }
  info.notes.emplace_back("primaries were converted to Rec. 709 from CIE XYZ");
  return to_rec709(kCieXyz);
}

}  // namespace welkin::codec
