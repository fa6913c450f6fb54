#include "harmonics/recorded_cases.h"

#include <nlohmann/json.hpp>

#include "places.h"
#include "support/catch.h"

namespace welkin::test {
namespace {

using nlohmann::json;

std::array<glm::dvec3, 9> triples_from(const json& recorded) {
  std::array<glm::dvec3, 9> triples{};
  for (std::size_t i = 0; i < triples.size(); ++i) {
    const json& triple = recorded.at(i);
    triples[i] = {triple.at(0).get<double>(), triple.at(1).get<double>(), triple.at(2).get<double>()};
  }
  return triples;
}

RecordedCase case_from(const json& recorded) {
  RecordedCase result;
  result.group = recorded.at("group").get<std::string>();
  result.content = content_named(recorded.at("content").get<std::string>());
  result.bytes = recorded.at("type") == "u8";
  result.size = recorded.at("size").get<int>();
  result.channels = recorded.at("channels").get<int>();
  result.seed = recorded.at("seed").get<std::uint32_t>();
  result.checksum = recorded.at("checksum").get<std::uint32_t>();
  result.options = babylon_options(recorded.at("options"), "maximum");
  result.polynomial = triples_from(recorded.at("polynomial"));
  if (recorded.contains("radiance")) result.radiance = triples_from(recorded.at("radiance"));
  return result;
}

std::vector<RecordedCase> read_cases() {
  std::ifstream file(WELKIN_TEST_DATA "/babylon.json");
  const json recorded = json::parse(file);
  std::vector<RecordedCase> cases;
  for (const json& entry : recorded.at("cases")) cases.push_back(case_from(entry));
  return cases;
}

}  // namespace

ProjectionOptions babylon_options(const json& recorded, const char* maximum_name) {
  float maximum = RadianceClamp{}.maximum;
  if (const auto given = recorded.find(maximum_name); given != recorded.end()) {
    maximum = given->is_string() ? std::numeric_limits<float>::infinity() : given->get<float>();
  }
  ProjectionOptions options{.quadrature = Quadrature::midpoint};
  if (const int target = recorded.value("target", 0); target != 0) options.target_size = target;
  options.pixels.gamma = recorded.value("gamma", false);
  if (std::isinf(maximum)) {
    options.pixels.negative = NegativePolicy::replace;
  } else {
    options.pixels.clamp = RadianceClamp{maximum, recorded.value("preserve", false)};
  }
  return options;
}

PolynomialTerms terms(const BabylonPolynomial& p) { return {p.x, p.y, p.z, p.xx, p.yy, p.zz, p.yz, p.zx, p.xy}; }

double relative_deviation(const PolynomialTerms& found, const PolynomialTerms& expected) {
  double largest = 0.0;
  double deviation = 0.0;
  for (std::size_t term = 0; term < expected.size(); ++term) {
    for (int channel = 0; channel < 3; ++channel) {
      const double difference = std::abs(found[term][channel] - expected[term][channel]);
      if (std::isnan(difference)) return difference;
      deviation = std::max(deviation, difference);
      largest = std::max(largest, std::abs(expected[term][channel]));
    }
  }
  return deviation == 0.0 ? 0.0 : deviation / largest;
}

std::string RecordedCase::description() const {
  std::ostringstream text;
  text << group << ": " << name(content) << (bytes ? " u8 " : " f32 ") << size << " x " << channels;
  if (options.pixels.gamma) text << ", gamma";
  if (!options.pixels.clamp) text << ", no clamp";
  if (options.pixels.clamp) text << ", maximum " << options.pixels.clamp->maximum;
  if (options.pixels.clamp && options.pixels.clamp->preserve_colour) text << " preserving colour";
  if (options.target_size) text << ", target " << *options.target_size;
  return text.str();
}

const std::vector<RecordedCase>& recorded_cases() {
  static const std::vector<RecordedCase> cases = read_cases();
  return cases;
}

}  // namespace welkin::test
