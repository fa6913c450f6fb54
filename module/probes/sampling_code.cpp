// A grid looked up by the code that shaders use, and that code in four languages from one text (probe_sampling.glsl).
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <string_view>

#include "math/direction.h"
#include "platform/float_environment.h"
#include "platform/standard_library.h"
#include "platform/text.h"
#include "probes/probe_arrays.h"
#include "welkin/core.h"
#include "welkin/probes.h"

namespace welkin {
namespace probes {
namespace {

using glm::abs;
using glm::dot;
using glm::floor;
using glm::length;
using glm::max;
using glm::min;

/// The inputs of the shaders' code, and the code itself.
class Lookup {
 public:
  using vec2 = glm::vec<2, float, glm::packed_highp>;
  using vec3 = glm::vec<3, float, glm::packed_highp>;
  using ivec3 = glm::vec<3, int, glm::packed_highp>;

  Lookup(const BakedProbes& probes, double scale) : probes_(probes), scale_(scale) {}

#include "probes/probe_sampling.glsl"

 private:
  [[nodiscard]] vec3 probe_coefficient(int probe, int index) const {
    return vec3(scale_ * probes_.coefficients[static_cast<std::size_t>(probe) * squared(probes_.bands) +
                                              static_cast<std::size_t>(index)]);
  }
  [[nodiscard]] vec2 probe_distance(int probe, int column, int row) const {
    const int edge = probes_.distance_edge();
    const float* texel = probes_.distances.data() + static_cast<std::size_t>(probe) * distance_floats(probes_) +
                         2 * static_cast<std::size_t>(row * edge + column);
    return {texel[0], texel[1]};
  }
  [[nodiscard]] float probe_share(int probe) const {
    return welkin::probe_share(probes_.passes[static_cast<std::size_t>(probe)]);
  }
  [[nodiscard]] vec3 probe_offset(int probe) const {
    if (probes_.offsets.empty()) return vec3(0.0F);
    const dvec3& offset = probes_.offsets[static_cast<std::size_t>(probe)];
    const bool is_good =
        std::abs(offset.x) <= kFarthest && std::abs(offset.y) <= kFarthest && std::abs(offset.z) <= kFarthest;
    return is_good ? vec3(offset) : vec3(0.0F);
  }

