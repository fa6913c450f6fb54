#include "codec/exr_primaries.h"

#include <ImfStandardAttributes.h>

#include <algorithm>
#include <cmath>

#include "codec/byte_file.h"
#include "codec/primaries.h"

namespace welkin::codec {
namespace {

glm::dvec2 to_glm(const Imath::V2f& xy) { return {xy.x, xy.y}; }

Chromaticities read_chromaticities(const Imf::Header& header) {
  const Imf::Chromaticities& stated = Imf::chromaticities(header);
  return {to_glm(stated.red), to_glm(stated.green), to_glm(stated.blue), to_glm(stated.white)};
}

std::optional<glm::dvec2> read_neutral(const Imf::Header& header) {
  return Imf::hasAdoptedNeutral(header) ? std::optional(to_glm(Imf::adoptedNeutral(header))) : std::nullopt;
}

[[noreturn]] void reject(const EnvironmentInfo& info, const char* attribute, const Chromaticities& found,
                         const char* remedy) {
  throw file_error(ErrorCode::corrupt_file, info.path,
                   std::string("its attribute \"") + attribute + "\" makes no colours, with chromaticities " +
                       describe(found) + "; " + remedy);
}

// Photoshop writes Rec. 709 as an ICC profile has it: adapted to D50. The way back is no more than its roundings.
bool is_nearly_nothing(const glm::dmat3& matrix) {
  constexpr double kRounding = 2e-3;
  double worst = 0.0;
  for (int column = 0; column < 3; ++column) {
    for (int row = 0; row < 3; ++row) {
      worst = std::max(worst, std::abs(matrix[column][row] - (row == column ? 1.0 : 0.0)));
    }
  }
  return worst < kRounding;
}

}  // namespace

std::optional<glm::dmat3> exr_colour_matrix(EnvironmentInfo& info, const Imf::Header& header, ExrChannels::Kind kind,
                                            Primaries wanted) {
  if (!Imf::hasChromaticities(header) || kind == ExrChannels::Kind::luminance) {
    return std::nullopt;
  }
  const Chromaticities stated = read_chromaticities(header);
  const std::optional<glm::dvec2> neutral = read_neutral(header);
  const bool sound = rgb_to_xyz(stated).has_value();
  if (!sound && kind == ExrChannels::Kind::luminance_chroma) {
    reject(info, "chromaticities", stated, "luminance and chroma cannot be taken apart: export it again");
  }
  Chromaticities balanced = stated;
  balanced.white = neutral.value_or(stated.white);
  if (nearly_same(stated, kRec709) && nearly_same(balanced, kRec709)) {
    return std::nullopt;
  }
  if (wanted == Primaries::as_stored) {
    info.notes.push_back("colours left in the primaries of the file: " + describe(stated));
    return std::nullopt;
  }
  const std::optional<glm::dmat3> matrix = to_rec709(stated, neutral);
  if (!matrix) {
    reject(info, sound && neutral ? "adoptedNeutral" : "chromaticities", stated,
           "pass --primaries as-stored to take the numbers as they are, or export it again");
  }
  if (is_nearly_nothing(*matrix)) {
    info.notes.push_back("colours left as they are: the primaries of the file, " + describe(stated) +
                         ", are those of Rec. 709 seen under another white");
    return std::nullopt;
  }
  info.notes.push_back("primaries converted from " + describe(stated) + " to Rec. 709");
  return matrix;
}

}  // namespace welkin::codec
