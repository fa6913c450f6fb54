#include "baker.h"

namespace engine_loop {

void Baker::keep(std::size_t number, Clock::time_point asked, const welkin::Projection& light) {
  place(number) = {light.radiance, light.diagnostics.texels, milliseconds(Clock::now() - asked)};
}

void Baker::give_up(std::size_t number) { place(number) = {}; }

Baked& Baker::place(std::size_t number) {
  if (baked_.size() <= number) baked_.resize(number + 1);
  return baked_[number];
}

}  // namespace engine_loop
