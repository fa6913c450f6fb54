// What is made of coefficients.
#include "c_interface/harmonics.h"

#include <algorithm>
#include <glm/vec3.hpp>

#include "c_interface/error_status.h"
#include "welkin/welkin.h"

namespace welkin::c_interface {

SphericalHarmonics read_harmonics(std::int32_t bands, const double* coefficients, const char* name) {
  require(coefficients, name);
  SphericalHarmonics harmonics(bands);
  for (glm::dvec3& rgb : harmonics.coefficients()) {
    rgb = {coefficients[0], coefficients[1], coefficients[2]};
    coefficients += 3;
  }
  return harmonics;
}

}  // namespace welkin::c_interface

using namespace welkin::c_interface;  // NOLINT(google-build-using-namespace)

welkin_status welkin_irradiance_from_radiance(int32_t bands, const double* radiance, double* irradiance) {
  return guarded([&] {
    require(irradiance, "irradiance");
    const auto result = welkin::irradiance_from_radiance(read_harmonics(bands, radiance, "radiance"));
    for (const glm::dvec3& rgb : result.coefficients()) {
      for (int channel = 0; channel < 3; ++channel) *irradiance++ = rgb[channel];
    }
    return WELKIN_OK;
  });
}

welkin_status welkin_evaluate(int32_t bands, const double* coefficients, const double* direction, double* value) {
  return guarded([&] {
    require(direction, "direction");
    require(value, "value");
    const glm::dvec3 rgb = welkin::evaluate(read_harmonics(bands, coefficients, "coefficients"),
                                            {direction[0], direction[1], direction[2]});
    for (int channel = 0; channel < 3; ++channel) value[channel] = rgb[channel];
    return WELKIN_OK;
  });
}
