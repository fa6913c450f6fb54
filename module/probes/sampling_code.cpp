// The code that looks a grid up, in four languages from one text (probe_sampling.glsl).
#include <array>
#include <cctype>
#include <string>
#include <string_view>

#include "platform/standard_library.h"
#include "probes/probe_sampling_text.h"
#include "welkin/core.h"
#include "welkin/probes.h"

namespace welkin {
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
  switch (language) {
    case ShaderLanguage::glsl: return "glsl";
    case ShaderLanguage::hlsl: return "hlsl";
    case ShaderLanguage::wgsl: return "wgsl";
    case ShaderLanguage::cpp: return "cpp";
  }
  return "";
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