  const BakedProbes& probes_;
  double scale_;  ///< of light
};

/// Returns the largest magnitude of a coefficient. Throws `Error` (invalid_argument) if one is not finite.
double largest_coefficient(const BakedProbes& probes) {
  double largest = 0.0;
  const std::size_t functions = squared(probes.bands);
  for (std::size_t k = 0; k < probes.coefficients.size(); ++k) {
    for (int c = 0; c < 3; ++c) {
      const double value = std::abs(probes.coefficients[k][c]);
      if (!std::isfinite(value)) {
        throw Error(ErrorCode::invalid_argument, "probe_irradiance: coefficient " + std::to_string(k % functions) +
                                                     " of probe " + std::to_string(k / functions) +
                                                     " is not finite; bake the probe again");
      }
      largest = std::max(largest, value);
    }
  }
  return largest;
}

/// The shaders' code makes indices of what it computes: a NaN would lead out of all arrays.
void check_lookup(const dvec3& position, const ProbeSampling& sampling) {
  bool is_good = std::abs(sampling.normal_bias) <= 1e3;
  for (int axis = 0; axis < 3; ++axis) is_good = is_good && std::abs(position[axis]) <= kFarthest;
  if (is_good) return;
  throw Error(ErrorCode::invalid_argument,
              "probe_irradiance: a position must be within 1e15 of the origin, and normal_bias at most 1000");
}

}  // namespace
}  // namespace probes

dvec3 probe_irradiance(const BakedProbes& probes, const dvec3& position, const dvec3& normal,
                       const ProbeSampling& sampling) {
  const platform::FloatingPointScope floating_point;
  probes::check_arrays(probes);
  probes::check_lookup(position, sampling);
  const vec3 unit(math::as_unit_direction(normal, "normal"));
  const double spacing = std::min({probes.grid.spacing.x, probes.grid.spacing.y, probes.grid.spacing.z});
  const probes::Lookup::ProbeVolume volume{
      .origin = vec3(probes.grid.origin),
      .spacing = vec3(probes.grid.spacing),
      .counts = {probes.grid.counts[0], probes.grid.counts[1], probes.grid.counts[2]},
      .bands = probes.bands,
      .distance_edge = probes.distance_edge(),
      .normal_bias = static_cast<float>(sampling.normal_bias * spacing),
      .visibility = sampling.visibility && probes.distance_size > 0 ? 1 : 0,
      .facing = sampling.facing ? 1 : 0,
      .validity = sampling.validity ? 1 : 0,
  };
  const auto light_at = [&](double scale) {
    return dvec3(probes::Lookup(probes, scale).probe_volume_light(volume, vec3(position), unit));
  };
  const dvec3 light = light_at(1.0);
  if (std::isfinite(light.x) && std::isfinite(light.y) && std::isfinite(light.z)) return light;
  const double largest = probes::largest_coefficient(probes);  // beyond what floats sum
  return largest * light_at(1.0 / largest);
}

namespace {

struct Word {
  std::string_view from;
  std::string_view to;
};

constexpr std::array kHlslWords{Word{"vec2", "float2"}, Word{"vec3", "float3"}, Word{"ivec3", "int3"}};
constexpr std::array kWgslWords{Word{"float", "f32"}, Word{"int", "i32"}, Word{"vec2", "vec2f"}, Word{"vec3", "vec3f"},
                                Word{"ivec3", "vec3i"}};

bool is_of_word(char c) noexcept { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// The word that begins at `index`.
std::string_view word_at(std::string_view line, std::size_t index) noexcept {
  std::size_t end = index;
  while (end < line.size() && is_of_word(line[end])) ++end;
  return line.substr(index, end - index);
}

template <class Words>
std::string with_words(std::string_view line, const Words& words) {
  std::string result;
  for (std::size_t index = 0; index < line.size();) {
    const std::string_view word = word_at(line, index);
    if (word.empty()) {
      result += line[index++];
      continue;
    }
    std::string_view taken = word;
    for (const Word& each : words) {
      if (each.from == word) taken = each.to;
    }
    result += taken;
    index += word.size();
  }
  return result;
}

bool is_type(std::string_view word) noexcept {
  return word == "ProbeVolume" ||
         platform::ranges::any_of(kWgslWords, [word](const Word& each) { return each.from == word; });
}

/// "TYPE NAME" at `index` as "NAME : TYPE"; `index` moves behind it.
std::string turned_round(std::string_view line, std::size_t& index) {
  const std::string_view type = word_at(line, index);
  const std::string_view name = word_at(line, index + type.size() + 1);
  index += type.size() + 1 + name.size();
  return std::string(name) + " : " + std::string(type);
}

/// "TYPE NAME(TYPE A, TYPE B) {" as "fn NAME(A : TYPE, B : TYPE) -> TYPE {".
std::string wgsl_function(std::string_view line) {
  const std::string_view type = word_at(line, 0);
  const std::size_t open = line.find('(');
  std::string result = "fn " + std::string(line.substr(type.size() + 1, open - type.size() - 1)) + "(";
  std::size_t index = open + 1;
  while (line[index] != ')') {
    if (line[index] == ',') {
      result += ", ";
      index += 2;
    }
    result += turned_round(line, index);
  }
  return result + ") -> " + std::string(type) + " {";
}

std::string wgsl_line(std::string_view line, bool in_structure) {
  const std::size_t indent = line.find_first_not_of(' ');
  if (indent == std::string_view::npos || line.substr(indent, 2) == "//") return std::string(line);
  const std::string margin(indent, ' ');
  if (indent == 0 && is_type(word_at(line, 0))) return with_words(wgsl_function(line), kWgslWords);
  std::size_t index = indent;
  if (line.substr(indent, 5) == "for (") {
    index += 5;
    const std::string counter = turned_round(line, index);
    return with_words(margin + "for (var " + counter + std::string(line.substr(index)), kWgslWords);
  }
  if (!is_type(word_at(line, indent))) return with_words(line, kWgslWords);
  const std::string declared = turned_round(line, index);
  if (in_structure) return with_words(margin + declared + ",", kWgslWords);
  return with_words(margin + "var " + declared + std::string(line.substr(index)), kWgslWords);
}

}  // namespace

const char* name(ShaderLanguage language) noexcept {
  static constexpr std::array kNames{"glsl", "hlsl", "wgsl", "cpp"};
  return platform::name_in<ShaderLanguage::cpp>(kNames, language, "");
}

std::string probe_sampling_code(ShaderLanguage language) {
  std::string result;
  bool in_structure = false;
  for (std::string_view rest = probes::kProbeSampling; !rest.empty();) {
    const std::size_t end = rest.find('\n');
    const std::string_view line = rest.substr(0, end);
    rest = end == std::string_view::npos ? std::string_view{} : rest.substr(end + 1);
    if (line.substr(0, 9) == "// NOLINT") continue;
    if (line.substr(0, 7) == "struct ") in_structure = true;
    switch (language) {
      case ShaderLanguage::glsl:
      case ShaderLanguage::cpp: result += line; break;
      case ShaderLanguage::hlsl:
        result += line.substr(0, 2) == "//" ? std::string(line) : with_words(line, kHlslWords);
        break;
      case ShaderLanguage::wgsl: result += wgsl_line(line, in_structure); break;
    }
    result += '\n';
    if (line == "};") in_structure = false;
  }
  return result;
}

}  // namespace welkin
