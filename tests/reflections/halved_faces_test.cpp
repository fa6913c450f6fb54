// Faces with half as many texels: uniform light, places of light, and instruction sets.
#include "reflections/halved_faces.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "image/geometry.h"
#include "support/catch.h"
#include "support/same_bits.h"
#include "welkin/core.h"

namespace welkin::test {
namespace {

std::size_t floats_of(int size) { return std::size_t{18} * static_cast<std::size_t>(size * size); }

std::vector<const float*> rows_of(const std::vector<float>& faces, int size) {
  std::vector<const float*> rows;
  for (int row = 0; row < 6 * size; ++row) rows.push_back(faces.data() + std::ptrdiff_t{3} * size * row);
  return rows;
}

std::vector<float> black(int size) { return std::vector<float>(floats_of(size), 0.0F); }

}  // namespace

TEST_CASE("uniform light stays uniform on halved faces", "[prefilter][halved]") {
  const std::vector<float> faces(floats_of(64), 0.7F);
  for (const int size : {32, 8}) {
    const auto halved = reflections::halved_faces(rows_of(faces, 64), size, {});
    float worst = 0.0F;
    for (std::size_t k = 0; k < floats_of(size); ++k) worst = std::max(worst, std::abs(halved.data()[k] / 0.7F - 1.0F));
    CHECK(worst < 2e-6F);
  }
}

// A mean over 2 x 2 texels moves it by a quarter of a large one.
TEST_CASE("a texel's light stays where it was on halved faces", "[prefilter][halved]") {
  constexpr int size = 64;
  constexpr int half = size / 2;
  const auto fine = image::FaceSolidAngles::get(size);
  const auto coarse = image::FaceSolidAngles::get(half);
  const int row = GENERATE(0, 1, 2, 12, 31, 50, 63);
  const int column = GENERATE(0, 1, 17, 40, 62);
  std::vector<float> faces = black(size);
  faces[3 * static_cast<std::size_t>((2 * size + row) * size + column)] = 1.0F;
  const auto halved = reflections::halved_faces(rows_of(faces, size), half, {});
  glm::dvec3 moments(0.0);  // light, and light times its place in fine texels
  for (int r = 0; r < half; ++r) {
    for (int c = 0; c < half; ++c) {
      const double light = coarse->at(r, c) * static_cast<double>(halved.data()[3 * ((2 * half + r) * half + c)]);
      moments += light * glm::dvec3(1.0, 2 * c + 0.5, 2 * r + 0.5);
    }
  }
  CAPTURE(row, column);
  // beside edges the share of what lies beyond depends on how fast solid angles change there
  const auto beside_edge = [](int at) { return std::min(at, size - 1 - at) < 11; };
  const double tolerance = beside_edge(row) || beside_edge(column) ? 0.04 : 2e-3;
  CHECK(moments.x == Approx(fine->at(row, column)).epsilon(tolerance));
  CHECK(std::abs(moments.y / moments.x - column) < std::max(tolerance, 0.004));
  CHECK(std::abs(moments.z / moments.x - row) < std::max(tolerance, 0.004));
}

TEST_CASE("halved faces have the same bits with every instruction set", "[prefilter][halved]") {
  constexpr int size = 48;
  std::vector<float> faces = black(size);
  std::uint32_t state = 7;
  for (float& value : faces) value = static_cast<float>((state = state * 1664525U + 1013904223U) >> 8U) * 0x1p-24F;
  const InstructionSet before = active_instruction_set();
  std::vector<float> first;
  for (const InstructionSet set : available_instruction_sets()) {
    force_instruction_set(set);
    const auto halved = reflections::halved_faces(rows_of(faces, size), 24, {});
    const std::vector<float> values(halved.data(), halved.data() + floats_of(24));
    if (first.empty()) first = values;
    CHECK(same_bytes<float>(values, first));
  }
  force_instruction_set(before);
}

}  // namespace welkin::test
