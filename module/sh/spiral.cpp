#include "sh/spiral.h"

#include <cmath>
#include <string>

#include "tables/trigonometry.h"
#include "welkin/error.h"

namespace welkin::sh {
namespace {

constexpr int kMostNormals = 100'000;

}  // namespace

std::vector<glm::dvec3> spiral(int count) {
  if (count < 1 || count > kMostNormals) {
    throw Error(ErrorCode::invalid_argument,
                std::to_string(count) + " normals; 1 to " + std::to_string(kMostNormals) + " are possible");
  }
  const double golden = 0.5 * (3.0 - std::sqrt(5.0));  // of a turn
  std::vector<glm::dvec3> normals;
  for (int i = 0; i < count; ++i) {
    const double y = 1.0 - (2.0 * i + 1.0) / count;
    const double ring = std::sqrt((1.0 - y) * (1.0 + y));
    const tables::SineCosine azimuth = tables::sine_cosine_of_turns(golden * i);
    normals.emplace_back(ring * azimuth.sine, y, ring * azimuth.cosine);
  }
  return normals;
}

}  // namespace welkin::sh
