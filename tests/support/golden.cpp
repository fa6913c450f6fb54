#include "support/golden.h"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "places.h"
#include "support/catch.h"

namespace welkin::test {
namespace {

std::string hexadecimal(double value) {
  char text[64];
  std::snprintf(text, sizeof text, "%a", value);
  return text;
}

/// One line a coefficient: result, index, red, green, blue.
std::vector<std::string> lines_of(const std::vector<SphericalHarmonics>& results) {
  std::vector<std::string> lines;
  for (std::size_t result = 0; result < results.size(); ++result) {
    for (std::size_t k = 0; k < results[result].coefficients().size(); ++k) {
      const glm::dvec3& value = results[result].coefficients()[k];
      std::ostringstream line;
      line << result << ' ' << k << ' ' << hexadecimal(value.x) << ' ' << hexadecimal(value.y) << ' '
           << hexadecimal(value.z);
      lines.push_back(line.str());
    }
  }
  return lines;
}

}  // namespace

void require_golden(const std::string& name, const std::vector<SphericalHarmonics>& results) {
  const std::string path = std::string(WELKIN_TEST_DATA) + "/golden_" + name + ".txt";
  const std::vector<std::string> lines = lines_of(results);
  if (std::getenv("WELKIN_RECORD_GOLDEN") != nullptr) {
    std::ofstream out(path);
    for (const std::string& line : lines) out << line << '\n';
    return;
  }
  std::ifstream in(path);
  REQUIRE(in);
  std::size_t at = 0;
  for (std::string line; std::getline(in, line); ++at) {
    REQUIRE(at < lines.size());
    CHECK(lines[at] == line);
  }
  CHECK(at == lines.size());
}

}  // namespace welkin::test
