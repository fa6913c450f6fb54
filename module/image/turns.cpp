#include <cmath>
#include <string>

#include "tables/trigonometry.h"
#include "welkin/error.h"
#include "welkin/resampling.h"

namespace welkin {

glm::dmat3 turn_about_y(double degrees) {
  if (!(std::abs(degrees) <= 1e6)) {
    throw Error(ErrorCode::invalid_argument,
                "a turn of " + std::to_string(degrees) + " degrees about y; it must be within 1e6 degrees");
  }
  const tables::SineCosine turn = tables::sine_cosine_of_turns(degrees / 360.0);
  return {glm::dvec3(turn.cosine, 0.0, -turn.sine), glm::dvec3(0.0, 1.0, 0.0), glm::dvec3(turn.sine, 0.0, turn.cosine)};
}

}  // namespace welkin
