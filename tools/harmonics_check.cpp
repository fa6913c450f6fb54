// Checks a file of spherical harmonics against the light that it was made from.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <locale>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <utility>
#include <variant>

#include "tools/chain_check.h"
#include "tools/json.h"
#include "tools/text.h"
#include "welkin/engines.h"
#include "welkin/spherical_harmonics.h"

namespace welkin::tool {
namespace {

constexpr int kSize = 64;
constexpr int kBands = 3;

Cubemap sampled(const std::function<glm::dvec3(const glm::dvec3& direction)>& value) {
  Cubemap image(kSize);
  float* texel = image.pixels().data();
  for (int face = 0; face < 6; ++face) {
    for (int row = 0; row < kSize; ++row) {
      for (int column = 0; column < kSize; ++column, texel += 3) {
        const glm::dvec3 rgb = value(image::face_direction(kSize, face, column + 0.5, row + 0.5));
        for (int channel = 0; channel < 3; ++channel) texel[channel] = static_cast<float>(rgb[channel]);
      }
    }
  }
  return image;
}

Cubemap sampled(const SphericalHarmonics& harmonics) {
  return sampled([&](const glm::dvec3& direction) { return evaluate(harmonics, direction); });
}

/// "( r, g, b); // L00, irradiance, pre-scaled base", nine times. Filament's shaders add these up without constants.
std::optional<HarmonicsFile> read_cmgen(const std::filesystem::path& file) {
  std::vector<glm::dvec3> rows;
  bool is_scaled = false;
  for_each_line(file, [&](std::size_t number, const std::string& line) {
    if (line.empty() || rows.size() == 9) return;
    std::string numbers = line.substr(0, line.find("//"));
    is_scaled = is_scaled || line.find("pre-scaled") != std::string::npos;
    for (char& c : numbers) {
      if (c == '(' || c == ')' || c == ',' || c == ';') c = ' ';
    }
    std::istringstream words(numbers);
    words.imbue(std::locale::classic());
    glm::dvec3 rgb;
    if (!(words >> rgb.x >> rgb.y >> rgb.z)) {
      throw Error(ErrorCode::corrupt_file, printable(file.string()) + ": line " + std::to_string(number) +
                                               " should have three numbers, \"( r, g, b)\"");
    }
    rows.push_back(rgb);
  });
  if (rows.size() != 9) {
    throw Error(ErrorCode::corrupt_file,
                printable(file.string()) + ": cmgen writes nine lines, and here are " + std::to_string(rows.size()));
  }
  if (is_scaled) {
    return HarmonicsFile{"cmgen's text for shaders", sampled([&](const glm::dvec3& d) {
                           return rows[0] + rows[1] * d.y + rows[2] * d.z + rows[3] * d.x + rows[4] * (d.y * d.x) +
                                  rows[5] * (d.y * d.z) + rows[6] * (3.0 * d.z * d.z - 1.0) + rows[7] * (d.z * d.x) +
                                  rows[8] * (d.x * d.x - d.y * d.y);
                         })};
  }
  SphericalHarmonics harmonics(kBands);
  std::ranges::copy(rows, harmonics.coefficients().begin());
  return HarmonicsFile{"cmgen's text", sampled(harmonics)};
}

std::optional<HarmonicsFile> read_own(const std::filesystem::path& file) {
  try {
    const Json json = read_json_file(file, "'welkin sh --json' writes one");
    SphericalHarmonics radiance(kBands);
    std::size_t count = 0;
    for (const auto& [name, value] : json.members()) {
      if (name != "radiance") continue;
      for (const Json& rgb : value.elements()) {
        if (count == 9) break;  // further bands
        for (int channel = 0; channel < 3; ++channel) {
          radiance.coefficients()[count][channel] = rgb.elements().at(static_cast<std::size_t>(channel)).number();
        }
        ++count;
      }
    }
    if (count < 9) throw Flaw{"it has no member 'radiance' with nine triples"};
    return HarmonicsFile{"sh.json", sampled(radiance)};
  } catch (const Flaw& flaw) {
    throw Error(ErrorCode::corrupt_file, printable(file.string()) + ": " + flaw.message);
  } catch (const std::bad_variant_access&) {
    throw Error(ErrorCode::corrupt_file, printable(file.string()) + ": 'radiance' should be triples of numbers");
  } catch (const std::out_of_range&) {
    throw Error(ErrorCode::corrupt_file, printable(file.string()) + ": 'radiance' should be triples of numbers");
  }
}

/// A meaning of three bands, by their factors over radiance.
struct Form {
  const char* words;
  std::array<double, kBands> factors;
};

std::vector<Form> forms() {
  const std::array<double, kBands> cosine = {cosine_lobe(0), cosine_lobe(1), cosine_lobe(2)};
  std::vector<Form> forms = {{"radiance", {1.0, 1.0, 1.0}}, {"irradiance", cosine}};
  Form divided{"irradiance / pi", {}};
  // Babylon.js applies the cosine's factors once more, and its shader reverses that.
  Form babylon{"Babylon.js's polynomial", {}};
  for (std::size_t band = 0; band < kBands; ++band) {
    divided.factors[band] = cosine[band] / std::numbers::pi;
    babylon.factors[band] = divided.factors[band] * divided.factors[band];
  }
  forms.push_back(divided);
  forms.push_back(babylon);
  return forms;
}

/// Returns the factor of each band of `image` over `light`, by least squares.
std::array<double, kBands> factors_of(const SphericalHarmonics& image, const SphericalHarmonics& light) {
  std::array<double, kBands> factors{};
  for (int band = 0; band < kBands; ++band) {
    double products = 0.0;
    double squares = 0.0;
    for (int order = -band; order <= band; ++order) {
      products += glm::dot(image.at(band, order), light.at(band, order));
      squares += glm::dot(light.at(band, order), light.at(band, order));
    }
    factors[static_cast<std::size_t>(band)] = squares > 0.0 ? products / squares : 1.0;
  }
  return factors;
}

/// Returns the light in the file's axes and channels.
SphericalHarmonics placed(const SphericalHarmonics& light, const ChainPlacement& placement) {
  const SphericalHarmonics rotated_light = placement.matrix ? rotate(light, glm::transpose(*placement.matrix)) : light;
  SphericalHarmonics result(rotated_light.bands());
  for (std::size_t i = 0; i < result.coefficients().size(); ++i) {
    for (int channel = 0; channel < 3; ++channel) {
      result.coefficients()[i][channel] =
          rotated_light.coefficients()[i][placement.channels[static_cast<std::size_t>(channel)]];
    }
  }
  return result;
}

/// Returns the light in a form.
SphericalHarmonics formed(SphericalHarmonics light, const Form& form) {
  for (int band = 0; band < kBands; ++band) {
    for (int order = -band; order <= band; ++order) {
      light.at(band, order) *= form.factors[static_cast<std::size_t>(band)];
    }
  }
  return light;
}

void add_findings(HarmonicsCheck& check) {
  constexpr double kTold = 0.02;
  if (!check.placement.is_identity()) check.findings.push_back(words_of(check.placement));
  const double scale = check.factors[0];
  if (std::abs(scale - 1.0) > kTold) {
    const std::string words = scale_words(scale);
    check.findings.push_back("scaled by " + significant(scale, 4) +
                             (words.empty() ? "" : ": " + words + " the source"));
  }
  for (int band = 1; band < kBands; ++band) {
    const double relative = check.factors[static_cast<std::size_t>(band)] / scale;
    if (std::abs(relative - 1.0) <= kTold) continue;
    check.findings.push_back("band " + std::to_string(band) + " has " + significant(relative, 3) +
                             " times its share: a window, or a wrong constant");
  }
}

}  // namespace

double relative_difference(const SphericalHarmonics& found, const SphericalHarmonics& expected) {
  double squares = 0.0;
  double all = 0.0;
  for (std::size_t i = 0; i < expected.coefficients().size(); ++i) {
    const glm::dvec3 difference = found.coefficients()[i] - expected.coefficients()[i];
    squares += glm::dot(difference, difference);
    all += glm::dot(expected.coefficients()[i], expected.coefficients()[i]);
  }
  return all > 0.0 ? std::sqrt(squares / all) : 0.0;
}

std::optional<HarmonicsFile> read_harmonics(const std::filesystem::path& file) {
  if (file.extension() == ".json") return read_own(file);
  if (file.extension() == ".txt") return read_cmgen(file);
  return std::nullopt;
}

std::optional<HarmonicsFile> harmonics_of(const BabylonEnvironment& environment) {
  if (!environment.polynomial) return std::nullopt;
  return HarmonicsFile{"polynomial", sampled([&](const glm::dvec3& direction) {
                         return evaluate(*environment.polynomial, {-direction.x, direction.y, direction.z});
                       })};
}

HarmonicsCheck check_harmonics(const HarmonicsFile& file, const EnvironmentView& source, const PixelPolicy& pixels,
                               const Control& control) {
  ProjectionOptions options;
  options.pixels = pixels;
  const SphericalHarmonics light = project(source, options, {control.stop, {}}).radiance;
  HarmonicsCheck check;
  // The form is not known yet: use the placement of the form with the nearest shape.
  double minimum = std::numeric_limits<double>::max();
  for (const Form& form : forms()) {
    const PlacementFit fit = placement_of(file.values, sampled(formed(light, form)));
    if (fit.difference >= minimum || !fit.placement.matrix) continue;  // a polynomial has no faces to mix up
    minimum = fit.difference;
    check.placement = fit.placement;
  }
  const SphericalHarmonics image = project(file.values.view()).radiance;
  const SphericalHarmonics expected = placed(light, check.placement);
  const std::array<double, kBands> factors = factors_of(image, expected);
  minimum = std::numeric_limits<double>::max();
  for (const Form& form : forms()) {
    double distance = std::abs(std::log(std::max(factors[0] / form.factors[0], 1e-9))) * 0.1;
    for (std::size_t band = 1; band < kBands; ++band) {
      distance += std::abs(factors[band] / factors[0] * form.factors[0] / form.factors[band] - 1.0);
    }
    if (distance >= minimum) continue;
    minimum = distance;
    check.form = form.words;
    check.rms = relative_difference(image, formed(expected, form));
    check.factors.assign(factors.begin(), factors.end());
    for (std::size_t band = 0; band < kBands; ++band) check.factors[band] /= form.factors[band];
  }
  add_findings(check);
  return check;
}

}  // namespace welkin::tool
